"""When the next iteration of a run is due."""

from __future__ import annotations

import time

from app.wire.orders import WHOLE, Rate

LONGEST_REST = 60.0
"""Seconds after which a very slow run looks at the clock again."""
WHOLE_LASTS, FIRST = 3.0, 0.25
"""Seconds that a search takes at its pace, and those before its second iterate. The others follow
sooner by one ratio, so that iterate n + 1 comes after `WHOLE_LASTS` (1 - (1 - 1/12)^n): one sees
each of the first, in which most happens, and a hundred last no longer than thirty."""
LATE = 0.1
"""Seconds that iterations may be behind and catch up: pictures are painted in between."""


class Tempo:
    """The pace of a run, its pause, and the steps that were asked for.

    Parameters
    ----------
    pace, pause_after
        As in a Run.
    """

    def __init__(self, pace: Rate, pause_after: int | None) -> None:
        self._pace = pace
        self._pause_after = pause_after
        self._steps = 0
        self._due = time.monotonic() + self._interval(0)

    def change(self, pace: Rate, done: int) -> None:
        """Go on at another pace, after so many iterations, without a pause and without steps."""
        self._steps = 0
        self._pace = pace
        self._pause_after = None
        self._due = min(self._due, time.monotonic() + self._interval(done))

    def step(self, count: int) -> None:
        """Do so many more iterations, and wait."""
        self._pace = 0
        self._steps += count

    def count(self, done: int) -> None:
        """Count the iteration that begins now, after so many others."""
        self._steps = max(self._steps - 1, 0)
        self._due = max(self._due, time.monotonic() - LATE) + self._interval(done)

    def rest(self, done: int) -> float | None:
        """Give the seconds until the next iteration is due; None waits for an order."""
        if self._steps:
            return 0.0
        paused = self._pause_after is not None and done >= self._pause_after
        if paused or self._pace == 0:
            return None
        return min(max(self._due - time.monotonic(), 0.0), LONGEST_REST)

    @property
    def is_slow(self) -> bool:
        """Whether one has the time to see what each iteration changes."""
        return self._pause_after is not None or (self._pace in (0.0, 1.0))

    def _interval(self, done: int) -> float:
        """Give the seconds between two iterations, after so many of them."""
        if self._pace == WHOLE:
            return FIRST * float((1.0 - FIRST / WHOLE_LASTS) ** done)
        return 1.0 / self._pace if self._pace else 0.0
