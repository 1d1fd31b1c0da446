"""Linear elements of an elastic rod."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.discrete.problem import Array


def rod_stiffness(elements: int, element_stiffness: float) -> sparse.csr_array:
    """Assemble the stiffness of equal linear elements in a row.

    Parameters
    ----------
    elements
        Their number.
    element_stiffness
        ES/h of one of them.

    Returns
    -------
    Shape (elements + 1, elements + 1).
    """
    side = np.full(elements, -element_stiffness)
    diagonal = np.full(elements + 1, 2.0 * element_stiffness)
    diagonal[[0, -1]] = element_stiffness
    return sparse.csr_array(sparse.diags_array([side, diagonal, side], offsets=[-1, 0, 1]))


def tributary(elements: int, element_length: float) -> Array:
    """Give the tributary lengths of the nodes of a row of elements, halved at its ends."""
    weights = np.full(elements + 1, element_length)
    weights[[0, -1]] = 0.5 * element_length
    return weights
