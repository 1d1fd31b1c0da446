"""When the next iteration of a run is due."""

from __future__ import annotations

import math
import time

from app.messages import WHOLE

WHOLE_LASTS, FIRST = 3.0, 0.25
"""Seconds that a search takes at the pace `WHOLE`, and those before its second iterate. Intervals
shrink by one ratio: each of the first iterates is seen, and a hundred last as long as thirty."""
LATE = 0.1
"""Seconds that iterations may be behind and catch up: pictures are painted in between."""


class Pacing:
    """The pace of a run, and the steps that were asked for.

    Parameters
    ----------
    pace
        Iterations a second, as in `Start`.
    """

    def __init__(self, pace: float) -> None:
        self._pace, self._steps, self._done = pace, 0, 0
        self._due = time.monotonic()

    def change(self, pace: float) -> None:
        """Go on at another pace."""
        self._pace, self._steps = pace, 0
        self._due = min(self._due, time.monotonic() + self._interval())

    def step(self, count: int) -> None:
        """Do so many iterations, and wait."""
        self._pace = 0.0
        self._steps += count

    def count(self, number: int) -> None:
        """Count the iteration that was done."""
        self._done = number
        self._steps = max(self._steps - 1, 0)
        self._due = max(self._due, time.monotonic() - LATE) + self._interval()

    def rest(self) -> float | None:
        """Seconds until the next iteration is due; None waits for an order."""
        if self._steps:
            return 0.0
        return None if self._pace == 0.0 else max(self._due - time.monotonic(), 0.0)

    @property
    def goes_on(self) -> bool:
        """Whether it does not wait."""
        return self._pace != 0.0 or self._steps > 0

    def _interval(self) -> float:
        if self._pace == WHOLE:
            return FIRST * float((1.0 - FIRST / WHOLE_LASTS) ** self._done)
        return 1.0 / self._pace if 0.0 < self._pace < math.inf else 0.0
