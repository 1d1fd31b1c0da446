"""Types of arrays, and functions on space-time fields."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.linalg import LinAlgError
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import SuperLU, splu

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]
ROUNDING = 64.0 * float(np.finfo(float).eps)
"""Error by rounding of the sum of some dozens of numbers, over the largest of them."""
RESIDUE = 1e-12
"""Size of a sum, over that of its terms, up to which the sum is shown as zero: a
solution has no more digits."""


def space_time(n_rows: int, n_instants: int) -> Array:
    """Allocate a zero field of shape (n_rows, n_instants), contiguous in space."""
    return np.zeros((n_rows, n_instants), order="F")


def sparse_factor(matrix: sparse.csc_array, **how: Any) -> SuperLU:
    """LU factors of a sparse matrix, (n, n); `how` are arguments of SciPy's `splu`.

    Raises
    ------
    LinAlgError
        If the matrix is singular.
    MemoryError
        If memory is short; SuperLU has several errors for that.
    """
    try:
        return splu(matrix, **how)
    except RuntimeError as trouble:
        if "singular" in str(trouble):
            raise LinAlgError(str(trouble)) from trouble
        raise MemoryError(str(trouble)) from trouble


def ones_at(
    rows: Indices, columns: Indices, shape: tuple[int, int]
) -> sparse.csr_array:
    """Sparse matrix of a shape with ones at places, (n,), that add up where equal."""
    return sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=shape)


def linked(first: Indices, second: Indices, count: int) -> tuple[int, Indices]:
    """Number of groups of 0 to count - 1 that links join, and the group of each.

    Links are between the `first` and `second` of them, (n_links,); the groups have the
    shape (count,).
    """
    links = ones_at(first, second, (count, count))
    n_groups, group = connected_components(links, directed=False)
    return int(n_groups), np.asarray(group, dtype=np.intp)


def read_only(field: Array) -> Array:
    """Make a field of any shape read-only in place, and return the field."""
    field.flags.writeable = False
    return field


def as_slice(rows: Indices) -> slice | Indices:
    """Rows, (n_rows,), as a slice if they are consecutive: reading copies nothing."""
    if not np.all(np.diff(rows) == 1):
        return rows
    first = 0
    if len(rows):
        first = int(rows[0])
    return slice(first, first + len(rows))


def distinct(numbers: Indices, count: int) -> tuple[Indices, Indices, Indices]:
    """Distinct integers below a count, ascending, as NumPy's `unique` returns them.

    Parameters
    ----------
    numbers
        Numbers from 0 on, shape (n,).
    count
        Number above the largest of them.

    Returns
    -------
    The distinct numbers, ascending, (n_distinct,), the first place of each, of the same
    shape, and the place of every number among the distinct ones, (n,).
    """
    first = np.full(count, -1)
    # The last write wins.
    first[numbers[::-1]] = np.arange(len(numbers) - 1, -1, -1)
    found = np.flatnonzero(first >= 0)
    places = np.empty(count, dtype=np.intp)
    places[found] = np.arange(len(found))
    return found, first[found], places[numbers]


def in_rows(fields: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Fields one below the other: (n_rows,), or (n_rows, n_instants) and (n_rows, 1).

    Fields that do not change with time have a single column; so has the result if none
    of them changes.
    """
    shapes = {field.shape[1:] for field in fields}
    # Of many interfaces mostly all fields have one shape.
    if len(shapes) > 1:
        columns = np.broadcast_shapes(*shapes)
        fields = [np.broadcast_to(field, (len(field), *columns)) for field in fields]
    return np.concatenate(fields)


def largest_size(*fields: Array) -> float:
    """Largest absolute value in fields of any shape: 0 without values, NaN with any."""
    sizes = [float(np.abs(field).max(initial=0.0)) for field in fields]
    return float(np.max(sizes, initial=0.0))


def power_of_two(values: Array) -> float:
    """Largest power of two not above the largest size of values of any shape.

    Values over it are at most 2. To divide by it rounds nothing, and squares of what is
    left neither vanish nor overflow.
    """
    _, exponent = math.frexp(largest_size(values))
    return math.ldexp(1.0, exponent - 1)


def without_residue(values: Array, terms: Array) -> Array:
    """Sums, (n_instants,), with zero in place of rounding errors of their terms.

    `terms` are sizes of the terms, of any shape, in the unit of the sums.
    """
    return np.where(np.abs(values) <= RESIDUE * np.max(terms, initial=0.0), 0.0, values)


def separated(load: Array) -> tuple[Array, Array]:
    """Factor loads, (n, n_instants): patterns (n, rank) times (rank, n_instants).

    The product is exact up to rounding.

    A structure has few patterns of load, and instants many: so there is less to solve
    for. Where it has many patterns, every instant counts as one.
    """
    patterns = np.zeros((0, len(load)))
    rest = load / power_of_two(load)
    smallest = float(np.finfo(float).eps * np.abs(rest).max(initial=0.0))
    # Gram-Schmidt by the largest residual, as a factorisation with pivoting.
    while len(patterns) < load.shape[1] // 2:
        largest = int(np.abs(rest).max(axis=0, initial=0.0).argmax())
        pattern = rest[:, largest] - patterns.T @ (patterns @ rest[:, largest])
        if np.abs(pattern).max(initial=0.0) <= smallest:
            return patterns.T, patterns @ load
        pattern /= np.linalg.norm(pattern)
        patterns = np.vstack([patterns, pattern])
        rest -= pattern[:, None] * (pattern @ rest)
    return load, np.eye(load.shape[1])
