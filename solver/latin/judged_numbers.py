"""The numbers by which an iterate is judged, and when they are worth computing."""

from __future__ import annotations

import math
from functools import cached_property

from solver.latin.estimate import ErrorEstimate
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.latin.iterate import Iterate

LARGEST_VIOLATION = 1e-2
"""Of the k-free indicator at the end, however loose the tolerance."""
SMALLEST_VIOLATION = 1e-12
"""The same however tight it is."""
VIOLATION = 1.0
"""Times the root of the tolerance on eta, which is a ratio of squares: what the k-free indicator
may be at the end, between the two bounds above. By default the friction force is then within 0.1 %
(block, layers) to 2 % (40 wires) of the reference; with 100 it was up to 20 % off (measured)."""
SHARE = 8
"""A value that is awaited is computed again at the latest after this part of the iterations."""


class Numbers:
    """Numbers by which one iterate is judged, each computed when it is first needed."""

    def __init__(self, iterate: Iterate, estimate: ErrorEstimate) -> None:
        self.iterate, self.estimate = iterate, estimate

    @cached_property
    def indicator(self) -> float:
        """LATIN indicator eta, a ratio of squares (paper, eq. 2)."""
        return latin_indicator(self.iterate)

    @cached_property
    def behaviour(self) -> float:
        """The k-free indicator (solver/README.md, 4)."""
        return behaviour_indicator(self.iterate)

    @cached_property
    def estimated_error(self) -> float:
        """Relative error of the contact force, estimated; NaN while that cannot be."""
        return self.estimate(self.iterate, self.known("indicator"))

    def known(self, name: str) -> float:
        """One of these numbers if it was computed, else NaN."""
        value: float = self.__dict__.get(name, math.nan)
        return value

    def is_low(self, tolerance: float, awaited: Awaited) -> bool:
        """Whether the LATIN indicator is low enough, and the k-free one agrees."""
        awaited.saw(self.iterate.number, self.indicator, tolerance)
        return self.indicator <= tolerance and self.agree(tolerance)

    def agree(self, tolerance: float) -> bool:
        """Whether the k-free indicator says converged, or the solution itself does.

        The LATIN indicator alone can be fooled: a search direction that is far from the stiffness
        in play makes it as small as one likes (solver/README.md, 4). The k-free one is a share of
        what contact carries, which is nothing where all contacts open.
        """
        enough = min(max(VIOLATION * math.sqrt(tolerance), SMALLEST_VIOLATION), LARGEST_VIOLATION)
        return self.behaviour <= enough or self.estimate.is_proven_within(enough, self.iterate)


class Awaited:
    """The next iteration at which a number that falls towards a level is worth computing.

    Half way to where its last two values would have it cross the level; while it does not fall,
    after half of the longest wait. So it is missed by little, and only if it falls suddenly.
    """

    def __init__(self) -> None:
        self.next = 0
        self._last = (0, math.nan)

    def is_due(self, iteration: int) -> bool:
        """Whether to compute it at this iteration."""
        return iteration >= self.next

    def saw(self, iteration: int, value: float, level: float) -> None:
        """Take in a value."""
        before, last = self._last
        self._last = iteration, value
        left = 0.0
        if level < value < last and iteration > before:
            rate = math.log(last / value) / (iteration - before)
            left = 0.5 * math.log(value / level) / rate
        least = 0 if value <= level else iteration // (2 * SHARE)
        self.next = iteration + 1 + max(int(min(left, iteration / SHARE)), least)
