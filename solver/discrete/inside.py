"""Rectangular substructures of bodies in the plane, and what lies inside them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.elements import Rectangle, SchurComplement, dofs_of
from solver.discrete.problem import Scales
from solver.discrete.substructure import Elasticity

HELD = 1e-9
"""Singular value, beside that of a translation, from which on what is prescribed
hinders."""


@dataclass(frozen=True, eq=False)
class Part:
    """A rectangular substructure: its mesh, and its stiffness seen from its boundary rows.

    Equal parts share these, and the elasticity. Its `nodes` have numbers among those of
    all bodies, shape (n_rows, n_columns) of the mesh; boundary `rows` go by joint or by
    the name of a side, shape (n_nodes, n_components) each; nodal forces are scaled,
    shape (2 n_nodes, n_instants).
    """

    rectangle: Rectangle
    condensed: SchurComplement
    elasticity: Elasticity
    nodes: Indices
    body: int
    rows: Mapping[Hashable, Indices]
    force: Array | None


class Inside:
    """What lies inside condensed substructures, found when somebody looks.

    Attributes
    ----------
    nodes
        Coordinates of all nodes, shape (n_nodes, 2), m.
    elements, bodies
        Corners of every element, counter-clockwise, (n_elements, 4), and body of each.
    grids
        Nodes of every substructure, row by row from below, shape (n_rows, n_columns)
        each.
    dofs
        Degrees of freedom of the problem under those that each substructure keeps.
    places, components
        Scaled position of every degree of freedom of the problem, (n_dofs, 2), and its
        direction: 0 along x and 1 along y, (n_dofs,).
    """

    def __init__(
        self, parts: Sequence[Part], positions: Array, scales: Scales, n_instants: int
    ) -> None:
        length = scales.displacement
        kept = [dofs_of(part.nodes.ravel())[part.condensed.kept] for part in parts]
        skeleton = np.unique(np.concatenate(kept))
        self._parts = parts
        self._length = length
        self._young = scales.force / length
        self._size = len(skeleton), n_instants
        self.dofs = [np.searchsorted(skeleton, own) for own in kept]
        self.nodes: Array = positions * length
        self.grids: list[Indices] = [part.nodes for part in parts]
        self.places = positions[skeleton // 2]
        corners = [part.nodes.ravel()[part.rectangle.elements] for part in parts]
        self.elements: Indices = np.concatenate(corners)
        sizes = [len(own) for own in corners]
        self.bodies: Indices = np.repeat([part.body for part in parts], sizes)
        self.components: Indices = skeleton % 2

    def displacement(self, skeleton: Array, instants: slice | list[int]) -> Array:
        """Displacement of all nodes, (n_nodes, 2, n), m, by that of the degrees of freedom, m."""
        chosen = skeleton[:, instants] / self._length
        whole = np.zeros((len(self.nodes), 2, chosen.shape[1]))
        for part, dofs in zip(self._parts, self.dofs, strict=True):
            if part.force is None:
                force = None
            else:
                force = part.force[:, instants]
            own = part.condensed.recover(chosen[dofs], force)
            whole[part.nodes.ravel()] = own.reshape(-1, 2, own.shape[1])
        return whole * self._length

    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Bring a weighted sum of all nodes' displacements onto the degrees of freedom.

        Weights of the problem's degrees of freedom, (n_dofs,), from those of the nodes,
        (n_nodes, 2); and what loads inside add, (n_instants,), m.
        """
        total = np.zeros(self._size[0])
        constant = np.zeros(self._size[1])
        # Substructures share the nodes on their cuts.
        counts = np.bincount(
            np.concatenate([part.nodes.ravel() for part in self._parts])
        )
        shares = weights / counts[:, None]
        for part, dofs in zip(self._parts, self.dofs, strict=True):
            own = shares[part.nodes.ravel()].reshape(-1, 1)
            if own.any():
                np.add.at(total, dofs, part.condensed.condense(own)[:, 0])
                if part.force is not None:
                    still = np.zeros((len(dofs), self._size[1]))
                    constant += own[:, 0] @ part.condensed.recover(still, part.force)
        return total, constant * self._length

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), Pa.

        `displacement` is that of all nodes at one instant, shape (n_nodes, 2), m.
        """
        scaled = displacement / self._length
        parts = [
            part.rectangle.stress(scaled[part.nodes.ravel()]) for part in self._parts
        ]
        return self._young * np.concatenate(parts)

    def rigid_motions(self, fixed: Indices) -> Array | None:
        """Independent rigid motions of bodies, (n_dofs, n_motions), or None.

        They move none of the degrees of freedom whose displacement is prescribed,
        `fixed`.
        """
        motions = []
        bodies = np.empty(len(self.components), dtype=np.intp)
        for part, dofs in zip(self._parts, self.dofs, strict=True):
            bodies[dofs] = part.body
        for body in np.unique(bodies):
            own = np.flatnonzero(bodies == body)
            along = self.components[own] == 0
            x, y = (self.places[own] - self.places[own].mean(axis=0)).T
            modes = np.stack([along, ~along, np.where(along, -y, x)], axis=1).astype(
                float
            )
            _, sizes, ways = np.linalg.svd(
                modes[np.isin(own, fixed)], full_matrices=True
            )
            hindered = np.count_nonzero(sizes > HELD)
            whole = np.zeros((len(bodies), 3 - hindered))
            whole[own] = modes @ ways[hindered:].T
            motions.append(whole)
        together = np.concatenate(motions, axis=1)
        return together if together.size else None
