"""Substructures of bodies in the plane, and the fields in their interior."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import chain, pairwise

import numpy as np

from solver.arrays import Array, Indices, distinct, read_only
from solver.discrete.condensed_part import (
    N_AXES,
    CondensedPart,
    Operator,
    PartForce,
)
from solver.discrete.schur_complement import SchurComplement
from solver.discrete.substructure import Scales, Substructure, check_forces

HELD = 1e-9
"""Smallest singular value of a rigid motion that prescribed displacements hinder, over
that of a translation."""
TOGETHER = 16
"""Number of parts whose forces are condensed together: few enough that what is made on
the way takes little memory again and again, not much of it once."""
MOVES = 1e-6
"""Smallest share in a free motion, over its size, of a body that moves."""


class Inside:
    """Interior nodes and elements of condensed substructures, and fields on demand.

    Attributes
    ----------
    nodes
        Coordinates of all nodes, shape (n_nodes, 2), m.
    elements, bodies, parts
        Corners of every element, counter-clockwise, (n_elements, 4), and number of the
        body and of the substructure of every element, (n_elements,).
    grids
        Nodes of every substructure: of a rectangle row by row from below, shape
        (n_rows, n_columns), of others in any order, (n_nodes,).
    dofs
        Degrees of freedom of the problem that each substructure keeps, (n_kept,) each.
    nodes_of_dofs
        Index of the node of every degree of freedom of the problem, (n_dofs,).
    positions, directions
        Its position, (n_dofs, 2), scaled, and its motion along x and y and its turn,
        (n_dofs, 3): a unit vector.
    """

    def __init__(
        self,
        parts: Sequence[CondensedPart],
        positions: Array,
        scales: Scales,
        n_instants: int,
    ) -> None:
        length = scales.displacement
        self._parts = parts
        self._length = length
        self._young = scales.force / length
        self.nodes: Array = positions * length
        self.grids: list[Indices] = [part.nodes for part in parts]
        nodes = np.concatenate([part.nodes.ravel() for part in parts])
        first_nodes = _firsts([part.nodes.size for part in parts])
        self._find_skeleton(nodes, first_nodes)
        self.positions = positions[self.nodes_of_dofs]
        self._size = len(self.nodes_of_dofs), n_instants
        elements = [part.mesh.elements for part in parts]
        sizes = [len(of_part) for of_part in elements]
        corners = np.concatenate(elements) + np.repeat(first_nodes, sizes)[:, None]
        self.elements: Indices = nodes[corners]
        self.bodies: Indices = np.repeat([part.body for part in parts], sizes)
        self.parts: Indices = np.repeat(np.arange(len(parts)), sizes)

    def _find_skeleton(self, nodes: Indices, first_nodes: Indices) -> None:
        """Number the degrees of freedom that remain after condensation in any part.

        `nodes` are those of all parts, part by part, and `first_nodes` the places of
        the first of each part.
        """
        kept = [part.condensed.kept for part in self._parts]
        counts = [len(of_part) for of_part in kept]
        n_axes = np.repeat([part.mesh.n_axes for part in self._parts], counts)
        of_parts = np.concatenate(kept)
        places, axes = np.divmod(of_parts, n_axes)
        own = nodes[np.repeat(first_nodes, counts) + places]
        skeleton, first, numbers = distinct(
            N_AXES * own + axes, N_AXES * len(self.nodes)
        )
        self.nodes_of_dofs: Indices = skeleton // N_AXES
        self.dofs: list[Indices] = _divided(numbers, counts)
        self.directions: Array = _directions(self._parts, counts, of_parts)[first]

    def substructures(self) -> tuple[Substructure, ...]:
        """Substructures of the problem; their rows are numbered part by part."""
        operators = [part.operator for part in self._parts]
        sizes = [len(operator.elasticity.trace) for operator in operators]
        rows = _divided(np.arange(sum(sizes)), sizes)
        by_operator = dict[Operator, list[int]]()
        for number, operator in enumerate(operators):
            by_operator.setdefault(operator, []).append(number)
        found = dict[int, Substructure]()
        for operator, numbers in by_operator.items():
            forces = [self._parts[number].force for number in numbers]
            equal = Substructure.of_equal(
                operator.elasticity,
                [self.dofs[number] for number in numbers],
                [rows[number] for number in numbers],
                _condensed_by(operator.condensed, forces),
            )
            found.update(zip(numbers, equal, strict=True))
        return tuple(found[number] for number in range(len(operators)))

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
                force = part.force.at(instants)
            of_part = part.condensed.recover(kept[dofs], force)
            whole[part.nodes.ravel()] = part.motion(of_part)
        return whole * self._length

    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Weights on degrees of freedom of a weighted sum of all nodes' displacements.

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
            of_nodes = shares[part.nodes.ravel()]
            if not of_nodes.any():
                continue
            share = part.forces(of_nodes)[:, None]
            np.add.at(total, dofs, part.condensed.condense(share)[:, 0])
            if part.force is not None:
                # With the boundary held, only loads inside move the inner nodes.
                patterns, courses = part.force
                held = np.zeros((len(dofs), len(courses)))
                moved = part.condensed.recover(held, patterns)
                constant += share[:, 0] @ moved @ courses
        return total, constant * self._length

    def of_part(self, number: int, nodes: Indices) -> tuple[Array, Array | None]:
        """Matrix from degrees of freedom of a substructure to nodal displacements.

        `nodes` are numbers among its own in the order of its grid, (n,). The matrix has
        shape (2 n, n_kept). Loads inside add a displacement, shape (2 n, n_instants),
        scaled; None without them.
        """
        part = self._parts[number]
        condensed = part.condensed
        n_kept = len(condensed.kept)
        moved = part.motion(condensed.recover(np.eye(n_kept), None))[nodes]
        matrix = moved.reshape(-1, n_kept)
        if part.force is None:
            return matrix, None
        patterns, courses = part.force
        held = np.zeros((n_kept, len(courses)))
        given = part.motion(condensed.recover(held, patterns))[nodes]
        return matrix, given.reshape(-1, len(courses)) @ courses

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), Pa.

        `displacement` is that of all nodes at one instant, shape (n_nodes, 2), m.
        """
        scaled = displacement / self._length
        parts = [part.stress(scaled[part.nodes.ravel()]) for part in self._parts]
        return self._young * np.concatenate(parts)

    @property
    def is_of_lines(self) -> bool:
        """Check whether all bodies are lines of beams, whose nodes have rotations."""
        return all(part.mesh.n_axes == N_AXES for part in self._parts)

    @cached_property
    def body_of_dofs(self) -> Indices:
        """Index of the body of every degree of freedom of the problem, (n_dofs,)."""
        bodies = np.empty(len(self.directions), dtype=np.intp)
        counts = [len(dofs) for dofs in self.dofs]
        of_parts = [part.body for part in self._parts]
        bodies[np.concatenate(self.dofs)] = np.repeat(of_parts, counts)
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
            modes = self.rigid_modes(dofs)
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

    def free_groups(
        self, groups: Indices, fixed: Indices, jumps: Sequence[tuple[Indices, Indices]]
    ) -> Indices:
        """Indices of the groups of bodies that can move, (n,).

        Parameters
        ----------
        groups
            Index of the group of every degree of freedom, all bodies of which move as
            one, shape (n_dofs,); -1 where it stands still.
        fixed
            Degrees of freedom that are held, shape (n,).
        jumps
            Degrees of freedom that move alike, shape (n,) each; -1 is one that stands
            still.
        """
        moving = np.unique(groups[groups >= 0])
        asked = np.unique(np.concatenate([fixed, *chain.from_iterable(jumps)]))
        motions = self._motions_of(groups, asked[asked >= 0])
        rows = [motions[fixed]]
        rows += [motions[above] - motions[below] for above, below in jumps]
        hindered = np.concatenate(rows)
        sizes = np.linalg.svd(hindered, compute_uv=False)
        count = int(np.count_nonzero(sizes > HELD))
        if count == motions.shape[1]:
            return moving[:0]
        free = np.linalg.svd(hindered, full_matrices=True)[2][count:]
        largest = np.abs(free).reshape(-1, len(moving), 3).max(axis=(0, 2))
        return np.asarray(moving[largest > MOVES], dtype=np.intp)

    def _motions_of(self, groups: Indices, dofs: Indices) -> Array:
        """Rigid motions of groups at some degrees of freedom, (n_dofs + 1, n_motions).

        Rows of others are 0, as is the last one, which is what stands still; arguments
        as of `free_groups`.
        """
        moving = np.unique(groups[groups >= 0])
        motions = np.zeros((len(groups) + 1, 3 * len(moving)))
        for number, group in enumerate(moving):
            centre = self.positions[groups == group].mean(axis=0)
            of_group = dofs[groups[dofs] == group]
            columns = slice(3 * number, 3 * number + 3)
            motions[of_group, columns] = self.rigid_modes(of_group, centre)
        return motions

    def rigid_modes(self, dofs: Indices, centre: Array | None = None) -> Array:
        """Translations and rotation about a centre, (n, 3), of dofs, (n,).

        The centre, (2,), scaled, is by default the mean position, where translations
        and rotation are independent.
        """
        along_x, along_y, turn = self.directions[dofs].T
        if centre is None:
            centre = self.positions[dofs].mean(axis=0)
        x, y = (self.positions[dofs] - centre).T
        # A turn is an angle, not over the unit of length as displacements are.
        rotation = x * along_y - y * along_x + turn / self._length
        return np.stack([along_x, along_y, rotation], axis=1)


