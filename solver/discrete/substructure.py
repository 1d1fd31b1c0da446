"""One part of the structure, and the elastic operator that it shares with its like."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices


@dataclass(frozen=True)
class Elasticity:
    """The elastic operator that identical substructures share.

    Attributes
    ----------
    stiffness
        Shape (n_dofs, n_dofs), symmetric, positive semi-definite; sparse, or dense where the inside
        is condensed.
    trace
        Degree of freedom of each boundary row, shape (n_boundary,). Rows of two interfaces that
        meet at a point share a degree of freedom.
    direction
        The paper's search direction k of each boundary row, shape (n_boundary,), positive.
    """

    stiffness: sparse.csr_array | Array
    trace: Indices
    direction: Array

    @cached_property
    def boundary(self) -> tuple[Indices, Indices, sparse.csr_array | Array]:
        """Degrees of freedom at the boundary, place of every boundary row in them, their stiffness.

        Shapes (n,), (n_boundary,) and (n, n_dofs); the degrees of freedom ascend.
        """
        own, place = np.unique(self.trace, return_inverse=True)
        return own, place, self.stiffness[own]


@dataclass(frozen=True)
class Substructure:
    """One part of the structure.

    Attributes
    ----------
    elasticity
        Shared by identity with all substructures of the same shape.
    dofs
        Its degrees of freedom in the whole structure, shape (n_dofs,).
    rows
        Its boundary rows, shape (n_boundary,).
    body_force
        Nodal forces inside, shape (n_dofs, n_instants), or None.
    free_force
        Axial force of each element of a rod, scaled, that would strain it as much as it is strained
        without any, shape (n_elements, n_instants); None where that is nothing. Its nodal forces
        are among `body_force`.
    """

    elasticity: Elasticity
    dofs: Indices
    rows: Indices
    body_force: Array | None
    free_force: Array | None = None


def tributary(elements: int) -> Array:
    """Length that belongs to each node of a row of elements, over that of one of them."""
    shares = np.ones(elements + 1)
    shares[[0, -1]] = 0.5
    return shares


def substructure_sizes(elements: int, substructures: int) -> list[int]:
    """Deal elements to substructures; sizes differ by at most one, the larger ones come first."""
    size, extra = divmod(elements, substructures)
    return [size + 1] * extra + [size] * (substructures - extra)
