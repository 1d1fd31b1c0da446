"""Rectangular substructures of bodies."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.elements import Rectangle, SchurComplement
from solver.discrete.inside import N_AXES
from solver.discrete.substructure import Elasticity


@dataclass(frozen=True, eq=False)
class RectangularSubstructure:
    """A rectangular substructure.

    Attributes
    ----------
    rectangle, condensed, elasticity
        Mesh, stiffness condensed onto its boundary rows, and operator; equal parts
        share them.
    nodes
        Numbers of its nodes among those of all bodies, shape (n_rows, n_columns).
    body
        Number of its body.
    rows
        Boundary rows by joint or by the span of an outer side, shape (n_nodes,
        n_components) each.
    force
        Nodal forces, scaled, shape (2 n_nodes, n_instants), or None.
    """

    rectangle: Rectangle
    condensed: SchurComplement
    elasticity: Elasticity
    nodes: Indices
    body: int
    rows: Mapping[Hashable, Indices]
    force: Array | None

    @property
    def dofs(self) -> Indices:
        """Numbers of its degrees of freedom among those of all nodes, shape (n,)."""
        return np.add.outer(N_AXES * self.nodes.ravel(), [0, 1]).ravel()

    @property
    def directions(self) -> Array:
        """Motion of each degree of freedom along x and y, and its turn, (n, 3)."""
        return np.tile(np.eye(2, N_AXES), (self.nodes.size, 1))

    @property
    def elements(self) -> Indices:
        """Corners of every element among its own nodes, shape (n_elements, 4)."""
        return self.rectangle.elements

    def motion(self, moved: Array) -> Array:
        """Displacement of its nodes, (n_nodes, 2, n_columns), from (n, n_columns)."""
        return moved.reshape(-1, 2, moved.shape[1])

    def forces(self, nodal: Array) -> Array:
        """Forces on its degrees of freedom, (n,), from those on nodes, (n_nodes, 2)."""
        return nodal.ravel()

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), scaled."""
        return self.rectangle.stress(displacement)
