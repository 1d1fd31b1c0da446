"""The minimum over one instant of rods on supports with a known bound.

With the stiffness K of rods one after the other, which is tridiagonal, and the bounds
r, the increment v minimises (MATHEMATICS.md, 6 and 14)

    phi(v) = 1/2 v' K v - g' v + sum r |v|.

Where friction hardens or softens with slip its bound is b + c |v|: the same minimum, of
a structure that is stiffer, or softer, where it slips.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np
from numpy.linalg import LinAlgError
from scipy.linalg import blas, lapack

from solver.arrays import ROUNDING, Array, Flags, Indices

NEWTON_LIMIT = 8
"""Steps from one guess of the statuses before a better one is sought."""
COARSEST = 64
"""Degrees of freedom of a rod below which no coarser mesh is asked for a guess
(measured)."""
HELD = 1e-13
"""Force per unit of a rigid motion of a rod, over the largest row of the stiffness, up
to which nothing holds the rod."""
LEASH = 1e-10
"""Stiffness that holds a loose rod for a step, over the same: the rod goes far, and
keeps its digits."""


class Tridiagonal:
    """A symmetric tridiagonal matrix, solved with some degrees of freedom held.

    Attributes
    ----------
    diagonal, beside
        Diagonal, shape (n,), and entries beside it, shape (n - 1,), scaled.
    largest_row
        Largest sum of the sizes of a row, without what is added where degrees of
        freedom are not held.
    """

    def __init__(
        self, diagonal: Array, beside: Array, slipping: Array | None = None
    ) -> None:
        self.diagonal = diagonal
        self.beside = beside
        # Added to the diagonal where degrees of freedom are not held.
        self._slipping = slipping
        self._upper = np.asfortranarray([np.append(0.0, beside), diagonal])
        # The largest row is a bound on the largest eigenvalue, and scales what rounding
        # leaves.
        sums = np.abs(diagonal)
        sums[1:] += np.abs(beside)
        sums[:-1] += np.abs(beside)
        self.largest_row = float(sums.max())

    def stiffened(self, slipping: Array) -> Self:
        """The matrix with stiffness, (n,), added at free degrees of freedom.

        Where friction softens, the stiffness is negative.
        """
        if self._slipping is not None:
            slipping = self._slipping + slipping
        return type(self)(self.diagonal, self.beside, slipping)

    def product(self, field: Array) -> Array:
        """Product K v with a field v; both have the shape (n,)."""
        force: Array = blas.dsbmv(1, 1.0, self._upper, field)
        if self._slipping is None:
            return force
        return force + self._slipping * field

    def solve_kept(self, keep: Array, force: Array) -> Array:
        """Solve on the degrees of freedom where `keep` is 1; the others are 0.

        Parameters
        ----------
        keep
            1 or 0 for each degree of freedom, shape (n,).
        force
            Right side, shape (n,), scaled; 0 where `keep` is 0.

        Returns
        -------
        The solution, shape (n,), scaled.

        Raises
        ------
        LinAlgError
            If the kept degrees of freedom can move without force.
        """
        diagonal = self.diagonal
        if self._slipping is not None:
            diagonal = diagonal + self._slipping * keep
        # A held degree of freedom is cut off by zeros beside the diagonal: no matrix is
        # copied.
        *_, solved, trouble = lapack.dptsv(
            diagonal, self.beside * keep[1:] * keep[:-1], force
        )
        if trouble:
            raise LinAlgError("the matrix is not positive definite where it is kept")
        return np.asarray(solved)

    def part(self, kept: slice) -> Self:
        """The matrix of consecutive degrees of freedom."""
        inside = slice(kept.start, kept.stop - 1)
        part = type(self)(self.diagonal[kept], self.beside[inside])
        if self._slipping is None:
            return part
        return part.stiffened(self._slipping[kept])

    def tied(self, group: Indices) -> Self:
        """The matrix of groups of neighbours tied together, by their numbers, (n,)."""
        diagonal = summed(group, self.diagonal)
        is_inside = group[1:] == group[:-1]
        # What ties two of one group counts on both sides of the diagonal.
        np.add.at(diagonal, group[1:][is_inside], 2.0 * self.beside[is_inside])
        tied = type(self)(diagonal, self.beside[~is_inside])
        if self._slipping is None:
            return tied
        return tied.stiffened(summed(group, self._slipping))


def summed(group: Indices, values: Array) -> Array:
    """Sum of the values (n,) of every group, by their numbers from 0, (n_groups,)."""
    return np.asarray(np.bincount(group, values), dtype=float)


@dataclass(frozen=True, eq=False)
class Minimum:
    """Fields at the minimum of phi, and its KKT residual.

    Attributes
    ----------
    increment, pull
        Increment v, and minus the friction force, shape (n_dofs,), scaled.
    status
        Direction of slip, 0 where a point sticks, shape (n_dofs,).
    violation, residual
        KKT residual, scaled, and divided by the sum of the forces.
    """

    increment: Array
    pull: Array
    status: Array
    violation: float
    residual: float


class _Fields(NamedTuple):
    """Fields for given statuses.

    Attributes
    ----------
    increment
        Increment, exactly zero where statuses are, shape (n_dofs,), scaled.
    pull
        Force that friction would have to hold, shape (n_dofs,), scaled.
    limit
        Largest pull at which a point sticks, rounding included, shape (n_dofs,).
    """

    increment: Array
    pull: Array
    limit: Array


class Search:
    """Search for the minimum of phi, with some degrees of freedom held at zero.

    In Newton's method for the statuses a front advances by one point a step, and it may
    cycle. So it gives up early, and each rod starts again from the statuses of a mesh
    twice as coarse, found in the same way. Where that fails too, an active-set method
    ends in finitely many steps.

    Attributes
    ----------
    rubs
        1 where a bound is above zero and nothing held, else 0, shape (n_dofs,).
    solutions
        Number of systems of full size that were solved.
    """

    def __init__(self, stiffness: Tridiagonal, bound: Array, movable: Array) -> None:
        self._stiffness = stiffness
        self._bound = bound
        self._movable = movable
        self.solutions = 0
        self._parts: dict[int, tuple[slice, Search]] = {}
        self.rubs = (bound > 0.0) * movable
        # Free: neither held nor with friction.
        self._free = movable - self.rubs
        self._limit = np.where(self.rubs > 0.0, bound, np.inf)
        # Rods are parts of the chain that no stiffness ties: each is mended on its own.
        is_tied = stiffness.beside * movable[1:] * movable[:-1] != 0.0
        self._starts = np.flatnonzero(np.append(True, ~is_tied))
        sizes = np.diff(self._starts, append=len(movable))
        self._rod = np.repeat(np.arange(len(sizes)), sizes)
        # Rods that move as one without force, where nothing sticks.
        self._loose: Flags = np.logical_and.reduceat(movable > 0.0, self._starts)
        if self._loose.any():
            pulled = np.maximum.reduceat(
                np.abs(stiffness.product(movable)), self._starts
            )
            self._loose &= pulled <= HELD * stiffness.largest_row

    def __call__(self, force: Array, status: Array) -> Minimum:
        """Find the minimum from a guess of the statuses.

        Parameters
        ----------
        force, status
            Load g, scaled, and guess of the statuses, shape (n_dofs,) each; the load is
            0 where nothing moves.
        """
        status, changing, fields = self._newton(force, status)
        if fields is None:
            # Most rods have come to rest: only those that cycle are sought otherwise.
            for rod in np.unique(self._rod[changing]):
                self._mend_rod(rod, force, status)
            fields = self._fields(force, status)
        pull = fields.pull
        bound = self._bound
        clipped = np.minimum(np.maximum(pull, -bound), bound)
        held = np.where(status != 0.0, bound * status, clipped)
        violation = float((np.abs(pull - held) * self._movable).max())
        relative = 0.0
        if violation:
            relative = violation / float(np.abs(force).sum())
        return Minimum(fields.increment, held, status, violation, relative)

    def _newton(
        self, force: Array, status: Array
    ) -> tuple[Array, Flags, _Fields | None]:
        """Correct statuses by increments and pulls, from a guess; (n_dofs,) each.

        Returns
        -------
        The statuses; which of them change in the last step; and their fields, None
        while some change.
        """
        changing = np.ones(len(status), dtype=bool)
        for _ in range(NEWTON_LIMIT):
            fields = self._fields(force, status)
            increment, pull, limit = fields
            corrected = np.where(
                status != 0.0,
                status * (status * increment > 0.0),
                np.sign(pull) * (np.abs(pull) > limit),
            )
            changing = corrected != status
            if not changing.any():
                return status, changing, fields
            status = corrected
        return status, changing, None

    def _mend_rod(self, rod: int, force: Array, status: Array) -> None:
        """Replace the statuses of a rod by those of its minimum.

        Forces and statuses have the shape (n_dofs,).
        """
        dofs, search = self._of_rod(rod)
        done = search.solutions
        status[dofs] = search._mended(force[dofs], status[dofs])
        # Systems of the rod count by its share of the size, rounded up.
        added = (search.solutions - done) * len(search.rubs)
        self.solutions += -(-added // len(force))

    def _of_rod(self, rod: int) -> tuple[slice, Search]:
        """Degrees of freedom of a rod, and the search restricted to the rod."""
        if rod not in self._parts:
            first, last = np.searchsorted(self._rod, [rod, rod + 1])
            dofs = slice(first, last)
            part = Search(
                self._stiffness.part(dofs), self._bound[dofs], self._movable[dofs]
            )
            self._parts[rod] = dofs, part
        return self._parts[rod]

    def _mended(self, force: Array, status: Array) -> Array:
        """Statuses of a rod, (n_dofs,), for which Newton's method fails.

        The guess of the statuses, and the load, have the same shape.
        """
        if len(force) >= COARSEST:
            coarser, group = self._coarser
            # A front moves two points in a step of the coarse mesh, and the coarsest is
            # small.
            forces = summed(group, force)
            guess, _, fields = coarser._newton(forces, np.sign(summed(group, status)))
            if fields is None:
                guess = coarser._mended(forces, guess)
            status, _, fields = self._newton(force, self.rubs * guess[group])
            if fields is not None:
                return status
        return self._descend(force, status)

    def _descend(self, force: Array, status: Array) -> Array:
        """Minimise phi of a rod by an active-set method; every step lowers phi.

        A step ends where a first point stops, which then sticks. At a minimum over the
        slipping points the point that is pulled farthest beyond its bound is released,
        and moves in the direction of its pull.

        Parameters
        ----------
        force, status
            Load g, scaled, and guess of the statuses, shape (n_dofs,) each.

        Returns
        -------
        The statuses at the minimum, shape (n_dofs,).
        """
        # Points that would move against their status stick, so that the start lowers
        # phi.
        increment = self._fields(force, status).increment
        status, increment = self._moving(status, increment)
        released = -1
        while True:
            fields = self._fields(force, status)
            target = fields.increment
            turns = np.flatnonzero(status * target < 0.0)
            if not len(turns):
                increment = target
                excess = np.abs(fields.pull) - fields.limit
                excess = np.where(status == 0.0, excess, -np.inf)
                released = int(excess.argmax())
                if excess[released] <= 0.0:
                    return status
                status[released] = np.sign(fields.pull[released])
                continue
            shares = increment[turns] / (increment[turns] - target[turns])
            first = turns[shares.argmin()]
            # A point that goes back before it has moved was released within rounding of
            # its bound; but a point that was slipping may have stood still all the
            # while.
            is_done = first == released and increment[first] == 0.0
            increment += shares.min() * (target - increment)
            increment[first] = 0.0
            status, increment = self._moving(status, increment)
            if is_done:
                return status

    def _moving(self, status: Array, increment: Array) -> tuple[Array, Array]:
        """Statuses and increments, (n_dofs,): points that would turn back stick."""
        status = status * (status * increment > 0.0)
        increment *= self._free + np.abs(status)
        return status, increment

    def _fields(self, force: Array, status: Array) -> _Fields:
        """Solve for the fields of statuses under a load, shape (n_dofs,) each.

        A loose rod of which all points slip goes as far as it has to for some of them
        to turn back.
        """
        keep = self._free + np.abs(status)
        stiffness = self._stiffness
        if self._loose.any():
            flies = self._loose & np.logical_and.reduceat(keep > 0.0, self._starts)
            if flies.any():
                leash = LEASH * stiffness.largest_row
                stiffness = stiffness.stiffened(np.where(flies[self._rod], leash, 0.0))
        self.solutions += 1
        increment = stiffness.solve_kept(keep, keep * (force - self._bound * status))
        inside = self._stiffness.largest_row * np.abs(increment).max()
        # Rounding of the pull is a share of the forces that cancel in it.
        largest = inside + np.abs(force).max()
        pull = force - self._stiffness.product(increment)
        return _Fields(increment, pull, self._limit + ROUNDING * float(largest))

    @cached_property
    def _coarser(self) -> tuple[Search, Indices]:
        """The search on the rod with points tied in pairs.

        With the number of the pair of each point, shape (n_dofs,).
        """
        group = np.arange(len(self.rubs)) // 2
        bound = summed(group, self._bound)
        return Search(self._stiffness.tied(group), bound, np.ones_like(bound)), group
