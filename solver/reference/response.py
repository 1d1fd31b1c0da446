"""One instant of frictional contact, its states known: a linear system.

With S y = f + q and jumps y + Q a (`solver.reference.condensation`), unknown are y where a jump is
not held or where something is in series, the forces of jumps that follow from others, and the rigid
motions a. Their equations say what free jumps carry, what held ones come to, and that Q' y = 0.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import ROUNDING, Array, Indices
from solver.laws.rules import Rules
from solver.reference.condensation import Condensation
from solver.reference.factors import Factors
from solver.reference.states import HELD, Increment, Sides, States

LOOSE = 1e-14
"""Pivot, as a share of the largest stiffness of all jumps, below which a motion is free."""


class Response:
    """The linear system of given states; the last factorisation is kept.

    Attributes
    ----------
    unit
        Stiffness of every jump alone, with what is in series, shape (n, 1), scaled.
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

    def __init__(self, condensed: Condensation, rules: Rules) -> None:
        self._stiffness, self._gauge = condensed.stiffness, condensed.gauge
        self._partner, self._friction = rules.partner, rules.friction
        self._base, self._soft = condensed.base, rules.compliance[:, None]
        self._others: Indices = np.setdiff1d(np.arange(len(rules.gap)), self._base)
        self._ties = condensed.ties[self._others].toarray()
        self._place = np.full(len(rules.gap), -1)
        self._place[self._base] = np.arange(len(self._base))
        alone = abs(condensed.ties) @ np.diagonal(self._stiffness)
        self.unit: Array = (alone / (1.0 + alone * rules.compliance))[:, None]
        self._alone = np.diagonal(self._stiffness)
        self._is_plain = not self._soft.any() and not self._gauge.size
        self._states: States | None = None
        self._factors: Factors
        self.solutions = 0
        self.unbalanced, self.turned, self.singular = 0.0, False, False

    def __call__(self, states: States, sides: Sides) -> Increment:
        """Solve for the step from the instant before."""
        if self._states is None or not np.array_equal(states, self._states):
            self._factor(states)
        self.solutions += 1
        rows, kept = self._rows, self._kept
        none = np.zeros((len(self._others), sides.load.shape[1]))
        strained = np.zeros_like(sides.load)
        strained[kept] = sides.held[self._base[kept]]
        force = self._forces(strained, sides.load, none)
        right = -self._way * sides.bound[rows] - force[rows] - self._slope * force[self._under]
        if not self._is_plain:
            right = np.concatenate([right, self._gauge[kept].T @ strained[kept]])
            own = rows[self._sprung]
            come = self._jump(strained, none[:0]) + self._soft * force
            right[self._sprung] = self._share * (sides.held[own] - come[own])
        found = self._factors.solve(right)
        n_free, n_rows = len(self._free), len(rows)
        strained[self._free], others, motion = np.split(found, [n_free, n_rows])
        if not self._is_plain:
            strained[kept] -= self._gauge[kept] @ motion
        force = self._forces(strained, sides.load, others)
        carried = -self._way * sides.bound[rows] - self._slope * force[self._under]
        carried[self._sprung] = force[rows[self._sprung]]
        self.unbalanced = float(np.abs(force[rows] - carried).max(initial=0.0))
        force[rows] = carried
        return Increment(self._ends(strained, motion, force, sides.held), force, strained, motion)

    def _forces(self, strained: Array, load: Array, others: Array) -> Array:
        """Give the forces of all jumps, those that follow from others given."""
        found = self._stiffness @ strained - load
        if self._is_plain:
            return np.asarray(found)
        whole = np.empty((len(self._place), load.shape[1]))
        whole[self._base], whole[self._others] = found - self._ties.T @ others, others
        return whole

    def _jump(self, strained: Array, motion: Array) -> Array:
        if len(motion):
            strained = strained + self._gauge @ motion
        whole = np.empty((len(self._place), strained.shape[1]))
        whole[self._base], whole[self._others] = strained, self._ties @ strained
        return whole

    def _ends(self, strained: Array, motion: Array, force: Array, held: Array) -> Array:
        """Give what all jumps come to, the held ones to the last bit."""
        if self._is_plain:
            return strained.copy()
        found = self._jump(strained, motion) + self._soft * force
        for own in (self._base[self._kept], self._rows[self._sprung]):
            found[own] = held[own]
        return found

    def on_base(self, force: Array) -> Array:
        """Give what forces of all jumps are to the base."""
        if not len(self._others):
            return force
        return np.asarray(force[self._base] + self._ties.T @ force[self._others])

    def inside(self, strained: Array) -> float:
        """Give the largest force that y of a single jump of the base takes."""
        return float((self._alone * np.abs(strained)).max())

    def blur(self, motion: Array) -> Array:
        """Give the force that rounding of a rigid motion may make at every jump, shape (n,)."""
        if self._is_plain:
            return np.zeros(1)
        moved = self._jump(np.zeros((len(self._base), 1)), motion)
        return np.asarray(ROUNDING * self.unit * np.abs(moved))[:, 0]

    def _factor(self, states: States) -> None:
        self._states = states.copy()
        is_free = (states != HELD) | (self._soft[:, 0] > 0.0)
        self._free: Indices = np.flatnonzero(is_free[self._base])
        self._kept: Indices = np.flatnonzero(~is_free[self._base])
        rows = np.concatenate([self._base[self._free], self._others])
        self._rows, own = rows, states[rows]
        self._sprung: Indices = np.flatnonzero(own == HELD)
        way = np.where(np.abs(own) == 1, own, 0).astype(float)
        slope = way * self._friction[rows]
        self._under: Indices = self._partner[rows]
        self._way, self._slope = way[:, None], slope[:, None]
        matrix = self._of_forces(rows)
        tied = np.flatnonzero(slope)
        if len(tied):
            matrix[tied] += slope[tied, None] * self._of_forces(self._under[tied])
        if not self._is_plain:
            matrix = self._with_motions(matrix)
        self._factors = Factors(matrix, scaled=not self._is_plain)
        self.turned = self._factors.turned
        least = 0.0 if self._factors.scaled else LOOSE * float(self.unit.max(initial=0.0))
        self.singular = self._factors.make_sure(least)

    def _of_forces(self, rows: Indices) -> Array:
        """Give what forces of jumps are of all unknowns, shape (n_rows, n_unknowns)."""
        place, free, gauge = self._place[rows], self._free, self._gauge
        own = self._stiffness[np.ix_(place, free)]
        if self._is_plain:
            return np.asarray(own)
        moved = -self._stiffness[np.ix_(place, self._kept)] @ gauge[self._kept]
        if not len(self._others):
            return np.hstack([own, moved])
        found = np.hstack([own, -self._ties.T[place], moved])
        follows = place < 0
        found[follows] = 0.0
        found[follows, len(free) + np.searchsorted(self._others, rows[follows])] = 1.0
        return found

    def _with_motions(self, matrix: Array) -> Array:
        """Let what is in series come to its end, and choose y: all equations."""
        free, kept, gauge, sprung = self._free, self._kept, self._gauge, self._sprung
        own = self._rows[sprung]
        base = np.zeros((len(own), len(self._base)))
        follows = self._place[own] < 0
        base[follows] = self._ties[np.searchsorted(self._others, own[follows])]
        base[np.flatnonzero(~follows), self._place[own[~follows]]] = 1.0
        none = np.zeros((len(own), len(self._others)))
        come = np.hstack([base[:, free], none, base[:, free] @ gauge[free]])
        self._share = 1.0 / (1.0 + self._soft[own])
        matrix[sprung] = self._share * (self._soft[own] * matrix[sprung] + come)
        middle = np.zeros((gauge.shape[1], len(self._others)))
        chosen = np.hstack([-gauge[free].T, middle, gauge[kept].T @ gauge[kept]])
        return np.asarray(np.vstack([matrix, chosen]))
