"""Linear system of an instant whose rigid motions only very soft springs hold.

Along a motion that a spring holds which is softer than a body by all digits of a
number, the stiffness between the jumps is nothing but rounding. There rigid motions a
are unknown beside the deformation y = w - Q a: of S y nothing is lost, as S Q = 0. The
jumps that are held are given with both, y = w - Q a there, and of all y with the same
forces the one with Q' y = 0 is found.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.arrays import Array, largest_size
from solver.reference.assembly import never
from solver.reference.condensation import Condensation
from solver.reference.factors import Factors
from solver.reference.linear_system import LinearSystem, Solved
from solver.reference.rules import RightSides, States

SOFT = 1e3
"""Stiffness of a jump over that of the spring in series, from which on this is soft: of
twice as many digits the stiffness between the jumps has none left."""
ROUNDS = 3
"""Number of times that the system is solved, each time for what is missing: the second
gives back the digits that scaling lost."""


def system_of(
    condensed: Condensation, stop: Callable[[], bool] = never
) -> LinearSystem:
    """Linear system of a condensed structure, chosen by the softness of springs.

    `stop` is as of `LinearSystem`.
    """
    stiffness = condensed.stiffness
    gauge = condensed.gauge
    alone = abs(condensed.ties) @ np.diagonal(stiffness)
    kind: type[LinearSystem] = LinearSystem
    if gauge.size and largest_size(condensed.rules.compliance * alone) > SOFT:
        kind = SoftSystem
    return kind(condensed, stiffness, gauge, stop)


class SoftSystem(LinearSystem):
    """Linear system with rigid motions as unknowns besides the deformation."""

    def _factored(self, states: States) -> Factors:
        """Factors of the whole matrix of states, (n,), with rigid motions, scaled."""
        forces = np.hstack([self._with_friction(), self._of_motions()])
        if len(self._sprung):
            moved = self._gauge[self._free]
            equations = self._rows_of_sprung(forces[self._sprung])
            along = self._jumps_of_sprung[:, self._free] @ moved
            equations[:, len(self._unknowns) :] += self._sprung_scale[:, None] * along
            forces[self._sprung] = equations
        matrix = np.vstack([forces, self._in_gauge()])
        # Lengths and forces come to one size (Skeel, Math. Comp. 35, 1980).
        self._row_scale = _scale(matrix, 1)
        matrix = self._row_scale[:, None] * matrix
        self._column_scale = _scale(matrix, 0)
        return Factors(matrix * self._column_scale)

    def _of_motions(self) -> Array:
        """Matrix of forces of rows less friction by motions, (n_rows, n_motions)."""
        pulled = -self._of_unknowns[:, self._kept] @ self._gauge[self._kept]
        rows = self._lengthening[:, None] * pulled[self._rows]
        rows += self._drag[:, None] * pulled[self._carriers]
        if self._grows:
            slips = self._jumps_of_rows[:, self._free] @ self._gauge[self._free]
            rows += self._growth_of_rows[:, None] * slips
        return np.asarray(rows)

    def _in_gauge(self) -> Array:
        """Equations -Q' y = 0 by all unknowns, (n_motions, n_rows + n_motions)."""
        kept = self._gauge[self._kept]
        beyond = np.zeros((self._gauge.shape[1], len(self._others)))
        return np.hstack([-self._gauge[self._free].T, beyond, kept.T @ kept])

    def _solved(self, right_sides: RightSides) -> Solved:
        """Solve the factored system, with iterative refinement."""
        count = len(self._unknowns)
        n_base = len(self._base)
        held = right_sides.held[self._base[self._kept]]
        deformed = np.zeros(len(self._of_unknowns))
        motion = np.zeros(self._gauge.shape[1])
        rounds = ROUNDS
        if self.is_singular:
            rounds = 1
        for number in range(rounds + 1):
            deformed[self._kept] = held - self._gauge[self._kept] @ motion
            force = self._of_unknowns @ deformed
            force[self._base_rows] -= right_sides.load
            unknown = deformed.copy()
            unknown[:n_base] += self._gauge @ motion
            unknown[self._kept] = held
            if number == rounds:
                break
            missing = self._missing(unknown, force, right_sides)
            off_gauge = self._gauge.T @ deformed[:n_base]
            right = self._row_scale * np.concatenate([missing, off_gauge])
            change = self._column_scale * self._factors.solve(right)
            deformed[self._unknowns] += change[:count]
            motion = motion + change[count:]
        return Solved(unknown, deformed[:n_base], motion, force)


def _scale(matrix: Array, axis: int) -> Array:
    """Powers of two that bring the largest entries along an axis near 1, (n,)."""
    _, exponent = np.frexp(np.abs(matrix).max(axis=axis, initial=0.0))
    return np.asarray(np.ldexp(1.0, -exponent))
