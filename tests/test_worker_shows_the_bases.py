"""A worker shows separated bases as asked, with the full linear stage beside them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from direct_runs import direct, iterate_number
from shown_pages import ALL, Shown
from test_worker_process import same

from app.picture.bases import Bases
from app.picture.shown import MOST_MODES, MOST_SIZES, Look, ShownModes
from app.wire.orders import Seek
from app.worker.seeking import Checkpoints

SMALL: dict[str, Any] = {
    "method": "paper",
    "linear_stage": "pgd",
    "elements": 20,
    "instants": 31,
    "substructures": 4,
    "max_iterations": 25,
}


def told(values: dict[str, Any]) -> Shown:
    shown = Shown()
    shown.run(1, "bar", values)
    return shown


@pytest.fixture(scope="module")
def small() -> Shown:
    return told(SMALL)


def bases_of(shown: Shown, look: Look = ALL) -> Bases:
    found = shown.frame(look).bases
    assert found is not None
    return found


def modes_of(shown: Shown, look: Look = ALL) -> ShownModes:
    return bases_of(shown, look).modes


def test_the_full_linear_stage_shows_nothing_of_bases() -> None:
    shown = told({**SMALL, "linear_stage": "full"})
    assert shown.frame().bases is None
    assert not shown.recording.sizes
    assert not len(shown.recording.beside)


def test_modes_and_their_sizes_are_computed_only_for_views_that_are_seen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[str] = []
    for name in ("modes", "values"):
        monkeypatch.setattr(Bases, name, property(lambda bases, name=name: asked.append(name)))
    shown = Shown(Look(views=("Convergence", "PGD basis size")))
    shown.run(1, "bar", SMALL)
    assert asked == []
    bases = bases_of(shown)
    assert (bases.modes, bases.values, asked) == (None, None, ["modes", "values"])


@pytest.mark.parametrize(("wanted", "found"), [(None, 3), (0, 0), (2, 2), (99, 3)])
def test_modes_are_those_of_the_chosen_substructure(
    small: Shown, wanted: int | None, found: int
) -> None:
    look = replace(ALL, substructure=wanted)
    assert bases_of(small, look).substructure == found
    along = np.linspace(found, found + 1, 6) / 4.0
    assert modes_of(small, look).positions == pytest.approx(along)


def test_shown_modes_times_their_functions_are_the_displacement() -> None:
    values = {**SMALL, "pgd_modes": MOST_MODES}
    modes = modes_of(told(values))
    field = modes.space_modes.T @ modes.time_functions
    # Where two substructures meet, the displacement is the mean of both.
    expected = iterate_number(25, values).displacement[16:20]
    assert field[1:-1] == pytest.approx(expected, abs=1e-9)


def test_modes_are_drawn_with_a_largest_entry_of_one_and_a_last_lobe_upwards(small: Shown) -> None:
    for mode in modes_of(small).space_modes:
        assert np.abs(mode).max() == pytest.approx(1.0)
        assert mode[np.abs(mode) >= 0.5][-1] > 0.0


def test_what_was_there_was_added_and_was_dropped_adds_up(small: Shown) -> None:
    shown = small
    before = 0
    for number in range(1, 26):
        shown.obey(Seek(1, number))
        modes = modes_of(shown)
        assert modes.record.modes == before + modes.record.added - modes.lost
        assert modes.record.modes == shown.recording.sizes[number - 1][-1]
        assert modes.record.added or not modes.born.any()
        before = modes.record.modes
    shown.obey(Seek(1, 1))
    assert modes_of(shown).born.all()


def test_modes_are_together_as_large_as_the_field_that_they_hold_once_it_has_converged() -> None:
    generous = {**SMALL, "pgd_modes": 20, "pgd_tolerance": 1e-10, "max_iterations": 100}
    own, wanted = bases_of(told(generous)).values
    assert np.linalg.norm(own) == pytest.approx(np.linalg.norm(wanted), rel=1e-3)


def test_a_certified_solution_stands_beside_the_modes_of_its_search() -> None:
    shown = told({**SMALL, "finish": "at-once", "pgd_modes": 3})
    last = bases_of(shown)
    assert last.is_left
    assert "of the search" in shown.page["pgd-space-modes.title"]["text"]
    shown.obey(Seek(1, shown.recording.iteration - 1))
    before = bases_of(shown)
    assert not before.is_left
    assert np.array_equal(last.modes.space_modes, before.modes.space_modes)
    assert not last.modes.born.any()
    # The field that the modes would have to hold is the solution's, the sizes are their own.
    own, wanted = last.values
    assert own / own[0] == pytest.approx(before.values[0] / before.values[0][0])
    assert np.linalg.norm(wanted[3:]) > 0.0


def test_numbers_of_modes_are_kept_for_a_screenful_of_substructures() -> None:
    shown = told({**SMALL, "elements": 200, "substructures": 200, "max_iterations": 3})
    assert {len(row) for row in shown.recording.sizes} == {MOST_SIZES}
    assert len(shown.recording.sizes) == len(shown.recording.history) == 3


@pytest.mark.parametrize(
    "change",
    [
        pytest.param({}, id="as long as the bases"),
        pytest.param({"max_iterations": 100, "tolerance": 1e-4, "pgd_modes": 2}, id="ends before"),
    ],
)
def test_full_stage_beside_the_bases_is_a_run_of_its_own(change: dict[str, Any]) -> None:
    values = {**SMALL, **change}
    recording = told(values).recording
    full = direct({**values, "linear_stage": "full", "finish": "none"})
    assert same(recording.beside, full.records[: len(recording.history)])
    assert same(recording.history, direct(values).records)


def test_checkpoints_count_their_bases_as_memory() -> None:
    iterate = iterate_number(5, SMALL)
    size = iterate.outgoing.nbytes
    kept = Checkpoints(budget=round(2.5 * size))
    for number in (1, 2):
        kept.keep(replace(iterate.checkpoint, number=number))
    assert kept.before(2) is None


def test_the_map_of_basis_sizes_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.views.reduction.basis_size.MOST_COLUMNS", 20)
    image = told(SMALL).page["pgd-basis-size.image"]["image"]
    assert image.shape == (4, 20)
