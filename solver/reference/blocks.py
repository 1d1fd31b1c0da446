"""Dense matrices that may take most of the memory there is, some columns at a time."""

from __future__ import annotations

from solver.arrays import Array

BLOCK = 500
"""Columns at a time."""


def blocks(size: int) -> list[slice]:
    """Cut columns, or rows, into those at a time."""
    return [slice(first, first + BLOCK) for first in range(0, size, BLOCK)]


def symmetrise(matrix: Array) -> None:
    """Put the mean of a square matrix and its transpose in its place."""
    for some in blocks(len(matrix)):
        others = slice(some.start, None)
        mean = matrix[some, others] + matrix[others, some].T
        mean *= 0.5
        matrix[some, others], matrix[others, some] = mean, mean.T
