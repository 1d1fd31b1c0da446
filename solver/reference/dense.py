"""Dense matrices: factored, or taken some columns at a time where they fill the memory."""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from solver.arrays import Array

SINGULAR = 1e-12
"""Pivot, as a share of the largest, below which a system is singular."""
BLOCK = 500
"""Columns at a time."""


def blocks(size: int) -> list[slice]:
    """Slices of as many columns, or rows, as are taken at a time."""
    return [slice(first, first + BLOCK) for first in range(0, size, BLOCK)]


def symmetrise(matrix: Array) -> None:
    """Replace a square matrix by the mean of it and its transpose."""
    for rows in blocks(len(matrix)):
        others = slice(rows.start, None)
        mean = matrix[rows, others] + matrix[others, rows].T
        mean *= 0.5
        matrix[rows, others], matrix[others, rows] = mean, mean.T


class Factors:
    """A square matrix, factored, and whether its determinant is negative (`turned`).

    If `scaled`, rows and columns are brought to one size first, by powers of two, and what
    is solved is refined once: then every row holds up to the rounding of its own terms (Skeel,
    Math. Comp. 35, 1980).
    """

    def __init__(self, matrix: Array, *, scaled: bool) -> None:
        self.scaled = scaled
        if scaled:
            self._rows = _sizes(matrix, 1)
            matrix = self._rows[:, None] * matrix
            self._columns = _sizes(matrix, 0)
            matrix = matrix * self._columns
        self._matrix = matrix
        self._is_singular = False
        self._pivots = np.zeros(0, dtype=np.intp)
        self._factors = matrix
        if len(matrix):
            self._factors, self._pivots, _ = lapack.dgetrf(matrix)
        diagonal = np.diagonal(self._factors)
        swaps = np.count_nonzero(self._pivots != np.arange(len(matrix)))
        self.turned = bool((np.count_nonzero(diagonal < 0.0) + swaps) % 2)

    def make_sure(self, least: float) -> bool:
        """Whether the matrix is singular: whether a pivot is too small, or below `least`."""
        sizes = np.abs(np.diagonal(self._factors))
        least = max(SINGULAR * float(sizes.max(initial=0.0)), least)
        self._is_singular = bool(sizes.min(initial=np.inf) <= least)
        return self._is_singular

    def solve(self, right: Array) -> Array:
        """Solve A x = b, b of shape (n, k); where A is singular, by the least x that fits best."""
        if not len(right):
            return right
        if not self.scaled:
            return self._solve(right)
        right = self._rows[:, None] * right
        solution = self._solve(right)
        if not self._is_singular:
            solution += self._solve(right - self._matrix @ solution)
        return np.asarray(self._columns[:, None] * solution)

    def _solve(self, right: Array) -> Array:
        if self._is_singular:
            return np.asarray(np.linalg.lstsq(self._matrix, right, rcond=SINGULAR)[0])
        return np.asarray(lapack.dgetrs(self._factors, self._pivots, right)[0]).reshape(right.shape)


def _sizes(matrix: Array, axis: int) -> Array:
    """Powers of two that bring the largest entries along an axis near 1."""
    _, exponent = np.frexp(np.abs(matrix).max(axis=axis, initial=0.0))
    return np.asarray(np.ldexp(1.0, -exponent))
