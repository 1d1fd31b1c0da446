"""Parts of shapes of bodies: their elasticity, loads and stresses.

Forces are scaled by E L and displacements by L, so that a stiffness is scaled by E.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from solver.arrays import Array, Flags, Indices
from solver.cache import CACHE, content_of
from solver.discrete.condensed_part import PartForce
from solver.discrete.elements import assembled, dofs_of, elastic_matrix
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.body import Body
from solver.discrete.plane.lattice import Lattice
from solver.discrete.plane.mesh_elasticity import (
    mesh_stiffness,
    mesh_strains,
    mesh_volumes,
    quadratic_basis,
)
from solver.discrete.plane.meshes import Mesh
from solver.discrete.schur_complement import SchurComplement

if TYPE_CHECKING:
    import skfem


@dataclass(frozen=True, eq=False)
class ShapePart:
    """A part of a shape of one material, in the axes of the shape.

    Attributes
    ----------
    body
        A body of this shape and material.
    chosen, nodes
        Indices of its elements and of its nodes among those of the shape, ascending.
    units
        Units of length, m, and of stress, Pa.
    state
        "strain" or "stress".
    """

    body: Body
    chosen: Indices
    nodes: Indices
    units: tuple[float, float]
    state: str

    @property
    def young(self) -> float:
        """Unit of stress, Pa."""
        return self.units[1]

    @cached_property
    def content(self) -> Hashable:
        """Key of a part: equal keys mean equal shape, elements and material.

        Parts of a lattice are equal wherever they lie in it.
        """
        body = self.body
        material = body.young, body.poisson, self.state
        if isinstance(body.shape, Lattice):
            own: Hashable = body.shape.content_of_part(self.chosen)
        else:
            own = body.shape.content, content_of(self.chosen)
        return own, material, self.units

    @property
    def n_axes(self) -> int:
        """Number of degrees of freedom of a node: x, y, and the turn of beams."""
        if isinstance(self.body.shape, Beam):
            return 3
        return 2

    def dofs_at(self, nodes: Indices, axes: Indices) -> Indices:
        """Degrees of freedom at nodes of the shape, (n, 1) or (n, n_axes).

        `axes` are the numbers of those of each node, which broadcast with (n, 1).
        """
        local = np.searchsorted(self.nodes, nodes)
        return self.n_axes * local[:, None] + axes

    def has(self, nodes: Indices) -> Flags:
        """Mask of those nodes of the shape, (n,), that belong to the part."""
        is_own = np.zeros(len(self.body.shape.nodes), dtype=bool)
        is_own[self.nodes] = True
        return is_own[nodes]

    @cached_property
    def size(self) -> float:
        """Size l_sub: side of a square of the same area, or length of beams, m."""
        shape = self.body.shape
        if isinstance(shape, Beam):
            return float(shape.lengths[self.chosen].sum())
        return float(np.sqrt(shape.areas[self.chosen].sum()))

    @cached_property
    def direction_per_length(self) -> float:
        """Search direction E / l_sub of a length, scaled, 1/m."""
        body = self.body
        if isinstance(body.shape, Beam):
            return self.direction_at_point / self.size
        return body.young / self.young / self.size

    def direction_on_cut(self, chain: Indices, lengths: Array) -> Array:
        """Search direction at the nodes along a cut, (n_nodes, n_axes), scaled.

        `lengths` are those that belong to the nodes, (n_nodes,), m; beams are cut at
        one node.
        """
        if isinstance(self.body.shape, Beam):
            along = self.direction_at_point
            return np.array([[along, along, self.direction_of_turn]])
        k = self.direction_per_length * self.lengths_on_side(chain, lengths)
        return np.repeat(k[:, None], 2, axis=1)

    def lengths_on_side(
        self, chain: Indices, lengths: Array, places: Indices | slice = slice(None)
    ) -> Array:
        """Length for k that belongs to nodes at some places of a chain, (n,), m.

        On a lattice that of the whole side of the part on which the chain lies, so that
        k does not depend on where a joint ends; on other shapes these are the `lengths`
        of the nodes along the chain, (n,), m.
        """
        shape = self.body.shape
        if isinstance(shape, Lattice):
            return shape.lengths_on_side(chain, self.nodes)[places]
        return lengths

    def slenderness(self, chain: Indices, length: float) -> float:
        """Length of a side over the depth behind it, for the degree of a macro basis.

        The side is the chain, of a length, m, or of a lattice the whole side of the
        part on which the chain lies.
        """
        shape = self.body.shape
        if isinstance(shape, Lattice):
            return shape.slenderness(chain, self.nodes)
        return float((length / self.size) ** 2)

    @cached_property
    def direction_at_point(self) -> float:
        """Search direction E A / l_sub at a node of beams, scaled."""
        assert isinstance(self.body.shape, Beam)
        return self.body.young * self.body.shape.area / self.young / self.size

    @cached_property
    def direction_of_turn(self) -> float:
        """Search direction E I / l_sub of the turn of a node of beams, scaled."""
        shape = self.body.shape
        assert isinstance(shape, Beam)
        return self.body.young * shape.second_moment / self.young / self.size

    @cached_property
    def stiffness(self) -> sparse.csr_array:
        """Stiffness, shape (n_nodes n_axes, n_nodes n_axes), scaled."""
        shape = self.body.shape
        if isinstance(shape, Mesh):
            return mesh_stiffness(self._basis, self.nodes, self._elastic)
        if isinstance(shape, Lattice):
            whole = shape.stiffness(self._elastic, self.chosen)
        else:
            whole = shape.stiffness(self.body.young / self.young, self.chosen)
        dofs = np.add.outer(self.n_axes * self.nodes, np.arange(self.n_axes)).ravel()
        return sparse.csr_array(whole[dofs][:, dofs])

    @cached_property
    def _basis(self) -> skfem.Basis:
        """Functions of the elements of a mesh."""
        mesh = self.body.shape
        assert isinstance(mesh, Mesh)
        return quadratic_basis(mesh, self.chosen)

    @cached_property
    def _elastic(self) -> Array:
        """Matrix from strains to stresses, shape (3, 3), scaled."""
        body = self.body
        return elastic_matrix(body.young / self.young, body.poisson, self.state)

    @cached_property
    def volumes(self) -> Array:
        """Volume that belongs to each node, shape (n_nodes,), m^3."""
        shape = self.body.shape
        if isinstance(shape, Mesh):
            return mesh_volumes(self._basis)[self.nodes]
        return shape.volumes(self.chosen)[self.nodes]

    def forces(
        self, weight: Array | None, loads: Sequence[PartForce]
    ) -> PartForce | None:
        """Forces of weight and loads on the nodes along x and y, N; None without any.

        The weight is per volume along x and y, (2, n_instants), N/m^3. Patterns of
        loads and of the result have the shape (n_nodes, 2, n_patterns).
        """
        patterns = [load.patterns for load in loads]
        courses = [load.courses for load in loads]
        # Mostly nothing is heavy, and volumes of meshes take some time.
        if weight is not None and weight.any():
            axes = np.flatnonzero(weight.any(axis=1))
            patterns.append(np.multiply.outer(self.volumes, np.eye(2)[:, axes]))
            courses.append(weight[axes])
        if not patterns:
            return None
        return PartForce(np.concatenate(patterns, axis=2), np.concatenate(courses))

    def arranged(self, nodes: Indices) -> Indices:
        """Nodes of the part, (n_nodes,), as they lie: of a rectangle row by row.

        Those of a rectangle have the shape (n_rows, n_columns), others (n_nodes,).
        """
        if self._columns is None:
            return nodes
        return nodes.reshape(-1, self._columns)

    @cached_property
    def _columns(self) -> int | None:
        """Number of nodes along of a part that is a rectangle of a lattice."""
        shape = self.body.shape
        if isinstance(shape, Lattice) and shape.is_rectangle(self.chosen):
            return shape.columns_of(self.nodes)
        return None

    @cached_property
    def elements(self) -> Indices:
        """Corners of the elements, as indices of the part's nodes, (n_elements, 4)."""
        corners = self.body.shape.element_corners[self.chosen]
        return np.searchsorted(self.nodes, corners)

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), scaled.

        `displacement` is that of its nodes, (n_nodes, 2), scaled.
        """
        moved = self.units[0] * displacement.ravel()
        return np.asarray((self._stresses @ moved).reshape(-1, 3))

    @cached_property
    def _stresses(self) -> sparse.csr_array:
        """Matrix from displacements of nodes to stresses, scaled by E over metres.

        Stresses xx, yy, xy of each element in turn, (3 n_elements, 2 n_nodes).
        """
        shape = self.body.shape
        if isinstance(shape, Mesh):
            strains = mesh_strains(shape, self.chosen, self.nodes)
        else:
            strains = shape.strains(self.chosen)[:, dofs_of(self.nodes)]
        elastic = self._elastic
        if isinstance(shape, Beam):
            # A beam has the stress of its axis, and half of 2 xy.
            elastic = np.diag([1.0, 1.0, 0.5]) * self.body.young / self.young
        blocks = sparse.kron(sparse.eye_array(len(self.chosen)), elastic)
        return sparse.csr_array(blocks @ strains)

    @cached_property
    def outline(self) -> SchurComplement | None:
        """Stiffness of a lattice condensed onto its outline; None of other shapes.

        Bricks of one shape differ in which of their sides are in contact.
        """
        shape = self.body.shape
        if not isinstance(shape, Lattice):
            return None
        outer = np.searchsorted(self.nodes, shape.outline(self.chosen))
        return CACHE.get(
            ("on outline", self.content),
            lambda: SchurComplement(sparse.csc_array(self.stiffness), dofs_of(outer)),
        )

    def stiffness_in(self, frames: Array) -> sparse.csc_array:
        """Stiffness in the directions at each node, (n_nodes n_axes, n_nodes n_axes).

        `frames` are those of its degrees of freedom in the axes of the shape, (n_nodes,
        2, 2).
        """
        stiffness = self.stiffness
        if np.any(frames != np.eye(2)):
            turn = self._turn(frames)
            stiffness = turn @ stiffness @ turn.T
        return sparse.csc_array(stiffness)

    def _turn(self, frames: Array) -> sparse.csr_array:
        """Matrix from x, y (and turn) of all nodes to their degrees of freedom."""
        n_axes = self.n_axes
        blocks = np.zeros((len(frames), n_axes, n_axes))
        blocks[:, :2, :2] = frames
        blocks[:, 2:, 2:] = 1.0
        dofs = np.arange(len(frames) * n_axes).reshape(-1, n_axes)
        return assembled(
            blocks, dofs[:, :, None], dofs[:, None], (dofs.size, dofs.size)
        )
