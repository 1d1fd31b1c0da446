"""Every setting of every scene moves to both ends and back, and no run breaks on it."""

from __future__ import annotations

import math

import pytest
from tour import Move, ends, has_errors, never_apply, small, tour

from app.worker.orders import Run
from app.worker.reports import Begun, Frame, Progress, Reference, Report, Unrivalled
from app.worker.rivals import References
from app.worker.run import WorkerRun
from solver.latin import Record
from solver.scenes import CATALOGUE
from solver.settings import Settings

WATCH = frozenset({"mesh", "axial", "spectra", "modes"})
SMALL_ERROR = 0.02


class Told:
    """A run as the worker's process has it, with the references of those before."""

    def __init__(self, settings: Settings, references: References, iterations: int | None) -> None:
        self.reports: list[Report] = []
        order = Run(1, settings.scene, settings.values(), pause_after=iterations, watch=WATCH)
        self.run = WorkerRun(order, self.reports.append, lambda: False, references)
        while self.run.rest() is not None:
            self.run.advance()

    def kinds(self) -> set[type]:
        return {type(report) for report in self.reports}

    @property
    def records(self) -> list[Record]:
        parts = [report for report in self.reports if isinstance(report, Progress)]
        return [record for part in parts for record in part.records]


def goes_on(settings: Settings, references: References) -> None:
    told = Told(settings, references, 3)
    assert {Begun, Frame, Progress} <= told.kinds()
    assert told.records
    errors = [(entry.error_displacement, entry.error_force) for entry in told.records]
    if Reference in told.kinds():
        assert all(math.isfinite(value) for pair in errors for value in pair)
    else:
        assert Unrivalled in told.kinds()
        assert not has_errors(settings)


def described(move: Move) -> str:
    return f"{move.name} = {move.value!r} after {move.before.changed()}"


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_setting_moves_to_both_ends_and_back_and_errors_are_small_at_the_end(
    scene: str,
) -> None:
    references, base = References(), small(scene)
    goes_on(base, references)
    moved: set[str] = set()
    broken: list[str] = []
    for move in tour(base, ends):
        moved.add(move.name)
        if move.starts_a_run:
            try:
                goes_on(move.after, references)
            except Exception as problem:
                broken.append(f"{described(move)}: {problem!r}")
    assert broken == []
    assert set(base.definitions()) - moved == never_apply(scene)
    last = Told(base, references, None).records[-1]
    assert last.error_displacement < SMALL_ERROR
    assert last.error_force < SMALL_ERROR
