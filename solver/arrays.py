"""Names for arrays, and how space-time fields lie in memory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.linalg import LinAlgError
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]
ROUNDING = 64.0 * float(np.finfo(float).eps)
"""Share of the largest of some dozens of numbers that rounding leaves of their sum."""
RESIDUE = 1e-12
"""Share of what is summed up to which a sum is shown as zero: a solution has no more
digits."""


def space_time(n_rows: int, n_instants: int) -> Array:
    """Allocate a zero field of shape (n_rows, n_instants), contiguous in space."""
    return np.zeros((n_rows, n_instants), order="F")


def sparse_factor(matrix: sparse.csc_array, **how: Any) -> SuperLU:
    """LU factor of a sparse matrix, (n, n), as `scipy.sparse.linalg.splu` with its arguments.

    Raises
    ------
    LinAlgError
        If the matrix is singular.
    MemoryError
        If memory is short, which SuperLU tells in several ways.
    """
    try:
        return splu(matrix, **how)
    except RuntimeError as trouble:
        if "singular" in str(trouble):
            raise LinAlgError(str(trouble)) from trouble
        raise MemoryError(str(trouble)) from trouble


def read_only(field: Array) -> Array:
    """The same field, which nobody can change any more."""
    field.flags.writeable = False
    return field


def as_slice(rows: Indices) -> slice | Indices:
    """Rows as a slice when they follow each other, so that reading them copies nothing."""
    if len(rows):
        first = int(rows[0])
    else:
        first = 0
    if np.all(np.diff(rows) == 1):
        return slice(first, first + len(rows))
    return rows


def in_rows(fields: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Fields of space, or of space and time, one below the other.

    What does not change with time has a single column, unless another of them does.
    """
    shape = np.broadcast_shapes(*(field.shape[1:] for field in fields))
    return np.concatenate(
        [np.broadcast_to(field, (len(field), *shape)) for field in fields]
    )


def without_residue(values: Array, terms: Array) -> Array:
    """Sums, (n_instants,), with zero where rounding alone leaves something of terms of a size."""
    return np.where(np.abs(values) <= RESIDUE * np.max(terms, initial=0.0), 0.0, values)