def _condensed_by(
    condensed: SchurComplement, forces: Sequence[PartForce | None]
) -> list[Array | None]:
    """Condensed forces of equal parts, (n_kept, n_instants) each, scaled; or None.

    The very same forces are condensed once, those of as many patterns some together.
    """
    by_size = dict[int, dict[int, PartForce]]()
    for force in forces:
        if force is not None:
            by_size.setdefault(len(force.courses), {})[id(force)] = force
    found = dict[int, Array]()
    for of_size in by_size.values():
        alike = list(of_size.values())
        for first in range(0, len(alike), TOGETHER):
            some = alike[first : first + TOGETHER]
            patterns = np.array([force.patterns for force in some])
            courses = np.array([force.courses for force in some])
            over_time = condensed.condense(patterns) @ courses
            check_forces(over_time)
            found.update(zip([id(force) for force in some], over_time, strict=True))
    return [found.get(id(force)) for force in forces]


def _firsts(sizes: Sequence[int]) -> Indices:
    """Offset of each list in the concatenation of lists of given sizes, (n,)."""
    lengths: Indices = np.asarray(sizes, dtype=np.intp)
    return np.cumsum(lengths) - lengths


def _divided(values: Indices, sizes: Sequence[int]) -> list[Indices]:
    """Split values, (n,), into consecutive lists of given sizes."""
    # NumPy's split takes five times as long for hundreds of small ones (measured).
    ends = np.cumsum([0, *sizes]).tolist()
    return [values[first:last] for first, last in pairwise(ends)]


def _directions(
    parts: Sequence[CondensedPart], counts: Sequence[int], of_parts: Indices
) -> Array:
    """Motions along x and y, and turns, of degrees of freedom of parts, (n, 3).

    `of_parts` are their numbers within each part, part by part, (n,), and `counts` how
    many of them are of each.
    """
    directions = [part.directions for part in parts]
    first_dofs = _firsts([len(of_part) for of_part in directions])
    rows = np.repeat(first_dofs, counts) + of_parts
    return np.asarray(np.concatenate(directions)[rows])
