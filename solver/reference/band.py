"""A symmetric band matrix, solved again and again with other degrees of freedom held."""

from __future__ import annotations

from copy import copy

import numpy as np
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import blas, lapack

from solver.arrays import Array

_LOOSE = "the matrix is not positive definite on the degrees of freedom that are kept"


class Band:
    """A symmetric sparse matrix, solved as a band: upper diagonals by row (LAPACK's form)."""

    def __init__(self, matrix: sparse.csr_array) -> None:
        self._matrix = matrix
        entries = sparse.triu(matrix).tocoo()
        rows, columns = entries.coords
        self._width = int((columns - rows).max())
        self._upper = np.zeros((self._width + 1, matrix.shape[0]), order="F")
        self._upper[self._width - (columns - rows), columns] = entries.data
        self._diagonal = self._upper[-1].copy()
        self._beside = self._upper[0, 1:].copy()
        self.largest_row = float(np.abs(matrix).sum(axis=1).max())
        self._added: Array | None = None
        self.solutions = 0

    def product(self, field: Array) -> Array:
        """Give K v."""
        found = np.asarray(blas.dsbmv(self._width, 1.0, self._upper, field))
        return found if self._added is None else found + self._added * field

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

    def stiffened(self, diagonal: Array) -> Band:
        """Give it with a diagonal matrix added, which may be negative, where degrees are kept."""
        found = copy(self)
        found._added, found.solutions = diagonal, 0
        return found

    def tied_in_pairs(self, movable: Array, movable_pairs: Array) -> Band:
        """Give the stiffness of successive pairs of movable degrees of freedom, tied together."""
        own = np.arange(len(movable))
        tie, held = sparse.csr_array((movable, (own, own // 2))), 1.0 - movable_pairs
        found = Band(sparse.csr_array(tie.T @ self._matrix @ tie + sparse.diags_array(held)))
        return found if self._added is None else found.stiffened(pairs(self._added * movable))


def pairs(field: Array) -> Array:
    """Sum over successive pairs; an odd last one stays alone."""
    return np.add.reduceat(field, np.arange(0, len(field), 2))
