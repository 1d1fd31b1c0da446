"""Factors of square matrices, and updates for a few rows and columns."""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from solver.arrays import Array, Indices

SINGULAR = 1e-12
"""Pivot, as a share of the largest, below which a matrix is singular."""
DOUBTFUL = 1e-6
"""Evenness of the pivots of an update, below which the matrix is factored again."""


class Factors:
    """LU factors of a square matrix.

    Attributes
    ----------
    has_negative_determinant
        Sign of the determinant.
    singular
        A pivot is too small, or not above the `smallest` one.
    evenness
        Smallest pivot over the largest, without signs.
    """

    def __init__(self, matrix: Array, smallest: float = 0.0) -> None:
        self._factors = matrix
        self._pivots = np.zeros(0, dtype=np.intp)
        if len(matrix):
            self._factors, self._pivots, _ = lapack.dgetrf(matrix)
        diagonal = np.diagonal(self._factors)
        # Every exchange of rows changes the sign of the determinant.
        swaps = np.count_nonzero(self._pivots != np.arange(len(matrix)))
        changes_of_sign = np.count_nonzero(diagonal < 0.0) + swaps
        self.has_negative_determinant = bool(changes_of_sign % 2)
        sizes = np.abs(diagonal)
        largest = float(sizes.max(initial=0.0))
        smallest = max(SINGULAR * largest, smallest)
        self.singular = bool(sizes.min(initial=np.inf) <= smallest)
        # Solutions of a singular matrix are found by itself.
        self._matrix = np.zeros((0, 0))
        if self.singular:
            self._matrix = matrix
        self.evenness = 1.0
        if largest > 0.0:
            self.evenness = float(sizes.min()) / largest

    def solve(self, right: Array) -> Array:
        """Solve A x = b with b and x of shape (n,) or (n, m).

        Where A is singular, x is the smallest of those that fit best.
        """
        if not len(right):
            return right
        if self.singular:
            return np.asarray(np.linalg.lstsq(self._matrix, right, rcond=SINGULAR)[0])
        solved, _ = lapack.dgetrs(self._factors, self._pivots, right)
        return np.asarray(solved).reshape(right.shape)


class UpdatedFactors:
    """Factors of a matrix that differs by few rows and columns from a factored one.

    What is removed keeps its unknown, which has to vanish, and its equation gets a
    force of its own. With these and with what is added as further unknowns v, the
    system is A x + B v = b, C x + D v = d: x = x_0 - W v with W = A^-1 B, and
    (D - C W) v = d - C x_0 (the Schur complement, as of Woodbury's formula).

    Attributes
    ----------
    has_negative_determinant, singular
        As those of `Factors`.
    is_doubtful
        The difference is nearly singular, so that digits would be lost.
    """

    singular = False

    def __init__(
        self,
        before: Factors,
        removed: Indices,
        added: Indices,
        *,
        columns: Array,
        rows: Array,
        corner: Array,
    ) -> None:
        """Update factors of a matrix of n rows.

        Parameters
        ----------
        before
            The factors, not singular.
        removed
            Rows and columns that are left out, ascending, shape (n_removed,).
        added
            Places of new rows and columns in the new matrix, ascending, shape
            (n_added,); what stays keeps its order.
        columns, rows, corner
            New columns in the rows of before, shape (n, n_added), new rows in the
            columns of before, (n_added, n), and where both meet, (n_added, n_added).
        """
        size = len(columns)
        count = len(added)
        self._before = before
        self._removed = removed
        self._added = added
        self._rows = rows
        self._kept_before = np.delete(np.arange(size), removed)
        self._kept = np.delete(np.arange(size - len(removed) + count), added)
        forces = np.zeros((size, len(removed)))
        forces[removed, np.arange(len(removed))] = 1.0
        self._gives = before.solve(np.hstack([columns, forces]))
        difference = -np.concatenate([rows @ self._gives, self._gives[removed]])
        difference[:count, :count] += corner
        self._difference = Factors(difference)
        self.is_doubtful = self._difference.evenness < DOUBTFUL
        # Each equation that is dropped changes places with that of its unknown.
        changes = [
            before.has_negative_determinant,
            self._difference.has_negative_determinant,
            len(removed) % 2 == 1,
        ]
        self.has_negative_determinant = sum(changes) % 2 == 1

    def solve(self, right: Array) -> Array:
        """Solve A x = b with b and x of shape (n,)."""
        known = np.zeros(len(self._gives))
        known[self._kept_before] = right[self._kept]
        solution = self._before.solve(known)
        missing = np.concatenate(
            [right[self._added] - self._rows @ solution, -solution[self._removed]]
        )
        further = self._difference.solve(missing)
        solution -= self._gives @ further
        whole = np.empty(len(right))
        whole[self._kept] = solution[self._kept_before]
        whole[self._added] = further[: len(self._added)]
        return whole
