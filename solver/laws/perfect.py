"""Perfect interface between two substructures: one displacement, opposite forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Perfect:
    """A glued cut.

    Attributes
    ----------
    first, second
        Boundary rows of the two sides, point by point, shape (n_points,).
    macro
        Macro basis of the interface, shape (n_points, n_macro).
    """

    first: Indices
    second: Indices
    macro: Array


def perfect(first: Array, second: Array, share: Array) -> Array:
    """Find the common displacement of two glued sides (theory.md, 2).

    Parameters
    ----------
    first, second
        z = W - F/k of the sides, shape (n_points, n_times), m.
    share
        k / (k + k') of the first side, shape (n_points, 1).

    Returns
    -------
    Displacement of both sides, shape (n_points, n_times), m.
    """
    return second + share * (first - second)
