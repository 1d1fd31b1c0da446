"""Every setting of every scene moves to an end and back, and no run or view breaks on it.

Settings of a scene's own move to both ends, and those that it shares with the bar do so there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from shown_pages import Shown
from tour import Move, ends, never_apply, one_end, small, tour

from app.picture.shown import has_reference
from app.worker import rivals
from solver.discrete.problem import Problem
from solver.reference.choice import reference_of
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE
from solver.settings import Settings

FEW = 1
SMALL_ERROR = 0.02


class Page(Shown):
    """Runs one after the other, and all views of a page drawn of them.

    Attributes
    ----------
    lacks
        For each reference that was computed, whether it is none.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__()
        self.lacks: list[bool] = []
        monkeypatch.setattr(rivals, "reference_of", self._reference_of)

    def _reference_of(self, problem: Problem, stop: Callable[[], bool]) -> Reference:
        self.lacks.append(True)
        found = reference_of(problem, stop)
        self.lacks[-1] = not found.converged.all()
        return found

    def try_out(self, settings: Settings, iterations: int | None = FEW) -> None:
        """Do some iterations, or all, and draw them beside the run before."""
        ticket = len(self.pictures) + 1
        self.run(ticket, settings.scene, settings.values(), pause_after=iterations)
        assert not self.pictures[-1].facts.is_broken, self.words


def goes_on(page: Page, settings: Settings) -> None:
    page.try_out(settings)
    found = page.recording
    assert len(found.history)
    if found.reference is not None:
        for name in ("error_displacement", "error_force"):
            assert np.isfinite(found.history.column(name)).all()
    else:
        assert not has_reference(settings) or page.lacks[-1]


def reach(settings: Settings, name: str) -> list[Any]:
    """Give both ends of what is a scene's own, and one of what the bar moves to both."""
    is_the_bars = settings.scene != "bar" and name in CATALOGUE["bar"].settings.definitions()
    return (one_end if is_the_bars else ends)(settings, name)


def described(move: Move) -> str:
    return f"{move.name} = {move.value!r} after {move.before.changed()}"


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_setting_moves_to_its_ends_and_back_and_errors_are_small_at_the_end(
    scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, base = Page(monkeypatch), small(scene)
    goes_on(page, base)
    moved: set[str] = set()
    # The way back leads through runs that were seen.
    seen = [base.values()]
    broken: list[str] = []
    for move in tour(base, reach):
        moved.add(move.name)
        if move.starts_a_run and move.after.values() not in seen:
            seen.append(move.after.values())
            try:
                goes_on(page, move.after)
            except Exception as problem:
                broken.append(f"{described(move)}: {problem!r}")
    assert broken == []
    assert set(base.definitions()) - moved == never_apply(scene)
    page.try_out(base, None)
    last = page.recording.last
    assert last is not None
    assert last.error_displacement < SMALL_ERROR
    assert last.error_force < SMALL_ERROR
