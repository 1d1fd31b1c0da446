"""Parts of bodies in the plane, condensed onto their boundary rows."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from solver.arrays import Array, Indices, read_only
from solver.discrete.schur_complement import SchurComplement
from solver.discrete.substructure import Elasticity

N_AXES = 3
"""Ways in which a node may move: along x, along y, and turning."""


class Trace(NamedTuple):
    """Boundary rows at some nodes of a part.

    Attributes
    ----------
    dofs
        Degrees of freedom of the part at the rows, shape (n_nodes, n_components).
    direction
        Search direction k of each row, of the same shape, scaled.
    has_macro
        Whether macro forces balance there.
    """

    dofs: Indices
    direction: Array
    has_macro: bool


class PartForce(NamedTuple):
    """Forces on the degrees of freedom of a part: patterns times their courses.

    Attributes
    ----------
    patterns
        Forces on the degrees of freedom, shape (n, n_patterns), scaled.
    courses
        Factors over time, shape (n_patterns, n_instants).
    """

    patterns: Array
    courses: Array

    def at(self, instants: slice | list[int]) -> Array:
        """Forces at n instants, (n_dofs_of_part, n), scaled."""
        return np.asarray(self.patterns @ self.courses[:, instants])


def kept_by(traces: Sequence[Trace]) -> Indices:
    """Degrees of freedom of a part under its boundary rows, ascending, shape (n,)."""
    return np.unique(np.concatenate([trace.dofs.ravel() for trace in traces]))


class Operator:
    """Stiffness of a part, condensed onto its boundary rows; equal parts share it.

    Parameters
    ----------
    condensed
        Stiffness of the part, condensed onto what `kept_by` the traces.
    traces
        Boundary rows of the part.

    Attributes
    ----------
    elasticity
        The operator of a substructure.
    """

    def __init__(self, condensed: SchurComplement, traces: Sequence[Trace]) -> None:
        dofs = np.concatenate([trace.dofs.ravel() for trace in traces])
        direction = np.concatenate([trace.direction.ravel() for trace in traces])
        self.condensed = condensed
        self.elasticity = Elasticity(
            stiffness=read_only(condensed.stiffness),
            trace=np.searchsorted(condensed.kept, dofs),
            direction=direction,
        )

    @property
    def nbytes(self) -> int:
        """Memory that the operator takes, B."""
        return self.condensed.nbytes


def numbered(
    traces: Mapping[Hashable, Trace], first: int
) -> tuple[dict[Hashable, int], int]:
    """First row of each trace, counted from `first`, and the row after the last."""
    first_rows: dict[Hashable, int] = {}
    for name, trace in traces.items():
        first_rows[name] = first
        first += trace.dofs.size
    return first_rows, first


class PartMesh(Protocol):
    """Mesh of a part, in the axes of the part."""

    @property
    def n_axes(self) -> int:
        """Number of degrees of freedom of a node: x, y, and the turn of beams."""

    @property
    def elements(self) -> Indices:
        """Corners of every element, as indices of the part's nodes, (n_elements, 4).

        Triangles have their last corner twice, beams both ends twice.
        """

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), scaled.

        `displacement` is that of all nodes, (n_nodes, 2), scaled.
        """


class CondensedPart(NamedTuple):
    """A part of a body, whose inner degrees of freedom are condensed.

    Attributes
    ----------
    mesh, operator
        Its mesh and operator, which equal parts share.
    nodes
        Indices of its nodes among those of all bodies: of a rectangle shape (n_rows,
        n_columns), of others (n_nodes,).
    body
        Index of its body.
    traces, first_rows
        Boundary rows by what has them, and the index of the first row of each. Rows of
        a trace follow each other, node by node, and so do those of parts.
    force
        Forces on its degrees of freedom, or None.
    frames
        Motion of the degrees of freedom of each node along x and y, and its turn,
        (n_nodes, n_axes, 3); None where they are along x and y.
    rotation
        Matrix from the axes of the mesh to the global ones, (2, 2); None where they are
        the same.
    """

    mesh: PartMesh
    operator: Operator
    nodes: Indices
    body: int
    traces: Mapping[Hashable, Trace]
    first_rows: Mapping[Hashable, int]
    force: PartForce | None
    frames: Array | None = None
    rotation: Array | None = None

    @property
    def condensed(self) -> SchurComplement:
        """Stiffness condensed onto the degrees of freedom at its boundary rows."""
        return self.operator.condensed

    def rows(self, name: Hashable) -> Indices:
        """Indices of the rows of a trace, shape (n_nodes, n_components)."""
        dofs = self.traces[name].dofs
        return self.first_rows[name] + np.arange(dofs.size).reshape(dofs.shape)

    @property
    def directions(self) -> Array:
        """Motion of each degree of freedom along x and y, and its turn, (n, 3)."""
        if self.frames is None:
            of_nodes = np.broadcast_to(np.eye(2, N_AXES), (self.nodes.size, 2, N_AXES))
            return of_nodes.reshape(-1, N_AXES)
        return self.frames.reshape(-1, N_AXES)

    def motion(self, moved: Array) -> Array:
        """Displacement of the nodes, (n_nodes, 2, n_columns), from (n, n_columns)."""
        if self.frames is None:
            return moved.reshape(-1, 2, moved.shape[1])
        own = moved.reshape(*self.frames.shape[:2], -1)
        return np.asarray(self.frames[:, :, :2].swapaxes(1, 2) @ own)

    def forces(self, nodal: Array) -> Array:
        """Forces on the degrees of freedom, (n,), from those on nodes, (n_nodes, 2)."""
        if self.frames is None:
            return nodal.ravel()
        return np.asarray((self.frames[:, :, :2] @ nodal[:, :, None]).ravel())

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), scaled.

        `displacement` is that of its nodes, (n_nodes, 2), scaled.
        """
        if self.rotation is None:
            return self.mesh.stress(displacement)
        xx, yy, xy = self.mesh.stress(displacement @ self.rotation).T
        tensors = np.moveaxis(np.array([[xx, xy], [xy, yy]]), -1, 0)
        turned = self.rotation @ tensors @ self.rotation.T
        return np.stack([turned[:, 0, 0], turned[:, 1, 1], turned[:, 0, 1]], axis=1)
