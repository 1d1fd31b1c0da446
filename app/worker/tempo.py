"""When the next iteration of a run is due."""

from __future__ import annotations

import time

LONGEST_REST = 60.0
"""Seconds after which a very slow run looks at the clock again."""


class Tempo:
    """The pace of a run, its pause, and the steps that were asked for.

    Parameters
    ----------
    pace, pause_after
        As in a Run.
    """

    def __init__(self, pace: float | None, pause_after: int | None) -> None:
        self._pace = pace
        self._pause_after = pause_after
        self._steps = 0
        self._due = time.monotonic() + self._interval

    def change(self, pace: float | None) -> None:
        """Go on at another pace, without a pause and without steps."""
        self._steps = 0
        self._pace = pace
        self._pause_after = None
        self._due = min(self._due, time.monotonic() + self._interval)

    def step(self, count: int) -> None:
        """Do so many more iterations, and wait."""
        self._pace = 0
        self._steps += count

    def count(self) -> None:
        """Count an iteration that begins now."""
        self._steps = max(self._steps - 1, 0)
        self._due = max(self._due + self._interval, time.monotonic())

    def rest(self, done: int) -> float | None:
        """Give the seconds until the next iteration is due; None waits for an order."""
        if self._steps:
            return 0.0
        paused = self._pause_after is not None and done >= self._pause_after
        if paused or self._pace == 0:
            return None
        return min(max(self._due - time.monotonic(), 0.0), LONGEST_REST)

    @property
    def _interval(self) -> float:
        return 1.0 / self._pace if self._pace else 0.0
