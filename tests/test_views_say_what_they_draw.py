"""What a view draws is what its legend names, over all of the axes that it draws it on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.recording import Recording
from app.views.axial import Axial
from app.views.convergence import Convergence
from app.views.drawing import Picture, View
from app.views.error_time import ErrorTime
from app.views.friction import FrictionForce
from app.views.loop import Loop
from app.views.status_map import StatusMap
from app.views.tractions import Tractions
from app.worker.orders import Look, Run
from app.worker.reports import Waiting
from app.worker.rivals import References
from app.worker.run import WorkerRun
from solver.scenes import CATALOGUE

SMALL: dict[str, dict[str, Any]] = {
    "bar": {"elements": 20, "instants": 21, "substructures": 4},
    "strand": {"elements": 10, "instants": 11},
    "block": {"elements": 16, "elements_up": 6, "instants": 13},
    "layers": {"elements": 16, "layers": 2, "instants": 13},
}


def recorded(
    scene: str, ticket: int, watch: frozenset[str] = frozenset({"axial"}), **changes: Any
) -> Recording:
    """Do a short run and keep what a page keeps of it."""
    values = {**SMALL[scene], "max_iterations": 4, **changes}
    kept = Recording(ticket, CATALOGUE[scene].settings.checked(values), "")

    def take(report: Any) -> None:
        if not isinstance(report, Waiting):
            kept.take(report)

    order = Run(ticket, scene, values, watch=watch, look=Look())
    run = WorkerRun(order, take, lambda: False, References())
    while run.rest() is not None:
        run.advance()
    return kept


def draw(view: View, run: Recording, *past: Recording) -> list[str]:
    """Draw a run beside those before it; give the words of the legend."""
    view.draw(Picture(run, past[-1] if past else None, past, run.newest, 5))
    return [key.text for key in view.keys]


def test_the_ghost_of_the_loop_is_the_run_before_and_not_its_reference() -> None:
    before, run = recorded("bar", 1, method="paper", max_iterations=2), recorded("bar", 2)
    view = Loop()
    assert "run before" in draw(view, run, before)
    assert before.newest is not None
    assert before.reference is not None
    drawn = view._ghost.data["x"] * view._scales[0]
    assert drawn == pytest.approx(before.newest.end_displacement, rel=1e-5)
    assert drawn != pytest.approx(before.reference.end_displacement, rel=0.01)


def test_a_loop_of_other_quantities_is_no_ghost() -> None:
    before, run = recorded("layers", 1, bending="moment"), recorded("layers", 2)
    assert "run before" not in draw(Loop(), run, before)


@pytest.mark.parametrize(
    ("scene", "has_closed_form"), [("bar", True), ("strand", False)], ids=["bar", "strand"]
)
def test_a_legend_names_only_curves_that_are_there(scene: str, has_closed_form: bool) -> None:
    run = recorded(scene, 1)
    bare = replace(run, reference=None)
    for view in (FrictionForce(), Loop(), ErrorTime()):
        first, alone = draw(view, bare), draw(view, run)
        assert not {"reference", "incremental", "run before"} & set(first)
        assert {"reference", "incremental"} & set(alone)
        assert ("closed form" in alone) == (has_closed_form and isinstance(view, FrictionForce))


def test_curves_that_begin_above_ten_are_not_cut_off() -> None:
    run = recorded("block", 1)
    run.records[0] = replace(run.records[0], behaviour=31.0)
    view = Convergence()
    draw(view, run)
    assert view.figure.y_range.end == 100.0
    draw(view, recorded("bar", 2))
    assert view.figure.y_range.end == 10.0


def test_the_line_of_the_incremental_solver_goes_with_its_time() -> None:
    run = recorded("bar", 1)
    view = ErrorTime()
    draw(view, run)
    assert view._incremental.visible
    draw(view, replace(run, ticket=2, reference=None), run)
    assert not view._incremental.visible


def test_past_runs_differ_in_color_and_keep_theirs() -> None:
    run = recorded("bar", 1)
    tickets = [1, 3, 7, 13, 19, 20, 26, 32]
    past = [replace(run, ticket=ticket) for ticket in tickets]
    view, seen = ErrorTime(), {}
    for last in range(1, len(past) + 1):
        kept = past[max(0, last - 6) : last]
        draw(view, replace(run, ticket=100 + last), *kept)
        colors = dict(zip([one.ticket for one in kept], view._past.data["color"], strict=True))
        assert len(set(colors.values())) == len(kept)
        assert all(seen.get(ticket, color) == color for ticket, color in colors.items())
        seen.update(colors)


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_all_axes_along_a_scene_run_from_end_to_end(scene: str) -> None:
    run = recorded(scene, 1)
    views = (FrictionForce(), Tractions(), Axial(), StatusMap(lambda time: None))
    for view in (view for view in views if view.applies(run.settings)):
        draw(view, run)
        scale = view.figure.x_range
        assert np.array_equal([scale.start, scale.end], [0.0, run.settings.values()["length"]])
