"""The play operator: Coulomb friction pointwise, in closed form (MATHEMATICS.md, 2).

A clip of a clip is a clip, so the recursion in time is an associative scan: blocks of
instants are composed side by side. Where the slack changes with the slip that has gone
by, time is walked.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices
from solver.refusal import RefusedError


def play(target: Array, slack: Array) -> Array:
    """Follow a target with Coulomb play.

    Parameters
    ----------
    target
        Position that the point would take without friction, shape (n_points, n_times),
        m.
    slack
        Distance at which it starts to slip, same shape or (n_points,), m; non-negative.

    Returns
    -------
    Position with friction, shape (n_points, n_times), m (MATHEMATICS.md, 2).
    """
    if slack.ndim < target.ndim:
        slack = slack[:, None]
    result: Array = Play(*target.shape)(target, slack).copy()
    return result


class Play:
    """The play operator for fields of one size, as a scan over blocks of instants.

    The positions begin at `start`, shape (n_points,), or at zero.

    A clip is a lower and an upper limit. `_composed[j, 0]` and `_composed[j, 1]` are
    the limits of the clip that the first j + 1 instants of every block make together:
    the positions of a point that enters the block far below, or far above.
    """

    def __init__(self, n_points: int, n_times: int, start: Array | None = None) -> None:
        # Blocks as long as they are many, about: both loops then take the root of the
        # time.
        size = max(2, round(0.5 * np.sqrt(n_times)))
        blocks = -(-n_times // size)
        self._limits = np.zeros((2, blocks, size, n_points))
        low, high = self._limits
        self._low = low.reshape(-1, n_points)[:n_times]
        self._high = high.reshape(-1, n_points)[:n_times]
        self._composed = np.zeros((size, 2, blocks, n_points))
        # Views are made once: the same memory serves every iteration.
        self._steps = [
            (self._composed[j - 1], low[:, j], high[:, j], self._composed[j])
            for j in range(1, size)
        ]
        entry = np.zeros((blocks + 1, n_points))
        entry[0] = 0.0 if start is None else start
        last_low, last_high = self._composed[-1]
        self._carries = list(
            zip(entry[:-1], last_low, last_high, entry[1:], strict=True)
        )
        self._entry = entry[:-1, None]
        self._position = np.zeros((blocks, size, n_points))
        self._result = self._position.reshape(-1, n_points)[:n_times]

    def __call__(self, target: Array, slack: Array) -> Array:
        """Follow a target, (n_points, n_times); the next call overwrites the positions.

        `slack` has the shape of the target, or (n_points, 1).
        """
        np.subtract(target, slack, out=self._low.T)
        np.add(target, slack, out=self._high.T)
        self._composed[0] = self._limits[:, :, 0]
        # Inside all blocks at once, then from block to block, then at all instants.
        for before, low, high, after in self._steps:
            np.maximum(before, low, out=after)
            np.minimum(after, high, out=after)
        for before, low, high, after in self._carries:
            np.maximum(before, low, out=after)
            np.minimum(after, high, out=after)
        low, high = self._composed.transpose(1, 2, 0, 3)
        np.maximum(self._entry, low, out=self._position)
        np.minimum(self._position, high, out=self._position)
        return self._result.T


@dataclass(frozen=True)
class SlipFactor:
    """Factor on the friction bound over accumulated slip, linear between points.

    Attributes
    ----------
    slips
        Accumulated slips, ascending from 0, m, or scaled; beyond the last the factor
        stays.
    factors
        Factors at these slips, non-negative, the first is 1.

    Raises
    ------
    RefusedError
        For slips and factors that are not as above.
    """

    slips: tuple[float, ...]
    factors: tuple[float, ...]

    def __post_init__(self) -> None:
        slips = np.array(self.slips)
        factors = np.array(self.factors)
        is_table = len(slips) == len(factors) >= 2 and np.all(
            np.isfinite([slips, factors])
        )
        begins_at_one = is_table and slips[0] == 0.0 and factors[0] == 1.0
        if not begins_at_one or not np.all(np.diff(slips) > 0):
            raise RefusedError(
                "SlipFactor",
                list(zip(self.slips, self.factors, strict=False)),
                "points (slip, factor), the first (0, 1), with slips that grow",
                "divide all factors by the first, and begin at slip 0",
            )
        if np.any(factors < 0.0):
            raise RefusedError(
                "SlipFactor.factors", factors.min(), "factors from 0 on", "raise it"
            )

    def __call__(self, slip: Array) -> Array:
        """Factor after accumulated slip, of its shape, which is any."""
        factor: Array = np.interp(slip, self.slips, self.factors)
        return factor

    @property
    def slopes(self) -> Array:
        """Slope of the factor between points, 0 beyond, shape (n_points,)."""
        return np.asarray(np.append(np.diff(self.factors) / np.diff(self.slips), 0.0))

    @cached_property
    def rising(self) -> Array:
        """Sum of the rises of the factor up to each point, shape (n_points,)."""
        rises = np.maximum(np.diff(self.factors), 0.0)
        return np.asarray(np.append(0.0, np.cumsum(rises)))

    def rise(self, slip: Array) -> Array:
        """Sum of the rises of the factor, without falls, up to slips of any shape."""
        risen: Array = np.interp(slip, self.slips, self.rising)
        return risen

    def segment(self, slip: Array) -> Indices:
        """Index of the last point up to each slip, of any shape."""
        return np.asarray(np.searchsorted(self.slips, slip, side="right") - 1)

    def slope(self, slip: Array) -> Array:
        """Slope of the factor at slips of any shape."""
        return np.asarray(self.slopes[self.segment(slip)])

    def lowest_slope(self, first: Array, last: Array) -> Array:
        """Smallest slope between a first and a last slip, shape (n,) all."""
        # All segments between the two slips, ends included.
        passed = np.arange(len(self.slips))[:, None]
        on_way = (self.segment(first) <= passed) & (passed <= self.segment(last))
        lowest: Array = np.where(on_way, self.slopes[:, None], np.inf).min(axis=0)
        return lowest


PLAIN = SlipFactor((0.0, 1.0), (1.0, 1.0))
"""Factor of friction that slip does not change."""


def follow(target: Array, slack: Array, slip_factor: SlipFactor) -> Array:
    """Positions of sliders whose slack changes with accumulated slip.

    `target` are the positions without friction, (n_points, n_instants), m or scaled;
    `slack` is the distance at which each starts to slip before it has slipped, of the
    same shape or (n_points, 1); `slip_factor` is a factor on the slack. Positions have
    the shape and unit of the target.
    """
    positions = np.empty_like(target)
    position = np.zeros(len(target))
    slipped = np.zeros(len(target))
    slacks = np.broadcast_to(slack, target.shape).T
    # Accumulated slip depends on all instants before, so no scan composes them.
    for after, wanted, limit in zip(positions.T, target.T, slacks, strict=True):
        distance = wanted - position
        slip = _slip(np.abs(distance), limit, slipped, slip_factor)
        position = position + np.sign(distance) * slip
        slipped = slipped + slip
        after[:] = position
    return positions


def _slip(
    distance: Array, slack: Array, slipped: Array, slip_factor: SlipFactor
) -> Array:
    """Smallest slip a >= 0 with a + slack g(slipped + a) = distance, shape (n,) all.

    The left side is linear in a between the points of g. Where it falls with a, as
    friction softens faster than the search direction unloads, and the distance is
    within its slack, the point sticks.
    """
    slip = np.zeros_like(distance)
    missing = distance - slack * slip_factor(slipped)
    # Points whose slip is not found yet, segment after segment of g.
    left = missing > 0.0
    for end in slip_factor.slips[1:]:
        ahead = np.maximum(end - slipped, slip)
        after = distance - ahead - slack * slip_factor(slipped + ahead)
        ends = left & (after <= 0.0)
        zeros = np.zeros_like(after)
        share = np.divide(missing, missing - after, out=zeros, where=ends)
        within = slip + share * (ahead - slip)
        # Points that stop on this segment, points that continue, and points that have
        # stopped.
        slip = np.where(ends, within, np.where(left, ahead, slip))
        left &= ~ends
        missing = after
    return np.where(left, distance - slack * slip_factor.factors[-1], slip)
