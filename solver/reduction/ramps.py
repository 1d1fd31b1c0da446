"""Ramps between two stops: what the friction of a point is, as long as the load goes one way.

Inside one monotone branch of the load, a point keeps the friction that it had before, then
follows the load in proportion, then slips at its bound (solver/README.md, 16). So its friction is
min(1, max(low, a g + b)), as a share of its bound, with the load g counted in the branch's way:
what is clipped is a straight line. Where the clip shows the line at one instant, or at none, many
lines give the same friction, and the steepest that fits is taken.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array

STEPS = 2
"""Passes in which a line is fitted again to the instants at which its own clip shows it. With none
the error is up to a tenth larger on iterates of the bar, with 20 the same (measured)."""
BANDS = (1e-9, 1e-3, 0.03, 0.25)
"""Shares of the way from low to 1 that an entry must lie inside to be taken as one of the line: the
first for an exact field, the others for iterates, which come near a stop and do not reach it."""
QUARTERS = 0.25, 0.75
"""Shares of that way, between whose crossings a line is drawn. Without it, an iterate 1e-3 from the
solution of the bar is missed by 0.16, with it by 7e-4 (measured)."""
BELOW = -2.0
"""A line that lies below all shares: the point keeps what it has."""


@dataclass(frozen=True, eq=False)
class Seen:
    """Shares of the bound at the points in one branch, each counted in the way that it goes.

    Attributes
    ----------
    shares
        Shape (n_points, n_instants).
    low
        What each had when the branch began, from -1 to 1, shape (n_points, 1), or
        (n_points, n_instants) where the bound changes.
    load
        Rising, shape (n_instants,).
    before
        The load when the branch began.
    weights
        Of the instants, shape (n_instants,), non-negative.
    """

    shares: Array
    low: Array
    load: Array
    before: float
    weights: Array

    def clipped(self, slope: Array, offset: Array) -> Array:
        """Lines, shapes (n_points,), clipped between both stops, (n_points, n_instants)."""
        line = slope[:, None] * self.load + offset[:, None]
        return np.minimum(1.0, np.maximum(self.low, line))

    def miss(self, slope: Array, offset: Array) -> Array:
        """Squared error of clipped lines, shape (n_points,)."""
        return np.asarray((self.clipped(slope, offset) - self.shares) ** 2 @ self.weights)


def fitted(seen: Seen) -> tuple[Array, Array]:
    """Slope and offset of the line fitted to every point, (n_points,) each.

    A point that keeps what it has gets a slope of 0, and all others one above.
    """
    count = len(seen.shares)
    slope, offset = np.zeros(count), np.full(count, BELOW)
    missed = seen.miss(slope, offset)

    def keep(line: tuple[Array, Array]) -> None:
        usable = np.isfinite(line[0]) & np.isfinite(line[1]) & (line[0] > 0.0)
        tried = np.where(usable, line[0], 0.0), np.where(usable, line[1], BELOW)
        misses = seen.miss(*tried)
        better = misses < missed
        for kept, new in ((missed, misses), (slope, tried[0]), (offset, tried[1])):
            kept[better] = new[better]

    depth = np.minimum(seen.shares - seen.low, 1.0 - seen.shares)
    for line in _through_one(seen, depth):
        keep(line)
    keep(_between_quarters(seen))
    for band in BANDS:
        keep(_regression(seen, depth > band * (1.0 - seen.low)))
    for _ in range(STEPS):
        line = slope[:, None] * seen.load + offset[:, None]
        keep(_regression(seen, (line > seen.low) & (line < 1.0)))
    return slope, offset


def _with_before(seen: Seen) -> tuple[Array, Array]:
    """Shares and loads with those at the branch's beginning in front."""
    return np.hstack([seen.low[:, :1], seen.shares]), np.append(seen.before, seen.load)


def _through_one(seen: Seen, depth: Array) -> list[tuple[Array, Array]]:
    """Lines through the entry that lies deepest between the stops, or the first at the upper.

    They are as steep as the point ever is, which is exact where the clip shows the line at one
    instant, or at none; as steep as on its way there; and on its way from there.
    """
    shares, loads = _with_before(seen)
    rises = np.diff(loads)
    slopes = np.diff(shares) / np.where(rises > 0.0, rises, np.inf)
    above = seen.shares >= 0.5 * (seen.low + 1.0)
    inside = depth.max(axis=1) > BANDS[0]
    points = np.arange(len(shares))
    deepest = np.where(inside, depth.argmax(axis=1), above.argmax(axis=1))
    after = np.minimum(deepest + 1, len(rises) - 1)
    at, there = seen.load[deepest], seen.shares[points, deepest]
    steep = (slopes.max(axis=1), slopes[points, deepest], slopes[points, after])
    return [(slope, there - slope * at) for slope in steep]


def _between_quarters(seen: Seen) -> tuple[Array, Array]:
    """Lines through the places where the friction crosses two shares of its way to the bound.

    Noise at the stops does not move these.
    """
    (first, low), (last, high) = (_crossing(seen, quarter) for quarter in QUARTERS)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = (high - low) / (last - first)
        return slope, low - slope * first


def _crossing(seen: Seen, quarter: float) -> tuple[Array, Array]:
    """Load at which a share of the way is first exceeded, and the friction there."""
    shares, loads = _with_before(seen)
    levels = np.broadcast_to(seen.low + quarter * (1.0 - seen.low), seen.shares.shape)
    above = seen.shares >= levels
    place = np.where(above.any(axis=1), above.argmax(axis=1), above.shape[1] - 1)
    points = np.arange(len(place))
    level, old = levels[points, place], shares[points, place]
    rise = shares[points, place + 1] - old
    part = np.clip((level - old) / np.where(rise == 0.0, 1.0, rise), 0.0, 1.0)
    return loads[place] + part * (loads[place + 1] - loads[place]), level


def _regression(seen: Seen, free: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Lines fitted to some of the entries; where these are fewer than two, not a number."""
    weights = free * seen.weights
    with np.errstate(divide="ignore", invalid="ignore"):
        whole = weights.sum(axis=1)
        middle = weights @ seen.load / whole
        mean = (weights * seen.shares).sum(axis=1) / whole
        apart = seen.load - middle[:, None]
        weights *= apart
        slope = (weights * seen.shares).sum(axis=1) / (weights * apart).sum(axis=1)
        return slope, mean - slope * middle
