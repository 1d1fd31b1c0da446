"""Every setting of every scene moves to both ends and back, and no run or view breaks on it."""

from __future__ import annotations

import math

import pytest
from tour import described, ends, has_errors, never_apply, small, tour

from app.cards import Cards
from app.recording import Recording
from app.views.drawing import Picture
from app.worker.orders import Run
from app.worker.rivals import References
from app.worker.run import WorkerRun
from solver.scenes import CATALOGUE
from solver.settings import Settings

WATCH = frozenset({"mesh", "axial", "spectra", "modes"})
FEW = 3
SMALL_ERROR = 0.02


class Page:
    """Runs as the worker's process has them, one after the other, and all views of a page."""

    def __init__(self) -> None:
        self._references = References()
        self._cards = Cards("", lambda time: None, lambda number: None, lambda: None)
        self._before: Recording | None = None

    def run(self, settings: Settings, iterations: int | None = FEW) -> Recording:
        """Do some iterations, or all, and draw them beside the run before."""
        before = self._before
        found = Recording(before.ticket + 1 if before else 1, settings, "")
        values = settings.values()
        order = Run(found.ticket, settings.scene, values, pause_after=iterations, watch=WATCH)
        run = WorkerRun(order, found.take, lambda: False, self._references)
        while run.rest() is not None:
            run.advance()
        picture = Picture(found, before, [before] if before else [], found.newest, 5)
        for view in self._cards.fitting(settings):
            view.draw(picture)
        self._before = found
        return found


def goes_on(page: Page, settings: Settings) -> None:
    found = page.run(settings)
    assert found.newest is not None
    assert found.records
    errors = [(entry.error_displacement, entry.error_force) for entry in found.records]
    if found.reference is not None:
        assert all(math.isfinite(value) for pair in errors for value in pair)
    else:
        assert not has_errors(settings)


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_setting_moves_to_both_ends_and_back_and_errors_are_small_at_the_end(
    scene: str,
) -> None:
    page, base = Page(), small(scene)
    goes_on(page, base)
    moved: set[str] = set()
    broken: list[str] = []
    for move in tour(base, ends):
        moved.add(move.name)
        if move.starts_a_run:
            try:
                goes_on(page, move.after)
            except Exception as problem:
                broken.append(f"{described(move)}: {problem!r}")
    assert broken == []
    assert set(base.definitions()) - moved == never_apply(scene)
    last = page.run(base, None).records[-1]
    assert last.error_displacement < SMALL_ERROR
    assert last.error_force < SMALL_ERROR
