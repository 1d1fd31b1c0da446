"""The minimum over one instant of rods on supports with a known bound (solver/README.md, 6 and 14).

With the stiffness K of rods one after the other, which is tridiagonal, and the bounds
r,

    phi(v) = 1/2 v' K v - g' v + sum r |v|.

Where friction hardens or softens with slip its bound is b + c |v|: the same minimum, of
a structure that is stiffer, or softer, where it slips.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

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
"""Force that moves a rod as one by a unit, over the largest row of the stiffness, which
is none."""
LEASH = 1e-10
"""Stiffness over the same that holds a loose rod for a step: it goes far, and keeps its
digits."""


class Tridiagonal:
    """A symmetric tridiagonal matrix, solved again and again with other degrees of freedom held.

    It has a diagonal (n,), entries (n - 1,) beside it, and what is added to the
    diagonal where degrees of freedom are not held, (n,). `largest_row` is the largest
    sum of the sizes of a row, without that.
    """

    def __init__(
        self, diagonal: Array, beside: Array, slipping: Array | None = None
    ) -> None:
        self.diagonal = diagonal
        self.beside = beside
        self._slipping = slipping
        self._upper = np.asfortranarray([np.append(0.0, beside), diagonal])
        sums = np.abs(diagonal)
        sums[1:] += np.abs(beside)
        sums[:-1] += np.abs(beside)
        self.largest_row = float(sums.max())

    def stiffened(self, slipping: Array) -> Self:
        """The matrix with more on its diagonal, or less, where degrees of freedom are not held."""
        if self._slipping is None:
            slipping = slipping
        else:
            slipping = self._slipping + slipping
        return type(self)(self.diagonal, self.beside, slipping)

    def product(self, field: Array) -> Array:
        """K v."""
        force: Array = blas.dsbmv(1, 1.0, self._upper, field)
        if self._slipping is None:
            return force
        return force + self._slipping * field

    def solve_kept(self, keep: Array, force: Array) -> Array:
        """Solve on the degrees of freedom where `keep` is 1; where it is 0, the force must be 0.

        LinAlgError is raised if these can move without force.
        """
        diagonal = self.diagonal
        if self._slipping is not None:
            diagonal = diagonal + self._slipping * keep
        *_, solved, trouble = lapack.dptsv(
            diagonal, self.beside * keep[1:] * keep[:-1], force
        )
        if trouble:
            raise LinAlgError("the matrix is not positive definite where it is kept")
        return np.asarray(solved)

    def part(self, kept: slice) -> Self:
        """The matrix of degrees of freedom that follow each other."""
        inside = slice(kept.start, kept.stop - 1)
        part = type(self)(self.diagonal[kept], self.beside[inside])
        if self._slipping is None:
            return part
        return part.stiffened(self._slipping[kept])

    def tied(self, group: Indices) -> Self:
        """Stiffness of neighbours that are tied together, by the number of their group, (n,)."""
        diagonal = summed(group, self.diagonal)
        is_inside = group[1:] == group[:-1]
        # What ties two of one group counts on both sides of the diagonal.
        np.add.at(diagonal, group[1:][is_inside], 2.0 * self.beside[is_inside])
        tied = type(self)(diagonal, self.beside[~is_inside])
        if self._slipping is None:
            return tied
        return tied.stiffened(summed(group, self._slipping))


def summed(group: Indices, values: Array) -> Array:
    """Sum of the values of every group, by their numbers from 0, shape (n_groups,)."""
    return np.asarray(np.bincount(group, values), dtype=float)


@dataclass(frozen=True, eq=False)
class Minimum:
    """Fields of shape (n_dofs,) at the minimum of phi, and its KKT residual, also relative."""

    increment: Array
    pull: Array
    status: Array
    violation: float
    residual: float


class Search:
    """Minimise phi where some degrees of freedom are held at zero.

    In Newton's method for the statuses a front advances by one point a step, and it may
    cycle. So it gives up early, and each rod starts again from the statuses of a mesh
    twice as coarse, found in the same way. Where that fails too, an active-set method
    ends in finitely many steps.

    Attributes
    ----------
    rubs
        1 where a bound is above zero and nothing held, else 0, shape (n_dofs,).
    solutions
        Systems of full size that were solved.
    """

    def __init__(self, stiffness: Tridiagonal, bound: Array, movable: Array) -> None:
        self._stiffness = stiffness
        self._bound = bound
        self._movable = movable
        self.solutions = 0
        self._parts: dict[int, tuple[slice, Search]] = {}
        self.rubs = (bound > 0.0) * movable
        self._free = movable - self.rubs  # neither held nor rubbing
        self._limit = np.where(self.rubs > 0.0, bound, np.inf)
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
        """Minimum, sought from a guess of the statuses; no force where nothing moves."""
        status, changing, fields = self._newton(force, status)
        if fields is None:
            for rod in np.unique(self._rod[changing]):
                own, search = self._of_rod(rod)
                done = search.solutions
                status[own] = search._mended(force[own], status[own])
                self.solutions += -(
                    -(search.solutions - done) * len(search.rubs) // len(force)
                )
            fields = self._fields(force, status)
        increment, pull, _ = fields
        bound = self._bound
        held = np.where(
            status != 0.0, bound * status, np.minimum(np.maximum(pull, -bound), bound)
        )
        violation = float((np.abs(pull - held) * self._movable).max())
        if violation:
            relative = violation / float(np.abs(force).sum())
        else:
            relative = 0.0
        return Minimum(increment, held, status, violation, relative)

    def _newton(
        self, force: Array, status: Array
    ) -> tuple[Array, Flags, tuple[Array, Array, Array] | None]:
        """Correct statuses by what they show; which change; the fields once none does."""
        changing = np.ones(len(status), dtype=bool)
        for _ in range(NEWTON_LIMIT):
            increment, pull, limit = fields = self._fields(force, status)
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

    def _of_rod(self, rod: int) -> tuple[slice, Search]:
        """Degrees of freedom of a rod, and the search on it alone."""
        if rod not in self._parts:
            first, last = np.searchsorted(self._rod, [rod, rod + 1])
            own = slice(first, last)
            part = Search(
                self._stiffness.part(own), self._bound[own], self._movable[own]
            )
            self._parts[rod] = own, part
        return self._parts[rod]

    def _mended(self, force: Array, status: Array) -> Array:
        """Statuses of a rod where those of Newton's method do not come to rest."""
        if len(force) >= COARSEST:
            coarser, group = self._coarser
            forces = summed(group, force)
            guess, _, fields = coarser._newton(forces, np.sign(summed(group, status)))
            if fields is None:
                guess = coarser._mended(forces, guess)
            status, _, fields = self._newton(force, self.rubs * guess[group])
            if fields is not None:
                return status
        return self._descend(force, status)

    def _descend(self, force: Array, status: Array) -> Array:
        """Minimise phi of a rod by an active-set method, every step of which lowers phi.

        A step ends where a first point stops, which then sticks; at a minimum over the
        slipping points that pulled most beyond its bound is released, and moves the way
        it is pulled.
        """
        increment, _, _ = self._fields(force, status)
        status = status * (status * increment > 0.0)
        increment *= self._free + np.abs(status)
        released = -1
        while True:
            target, pull, limit = self._fields(force, status)
            turns = np.flatnonzero(status * target < 0.0)
            if not len(turns):
                increment = target
                excess = np.where(status == 0.0, np.abs(pull) - limit, -np.inf)
                released = int(excess.argmax())
                if excess[released] <= 0.0:
                    return status
                status[released] = np.sign(pull[released])
                continue
            shares = increment[turns] / (increment[turns] - target[turns])
            first = turns[shares.argmin()]
            # One that goes back before it has moved was released within rounding of its
            # bound; but one that was slipping may have stood still all the while.
            is_done = first == released and increment[first] == 0.0
            increment += shares.min() * (target - increment)
            increment[first] = 0.0
            status = status * (status * increment > 0.0)
            increment *= self._free + np.abs(status)
            if is_done:
                return status

    def _fields(self, force: Array, status: Array) -> tuple[Array, Array, Array]:
        """Increment, exactly zero where statuses are; pull; and its limit, rounding included.

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
        largest = (
            self._stiffness.largest_row * np.abs(increment).max() + np.abs(force).max()
        )
        pull = force - self._stiffness.product(increment)
        return increment, pull, self._limit + ROUNDING * float(largest)

    @cached_property
    def _coarser(self) -> tuple[Search, Indices]:
        """The same rod, all of it movable, with its points tied in pairs; and the pair of each."""
        group = np.arange(len(self.rubs)) // 2
        bound = summed(group, self._bound)
        return Search(self._stiffness.tied(group), bound, np.ones_like(bound)), group
