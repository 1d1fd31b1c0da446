"""A friction field as clips with memory: two vectors for each branch of the load.

A slip front is no sum of a few products, but a fixed function of one product: as in the
Front Transport Reduction of P. Krah and others (J. Sci. Comput. 96, 28, 2023). The
function here is the clip of the local stage; its stops are the strength, and the
friction that the last reversal of the load left behind (MATHEMATICS.md, 16).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from solver.arrays import Array, Indices
from solver.reduction.svd import decompose

FADED = 1e-9
"""Smallest share of its largest value that the strength counts with where the load is
divided by it: an instant without any strength has no weight."""
BELOW = -2.0
"""Offset of a line that lies below all shares: the point keeps the friction it has."""
REFITS = 6
"""Number of times that a line is fitted again to the instants at which its own clip
shows it. With 2 the error where friction changes with slip is a sixth larger
(measured)."""
MOST_ENTRIES = 64
"""Largest number of instants of a branch at which lines are drawn through the entries
of all points."""


@dataclass(frozen=True, eq=False)
class Clips:
    """A friction field, and clips with memory fitted to the field and its strength.

    Attributes
    ----------
    given, field, strength
        The field, its clips, and its strength, shape (n_points, n_instants), N/m.
    branches
        Number of branches of the load, in each of which it goes one way.
    space_weights, time_weights
        Lengths of the points and weights of the instants, in which errors are measured,
        shapes (n_points,) and (n_instants,).
    """

    given: Array
    field: Array
    strength: Array
    branches: int
    space_weights: Array
    time_weights: Array

    @cached_property
    def errors(self) -> Array:
        """Errors with 0 to n_modes singular vectors of the residual, (n_modes + 1,).

        Relative to the field in L2 over length and time; zero for a field that
        vanishes.
        """
        # Singular vectors of the rest are the best that can be added to the clips.
        rest = decompose(self.given - self.field, self.space_weights, self.time_weights)
        whole = float(self.space_weights @ self.given**2 @ self.time_weights)
        if whole > 0.0:
            left = float(np.sqrt(rest.values @ rest.values / whole))
        else:
            left = 0.0
        return np.asarray(left * rest.errors)


def clips_of(
    field: Array,
    strength: Array,
    load: Array,
    space_weights: Array,
    time_weights: Array,
) -> Clips:
    """Clips with memory fitted to a friction field.

    The branches are those of the load over the size of the strength; the lines are
    fitted to the entries that are not clipped, point by point. Clips are exact for a
    rod whose friction strength stays the same, and which this load alone drives.

    Parameters
    ----------
    field
        Friction, which starts from zero before the first instant, shape (n_points,
        n_instants), N/m.
    strength
        Largest friction, shape (n_points,), (n_points, 1) or that of the field, N/m.
    load
        The load, shape (n_instants,), in any unit.
    space_weights, time_weights
        Lengths of the points and weights of the instants, shapes (n_points,) and
        (n_instants,).
    """
    strength = np.broadcast_to(strength.reshape(len(field), -1), field.shape)
    # Friction over a strength that changes with time is a clip of the load over its
    # size.
    share = _size_of(strength)
    driving = np.asarray(load / share)
    weights = time_weights * share**2
    fitted = np.empty(field.shape)
    # Every branch starts from the friction and the load at which the last one ended.
    held = np.zeros((len(field), 1))
    before = 0.0
    branches = list(monotone(driving))
    for branch in branches:
        path = np.append(before, driving[branch])
        clip = _branch(
            field[:, branch], held, strength[:, branch], path, weights[branch]
        )
        fitted[:, branch] = clip
        held = clip[:, -1:]
        before = path[-1]
    return Clips(field, fitted, strength, len(branches), space_weights, time_weights)


def _size_of(strength: Array) -> Array:
    """Strength at each instant over its largest value, (n_instants,)."""
    size = strength.max(axis=0)
    largest = float(size.max(initial=0.0)) or 1.0
    return np.asarray(np.maximum(size / largest, FADED))


def monotone(load: Array) -> Iterator[slice]:
    """Yield the monotone branches of a load, as ranges of instants.

    The load, shape (n_instants,), is zero before the first instant.
    """
    directions = np.sign(np.diff(load, prepend=0.0))
    # An instant at which the load stands still belongs to the branch before.
    moving = np.flatnonzero(directions)
    turns = moving[1:][directions[moving[1:]] != directions[moving[:-1]]]
    for first, end in pairwise([0, *turns, len(load)]):
        yield slice(int(first), int(end))


def _branch(
    field: Array, held: Array, strength: Array, load: Array, weights: Array
) -> Array:
    """Clip fitted to a field in one branch, shape (n_points, n_instants), N/m.

    Every point is seen in the direction in which its friction goes, so that its line
    rises. Where the strength falls below the friction that was held, it cuts that.

    Parameters
    ----------
    field, strength
        Friction and its strength, shape (n_points, n_instants), N/m.
    held
        Friction before the branch, shape (n_points, 1), N/m.
    load
        The load before the branch and at its instants, shape (n_instants + 1,).
    weights
        Weights of the instants, shape (n_instants,).
    """
    # Friction that falls is fitted upside down, so that one form serves both.
    falls = (field - held) @ weights < 0.0
    sign = np.where(falls, -1.0, 1.0)[:, None]
    limit = np.where(strength > 0.0, strength, np.inf)
    if load[-1] >= load[0]:
        path = load
    else:
        path = -load
    low = np.clip(sign * held / limit, -1.0, 1.0)
    slope, offset = _ramps(sign * field / limit, low, path, weights)
    line = (slope[:, None] * path[1:] + offset[:, None]) * strength
    stops = np.clip(sign * held, -strength, strength)
    return sign * np.minimum(strength, np.maximum(stops, line))


def _ramps(
    shares: Array, low: Array, loads: Array, weights: Array
) -> tuple[Array, Array]:
    """Slope and offset of a line for every point in one branch, (n_points,) each.

    A point's share of its strength is min(1, max(low, a g + b)), with a load g that
    rises.

    The nearest is taken of lines through entries, as steep as the point is before the
    entry or after it. With the lines through the entry farthest from both stops, and
    through the first entry above their middle, the fit is exact where the clip shows
    the line at one instant, or at none. Then lines are fitted to the instants at which
    the clip shows them. A point that keeps its friction gets a slope of 0, and all
    others a slope above 0.

    Parameters
    ----------
    shares
        Friction over its strength, shape (n_points, n_instants), from -1 to 1.
    low
        Lower stop of every point, same shape.
    loads
        The load before the branch and at its instants, shape (n_instants + 1,).
    weights
        Weights of the instants, shape (n_instants,).
    """
    load = loads[1:]
    nearest = _NearestLines(shares, low, load, weights)
    # Slope 0 first: a point that keeps its friction needs no line at all.
    nearest.keep(nearest.slope, nearest.offset)
    steepest = _steepest(shares, low, np.diff(loads))
    points = np.arange(len(shares))
    for entry in _entries(shares, low):
        slope = steepest[points, entry]
        nearest.keep(slope, shares[points, entry] - slope * load[entry])
    for _ in range(REFITS):
        line = nearest.line(nearest.slope, nearest.offset)
        # Instants at which the clip hides the line say nothing about it.
        is_shown = (line > low) & (line < 1.0)
        slope, offset = _regression(load, shares, is_shown * weights)
        nearest.keep(slope, offset)
    return nearest.slope, nearest.offset


class _NearestLines:
    """For each point the line whose clip is nearest to the shares of the point.

    Shares, stops, load and weights are those of `_ramps`.

    Attributes
    ----------
    slope, offset
        The lines, shape (n_points,) each.
    """

    def __init__(self, shares: Array, low: Array, load: Array, weights: Array) -> None:
        self._shares = shares
        self._low = low
        self._load = load
        self._weights = weights
        self._distance = np.full(len(shares), np.inf)
        self.slope = np.zeros(len(shares))
        self.offset = np.zeros(len(shares))

    def line(self, slope: Array, offset: Array) -> Array:
        """Values of lines at all instants, shape (n_points, n_instants)."""
        return np.asarray(slope[:, None] * self._load + offset[:, None])

    def keep(self, slope: Array, offset: Array) -> None:
        """Replace lines at the points where other lines, (n_points,), are nearer.

        A line that does not rise counts as one that keeps the friction of its point.
        """
        is_usable = np.isfinite(slope) & np.isfinite(offset) & (slope > 0.0)
        slope = np.where(is_usable, slope, 0.0)
        offset = np.where(is_usable, offset, BELOW)
        clipped = np.minimum(1.0, np.maximum(self._low, self.line(slope, offset)))
        distance = (clipped - self._shares) ** 2 @ self._weights
        nearer = distance < self._distance
        self._distance[nearer] = distance[nearer]
        self.slope[nearer] = slope[nearer]
        self.offset[nearer] = offset[nearer]


def _steepest(shares: Array, low: Array, rises: Array) -> Array:
    """Larger of the slopes before and after each instant, (n_points, n_instants).

    Shares and stops are those of `_ramps`; `rises` are those of the load, shape
    (n_instants,).
    """
    changes = np.diff(np.hstack([low[:, :1], shares]))
    before = changes / np.where(rises > 0.0, rises, np.inf)
    after = np.hstack([before[:, 1:], before[:, -1:]])
    return np.maximum(before, after)


def _entries(shares: Array, low: Array) -> Iterator[Indices | int]:
    """Yield instants for lines to pass through: for each point, (n_points,), or all.

    Shares and stops are those of `_ramps`.
    """
    yield np.argmax(shares >= 0.5 * (low + 1.0), axis=1)
    yield np.argmax(np.minimum(shares - low, 1.0 - shares), axis=1)
    count = shares.shape[1]
    yield from np.linspace(0, count - 1, min(count, MOST_ENTRIES)).astype(int)


def _regression(load: Array, shares: Array, weights: Array) -> tuple[Array, Array]:
    """Slope and offset of lines fitted to the entries of every point, (n_points,) each.

    They are not numbers where fewer than two entries have a weight.

    Parameters
    ----------
    load
        Abscissa of the entries, shape (n_instants,).
    shares, weights
        Entries and their weights, shape (n_points, n_instants).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        whole = weights.sum(axis=1)
        # About the middle, where slope and mean do not cancel.
        middle = weights @ load / whole
        mean = (weights * shares).sum(axis=1) / whole
        apart = load - middle[:, None]
        weights = weights * apart
        slope = (weights * shares).sum(axis=1) / (weights * apart).sum(axis=1)
        return slope, mean - slope * middle
