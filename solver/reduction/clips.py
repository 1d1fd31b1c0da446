"""A friction field as clips with memory, two vectors a branch of the load (solver/README.md, 16).

A slip front is no sum of a few products, but a fixed function of one: as in the Front Transport
Reduction of P. Krah and others (J. Sci. Comput. 96, 28, 2023). The function here is the clip of the
local stage; its stops are the bound, and the friction that the last reversal of the load left
behind.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from solver.arrays import Array
from solver.reduction.svd import Decomposition, decompose

FADED = 1e-9
"""Share of its largest value that the bound is not taken to be below, where the load is divided by
it: an instant without any counts for nothing."""
BELOW = -2.0
"""A line that lies below all shares: the point keeps what it has."""
STEPS = 6
"""Passes in which a line is fitted again to the instants at which its own clip shows it. With 2 the
error where friction changes with slip is a sixth larger (measured)."""
ENTRIES = 64
"""Instants of a branch, at most, at which lines are drawn through the entries of all points."""
SAME_SHAPE = 1e-9
"""Share of the largest bound by which one that changes in size alone may differ from that."""


@dataclass(frozen=True, eq=False)
class Branch:
    """Instants between two reversals of the load, and the argument of their clip.

    Attributes
    ----------
    instants
        Which, as a slice.
    way
        1 where the load rises, or -1.
    slope, offset
        The argument is slope times load plus offset, a share of the bound, (n_points,) each. Where
        the slope takes it up as the load goes on, it is clipped between the friction before and
        the bound; where it takes it down, between that and the bound the other way.
    """

    instants: slice
    way: float
    slope: Array
    offset: Array


@dataclass(frozen=True, eq=False)
class Clips:
    """A friction field, and clips with memory fitted to it.

    Attributes
    ----------
    given
        The field, shape (n_points, n_instants), N/m.
    bound
        Largest friction, same shape, N/m.
    load
        What drives it, over the size of the bound at every instant as a share of its largest,
        shape (n_instants,).
    branches
        In their order.
    space_weights, time_weights
        Lengths of the points, and weights of the instants, in which errors are measured.
    """

    given: Array
    bound: Array
    load: Array
    branches: tuple[Branch, ...]
    space_weights: Array
    time_weights: Array

    @cached_property
    def field(self) -> Array:
        """What the clips are, shape (n_points, n_instants), N/m."""
        field = np.empty_like(self.given)
        held = np.zeros(len(field))
        for branch in self.branches:
            some = branch.instants
            field[:, some] = _clipped(branch, held, self.bound[:, some], self.load)
            held = field[:, some.stop - 1]
        return field

    @cached_property
    def rest(self) -> Decomposition:
        """What they leave of the field, in singular vectors."""
        left = self.given - self.field
        return decompose(left, self.space_weights, self.time_weights)

    @cached_property
    def errors(self) -> Array:
        """Error of the clips with every number of modes from 0 on, shape (n_modes + 1,).

        Relative to the field in L2 over length and time; zero for a field that vanishes.
        """
        whole = float(self.space_weights @ self.given**2 @ self.time_weights)
        if whole == 0.0:
            return np.zeros(len(self.rest.values) + 1)
        left = float(np.sqrt(self.rest.values @ self.rest.values / whole))
        return np.asarray(left * self.rest.errors)

    @property
    def numbers(self) -> int:
        """How many numbers they take: two vectors and a place a branch, the load, the bound."""
        points, instants = self.given.shape
        return int(len(self.branches) * (2 * points + 1) + instants) + _numbers_of(self.bound)


def clips_of(
    field: Array, bound: Array, load: Array, space_weights: Array, time_weights: Array
) -> Clips:
    """Clips with memory fitted to a friction field.

    Its branches are those of the load over the size of the bound; the arguments are fitted to the
    entries that are not clipped, point by point. Of a rod whose friction bound stays the same, and
    which nothing drives but this load, they are exact.

    Parameters
    ----------
    field
        Shape (n_points, n_instants), N/m; it starts from rest at zero before the first instant.
    bound
        Largest friction, non-negative, shape (n_points,), (n_points, 1) or that of the field, N/m.
    load
        What drives it, in any unit, shape (n_instants,).
    space_weights, time_weights
        Shapes (n_points,) and (n_instants,), positive.
    """
    bound = np.broadcast_to(bound.reshape(len(field), -1), field.shape)
    size = bound.max(axis=0)
    most = float(size.max(initial=0.0)) or 1.0
    share = np.maximum(size / most, FADED)
    driving = np.asarray(load / share)
    weights = time_weights * share**2
    held, before = np.zeros(len(field)), 0.0
    branches: list[Branch] = []
    for some in monotone(driving):
        limit = bound[:, some]
        branch = _fitted(field[:, some], held, limit, driving, some, before, weights[some])
        held = _clipped(branch, held, limit, driving)[:, -1]
        before = float(driving[some.stop - 1])
        branches.append(branch)
    return Clips(field, bound, driving, tuple(branches), space_weights, time_weights)


def monotone(load: Array) -> Iterator[slice]:
    """Yield the branches of a load, from zero: as far as it goes one way, or stands still."""
    ways = np.sign(np.diff(load, prepend=0.0))
    moving = np.flatnonzero(ways)
    turns = moving[1:][ways[moving[1:]] != ways[moving[:-1]]]
    yield from (slice(int(a), int(b)) for a, b in pairwise([0, *turns, len(load)]))


def _fitted(
    field: Array,
    held: Array,
    bound: Array,
    load: Array,
    some: slice,
    before: float,
    weights: Array,
) -> Branch:
    """Branch whose argument is fitted, each point counted in the way that its friction goes."""
    way = 1.0 if load[some.stop - 1] >= before else -1.0
    up = np.where((field - held[:, None]) @ weights < 0.0, -1.0, 1.0)
    limit = np.where(bound > 0.0, bound, np.inf)
    shares, low = (up[:, None] * force / limit for force in (field, held[:, None]))
    slope, offset = _ramps(shares, np.clip(low, -1.0, 1.0), way * load[some], way * before, weights)
    return Branch(some, way, way * up * slope, np.where(slope > 0.0, up * offset, BELOW))


def _ramps(
    shares: Array, low: Array, load: Array, before: float, weights: Array
) -> tuple[Array, Array]:
    """Slope and offset of the line fitted to every point in one branch, (n_points,) each.

    A point keeps the friction `low` that it had before, then follows the load g, which rises from
    `before`, in proportion, then slips at its bound: its share is min(1, max(low, a g + b)).

    Of lines through entries, as steep as the point is before them or after them, the nearest is
    taken. With the ones through the entry farthest from both stops, and the first above their
    middle, it is exact where the clip shows the line at one instant, or at none. Then lines are
    fitted to the instants at which its clip shows it. A point that keeps what it has gets a slope
    of 0, and all others one above.
    """

    def miss(slope: Array, offset: Array) -> Array:
        line = slope[:, None] * load + offset[:, None]
        clipped = np.minimum(1.0, np.maximum(low, line))
        return np.asarray((clipped - shares) ** 2 @ weights)

    def keep(new_slope: Array, new_offset: Array) -> None:
        usable = np.isfinite(new_slope) & np.isfinite(new_offset) & (new_slope > 0.0)
        tried = np.where(usable, new_slope, 0.0), np.where(usable, new_offset, BELOW)
        misses = miss(*tried)
        better = misses < missed
        for kept, new in zip((missed, slope, offset), (misses, *tried), strict=True):
            kept[better] = new[better]

    slope, offset = np.zeros(len(shares)), np.full(len(shares), BELOW)
    missed = miss(slope, offset)
    with_start, loads = np.hstack([low[:, :1], shares]), np.append(before, load)
    rises = np.diff(loads)
    slopes = np.diff(with_start) / np.where(rises > 0.0, rises, np.inf)
    steepest = np.maximum(slopes, np.hstack([slopes[:, 1:], slopes[:, -1:]]))
    deepest = np.argmax(np.minimum(shares - low, 1.0 - shares), axis=1)
    slid = np.argmax(shares >= 0.5 * (low + 1.0), axis=1)
    points, count = np.arange(len(slid)), len(load)
    evenly = np.linspace(0, count - 1, min(count, ENTRIES)).astype(int)
    for entry in [slid, deepest, *evenly]:
        steep = steepest[points, entry]
        keep(steep, shares[points, entry] - steep * load[entry])
    for _ in range(STEPS):
        line = slope[:, None] * load + offset[:, None]
        keep(*_regression(load, shares, ((line > low) & (line < 1.0)) * weights))
    return slope, offset


def _regression(load: Array, shares: Array, weights: Array) -> tuple[Array, Array]:
    """Lines fitted to entries by their weights; where fewer than two count, not a number."""
    with np.errstate(divide="ignore", invalid="ignore"):
        whole = weights.sum(axis=1)
        middle = weights @ load / whole
        mean = (weights * shares).sum(axis=1) / whole
        apart = load - middle[:, None]
        weights = weights * apart
        slope = (weights * shares).sum(axis=1) / (weights * apart).sum(axis=1)
        return slope, mean - slope * middle


def _clipped(branch: Branch, held: Array, bound: Array, load: Array) -> Array:
    """Clipped argument of a branch, (n_points, n_instants); a lower bound cuts what was held."""
    line = (branch.slope[:, None] * load[branch.instants] + branch.offset[:, None]) * bound
    kept = np.clip(held[:, None], -bound, bound)
    is_up = (branch.way * branch.slope >= 0.0)[:, None]
    up, down = np.minimum(bound, np.maximum(kept, line)), np.maximum(-bound, np.minimum(kept, line))
    return np.where(is_up, up, down)


def _numbers_of(bound: Array) -> int:
    """How many numbers a bound takes: fewer if it changes in size alone."""
    sizes, most = bound.max(axis=0), float(bound.max(initial=0.0))
    shape = bound[:, [int(sizes.argmax())]] / (most or 1.0)
    is_product = np.abs(bound - shape * sizes).max() <= SAME_SHAPE * most
    if not is_product:
        return int(bound.size)
    return int(len(bound) + (bound.shape[1] if np.ptp(sizes) else 0))
