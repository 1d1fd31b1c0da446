"""Interfaces with the outside: prescribed displacement, prescribed force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Dirichlet:
    """Prescribed displacement.

    Attributes
    ----------
    rows
        Boundary rows, shape (n_rows,).
    displacement
        Shape (n_rows, n_times).
    """

    rows: Indices
    displacement: Array


@dataclass(frozen=True)
class Neumann:
    """Prescribed force.

    Attributes
    ----------
    rows
        Boundary rows, shape (n_rows,).
    force
        Nodal forces on the body, shape (n_rows, n_times).
    macro
        Macro basis of the interface, shape (n_rows, n_macro).
    """

    rows: Indices
    force: Array
    macro: Array


def neumann(target: Array, force_over_k: Array) -> Array:
    """Find the displacement under a prescribed force (theory.md, 2).

    Parameters
    ----------
    target
        z = W - F/k, shape (n_rows, n_times), m.
    force_over_k
        F_d / k, same shape, m.
    """
    return target + force_over_k
