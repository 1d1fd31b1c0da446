"""One part of the structure, and the elastic operator that it shares with its like."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.checks import ALIKE, Numbers, Part, check, check_value
from solver.refusal import RefusedError, Words


@dataclass(frozen=True)
class Elasticity:
    """The elastic operator that identical substructures share.

    Attributes
    ----------
    stiffness
        Shape (n_dofs, n_dofs), symmetric, positive semi-definite; sparse, or dense
        where the inside is condensed.
    trace
        Degree of freedom of each boundary row, shape (n_boundary,). Rows of two
        interfaces that meet at a point share a degree of freedom.
    direction
        The paper's search direction k of each boundary row, shape (n_boundary,),
        positive.

    Raises
    ------
    RefusedError
        For a stiffness that is not symmetric, or fields of another shape.
    """

    stiffness: sparse.csr_array | Array
    trace: Indices
    direction: Array

    def __post_init__(self) -> None:
        check(self, stiffness=Part(sparse.sparray, np.ndarray))
        matrix = self.stiffness
        entries = matrix.data if isinstance(matrix, sparse.csr_array) else matrix
        check_value("Elasticity.stiffness", entries, Numbers(((None,) * entries.ndim,)))
        if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
            shown = Words(f"of shape {list(matrix.shape)}")
            raise RefusedError(
                "Elasticity.stiffness", shown, "a square matrix", "correct it"
            )
        if not self._is_symmetric:
            raise RefusedError(
                "Elasticity.stiffness",
                Words("not symmetric"),
                "that of an elastic body, which is symmetric",
                "take its symmetric part, if it is so up to rounding",
            )
        check(
            self,
            trace=Numbers(((None,),), low=0, high=matrix.shape[0] - 1, whole=True),
            direction=Numbers(((len(self.trace),),), low=0.0, above=True),
        )

    @property
    def _is_symmetric(self) -> bool:
        """Whether the work of one displacement on the forces of another is that the other way.

        Two displacements that no structure has for its own tell it for all, in two
        products.
        """
        numbers = np.arange(self.stiffness.shape[0])
        one = np.cos(numbers)
        other = np.sin(numbers)
        there = self.stiffness @ other
        apart = float(one @ there - other @ (self.stiffness @ one))
        return abs(apart) <= ALIKE * float(np.abs(one) @ np.abs(there))

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
        Axial force of each element of a rod, scaled, that would strain it as much as it
        is strained without any, shape (n_elements, n_instants); None where that is
        nothing. Its nodal forces are among `body_force`.

    Raises
    ------
    RefusedError
        For fields that do not fit its elasticity.
    """

    elasticity: Elasticity
    dofs: Indices
    rows: Indices
    body_force: Array | None
    free_force: Array | None = None

    def __post_init__(self) -> None:
        check(self, elasticity=Part(Elasticity))
        n_dofs = self.elasticity.stiffness.shape[0]
        n_rows = len(self.elasticity.trace)
        check(
            self,
            dofs=Numbers(((n_dofs,),), low=0, whole=True),
            rows=Numbers(((n_rows,),), low=0, whole=True),
            free_force=Numbers(((None, None),)),
        )
        if self.body_force is not None:
            fits = Numbers(((n_dofs, None),))
            check_value("Substructure.body_force", self.body_force, fits)


def tributary(elements: int) -> Array:
    """Length that belongs to each node of a row of elements, over that of one of them."""
    shares = np.ones(elements + 1)
    shares[[0, -1]] = 0.5
    return shares


def substructure_sizes(elements: int, substructures: int) -> list[int]:
    """Deal elements to substructures; sizes differ by at most one, the larger ones come first."""
    size, extra = divmod(elements, substructures)
    return [size + 1] * extra + [size] * (substructures - extra)
