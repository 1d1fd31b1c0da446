"""A worker shows separated bases as asked, with the full linear stage beside them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from direct_runs import direct, iterate_number, timeless

from app.recording import Recording
from app.views.basis_size import MOST_COLUMNS, BasisSize
from app.views.convergence import Convergence
from app.views.drawing import Picture, View
from app.views.error_time import ErrorTime
from app.views.modes import SpaceModes, TimeFunctions
from app.views.spectra import Spectra
from app.worker.checkpoints import Checkpoints
from app.worker.orders import Run, Seek, Watch
from app.worker.reports import Frame, Progress, Report, Waiting
from app.worker.rivals import References
from app.worker.run import WorkerRun
from app.worker.shown import MOST_MODES, MOST_SIZES, Bases, ShownModes
from solver.latin import Record
from solver.scenes.bar import BarSettings

SMALL: dict[str, Any] = {
    "method": "paper",
    "linear_stage": "pgd",
    "elements": 20,
    "instants": 31,
    "substructures": 4,
    "max_iterations": 25,
}
ALL = frozenset({"modes", "spectra"})
REFERENCES = References()


class Told:
    """A run in this process, and all that it has said."""

    def __init__(self, order: Run) -> None:
        self.reports: list[Report] = []
        self.run = WorkerRun(order, self.reports.append, lambda: False, REFERENCES)
        self.work()

    def work(self) -> None:
        while self.run.rest() is not None:
            self.run.advance()

    def asked(self, order: Seek | Watch) -> Frame:
        """Give the answer to an order."""
        self.run.obey(order)
        self.work()
        return self.frames[-1]

    @property
    def frames(self) -> list[Frame]:
        return [report for report in self.reports if isinstance(report, Frame)]

    @property
    def progress(self) -> list[Progress]:
        return [report for report in self.reports if isinstance(report, Progress)]

    @property
    def records(self) -> list[Record]:
        return [entry for part in self.progress for entry in part.records]

    @property
    def beside(self) -> list[Record]:
        return [entry for part in self.progress for entry in part.beside]

    @property
    def sizes(self) -> list[list[int]]:
        parts = [part.sizes for part in self.progress if part.sizes is not None]
        return [row.tolist() for part in parts for row in part]


def told(values: dict[str, Any], **options: Any) -> Told:
    return Told(Run(1, "bar", values, **options))


def shown(frame: Frame) -> Bases:
    assert frame.bases is not None
    return frame.bases


def shown_modes(frame: Frame) -> ShownModes:
    modes = shown(frame).modes
    assert modes is not None
    return modes


def test_the_full_linear_stage_sends_nothing_of_bases() -> None:
    found = told({**SMALL, "linear_stage": "full"}, watch=ALL)
    assert all(frame.bases is None for frame in found.frames)
    assert all(part.sizes is None and part.beside == () for part in found.progress)


def test_modes_and_their_sizes_are_sent_only_when_watched() -> None:
    found = told(SMALL)
    bare = shown(found.frames[-1])
    assert bare.modes is bare.values is None
    for watch in (frozenset({"modes"}), frozenset({"spectra"}), ALL):
        bases = shown(found.asked(Watch(1, watch)))
        assert (bases.modes is not None) == ("modes" in watch)
        assert (bases.values is not None) == ("spectra" in watch)


@pytest.mark.parametrize(("wanted", "found"), [(None, 3), (0, 0), (2, 2), (99, 3)])
def test_modes_are_those_of_the_chosen_substructure(wanted: int | None, found: int) -> None:
    frame = told(SMALL, watch=ALL, substructure=wanted).frames[-1]
    assert shown(frame).substructure == found
    along = np.linspace(found, found + 1, 6) / 4.0
    assert shown_modes(frame).positions == pytest.approx(along)


def test_shown_modes_times_their_functions_are_the_displacement() -> None:
    values = {**SMALL, "pgd_modes": MOST_MODES}
    modes = shown_modes(told(values, watch=ALL).frames[-1])
    field = modes.space_modes.T @ modes.time_functions
    # Where two substructures meet, the displacement is the mean of both.
    expected = iterate_number(25, values).displacement[16:20]
    assert field[1:-1] == pytest.approx(expected, abs=1e-9)


def test_modes_are_drawn_with_a_largest_entry_of_one_and_a_last_lobe_upwards() -> None:
    for mode in shown_modes(told(SMALL, watch=ALL).frames[-1]).space_modes:
        assert np.abs(mode).max() == pytest.approx(1.0)
        assert mode[np.abs(mode) >= 0.5][-1] > 0.0


def test_what_was_there_was_added_and_was_dropped_adds_up() -> None:
    found = told(SMALL, watch=ALL)
    before = 0
    for number in range(1, 26):
        modes = shown_modes(found.asked(Seek(1, number)))
        assert modes.record.modes == before + modes.record.added - modes.lost
        assert modes.record.modes == found.sizes[number - 1][-1]
        assert modes.record.added or not modes.born.any()
        before = modes.record.modes
    assert shown_modes(found.asked(Seek(1, 1))).born.all()


def test_modes_are_together_as_large_as_the_field_that_they_hold_once_it_has_converged() -> None:
    generous = {**SMALL, "pgd_modes": 20, "pgd_tolerance": 1e-10, "max_iterations": 300}
    values = shown(told(generous, watch=ALL).frames[-1]).values
    assert values is not None
    assert np.linalg.norm(values.basis) == pytest.approx(np.linalg.norm(values.wanted), rel=1e-3)


def test_numbers_of_modes_are_sent_for_a_screenful_of_substructures() -> None:
    found = told({**SMALL, "elements": 200, "substructures": 200, "max_iterations": 3})
    assert {len(row) for row in found.sizes} == {MOST_SIZES}
    assert len(found.sizes) == len(found.records) == 3


@pytest.mark.parametrize(
    "change",
    [
        pytest.param({}, id="as long as the bases"),
        pytest.param({"max_iterations": 400, "tolerance": 1e-6, "pgd_modes": 2}, id="ends before"),
        pytest.param({"method": "fast"}, id="fast"),
    ],
)
def test_full_stage_beside_the_bases_is_a_run_of_its_own(change: dict[str, Any]) -> None:
    values = {**SMALL, **change}
    found = told(values)
    full = direct({**values, "linear_stage": "full", "finish": "none"})
    assert timeless(found.beside) == timeless(full.records)[: len(found.records)]
    assert timeless(found.records) == timeless(direct(values).records)


def test_checkpoints_count_their_bases_as_memory() -> None:
    iterate = iterate_number(5, SMALL)
    size = iterate.outgoing.nbytes
    kept = Checkpoints(budget=round(2.5 * size))
    for number in (1, 2):
        kept.keep(replace(iterate.checkpoint, number=number))
    assert kept.before(2) is None


def test_views_draw_a_run_on_bases_and_what_they_draw_is_bounded() -> None:
    found = told(SMALL, watch=ALL)
    recording = Recording(1, BarSettings.checked(SMALL), "")
    for report in found.reports:
        if not isinstance(report, Waiting):
            recording.take(report)
    recording.sizes *= 100
    basis_size = BasisSize(lambda number: None)
    views: list[View] = [
        SpaceModes(),
        TimeFunctions(),
        basis_size,
        Convergence(),
        Spectra(),
        ErrorTime(),
    ]
    picture = Picture(recording, None, (), recording.newest, 0)
    for view in views:
        assert view.applies(recording.settings)
        view.draw(picture)
        view.draw(picture)
    (image,) = basis_size._image.data["image"]
    assert image.shape == (4, MOST_COLUMNS)
