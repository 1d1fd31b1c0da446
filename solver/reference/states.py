"""One instant of frictional contact, its states known: a linear system.

Every jump has a state. A normal one is HELD at the gap, or OPEN without force. A tangential one is
HELD where it was, slips with s = -1 or +1 against the friction force -s (r + mu f_n), or is OPEN:
without force, as where the contact is open or there is no friction. With S jump = f + q
(`solver.reference.condensation`), the jumps that are not held are the unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.laws.rules import Rules, stacked

States = NDArray[np.int8]
HELD = 0
SINGULAR = 1e-12
"""Pivot, as a share of the largest, below which a system of free jumps is singular."""
LOOSE = 1e-14
"""The same as a share of the largest stiffness of all jumps."""


def rules_of(problem: Problem) -> Rules:
    """Stack the laws of all interfaces with friction, point by point."""
    found: list[Rules] = []
    first = 0
    for law in problem.rubbing.values():
        own = law.rules(first)
        found += own
        first += len(own) * len(law.positions)
    return stacked(found)


@dataclass(frozen=True, eq=False)
class Sides:
    """Right sides of one instant; columns, where there are several, are solved together.

    Attributes
    ----------
    load
        q, shape (n, ...).
    bound
        Friction force r that needs no normal force, shape (n, ...).
    held
        Where held jumps stand, shape (n, ...): minus the gap, or the position before.
    """

    load: Array
    bound: Array
    held: Array


class Response:
    """The linear system of given states; the last factorisation is kept.

    Attributes
    ----------
    unit
        Stiffness of every jump alone, shape (n,), scaled.
    solutions
        Systems solved.
    unbalanced
        Largest force out of balance in the last one; more than rounding, where a motion is free.
    turned
        Whether the determinant of the last one is negative. That of a convex problem never is,
        and the signs at all solutions of an instant add up to one: so it has others.
    singular
        Whether the last one left a motion free; then its smallest solution is given.
    """

    def __init__(self, stiffness: Array, rules: Rules) -> None:
        self._stiffness = stiffness
        self.unit: Array = np.diagonal(stiffness).copy()
        self._partner, self._friction = rules.partner, rules.friction
        self._states: States | None = None
        self._factors: Array
        self._pivots: Indices
        self.solutions = 0
        self.unbalanced, self.turned = 0.0, False

    def __call__(self, states: States, sides: Sides) -> tuple[Array, Array]:
        """Give jump and force, shape (n, ...) each."""
        if self._states is None or not np.array_equal(states, self._states):
            self._factor(states)
        self.solutions += 1
        free, slope = self._free, self._slope
        wide = sides.load.ndim > 1
        jump = sides.held.copy()
        jump[free] = 0.0
        missing = sides.load - self._stiffness @ jump
        way, slope = (self._way[:, None], slope[:, None]) if wide else (self._way, slope)
        right = missing[free] - way * sides.bound[free] + slope * missing[self._under]
        jump[free] = self._solve(right)
        force = self._stiffness @ jump - sides.load
        allowed = -way * sides.bound[free] - slope * force[self._under]
        self.unbalanced = float(np.abs(force[free] - allowed).max(initial=0.0))
        force[free] = allowed
        return jump, force

    def _factor(self, states: States) -> None:
        self._states = states.copy()
        self._free = free = np.flatnonzero(states)
        self._way = np.where(np.abs(states[free]) == 1, states[free], 0).astype(float)
        self._slope = self._way * self._friction[free]
        self._under = self._partner[free]
        matrix = self._stiffness[np.ix_(free, free)]
        tied = np.flatnonzero(self._slope)
        if len(tied):
            under = self._stiffness[np.ix_(self._under[tied], free)]
            matrix[tied] += self._slope[tied, None] * under
        self._matrix = matrix
        if len(free):
            self._factors, self._pivots, _ = lapack.dgetrf(matrix)
        else:
            self._factors, self._pivots = matrix, free
        diagonal = np.diagonal(self._factors)
        swaps = np.count_nonzero(self._pivots != np.arange(len(free)))
        self.turned = bool((np.count_nonzero(diagonal < 0.0) + swaps) % 2)
        sizes = np.abs(diagonal)
        least = max(SINGULAR * sizes.max(initial=0.0), LOOSE * self.unit.max(initial=0.0))
        self.singular = bool(sizes.min(initial=np.inf) <= least)

    def _solve(self, right: Array) -> Array:
        if not len(right):
            return right
        if self.singular:
            return np.asarray(np.linalg.lstsq(self._matrix, right, rcond=SINGULAR)[0])
        return np.asarray(lapack.dgetrs(self._factors, self._pivots, right)[0]).reshape(right.shape)
