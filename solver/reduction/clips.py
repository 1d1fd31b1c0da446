"""A friction field as clips with memory, two vectors a branch of the load (solver/README.md, 16).

A slip front is no sum of a few products, but a fixed function of one: as in the Front
Transport Reduction of P. Krah and others (J. Sci. Comput. 96, 28, 2023). The function
here is the clip of the local stage; its stops are the bound, and the friction that the
last reversal of the load left behind.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from solver.arrays import Array
from solver.reduction.svd import decompose

FADED = 1e-9
"""Share of its largest value that the bound is not taken to be below, where the load is
divided by it: an instant without any counts for nothing."""
BELOW = -2.0
"""A line that lies below all shares: the point keeps what it has."""
STEPS = 6
"""Passes in which a line is fitted again to the instants at which its own clip shows
it. With 2 the error where friction changes with slip is a sixth larger (measured)."""
ENTRIES = 64
"""Instants of a branch, at most, at which lines are drawn through the entries of all
points."""


@dataclass(frozen=True, eq=False)
class Clips:
    """A friction field as it was given, and clips with memory fitted to it, and to its bound.

    All have shape (n_points, n_instants), in N/m. The load goes one way in so many
    branches; errors are measured with lengths of the points, and weights of the
    instants.
    """

    given: Array
    field: Array
    bound: Array
    branches: int
    space_weights: Array
    time_weights: Array

    @cached_property
    def errors(self) -> Array:
        """Error of the clips with every number of singular vectors of the rest, (n_modes + 1,).

        Relative to the field in L2 over length and time; zero for a field that
        vanishes.
        """
        rest = decompose(self.given - self.field, self.space_weights, self.time_weights)
        whole = float(self.space_weights @ self.given**2 @ self.time_weights)
        if whole > 0.0:
            left = float(np.sqrt(rest.values @ rest.values / whole))
        else:
            left = 0.0
        return np.asarray(left * rest.errors)


def clips_of(
    field: Array, bound: Array, load: Array, space_weights: Array, time_weights: Array
) -> Clips:
    """Clips with memory fitted to a friction field.

    Its branches are those of the load over the size of the bound; the arguments are
    fitted to the entries that are not clipped, point by point. Of a rod whose friction
    bound stays the same, and which nothing drives but this load, they are exact.

    The field, (n_points, n_instants), N/m, starts from rest at zero before the first
    instant; the bound has shape (n_points,), (n_points, 1) or that of the field; the
    load is in any unit.
    """
    bound = np.broadcast_to(bound.reshape(len(field), -1), field.shape)
    size = bound.max(axis=0)
    most = float(size.max(initial=0.0)) or 1.0
    share = np.maximum(size / most, FADED)
    driving = np.asarray(load / share)
    weights = time_weights * share**2
    fitted = np.empty(field.shape)
    held = np.zeros((len(field), 1))
    before = 0.0
    branches = list(monotone(driving))
    for some in branches:
        path = np.append(before, driving[some])
        fitted[:, some] = _branch(
            field[:, some], held, bound[:, some], path, weights[some]
        )
        held = fitted[:, some][:, -1:]
        before = path[-1]
    return Clips(field, fitted, bound, len(branches), space_weights, time_weights)


def monotone(load: Array) -> Iterator[slice]:
    """Yield the branches of a load, from zero: as far as it goes one way, or stands still."""
    ways = np.sign(np.diff(load, prepend=0.0))
    moving = np.flatnonzero(ways)
    turns = moving[1:][ways[moving[1:]] != ways[moving[:-1]]]
    yield from (slice(int(a), int(b)) for a, b in pairwise([0, *turns, len(load)]))


def _branch(
    field: Array, held: Array, bound: Array, load: Array, weights: Array
) -> Array:
    """Clip fitted to a field between two reversals of the load, (n_points, n_instants).

    From the friction that was `held` before, (n_points, 1), and the load from then on,
    (n_instants + 1,). Each point is seen in the way that its friction goes; a lower
    bound cuts what it held.
    """
    up = np.where((field - held) @ weights < 0.0, -1.0, 1.0)[:, None]
    limit = np.where(bound > 0.0, bound, np.inf)
    path = load if load[-1] >= load[0] else -load
    low = np.clip(up * held / limit, -1.0, 1.0)
    slope, offset = _ramps(up * field / limit, low, path, weights)
    line = (slope[:, None] * path[1:] + offset[:, None]) * bound
    return up * np.minimum(bound, np.maximum(np.clip(up * held, -bound, bound), line))


def _ramps(
    shares: Array, low: Array, loads: Array, weights: Array
) -> tuple[Array, Array]:
    """Slope and offset of the line fitted to every point in one branch, (n_points,) each.

    A point's share of its bound is min(1, max(low, a g + b)), of a load g that rises.

    Of lines through entries, as steep as the point is before them or after them, the
    nearest is taken. With the ones through the entry farthest from both stops, and the
    first above their middle, it is exact where the clip shows the line at one instant,
    or at none. Then lines are fitted to the instants at which its clip shows it. A
    point that keeps what it has gets a slope of 0, and all others one above.
    """
    load = loads[1:]
    missed = np.full(len(shares), np.inf)
    slope = np.zeros_like(missed)
    offset = np.zeros_like(missed)

    def line_of(slope: Array, offset: Array) -> Array:
        return np.asarray(slope[:, None] * load + offset[:, None])

    def keep(new_slope: Array, new_offset: Array) -> None:
        usable = np.isfinite(new_slope) & np.isfinite(new_offset) & (new_slope > 0.0)
        tried = np.where(usable, new_slope, 0.0), np.where(usable, new_offset, BELOW)
        clipped = np.minimum(1.0, np.maximum(low, line_of(*tried)))
        misses = (clipped - shares) ** 2 @ weights
        better = misses < missed
        for kept, new in zip((missed, slope, offset), (misses, *tried), strict=True):
            kept[better] = new[better]

    keep(slope, offset)
    rises = np.diff(loads)
    slopes = np.diff(np.hstack([low[:, :1], shares])) / np.where(
        rises > 0.0, rises, np.inf
    )
    steepest = np.maximum(slopes, np.hstack([slopes[:, 1:], slopes[:, -1:]]))
    deepest = np.argmax(np.minimum(shares - low, 1.0 - shares), axis=1)
    slid = np.argmax(shares >= 0.5 * (low + 1.0), axis=1)
    points = np.arange(len(slid))
    count = len(load)
    evenly = np.linspace(0, count - 1, min(count, ENTRIES)).astype(int)
    for entry in [slid, deepest, *evenly]:
        steep = steepest[points, entry]
        keep(steep, shares[points, entry] - steep * load[entry])
    for _ in range(STEPS):
        line = line_of(slope, offset)
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
