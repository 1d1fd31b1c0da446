"""Rectangular substructures of bodies in the plane, and the fields inside them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices, read_only
from solver.discrete.elements import Rectangle, SchurComplement, dofs_of
from solver.discrete.scales import Scales
from solver.discrete.substructure import Elasticity

HELD = 1e-9
"""Smallest singular value of a rigid motion that prescribed displacements hinder, over
that of a translation."""


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


class Inside:
    """Nodes and elements inside condensed substructures, and fields there on demand.

    Attributes
    ----------
    nodes
        Coordinates of all nodes, shape (n_nodes, 2), m.
    elements, bodies
        Corners of every element, counter-clockwise, (n_elements, 4), and number of the
        body of every element, (n_elements,).
    grids
        Nodes of every substructure, row by row from below, shape (n_rows, n_columns)
        each.
    dofs
        Degrees of freedom of the problem that each substructure keeps, (n_kept,) each.
    positions, components
        Position of every degree of freedom of the problem, (n_dofs, 2), scaled, and its
        component: 0 along x and 1 along y, (n_dofs,).
    """

    def __init__(
        self,
        parts: Sequence[RectangularSubstructure],
        positions: Array,
        scales: Scales,
        n_instants: int,
    ) -> None:
        length = scales.displacement
        kept = [dofs_of(part.nodes.ravel())[part.condensed.kept] for part in parts]
        skeleton = np.unique(np.concatenate(kept))
        self._parts = parts
        self._length = length
        self._young = scales.force / length
        self._size = len(skeleton), n_instants
        self.dofs = [np.searchsorted(skeleton, dofs) for dofs in kept]
        self.nodes: Array = positions * length
        self.grids: list[Indices] = [part.nodes for part in parts]
        self.positions = positions[skeleton // 2]
        corners = [part.nodes.ravel()[part.rectangle.elements] for part in parts]
        self.elements: Indices = np.concatenate(corners)
        sizes = [len(elements) for elements in corners]
        self.bodies: Indices = np.repeat([part.body for part in parts], sizes)
        self.components: Indices = skeleton % 2

    def displacement(self, skeleton: Array, instants: slice | list[int]) -> Array:
        """Displacement of all nodes at n instants, (n_nodes, 2, n), m.

        `skeleton` is that of the problem's degrees of freedom, (n_dofs, n_instants), m.
        """
        kept = skeleton[:, instants] / self._length
        n_instants = kept.shape[1]
        whole = np.zeros((len(self.nodes), 2, n_instants))
        for part, dofs in zip(self._parts, self.dofs, strict=True):
            force = None
            if part.force is not None:
                force = part.force[:, instants]
            of_part = part.condensed.recover(kept[dofs], force)
            whole[part.nodes.ravel()] = of_part.reshape(-1, 2, n_instants)
        return whole * self._length

    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Bring a weighted sum of all nodes' displacements onto the degrees of freedom.

        `weights` are those of the nodes, (n_nodes, 2). Returned are those of the
        problem's degrees of freedom, (n_dofs,), and the part of the sum that loads
        inside make, (n_instants,), m.
        """
        total = np.zeros(self._size[0])
        constant = np.zeros(self._size[1])
        # Substructures share the nodes on their cuts.
        nodes = np.concatenate([part.nodes.ravel() for part in self._parts])
        shares = weights / np.bincount(nodes)[:, None]
        for part, dofs in zip(self._parts, self.dofs, strict=True):
            share = shares[part.nodes.ravel()].reshape(-1, 1)
            if not share.any():
                continue
            np.add.at(total, dofs, part.condensed.condense(share)[:, 0])
            if part.force is not None:
                # With the boundary held, only loads inside move the inner nodes.
                held = np.zeros((len(dofs), self._size[1]))
                constant += share[:, 0] @ part.condensed.recover(held, part.force)
        return total, constant * self._length

    def of_part(self, number: int, nodes: Indices) -> tuple[Array, Array | None]:
        """Map from a substructure's degrees of freedom to the motion of its nodes.

        `nodes` are numbers among its own, row by row from below, (n,). The matrix has
        shape (2 n, n_kept). Loads inside add a displacement, shape (2 n, n_instants),
        scaled; None without them.
        """
        part = self._parts[number]
        condensed = part.condensed
        n_kept = len(condensed.kept)
        dofs = dofs_of(nodes)
        matrix = condensed.recover(np.eye(n_kept), None)[dofs]
        if part.force is None:
            return matrix, None
        held = np.zeros((n_kept, part.force.shape[1]))
        return matrix, condensed.recover(held, part.force)[dofs]

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), Pa.

        `displacement` is that of all nodes at one instant, shape (n_nodes, 2), m.
        """
        scaled = displacement / self._length
        parts = [
            part.rectangle.stress(scaled[part.nodes.ravel()]) for part in self._parts
        ]
        return self._young * np.concatenate(parts)

    @cached_property
    def body_of_dofs(self) -> Indices:
        """Number of the body of every degree of freedom of the problem, (n_dofs,)."""
        bodies = np.empty(len(self.components), dtype=np.intp)
        for part, dofs in zip(self._parts, self.dofs, strict=True):
            bodies[dofs] = part.body
        return bodies

    def rigid_motions(self, fixed: Indices) -> Array | None:
        """Independent rigid motions of bodies, (n_dofs, n_motions), or None.

        The motions are zero at the degrees of freedom of prescribed displacement,
        `fixed`, (n,).
        """
        motions = []
        bodies = self.body_of_dofs
        for body in np.unique(bodies):
            dofs = np.flatnonzero(bodies == body)
            modes = self._rigid_modes(dofs)
            # Motions that vanish where displacements are prescribed are those that stay
            # free.
            at_fixed = modes[np.isin(dofs, fixed)]
            _, sizes, combinations = np.linalg.svd(at_fixed, full_matrices=True)
            hindered = np.count_nonzero(sizes > HELD)
            of_body = np.zeros((len(bodies), 3 - hindered))
            of_body[dofs] = modes @ combinations[hindered:].T
            motions.append(of_body)
        together = np.concatenate(motions, axis=1)
        if not together.size:
            return None
        return read_only(together)

    def hold_still(
        self, groups: Indices, fixed: Indices, jumps: Sequence[tuple[Indices, Indices]]
    ) -> bool:
        """Check whether groups of bodies cannot move where some displacements vanish.

        Parameters
        ----------
        groups
            Number of the group of every degree of freedom, all bodies of which move as
            one, shape (n_dofs,); -1 where it stands still.
        fixed
            Degrees of freedom that are held, shape (n,).
        jumps
            Degrees of freedom that move alike, shape (n,) each; -1 is one that stands
            still.
        """
        moving = np.unique(groups[groups >= 0])
        # The row beyond the last is what stands still.
        motions = np.zeros((len(groups) + 1, 3 * len(moving)))
        for number, group in enumerate(moving):
            dofs = np.flatnonzero(groups == group)
            motions[dofs, 3 * number : 3 * number + 3] = self._rigid_modes(dofs)
        hindered = [motions[fixed]]
        hindered += [motions[above] - motions[below] for above, below in jumps]
        sizes = np.linalg.svd(np.concatenate(hindered), compute_uv=False)
        return int(np.count_nonzero(sizes > HELD)) == motions.shape[1]

    def _rigid_modes(self, dofs: Indices) -> Array:
        """Translations and rotation about the mean position, (n, 3), of dofs, (n,)."""
        is_along_x = self.components[dofs] == 0
        x, y = (self.positions[dofs] - self.positions[dofs].mean(axis=0)).T
        # About the mean position, where translations and rotation are independent.
        rotation = np.where(is_along_x, -y, x)
        modes = np.stack([is_along_x, ~is_along_x, rotation], axis=1)
        return np.asarray(modes.astype(float))
