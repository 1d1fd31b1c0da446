"""One instant of frictional contact, its states known: a linear system.

With S y = f + q and jumps y + Q a (`solver.reference.condensation`), unknown are y
where a jump is not held or where something is in series, the forces of jumps that
follow from others, and the rigid motions a. Their equations say what free jumps carry,
what held ones come to, and that Q' y = 0.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import lapack

from solver.arrays import ROUNDING, Array, Indices, as_slice
from solver.reference.assembly import Interrupted
from solver.reference.condensation import Condensation
from solver.reference.rules import HELD, Increment, Sides, States

LOOSE = 1e-14
"""Pivot, as a share of the largest stiffness of all jumps, below which a motion is
free."""
SINGULAR = 1e-12
"""Pivot, as a share of the largest, below which a system is singular."""
FEW = 4
"""Rows of S at most, one in so many, that are gathered sooner than all of S is read."""


class LinearSystem:
    """The linear system of given states; the last factorisation is kept.

    The stiffness and gauge are those of the condensed structure, or others where
    springs hold it.

    Attributes
    ----------
    unit
        Stiffness of every jump alone, with what is in series, shape (n,), scaled.
    friction
        Coefficient mu of each jump, shape (n,).
    stop
        Asked before each system is solved; where it returns True, `Interrupted` is
        raised instead.
    solutions
        Systems solved.
    unbalanced
        Largest force out of balance in the last one; more than rounding, where a motion
        is free.
    turned
        Whether the determinant of the last one is negative. That of a convex problem
        never is, and the signs at all solutions of an instant add up to one: so it has
        others.
    """

    def __init__(
        self,
        condensed: Condensation,
        stiffness: Array,
        gauge: Array,
        stop: Callable[[], bool] | None = None,
    ) -> None:
        self._stiffness = stiffness
        self._gauge = gauge
        rules = condensed.rules
        self.stop = stop
        self._partner = rules.partner
        self.friction = rules.friction
        self._growth = np.zeros_like(rules.friction)
        self._base = condensed.base
        self._soft = rules.compliance
        self._base_rows = as_slice(condensed.base)
        self._others: Indices = np.setdiff1d(np.arange(len(rules.gap)), self._base)
        if len(self._others):
            self._ties = condensed.ties.toarray()
        else:
            self._ties = None
        self._of_unknowns = self._forces_of_unknowns()
        alone = abs(condensed.ties) @ np.diagonal(self._stiffness)
        self.unit: Array = alone / (1.0 + alone * rules.compliance)
        self._alone = np.diagonal(self._stiffness)
        self._pulls_of_gauge = self._of_unknowns[:, : len(self._base)] @ self._gauge
        self._is_plain = not self._soft.any() and not self._gauge.size
        self._states: States | None = None
        self._factors: Factors
        self.solutions = 0
        self.unbalanced = 0.0
        self.turned = False

    def _forces_of_unknowns(self) -> Array:
        """Forces of all jumps by y and forces of jumps that follow from others, (n, n)."""
        if self._ties is None:
            return self._stiffness
        n_base = len(self._base)
        size = len(self._ties)
        forces = np.zeros((size, size))
        forces[self._base, :n_base] = self._stiffness
        forces[self._base, n_base:] = -self._ties[self._others].T
        forces[self._others, np.arange(n_base, size)] = 1.0
        return forces

    def set_friction(self, friction: Array, growth: Array) -> None:
        """Change coefficients of friction, and growths of their bounds per slip, shape (n,)."""
        self.friction = friction
        self._growth = growth
        self._states = None

    def __call__(self, states: States, sides: Sides) -> Increment:
        """Solve for the step from the instant before."""
        if self.stop is not None and self.stop():
            raise Interrupted
        if self._states is None or not np.array_equal(states, self._states):
            self._factor(states)
        self.solutions += 1
        rows = self._rows
        kept = self._kept
        sprung = self._sprung
        n_base = len(self._base)
        n_free = len(self._free)
        n_rows = len(rows)
        unknown = np.zeros(len(self._of_unknowns))
        unknown[kept] = sides.held[self._base[kept]]
        stays = self._forces(unknown, kept)
        stays[self._base_rows] -= sides.load
        force = stays
        given = -self._way * sides.bound[rows]
        right = (
            given - self._share_of_own * force[rows] - self._slope * force[self._under]
        )
        if self._grows:
            right += self._stiffer * (sides.held[rows] - self._slips @ unknown[:n_base])
        if not self._is_plain:
            right = np.concatenate([right, self._gauge_kept.T @ unknown[kept]])
            if len(sprung):
                springs = rows[sprung]
                come = (
                    self._come @ unknown[:n_base] + self._soft[springs] * force[springs]
                )
                right[sprung] = self._share * (sides.held[springs] - come)
        solution = self._factors.solve(right)
        motion = solution[n_rows:]
        unknown[self._free] = solution[:n_free]
        unknown[n_base:] = solution[n_free:n_rows]
        if len(motion):
            unknown[kept] -= self._gauge_kept @ motion
            stays = self._forces(unknown, kept)
            stays[self._base_rows] -= sides.load
        force = stays + self._forces(unknown, self._unknowns, self._own)
        carried = given - self._slope * force[self._under]
        if self._grows:
            slip = (
                self._slips @ (unknown[:n_base] + self._gauge @ motion)
                - sides.held[rows]
            )
            carried = (carried - self._stiffer * slip) / self._share_of_own
        carried[sprung] = force[rows[sprung]]
        self.unbalanced = float(np.abs(force[rows] - carried).max(initial=0.0))
        force[rows] = carried
        strained = unknown[:n_base]
        return Increment(
            self._ends(strained, motion, force, sides.held), force, strained, motion
        )

    def _forces(
        self, unknown: Array, places: Indices, rows: Array | None = None
    ) -> Array:
        """Forces of all jumps that the unknowns at some places make.

        Most of what is held comes to nothing, and few jumps slip at a time: so S, which
        is symmetric, is read at the `rows` of what does, if these are not at hand.
        """
        if rows is None:
            places = places[unknown[places] != 0.0]
            if self._ties is not None or len(places) * FEW > len(unknown):
                alone = np.zeros_like(unknown)
                alone[places] = unknown[places]
                return np.asarray(self._of_unknowns @ alone)
            rows = self._stiffness[places]
        return np.asarray(rows.T @ unknown[places])

    def _jump(self, strained: Array, motion: Array) -> Array:
        if len(motion):
            strained = strained + self._gauge @ motion
        if self._ties is None:
            return strained
        return np.asarray(self._ties @ strained)

    def _ends(self, strained: Array, motion: Array, force: Array, held: Array) -> Array:
        """What all jumps come to, the held ones to the last bit."""
        if self._is_plain:
            return strained.copy()
        ends = self._jump(strained, motion) + self._soft * force
        ends[self._held] = held[self._held]
        return ends

    def on_base(self, force: Array) -> Array:
        """Forces on the base that forces of all jumps are."""
        if self._ties is None:
            return force
        return np.asarray(self._ties.T @ force)

    def inside(self, strained: Array) -> float:
        """Largest force that y of a single jump of the base takes."""
        return float((self._alone * np.abs(strained)).max())

    def blur(self, motion: Array) -> Array:
        """Force that rounding of a rigid motion may make at every jump, shape (n,)."""
        if self._is_plain:
            return np.zeros(1)
        moved = self._jump(np.zeros(len(self._base)), motion)
        return np.asarray(ROUNDING * self.unit * np.abs(moved))

    def _factor(self, states: States) -> None:
        self._states = states.copy()
        is_free = (states != HELD) | (self._soft > 0.0)
        self._free: Indices = np.flatnonzero(is_free[self._base])
        self._kept: Indices = np.flatnonzero(~is_free[self._base])
        rows = np.concatenate([self._base[self._free], self._others])
        self._rows = rows
        of_rows = states[rows]
        self._sprung: Indices = np.flatnonzero(of_rows == HELD)
        self._way = np.where(np.abs(of_rows) == 1, of_rows, 0).astype(float)
        self._slope = slope = self._way * self.friction[rows]
        self._stiffer = np.abs(self._way) * self._growth[rows]
        self._grows = bool(self._stiffer.any())
        self._under: Indices = self._partner[rows]
        others = np.arange(len(self._base), len(self._of_unknowns))
        unknowns = self._unknowns = np.concatenate([self._free, others])
        is_few = self._ties is None and len(rows) * FEW <= len(self._stiffness)
        self._own: Array | None = None
        if is_few:
            self._own = self._stiffness.take(rows, axis=0)
        matrix = self._of_unknowns[np.ix_(rows, unknowns)]
        # A spring in series lengthens the slip by its force over its stiffness.
        self._share_of_own = 1.0 + self._stiffer * self._soft[rows]
        if self._grows:
            matrix *= self._share_of_own[:, None]
        tied = np.flatnonzero(slope)
        if len(tied):
            under = self._of_unknowns[np.ix_(self._under[tied], unknowns)]
            matrix[tied] += slope[tied, None] * under
        if self._grows:
            self._slips = self._jumps_of(rows)
            matrix[:, : len(self._free)] += (
                self._stiffer[:, None] * self._slips[:, self._free]
            )
        if not self._is_plain:
            matrix = self._with_motions(matrix)
        if self._is_plain:
            least = LOOSE * float(self.unit.max(initial=0.0))
        else:
            least = 0.0
        self._factors = Factors(matrix, least, scaled=not self._is_plain)
        self.turned = self._factors.turned

    def _with_motions(self, forces: Array) -> Array:
        """All equations: what is in series comes to its end, and y is chosen."""
        free = self._free
        gauge = self._gauge
        sprung = self._sprung
        kept = self._gauge_kept = gauge[self._kept]
        held = self._rows[sprung]
        n_rows = len(forces)
        n_free = len(free)
        self._held = np.concatenate([self._base[self._kept], held])
        matrix = np.zeros((n_rows + gauge.shape[1],) * 2)
        matrix[:n_rows, :n_rows] = forces
        if gauge.size:
            pulls = self._share_of_own[:, None] * self._pulls_of_motions(self._rows)
            tied = np.flatnonzero(self._slope)
            pulls[tied] += self._slope[tied, None] * self._pulls_of_motions(
                self._under[tied]
            )
            matrix[:n_rows, n_rows:] = pulls
            if self._grows:
                slid = self._slips[:, free] @ gauge[free]
                matrix[:n_rows, n_rows:] += self._stiffer[:, None] * slid
        if len(sprung):
            come = self._come = self._jumps_of(held)
            soft = self._soft[held, None]
            size = (len(held), len(self._others))
            share = 1.0 / (1.0 + soft)
            moved = [come[:, free], np.zeros(size), come[:, free] @ gauge[free]]
            matrix[sprung] = share * (soft * matrix[sprung] + np.hstack(moved))
            self._share = share[:, 0]
        matrix[n_rows:, :n_free] = -gauge[free].T
        matrix[n_rows:, n_rows:] = kept.T @ kept
        return matrix

    def _pulls_of_motions(self, rows: Indices) -> Array:
        """Forces at some jumps where the base is kept in place of each motion, (n, n_motions)."""
        free = self._free
        moved = self._of_unknowns[np.ix_(rows, free)] @ self._gauge[free]
        return np.asarray(moved - self._pulls_of_gauge[rows])

    def _jumps_of(self, numbers: Indices) -> Array:
        """Jumps at some places as a matrix on those of the base, shape (n, n_base)."""
        if self._ties is not None:
            return np.asarray(self._ties[numbers])
        jumps = np.zeros((len(numbers), len(self._base)))
        jumps[np.arange(len(numbers)), numbers] = 1.0
        return jumps


class Factors:
    """A square matrix, factored.

    If `scaled`, rows and columns are brought to one size first, by powers of two, and
    what is solved is refined once: then every row holds up to the rounding of its own
    terms (Skeel, Math. Comp. 35, 1980).

    Attributes
    ----------
    turned
        Whether its determinant is negative.
    singular
        Whether a pivot is too small, or not above `least`.
    """

    def __init__(self, matrix: Array, least: float, *, scaled: bool) -> None:
        self._scaled = scaled
        if scaled:
            self._rows = _sizes(matrix, 1)
            matrix = self._rows[:, None] * matrix
            self._columns = _sizes(matrix, 0)
            matrix = matrix * self._columns
        self._matrix = self._factors = matrix
        self._pivots = np.zeros(0, dtype=np.intp)
        if len(matrix):
            self._factors, self._pivots, _ = lapack.dgetrf(matrix)
        diagonal = np.diagonal(self._factors)
        swaps = np.count_nonzero(self._pivots != np.arange(len(matrix)))
        self.turned = bool((np.count_nonzero(diagonal < 0.0) + swaps) % 2)
        sizes = np.abs(diagonal)
        least = max(SINGULAR * float(sizes.max(initial=0.0)), least)
        self.singular = bool(sizes.min(initial=np.inf) <= least)

    def solve(self, right: Array) -> Array:
        """Solve A x = b, b of shape (n,); where A is singular, by the least x that fits best."""
        if not len(right):
            return right
        if not self._scaled:
            return self._solve(right)
        right = self._rows * right
        solution = self._solve(right)
        if not self.singular:
            solution += self._solve(right - self._matrix @ solution)
        return np.asarray(self._columns * solution)

    def _solve(self, right: Array) -> Array:
        if self.singular:
            return np.asarray(np.linalg.lstsq(self._matrix, right, rcond=SINGULAR)[0])
        return np.asarray(lapack.dgetrs(self._factors, self._pivots, right)[0]).reshape(
            right.shape
        )


def _sizes(matrix: Array, axis: int) -> Array:
    """Powers of two that bring the largest entries along an axis near 1."""
    _, exponent = np.frexp(np.abs(matrix).max(axis=axis, initial=0.0))
    return np.asarray(np.ldexp(1.0, -exponent))
