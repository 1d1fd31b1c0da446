"""Statuses that change from one iterate to the next are counted, and the law says why."""

from __future__ import annotations

from itertools import islice, pairwise

import numpy as np
import pytest
from shown_pages import SMALL, Shown

from app.wire.orders import Seek
from solver.latin import Iterate, iterations
from solver.latin.status_changes import over_bound, status_changes
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of


def iterates(scene: str, count: int = 8) -> list[Iterate]:
    settings = CATALOGUE[scene].settings.checked({**SMALL[scene], "method": "paper"})
    return list(islice(iterations(discretise(settings), method_of(settings)), count))


@pytest.mark.parametrize("scene", CATALOGUE)
def test_every_change_is_of_one_kind_and_has_the_reason_that_its_kind_says(scene: str) -> None:
    seen = 0
    for before, iterate in pairwise(iterates(scene)):
        for name, law in iterate.problem.rubbing.items():
            found = status_changes(iterate, before, name)
            changed = iterate.status_at(law) != before.status_at(law)
            assert np.array_equal(found.all, changed)
            assert sum(found.counts.values()) == changed.sum()
            over = over_bound(law, iterate)
            assert over[found.slip | found.turn].all()
            assert not over[found.stick].any()
            seen += changed.sum()
    assert seen > 0


def test_a_point_sticks_again_where_friction_at_its_bound_would_drive_its_slip() -> None:
    seen = 0
    for before, iterate in pairwise(iterates("bar", 20)):
        ((name, law),) = iterate.problem.rubbing.items()
        stick = status_changes(iterate, before, name).stick
        way = before.status_at(law)[law.points]
        moved, force = iterate.local_displacement, iterate.boundary_local_force
        above = law.tangent.above
        # Held at its bound against the slip that there was, from where it stood before.
        bound = -way * law.tangential.bound
        slipped = iterate.local_incoming[above] + bound / iterate.k[above, None]
        slipped -= np.concatenate([np.zeros((len(above), 1)), moved[above][:, :-1]], axis=1)
        assert np.all((way * slipped)[stick[law.points]] <= 1e-12 * np.abs(moved).max())
        seen += stick.sum()
        assert force.shape == moved.shape
    assert seen > 0


def test_a_page_that_waits_says_what_changed_and_marks_it() -> None:
    shown = Shown()
    shown.run(1, "bar", {**SMALL["bar"], "method": "paper", "max_iterations": 9}, pause_after=5)
    assert "force over its bound" in shown.words
    assert "changed status" in shown.page["stick-and-slip.title"]["text"]
    shown.obey(Seek(1, 4))
    assert "showing iteration 4" in shown.words
    assert "force over its bound" in shown.words


def test_a_run_that_does_not_wait_says_nothing_of_changes() -> None:
    shown = Shown(is_quick=True)
    shown.run(1, "bar", {**SMALL["bar"], "method": "paper", "max_iterations": 9})
    assert all("over its bound" not in one["status"]["text"] for one in shown.models)
