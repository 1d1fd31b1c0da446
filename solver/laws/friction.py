"""Coulomb friction with a known bound, on a support or between two bodies (theory.md, 2).

Pointwise it is the play operator. A clip of a clip is a clip, so the recursion in time is an
associative scan: for few points, blocks of instants are composed side by side; for many points,
walking in time already keeps the processor busy and moves less memory.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.laws.points import AtPoints

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

WALK_FROM_POINTS = 150
"""From this many points on, the walk beats the scan (measured: between 60 and 211)."""


@dataclass(frozen=True)
class Friction(AtPoints):
    """A frictional interface with a known normal force, on a rigid support or between two bodies.

    Attributes
    ----------
    rows
        Boundary rows that rub, shape (n_rows,); of the body above, if there are two.
    points
        Point of the interface that each row belongs to, shape (n_rows,). The rows of a point
        (two, where a cut crosses the interface) share its force.
    positions
        Place of the points along the interface, shape (n_points,), m.
    weights
        Tributary length of each row, shape (n_rows,), m.
    bound
        Largest friction force of each row, shape (n_rows,), non-negative.
    below
        Rows of the body below, each opposite its partner in `rows`; None on a rigid support.
    macro
        Macro basis between two bodies, shape (n_rows, n_macro): the macro forces of both sides
        cancel each other. None on a rigid support.
    modulus
        Stiffness of what rubs around each row, shape (n_rows,), scaled; None where it is 1.
    """

    rows: Indices
    points: Indices
    positions: Array
    weights: Array
    bound: Array
    below: Indices | None = None
    macro: sparse.csr_array | None = None
    modulus: Array | None = None


class FrictionLaw:
    """The law of one interface for given search directions; its memory is allocated once.

    Parameters
    ----------
    law
        The interface.
    k
        Search direction of all rows, shape (n_rows,).
    n_times
        Number of instants.
    """

    def __init__(self, law: Friction, k: Array, n_times: int) -> None:
        self._rows = as_slice(law.rows)
        self._below = None if law.below is None else as_slice(law.below)
        soft = 1.0 / k[law.rows]
        if law.below is not None:
            soft_below = 1.0 / k[law.below]
            soft = soft + soft_below
            self._share_below = (soft_below / soft)[:, None]
        self._reach = (law.bound * soft)[:, None]
        self._play = Play(len(law.rows), n_times)

    def __call__(self, incoming: Array, displacement: Array) -> None:
        """Write W^ of the interface's rows, for z = W - F/k of all rows, (n_rows, n_times)."""
        above = incoming[self._rows]
        if self._below is None:
            displacement[self._rows] = self._play(above, self._reach)
            return
        below = incoming[self._below]
        jump = above - below
        moved = self._play(jump, self._reach) - jump
        under = self._share_below * moved
        displacement[self._below] = below - under
        displacement[self._rows] = above + (moved - under)


def as_slice(rows: Indices) -> slice | Indices:
    """Give rows as a slice when they follow each other, so that reading them copies nothing."""
    first = int(rows[0]) if len(rows) else 0
    return slice(first, first + len(rows)) if np.all(np.diff(rows) == 1) else rows


def play(target: Array, reach: Array) -> Array:
    """Follow a target with Coulomb play, from rest at zero.

    Parameters
    ----------
    target
        Position that the point would take without friction, shape (n_points, n_times), m.
    reach
        Distance at which it starts to slip, same shape or (n_points,), m; non-negative.

    Returns
    -------
    Position with friction, shape (n_points, n_times), m (theory.md, 2).
    """
    reach = reach if reach.ndim == target.ndim else reach[:, None]
    result: Array = Play(*target.shape)(target, reach).copy()
    return result


def Play(n_points: int, n_times: int) -> _Walk | _Scan:  # noqa: N802  # chooses a class, as one
    """Prepare the play operator for a size: its memory is allocated once, here.

    Calling the result as `play(target, reach)`, with reach of shape (n_points, n_times) or
    (n_points, 1), gives an array that the next call overwrites.
    """
    few = n_points < WALK_FROM_POINTS and n_times > 1
    return _Scan(n_points, n_times) if few else _Walk(n_points, n_times)


class _Walk:
    """One instant after the other."""

    def __init__(self, n_points: int, n_times: int) -> None:
        self._low, self._high, self._position = np.zeros((3, n_times, n_points))
        before = [np.zeros(n_points), *self._position[:-1]]
        self._steps = list(zip(before, self._low, self._high, self._position, strict=True))

    def __call__(self, target: Array, reach: Array) -> Array:
        np.subtract(target, reach, out=self._low.T)
        np.add(target, reach, out=self._high.T)
        for before, low, high, position in self._steps:
            np.maximum(before, low, out=position)
            np.minimum(position, high, out=position)
        return self._position.T


class _Scan:
    """Blocks of instants side by side: compose inside all blocks, carry across, apply.

    `composed[j, 0]` and `composed[j, 1]` are the clip of the first j + 1 instants of every block:
    what the block makes of a point that enters it far below, or far above.
    """

    def __init__(self, n_points: int, n_times: int) -> None:
        size = max(2, round(0.5 * np.sqrt(n_times)))
        blocks = -(-n_times // size)
        self._n_times = n_times
        self._limits = np.zeros((2, blocks, size, n_points))
        low, high = self._limits
        self._low, self._high = (limit.reshape(-1, n_points)[:n_times] for limit in self._limits)
        self._composed = np.zeros((size, 2, blocks, n_points))
        self._steps = [
            (self._composed[j - 1], low[:, j], high[:, j], self._composed[j])
            for j in range(1, size)
        ]
        entry = np.zeros((blocks + 1, n_points))
        last_low, last_high = self._composed[-1]
        self._carries = list(zip(entry[:-1], last_low, last_high, entry[1:], strict=True))
        self._entry = entry[:-1, None]
        self._position = np.zeros((blocks, size, n_points))
        self._result = self._position.reshape(-1, n_points)[:n_times]

    def __call__(self, target: Array, reach: Array) -> Array:
        np.subtract(target, reach, out=self._low.T)
        np.add(target, reach, out=self._high.T)
        self._composed[0] = self._limits[:, :, 0]
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
