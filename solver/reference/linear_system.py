"""Frictional contact at an instant with known states: a linear system.

With S w = f + q (`solver.reference.condensation`), the unknowns are the jumps w where
they are not held or where something is in series, and the forces of jumps that follow
from others. The equations are the friction law of free jumps, and the given increments
of held ones. Rigid motions a = Q' w cost no force, so they are set apart from the
deformation y = w - Q a afterwards. Where they are far larger, the forces are those of
the deformation, and the solution is refined by these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solver.arrays import ROUNDING, Array, Indices, as_slice, largest_size
from solver.reference.assembly import Interrupted, never
from solver.reference.condensation import Condensation
from solver.reference.factors import Factors, UpdatedFactors
from solver.reference.rules import HELD, Increment, RightSides, States

LOOSE = 1e-14
"""Pivot, as a share of the largest stiffness of all jumps, below which a motion is
free."""
MANY = 200
"""Number of unknowns from which on factors are updated: smaller systems are factored
again in the same time."""
CHANGED = 6
"""Factors are updated where at most one unknown in this number comes or goes: from step
to step it is one in a hundred."""
FAR = 100.0
"""Ratio of the largest rigid motion to the largest deformation from which on forces are
found from the deformation alone, as their sum has lost its digits."""
FEW = 4
"""Rows of S are gathered where they are at most one in this number; else all of S is
read."""


@dataclass(frozen=True, eq=False)
class Solved:
    """Solution of a linear system, scaled.

    Attributes
    ----------
    unknown
        Jumps of the base, then forces of the jumps beyond it, shape (n,).
    strained, motion
        The same jumps apart: y of the base, shape (n_base,), and the rigid motions,
        shape (n_motions,).
    force
        Forces of all jumps, shape (n,).
    """

    unknown: Array
    strained: Array
    motion: Array
    force: Array


class LinearSystem:
    """The linear system for given states, which reuses its last factors.

    The stiffness and gauge are those of the condensed structure, or others where
    springs hold it. Rows of the system are the jumps of the base that are free or have
    a spring in series, and the jumps that follow from the base: on a wall a fifth of
    the jumps, fewer than its rigid motions.

    Attributes
    ----------
    unit
        Stiffness of every jump alone, with the spring in series, shape (n,), scaled.
    friction
        Coefficient mu of each jump, shape (n,).
    stop
        Function asked before each system is solved; where it returns True,
        `Interrupted` is raised instead.
    solutions
        Number of systems solved.
    unbalanced
        Largest force out of balance in the last system, scaled; more than rounding,
        where a motion is free.
    has_negative_determinant
        Sign of the determinant of the last system. The determinant of a convex problem
        is never negative, and the signs at all solutions of an instant add up to one:
        so an instant with a negative one has other solutions.
    """

    def __init__(
        self,
        condensed: Condensation,
        stiffness: Array,
        gauge: Array,
        stop: Callable[[], bool] = never,
    ) -> None:
        self._stiffness = stiffness
        self._gauge = gauge
        rules = condensed.rules
        self.stop = stop
        self._partner = rules.partner
        self.friction = rules.friction
        self._growth = np.zeros_like(rules.friction)
        self._base = condensed.base
        self._compliance = rules.compliance
        self._base_rows = as_slice(condensed.base)
        self._others: Indices = np.setdiff1d(np.arange(len(rules.gap)), self._base)
        self._ties: Array | None = None
        if len(self._others):
            self._ties = condensed.ties.toarray()
        self._of_unknowns = self._forces_of_unknowns()
        self._alone = np.diagonal(self._stiffness)
        alone = abs(condensed.ties) @ self._alone
        self.unit: Array = alone / (1.0 + alone * rules.compliance)
        self._is_plain = not self._compliance.any() and not self._gauge.size
        self._states: States | None = None
        self._factors: Factors | UpdatedFactors
        # The last factors of a whole matrix, with its states and rows.
        self._whole: tuple[States, Indices, Factors] | None = None
        self.solutions = 0
        self.unbalanced = 0.0
        self.has_negative_determinant = False

    def _forces_of_unknowns(self) -> Array:
        """Matrix from forces of base and of dependent jumps to all forces, (n, n)."""
        if self._ties is None:
            return self._stiffness
        n_base = len(self._base)
        size = len(self._ties)
        forces = np.zeros((size, size))
        forces[self._base, :n_base] = self._stiffness
        forces[self._base, n_base:] = -self._ties[self._others].T
        forces[self._others, np.arange(n_base, size)] = 1.0
        return forces

    @property
    def is_singular(self) -> bool:
        """Check whether the states of the last system leave a motion free."""
        return self._factors.singular

    def set_friction(self, friction: Array, growth: Array) -> None:
        """Change coefficients of friction and growths of bounds per slip, (n,) each."""
        self.friction = friction
        self._growth = growth
        self._states = None
        self._whole = None

    def __call__(self, states: States, right_sides: RightSides) -> Increment:
        """Solve for the step from the instant before, with states of shape (n,)."""
        if self.stop():
            raise Interrupted
        if self._states is None or not np.array_equal(states, self._states):
            self._factor(states)
        self.solutions += 1
        solved = self._solved(right_sides)
        self._set_carried(solved, right_sides)
        end = self._ends(solved, right_sides.held)
        return Increment(end, solved.force, solved.strained, solved.motion)

    def _solved(self, right_sides: RightSides) -> Solved:
        """Solve the factored system."""
        # Jumps of the base, then forces of the jumps beyond it.
        unknown = np.zeros(len(self._of_unknowns))
        unknown[self._kept] = right_sides.held[self._base[self._kept]]
        force = self._forces(unknown, self._kept)
        force[self._base_rows] -= right_sides.load
        missing = self._missing(unknown, force, right_sides)
        unknown[self._unknowns] = self._factors.solve(missing)
        force += self._forces(unknown, self._unknowns, self._stiffness_rows)
        solved = Solved(unknown, unknown[: len(self._base)], unknown[:0], force)
        if self._is_plain:
            return solved
        return self._apart(solved, right_sides)

    def _apart(self, solved: Solved, right_sides: RightSides) -> Solved:
        """Separate rigid motions, and refine the solution where needed."""
        if not self._gauge.size:
            return self._refined(solved, right_sides)
        motion = self._gauge.T @ solved.strained
        moved = self._gauge @ motion
        strained = solved.strained - moved
        apart = Solved(solved.unknown, strained, motion, solved.force)
        if largest_size(moved) > FAR * largest_size(strained) or len(self._sprung):
            return self._refined(apart, right_sides)
        return apart

    def _refined(self, solved: Solved, right_sides: RightSides) -> Solved:
        """Refine a solution once.

        Beside a motion that is far larger than the deformation, the solution has lost
        digits of the forces: those by the deformation alone have them.
        """
        unknown = solved.unknown
        strained = solved.strained
        motion = solved.motion
        force = solved.force
        if len(motion):
            # Once more, as rounding of a large motion is a deformation, too.
            further = self._gauge.T @ strained
            strained = strained - self._gauge @ further
            motion = motion + further
            deformed = unknown.copy()
            deformed[: len(strained)] = strained
            force = self._of_unknowns @ deformed
            force[self._base_rows] -= right_sides.load
        change = np.zeros_like(unknown)
        if not self.is_singular:
            missing = self._missing(unknown, force, right_sides)
            change[self._unknowns] = self._factors.solve(missing)
            force = force + self._forces(change, self._unknowns, self._stiffness_rows)
        changed = change[: len(strained)]
        if len(motion):
            further = self._gauge.T @ changed
            changed = changed - self._gauge @ further
            motion = motion + further
        return Solved(unknown + change, strained + changed, motion, force)

    def _missing(self, unknown: Array, force: Array, right_sides: RightSides) -> Array:
        """Differences from the equations, (n_rows,), with some unknowns, (n,).

        The forces are those of all jumps by these unknowns, shape (n,).
        """
        rows = self._rows
        jump = unknown[: len(self._base)]
        missing = (
            -self._direction * right_sides.bound[rows]
            - self._lengthening * force[rows]
            - self._drag * force[self._carriers]
        )
        if self._grows:
            slip = right_sides.held[rows] - self._jumps_of_rows @ jump
            missing += self._growth_of_rows * slip
        if len(self._sprung):
            springs = rows[self._sprung]
            length = self._compliance[springs] * force[springs]
            end = self._jumps_of_sprung @ jump + length
            missing[self._sprung] = self._sprung_scale * (
                right_sides.held[springs] - end
            )
        return np.asarray(missing)

    def _set_carried(self, solved: Solved, right_sides: RightSides) -> None:
        """Set the forces of rows by their friction law, and store the difference."""
        rows = self._rows
        force = solved.force
        carried = -self._direction * right_sides.bound[rows]
        carried = carried - self._drag * force[self._carriers]
        if self._grows:
            jump = solved.unknown[: len(self._base)]
            slip = self._jumps_of_rows @ jump - right_sides.held[rows]
            carried = (carried - self._growth_of_rows * slip) / self._lengthening
        carried[self._sprung] = force[rows[self._sprung]]
        self.unbalanced = float(np.abs(force[rows] - carried).max(initial=0.0))
        force[rows] = carried

    def _forces(
        self, unknown: Array, places: Indices, rows: Array | None = None
    ) -> Array:
        """Forces of all jumps due to some of the unknowns, (n,).

        Most held jumps do not move, and few jumps slip at a time: so S, which is
        symmetric, is read at the rows of the others alone.

        Parameters
        ----------
        unknown
            All unknowns, shape (n,).
        places
            Places of the unknowns that count.
        rows
            Rows of S at these places, shape (n_places, n), where they are at hand.
        """
        if rows is None:
            places = places[unknown[places] != 0.0]
            # A product with all of S costs less than gathering many of its rows.
            if self._ties is not None or len(places) * FEW > len(unknown):
                alone = np.zeros_like(unknown)
                alone[places] = unknown[places]
                return np.asarray(self._of_unknowns @ alone)
            rows = self._stiffness[places]
        return np.asarray(rows.T @ unknown[places])

    def _ends(self, solved: Solved, held: Array) -> Array:
        """Jumps with springs in series, (n,); held jumps are exact."""
        ends = solved.unknown[: len(self._base)].copy()
        if self._is_plain:
            return ends
        ends = self._jump(ends) + self._compliance * solved.force
        # What is held is known exactly, and rounding must not pass for slip.
        ends[self._held] = held[self._held]
        return ends

    def _jump(self, base: Array) -> Array:
        """All jumps, (n,), from those of the base, (n_base,)."""
        if self._ties is None:
            return base
        return np.asarray(self._ties @ base)

    def on_base(self, force: Array) -> Array:
        """Forces on the base, (n_base,), equivalent to forces of all jumps, (n,)."""
        if self._ties is None:
            return force
        return np.asarray(self._ties.T @ force)

    def largest_force(self, strained: Array) -> float:
        """Largest force due to any single jump of y, (n_base,), scaled."""
        return float((self._alone * np.abs(strained)).max())

    def blur(self, motion: Array) -> Array:
        """Force at every jump by rounding of a rigid motion, (n,), scaled.

        Shape (1,) where there is none. The motion has the shape (n_motions,).
        """
        if not len(motion):
            return np.zeros(1)
        moved = self._jump(self._gauge @ motion)
        return np.asarray(ROUNDING * self.unit * np.abs(moved))

    def _factor(self, states: States) -> None:
        """Factor the system of states, (n,)."""
        self._states = states.copy()
        self._choose_rows(states)
        self._factors = self._updated(states) or self._factored(states)
        self.has_negative_determinant = self._factors.has_negative_determinant

    def _factored(self, states: States) -> Factors:
        """Factors of the whole matrix of states, (n,)."""
        matrix = self._with_friction()
        if len(self._sprung):
            matrix[self._sprung] = self._rows_of_sprung(matrix[self._sprung])
        factors = Factors(matrix, LOOSE * float(self.unit.max(initial=0.0)))
        self._whole = None
        if len(self._rows) >= MANY and not factors.singular:
            self._whole = states.copy(), self._rows, factors
        return factors

    def _updated(self, states: States) -> UpdatedFactors | None:
        """Update the last factors to the states, (n,); None where that is slower.

        What comes and goes are jumps that are free or held now, and those that slip the
        other way. Where something is in series, equations change in other ways, too.
        """
        if self._whole is None or self._grows or self._compliance.any():
            return None
        before, rows, factors = self._whole
        is_new = states != before
        removed = np.flatnonzero(is_new[rows])
        added = np.flatnonzero(is_new[self._rows])
        if (len(removed) + len(added)) * CHANGED > len(rows):
            return None
        # Equations that stay are the same under both states, and others are dropped.
        direction = np.where(np.abs(states[rows]) == 1, states[rows], 0)
        drag = direction * self.friction[rows]
        new = self._rows[added]
        updated = UpdatedFactors(
            factors,
            removed,
            added,
            columns=self._less_friction(rows, drag, new),
            rows=self._less_friction(new, self._drag[added], rows),
            corner=self._less_friction(new, self._drag[added], new),
        )
        if updated.is_doubtful:
            return None
        return updated

    def _choose_rows(self, states: States) -> None:
        """Choose unknowns and rows of the system by states (n,), and their friction."""
        is_free = (states != HELD) | (self._compliance > 0.0)
        self._free: Indices = np.flatnonzero(is_free[self._base])
        self._kept: Indices = np.flatnonzero(~is_free[self._base])
        # Jumps beyond the base are unknown by their forces, held or not.
        rows = np.concatenate([self._base[self._free], self._others])
        self._rows = rows
        others = np.arange(len(self._base), len(self._of_unknowns))
        self._unknowns: Indices = np.concatenate([self._free, others])
        self._stiffness_rows: Array | None = None
        if self._ties is None and len(rows) * FEW <= len(self._stiffness):
            self._stiffness_rows = self._stiffness.take(rows, axis=0)
        # Friction of each row: its direction, how the normal force and the slip change
        # it, and which jump carries it.
        of_rows = states[rows]
        self._sprung: Indices = np.flatnonzero(of_rows == HELD)
        self._held = np.concatenate([self._base[self._kept], rows[self._sprung]])
        self._direction = np.where(np.abs(of_rows) == 1, of_rows, 0).astype(float)
        self._drag = self._direction * self.friction[rows]
        self._carriers: Indices = self._partner[rows]
        self._growth_of_rows = np.abs(self._direction) * self._growth[rows]
        self._grows = bool(self._growth_of_rows.any())
        # A spring in series lengthens the slip by its force over its stiffness.
        self._lengthening = 1.0 + self._growth_of_rows * self._compliance[rows]

    def _with_friction(self) -> Array:
        """Matrix of forces of rows less friction by all unknowns, (n_rows, n_rows)."""
        matrix = self._less_friction(self._rows, self._drag, self._unknowns)
        if self._grows:
            self._jumps_of_rows = self._jumps_of(self._rows)
            slips = self._jumps_of_rows[:, self._free]
            matrix[:, : len(self._free)] += self._growth_of_rows[:, None] * slips
        return matrix

    def _less_friction(self, rows: Indices, drag: Array, unknowns: Indices) -> Array:
        """Matrix of forces of rows less friction by some unknowns.

        Shape (n_rows, n_unknowns); `drag` is mu with the direction of friction,
        (n_rows,). Where friction grows with slip, the rows are all of the system.
        """
        # Each row is f + s mu f_n = -s r: the force of a jump less its friction.
        matrix = self._of_unknowns[np.ix_(rows, unknowns)]
        if self._grows:
            matrix *= self._lengthening[:, None]
        # Few rows drag, and each reads a further row of S.
        tied = np.flatnonzero(drag)
        if len(tied):
            carriers = self._partner[rows[tied]]
            normal = self._of_unknowns[np.ix_(carriers, unknowns)]
            matrix[tied] += drag[tied, None] * normal
        return np.asarray(matrix)

    def _rows_of_sprung(self, forces: Array) -> Array:
        """Equations of held jumps with springs in series: both end at a given length.

        Parameters
        ----------
        forces
            Rows of the forces of these jumps, shape (n_sprung, n_unknowns).

        Returns
        -------
        The equations, same shape, scaled to the size of the jumps or of the forces,
        whichever is larger.
        """
        springs = self._rows[self._sprung]
        self._jumps_of_sprung = self._jumps_of(springs)
        compliance = self._compliance[springs, None]
        # A soft spring makes an equation of forces, a stiff one an equation of lengths.
        scale = 1.0 / (1.0 + compliance)
        self._sprung_scale = scale[:, 0]
        equations = compliance * forces
        equations[:, : len(self._free)] += self._jumps_of_sprung[:, self._free]
        return np.asarray(scale * equations)

    def _jumps_of(self, numbers: Indices) -> Array:
        """Matrix from jumps of the base to some jumps, (n_numbers, n_base)."""
        if self._ties is not None:
            return np.asarray(self._ties[numbers])
        jumps = np.zeros((len(numbers), len(self._base)))
        jumps[np.arange(len(numbers)), numbers] = 1.0
        return jumps
