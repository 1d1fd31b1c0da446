"""Linear elements in a row: of an elastic rod, or of any side that is cut."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.arrays import Array


def rod_stiffness(elements: int, element_stiffness: float | Array) -> sparse.csr_array:
    """Assemble the stiffness of linear elements in a row.

    Parameters
    ----------
    elements
        Their number.
    element_stiffness
        ES/h of each of them, or of all alike.

    Returns
    -------
    Shape (elements + 1, elements + 1).
    """
    diagonal = np.zeros(elements + 1)
    diagonal[:-1] = element_stiffness
    diagonal[1:] += element_stiffness
    # Written out as it is stored: a general constructor takes ten times as long.
    entries = np.empty(3 * elements + 1)
    entries[::3] = diagonal
    entries[1::3] = entries[2::3] = np.negative(element_stiffness)
    nodes = np.arange(elements + 1)
    columns = np.repeat(nodes, 3)[1:-1]
    columns[1::3] += 1
    columns[2::3] -= 1
    ends = np.clip(3 * np.arange(elements + 2) - 1, 0, len(entries))
    return sparse.csr_array((entries, columns, ends), shape=(elements + 1, elements + 1))


def tributary(elements: int, element_length: float) -> Array:
    """Give the tributary lengths of the nodes of a row of elements, halved at its ends."""
    weights = np.full(elements + 1, element_length)
    weights[[0, -1]] = 0.5 * element_length
    return weights


def substructure_sizes(elements: int, substructures: int) -> list[int]:
    """Deal elements to substructures; sizes differ by at most one, the larger ones come first."""
    size, extra = divmod(elements, substructures)
    return [size + 1] * extra + [size] * (substructures - extra)
