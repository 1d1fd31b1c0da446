"""Substructures, the operators that equal ones share, and the units of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.checks import (
    ALIKE,
    POSITIVE,
    InstanceOf,
    Kind,
    Numbers,
    check,
    check_value,
    checked_copies,
)
from solver.refusal import RefusedError, Words


@dataclass(frozen=True)
class Scales:
    """Units of scaled displacement, m, force, N, and time, s.

    With them the results of a method do not depend on the units of the input.
    """

    displacement: float
    force: float
    time: float

    def __post_init__(self) -> None:
        check(self, displacement=POSITIVE, force=POSITIVE, time=POSITIVE)


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
        check(self, stiffness=InstanceOf(sparse.sparray, np.ndarray))
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
    def nbytes(self) -> int:
        """Memory of the operator, B, without the indices of sparse entries."""
        fields = (self.stiffness, self.trace, self.direction)
        return sum(field.size * field.dtype.itemsize for field in fields)

    @property
    def _is_symmetric(self) -> bool:
        """Check whether the stiffness is symmetric, in two products.

        The work of a first displacement on the forces of a second one is compared with
        that of the second on the forces of the first. Both are arbitrary, so that a
        stiffness that is not symmetric hardly passes.
        """
        numbers = np.arange(self.stiffness.shape[0])
        # Two products cost less than a transpose of a large stiffness.
        first = np.cos(numbers)
        second = np.sin(numbers)
        force = self.stiffness @ second
        difference = float(first @ force - second @ (self.stiffness @ first))
        return abs(difference) <= ALIKE * float(np.abs(first) @ np.abs(force))

    @cached_property
    def is_tridiagonal(self) -> bool:
        """Check whether degrees of freedom are tied to their neighbours alone."""
        rows, columns = sparse.coo_array(self.stiffness).coords
        return bool(np.abs(rows - columns).max(initial=0) <= 1)

    @cached_property
    def boundary(self) -> tuple[Indices, Indices, sparse.csr_array | Array]:
        """Degrees of freedom at the boundary, and the rows of the stiffness there.

        The degrees of freedom, (n,), ascend. Then the index in them of every boundary
        row, (n_boundary,), and the stiffness, (n, n_dofs), scaled.
        """
        dofs, index = np.unique(self.trace, return_inverse=True)
        return dofs, index, self.stiffness[dofs]


ELASTICITY = InstanceOf(Elasticity)


@cache
def _kinds_of_fields(n_dofs: int, n_rows: int) -> dict[str, Kind]:
    """Kinds of the fields of a substructure of an operator of this size."""
    return {
        "dofs": Numbers(((n_dofs,),), whole=True),
        "rows": Numbers(((n_rows,),), whole=True),
        "body_force": Numbers(((n_dofs, None),)),
        "free_force": Numbers(((None, None),)),
    }


@dataclass(frozen=True)
class Substructure:
    """A substructure: its operator, degrees of freedom, boundary rows and body forces.

    Attributes
    ----------
    elasticity
        Elastic operator, the same object for all equal substructures.
    dofs
        Its degrees of freedom in the whole structure, shape (n_dofs,).
    rows
        Its boundary rows, shape (n_boundary,).
    body_force
        Nodal forces inside, shape (n_dofs, n_instants), scaled, or None.
    free_force
        Axial force that would strain each element of a rod as heat or settlement does,
        shape (n_elements, n_instants), scaled; None without such strains. Its nodal
        forces are among `body_force`.

    Raises
    ------
    RefusedError
        For fields that do not fit its elasticity. Numbers of degrees of freedom and
        rows are checked for all substructures together, by their problem.
    """

    elasticity: Elasticity
    dofs: Indices
    rows: Indices
    body_force: Array | None = None
    free_force: Array | None = None

    def __post_init__(self) -> None:
        check(self, elasticity=ELASTICITY)
        n_dofs = self.elasticity.stiffness.shape[0]
        kinds = _kinds_of_fields(n_dofs, len(self.elasticity.trace))
        check(self, **kinds)

    @classmethod
    def of_equal(
        cls,
        elasticity: Elasticity,
        dofs: Sequence[Indices],
        rows: Sequence[Indices],
        body_forces: Sequence[Array | None],
    ) -> list[Substructure]:
        """Substructures that share an operator; only the first is checked.

        Of each there are its `dofs`, (n_dofs,), its `rows`, (n_boundary,), and the
        forces inside, (n_dofs, n_instants), scaled, or None; `check_forces` is for
        many of these.

        Raises
        ------
        RefusedError
            For degrees of freedom, rows and forces of different counts, and forces that
            do not fit.
        """
        for name, each in (("dofs", dofs), ("rows", rows)):
            if len({len(numbers) for numbers in each}) > 1:
                raise RefusedError(
                    f"Substructure.{name}",
                    Words("of several lengths"),
                    "as many for each substructure of an operator",
                    "make those of each operator together",
                )
        first = cls(elasticity, dofs[0], rows[0], body_forces[0])
        return checked_copies(
            first, len(dofs), dofs=dofs, rows=rows, body_force=body_forces
        )


def check_forces(body_forces: Array) -> None:
    """Refuse forces inside some substructures, (n, n_dofs, n_instants)."""
    kind = Numbers(((None, None, None),))
    check_value("Substructure.body_force", body_forces, kind)


def tributary(elements: int) -> Array:
    """Tributary length of nodes along equal elements, over an element's, (n_nodes,)."""
    shares = np.ones(elements + 1)
    shares[[0, -1]] = 0.5
    return shares


def substructure_sizes(elements: int, substructures: int) -> list[int]:
    """Elements of each substructure: numbers differ by at most 1, larger ones first."""
    size, extra = divmod(elements, substructures)
    return [size + 1] * extra + [size] * (substructures - extra)
