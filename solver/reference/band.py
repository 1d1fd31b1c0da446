"""A symmetric band matrix, solved again and again with other degrees of freedom held."""

from __future__ import annotations

from copy import copy
from typing import Self

import numpy as np
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import blas, lapack

from solver.arrays import Array, Flags, Indices

_LOOSE = "the matrix is not positive definite on the degrees of freedom that are kept"


class Band:
    """A symmetric sparse matrix, solved as a band: upper diagonals by row (LAPACK's form).

    Attributes
    ----------
    largest_row
        Largest sum of the sizes of a row.
    solutions
        Systems that were solved.
    """

    def __init__(self, matrix: sparse.csr_array) -> None:
        entries = sparse.triu(matrix).tocoo()
        rows, columns = entries.coords
        width = int((columns - rows).max())
        upper = np.zeros((width + 1, matrix.shape[0]), order="F")
        upper[width - (columns - rows), columns] = entries.data
        self._set(upper)

    def _set(self, upper: Array) -> None:
        self._upper, self._width = upper, len(upper) - 1
        self._diagonal = upper[-1].copy()
        self._beside = upper[0, 1:].copy()
        sums = np.abs(self._diagonal)
        for offset in range(1, self._width + 1):
            beside = np.abs(upper[self._width - offset, offset:])
            sums[offset:] += beside
            sums[: len(sums) - offset] += beside
        self.largest_row = float(sums.max())
        self._added: Array | None = None
        self.solutions = 0

    @classmethod
    def _of(cls, upper: Array) -> Self:
        band = cls.__new__(cls)
        band._set(upper)
        return band

    def apart(self, movable: Array) -> Indices:
        """First of every run of degrees of freedom that nothing movable ties to others."""
        if self._width != 1:
            return np.zeros(1, dtype=np.intp)
        tied = self._beside * movable[1:] * movable[:-1] != 0.0
        return np.concatenate([[0], 1 + np.flatnonzero(~tied)])

    def product(self, field: Array) -> Array:
        """K v."""
        force = np.asarray(blas.dsbmv(self._width, 1.0, self._upper, field))
        return force if self._added is None else force + self._added * field

    def solve_kept(self, keep: Array, force: Array) -> Array:
        """Solve on the degrees of freedom where `keep` is 1; where it is 0, the force must be 0.

        Raises
        ------
        LinAlgError
            If these can move without force.
        """
        self.solutions += 1
        added = None if self._added is None else self._added * keep
        if self._width == 1:
            diagonal = self._diagonal if added is None else self._diagonal + added
            *_, solved, trouble = lapack.dptsv(diagonal, self._beside * keep[1:] * keep[:-1], force)
        else:
            matrix = self._upper.copy(order="F")
            for offset in range(1, self._width + 1):
                matrix[self._width - offset, offset:] *= keep[offset:] * keep[:-offset]
            if added is not None:
                matrix[-1] += added
            _, solved, trouble = lapack.dpbsv(matrix, force, overwrite_ab=True)
        if trouble:
            raise LinAlgError(_LOOSE)
        return np.asarray(solved).reshape(len(force))

    def stiffened(self, diagonal: Array) -> Self:
        """The matrix plus a diagonal one, which may be negative, where degrees are kept."""
        band = copy(self)
        band._added = diagonal if self._added is None else self._added + diagonal
        band.solutions = 0
        return band

    def only(self, kept: Flags) -> Self:
        """The matrix of some degrees of freedom that nothing movable ties to the others."""
        places = np.flatnonzero(kept)
        upper = np.asfortranarray(self._upper[:, places])
        upper[:-1, 1:][:, np.diff(places) > 1] = 0.0
        band = self._of(upper)
        return band if self._added is None else band.stiffened(self._added[places])

    def tied(self, group: Indices, movable: Array) -> Self:
        """Stiffness of degrees of freedom that are tied together where they are movable, 1 or 0.

        `group` is the number of the one that each becomes, ascending, shape (n,); one without
        any that is movable has the stiffness 1.
        """
        size = int(group[-1]) + 1
        upper = np.zeros((self._width + 1, size), order="F")
        np.add.at(upper[-1], group, self._diagonal * movable)
        upper[-1] += summed(group, movable) == 0.0
        for offset in range(1, self._width + 1):
            entries = self._upper[self._width - offset, offset:]
            entries = entries * movable[offset:] * movable[:-offset]
            first, second = group[:-offset], group[offset:]
            # What ties two of one group counts on both sides of the diagonal.
            np.add.at(
                upper,
                (self._width - (second - first), second),
                entries * np.where(first == second, 2.0, 1.0),
            )
        band = self._of(upper)
        if self._added is None:
            return band
        return band.stiffened(summed(group, self._added * movable))


def summed(group: Indices, values: Array) -> Array:
    """Sum values by the number of their group, ascending from 0, shape (n_groups,)."""
    return np.asarray(np.bincount(group, values), dtype=float)
