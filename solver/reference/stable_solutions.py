"""Stability of the solution of an instant, and the direction of instability.

Where friction falls with slip the contacts that slip have a negative stiffness. A
solution is stable while the stiffness of structure and contacts together is positive
definite; the softest motion of a solution that is not stable is the way to leave it
(MATHEMATICS.md, 14).
"""

from __future__ import annotations

import numpy as np
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import cholesky, eigh

from solver.arrays import Array, Indices
from solver.laws import OPEN
from solver.reference.condensation import Condensation
from solver.reference.friction_over_slip import FrictionOverSlip
from solver.reference.rules import HELD, InstantSolution, RightSides


class Stability:
    """Stability of solutions of an instant, with the stiffness of all contacts."""

    def __init__(self, condensed: Condensation, friction_law: FrictionOverSlip) -> None:
        self._condensed = condensed
        self._rules = condensed.rules
        self._friction_law = friction_law

    def continues(
        self, at: InstantSolution, reached: InstantSolution, right_sides: RightSides
    ) -> bool:
        """Check whether a reached solution is on the branch of another.

        The solution does if the structure is stable however far the contacts that slip
        in either have softened in between, whatever else slips: then no other solution
        slips there alone.
        """
        contacts, free = self._contact_stiffness(at, reached, right_sides)
        if contacts is None:
            return False
        if not len(free):
            return True
        stiffness = self._tangent_stiffness(contacts, free)
        try:
            # Cholesky's factors exist exactly where the matrix is positive definite.
            cholesky(stiffness, overwrite_a=True, check_finite=False)
        except LinAlgError:
            return False
        return True

    def leave(self, at: InstantSolution, right_sides: RightSides) -> InstantSolution:
        """Disturb an unstable solution in its direction of instability.

        All points that slip continue along the motion that costs least, until half of
        the slip after which the first of them would stop.
        """
        direction = self._weakest_direction(at, right_sides)
        slip = np.abs(at.slip)
        # An eigenvector has no sign: it is taken such that some points slip on.
        turns = direction < 0.0
        if turns.all() or not (direction > 0.0).any():
            direction = -direction
            turns = direction < 0.0
        length = float((slip[turns] / -direction[turns]).min(initial=np.inf))
        if not np.isfinite(length):
            length = float(slip.max() / direction.max())
        further = np.maximum(slip + 0.5 * length * direction, 0.0)
        return at._replace(slip=further * at.states)

    def _weakest_direction(self, at: InstantSolution, right_sides: RightSides) -> Array:
        """Slip of each jump, along its friction, in the softest motion, (n,)."""
        condensed = self._condensed
        contacts, free = self._contact_stiffness(at, at, right_sides)
        motion = np.zeros(len(condensed.base))
        if contacts is None:
            motion[free] = self._rules.compliance[condensed.base[free]] > 0.0
        else:
            # The lowest eigenvalue is the softest motion: the way down from a ridge.
            stiffness = self._tangent_stiffness(contacts, free)
            _, vectors = eigh(stiffness, subset_by_index=[0, 0], check_finite=False)
            motion[free] = vectors[:, 0]
        direction = condensed.ties @ motion * at.states
        direction[np.abs(at.states) != 1] = 0.0
        return np.asarray(direction)

    def _contact_stiffness(
        self, at: InstantSolution, reached: InstantSolution, right_sides: RightSides
    ) -> tuple[Array | None, Indices]:
        """Stiffness of contacts, with softening between two solutions, scaled.

        Returns
        -------
        The stiffness, shape (n,), and the places in the base of the jumps that may
        move, shape (n_free,); no places where nothing softens. The stiffness is None
        where a spring in series snaps by itself: the places are then those of such
        springs.
        """
        rules = self._rules
        base = self._condensed.base
        slips = (np.abs(at.states) == 1) | (np.abs(reached.states) == 1)
        growth = np.where(slips, self._lowest_growth(at, reached, right_sides), 0.0)
        # Stiffness without softening is positive, so the solution is the only one
        # nearby.
        if not np.any(growth < 0.0):
            return growth, np.zeros(0, dtype=np.intp)
        # A contact and a spring in series with it share the motion.
        sprung = rules.compliance > 0.0
        lengthening = 1.0 + growth * rules.compliance
        if np.any(lengthening <= 0.0):
            return None, np.flatnonzero(lengthening[base] <= 0.0)
        stiffness = growth / lengthening
        stays_held = sprung & (at.states == HELD) & (reached.states == HELD)
        stiffness[stays_held] += 1.0 / rules.compliance[stays_held]
        stays_open = (at.states == OPEN) & (reached.states == OPEN)
        is_free = slips | stays_open | sprung
        return stiffness, np.flatnonzero(is_free[base])

    def _lowest_growth(
        self, at: InstantSolution, reached: InstantSolution, right_sides: RightSides
    ) -> Array:
        """Lowest growth of friction per slip between two solutions, (n,), scaled."""
        rules = self._rules
        slope = self._friction_law.lowest_slope(np.abs(at.slip), np.abs(reached.slip))
        before = rules.before_slip(right_sides.bound, at.step.force)
        after = rules.before_slip(right_sides.bound, reached.step.force)
        return np.asarray(slope * np.maximum(before, after))

    def _tangent_stiffness(self, contacts: Array, free: Indices) -> Array:
        """Stiffness of structure and contacts at places of the base, (n_free, n_free).

        `contacts` is the stiffness of the contacts, shape (n,), scaled, and `free` are
        the places, shape (n_free,).
        """
        tied = self._condensed.ties[:, free]
        stiffness = self._condensed.stiffness[np.ix_(free, free)]
        stiffness += tied.T @ sparse.diags_array(contacts) @ tied
        return np.asarray(stiffness)
