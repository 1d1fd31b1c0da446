"""Names for arrays, and how space-time fields lie in memory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]
ROUNDING = 64.0 * float(np.finfo(float).eps)
"""Share of the largest of some dozens of numbers that rounding leaves of their sum."""


def space_time(n_rows: int, n_instants: int) -> Array:
    """Allocate a zero field of shape (n_rows, n_instants), contiguous in space."""
    return np.zeros((n_rows, n_instants), order="F")


def as_slice(rows: Indices) -> slice | Indices:
    """Give rows as a slice when they follow each other, so that reading them copies nothing."""
    first = int(rows[0]) if len(rows) else 0
    return slice(first, first + len(rows)) if np.all(np.diff(rows) == 1) else rows
