"""When to look again at a figure that falls towards a level: seldom while that is far off."""

from __future__ import annotations

import math

SHARE = 8
"""At the latest after this part of the iterations done so far."""


class Lookout:
    """The next iteration at which a figure is worth computing.

    Half way to where the last two values would have it cross its level; while it does not fall,
    after half of the longest wait. So it is missed by little, and only if it falls suddenly.
    """

    def __init__(self) -> None:
        self.next = 0
        self._last = (0, math.nan)

    def is_due(self, iteration: int) -> bool:
        """Tell whether to look at this iteration."""
        return iteration >= self.next

    def saw(self, iteration: int, value: float, level: float) -> None:
        """Take in a value of the figure."""
        before, last = self._last
        self._last = iteration, value
        left = 0.0
        if level < value < last and iteration > before:
            rate = math.log(last / value) / (iteration - before)
            left = 0.5 * math.log(value / level) / rate
        least = 0 if value <= level else iteration // (2 * SHARE)
        self.next = iteration + 1 + max(int(min(left, iteration / SHARE)), least)
