"""Rectangular substructures of bodies in the plane, and the boundary rows at their sides."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse
from scipy.linalg import block_diag

from solver.arrays import Array, Indices
from solver.discrete.plane import Condensed, Rectangle, dofs_of, side_basis
from solver.discrete.problem import Problem, Scales
from solver.discrete.substructure import Elasticity, Substructure
from solver.laws import Interface

HELD = 1e-9
"""Singular value, beside that of a translation, from which on what is prescribed hinders."""


@dataclass(frozen=True)
class Trace:
    """Boundary rows along a side of a rectangle.

    Attributes
    ----------
    side
        "left", "right", "bottom" or "top".
    components
        Displacements that have rows, 0 along x and 1 along y.
    first, last
        Nodes of the side that have rows, as a slice.
    has_macro
        Whether macro forces are to balance there; parts that differ in it share no operator.
    """

    side: str
    components: tuple[int, ...] = (0, 1)
    first: int = 0
    last: int | None = None
    has_macro: bool = False

    def dofs(self, rectangle: Rectangle) -> Indices:
        """Degrees of freedom of a rectangle under the rows, shape (n_nodes, n_components)."""
        nodes = rectangle.edge(self.side)[self.first : self.last]
        return np.add.outer(2 * nodes, self.components)

    def weights(self, rectangle: Rectangle) -> Array:
        """Length of the whole side that belongs to each node, shape (n_nodes,), scaled."""
        return rectangle.edge_weights(self.side)[self.first : self.last]


@dataclass(eq=False)
class Part:
    """A rectangular substructure.

    Attributes
    ----------
    condensed
        Its stiffness, seen from what its traces need.
    nodes
        Number of its nodes among those of all bodies, shape (n_rows, n_columns) of the mesh.
    body
        Number of its body.
    traces
        Its boundary rows, by the name of a side or the joint that one trace of the part is at.
    modulus
        Young's modulus, scaled, for the search direction.
    force
        Nodal forces, scaled, shape (2 n_nodes, n_instants), or None.
    rows
        Numbers of the boundary rows of each trace, shape (n_nodes, n_components).
    """

    condensed: Condensed
    nodes: Indices
    body: int
    traces: dict[Hashable, Trace]
    modulus: float = 1.0
    force: Array | None = None
    rows: dict[Hashable, Indices] = field(default_factory=dict)

    @property
    def rectangle(self) -> Rectangle:
        """Its mesh."""
        return self.condensed.rectangle

    @property
    def dofs(self) -> Indices:
        """What is kept, among the degrees of freedom of all nodes."""
        return dofs_of(self.nodes.ravel())[self.condensed.dofs]


def number_rows(parts: Iterable[Part]) -> Indices:
    """Number the boundary rows of all parts, trace by trace.

    Returns
    -------
    Degrees of freedom of all nodes that any part keeps, ascending: those of the problem.
    """
    first, kept = 0, []
    for part in parts:
        for name, trace in part.traces.items():
            shape = trace.dofs(part.rectangle).shape
            size = shape[0] * shape[1]
            part.rows[name] = np.arange(first, first + size).reshape(shape)
            first += size
        kept.append(part.dofs)
    return np.unique(np.concatenate(kept))


def _substructure(
    part: Part, skeleton: Indices, shared: dict[tuple[Hashable, ...], Elasticity]
) -> Substructure:
    mesh, kept = part.rectangle, part.condensed
    # Members of a group have body forces on all or on none, and see the same macro forces.
    key = id(kept), part.force is not None, *part.traces.values()
    if key not in shared:
        density = part.modulus / np.sqrt(mesh.columns * mesh.width * mesh.rows * mesh.height)
        traces = part.traces.values()
        trace = [np.searchsorted(kept.dofs, one.dofs(mesh).ravel()) for one in traces]
        k = [density * np.repeat(one.weights(mesh), len(one.components)) for one in traces]
        shared[key] = Elasticity(kept.stiffness, np.concatenate(trace), np.concatenate(k))
    return Substructure(
        elasticity=shared[key],
        dofs=np.searchsorted(skeleton, part.dofs),
        rows=np.concatenate([rows.ravel() for rows in part.rows.values()]),
        body_force=None if part.force is None else kept.condense(part.force),
    )


def lined_up(
    traces: Sequence[tuple[Part, Hashable]], degree: int
) -> tuple[Indices, sparse.csr_array]:
    """Traces that follow each other, as one side, with a macro basis of a degree.

    From parts and the name of a trace of each: rows, (n_points, n_components), and the macro basis
    of one component, (n_points, n_macro).
    """
    rows = [part.rows[name] for part, name in traces]
    bases = [
        side_basis(part.rectangle, part.traces[name].side, len(part.rows[name]), degree)
        for part, name in traces
    ]
    # Most joints of a wall have one part, and SciPy takes long for one block.
    whole = bases[0] if len(bases) == 1 else block_diag(*bases)
    return np.concatenate(rows), sparse.csr_array(whole)


def rigid_motions(
    positions: Array, components: Indices, bodies: Indices, fixed: Indices
) -> Array | None:
    """Independent rigid motions that move nothing prescribed, (n_dofs, n_motions), or None.

    Of degrees of freedom at positions, (n_dofs, 2), in units of a body's length, along x or y, the
    components 0 or 1, of bodies by number; `fixed` are those with prescribed displacement.
    """
    motions = []
    for body in np.unique(bodies):
        own = np.flatnonzero(bodies == body)
        along = components[own] == 0
        x, y = (positions[own] - positions[own].mean(axis=0)).T
        modes = np.stack([along, ~along, np.where(along, -y, x)], axis=1).astype(float)
        _, sizes, ways = np.linalg.svd(modes[np.isin(own, fixed)], full_matrices=True)
        hindered = np.count_nonzero(sizes > HELD)
        whole = np.zeros((len(components), 3 - hindered))
        whole[own] = modes @ ways[hindered:].T
        motions.append(whole)
    together = np.concatenate(motions, axis=1)
    return together if together.size else None


class Inside:
    """What lies inside condensed substructures, found when somebody looks.

    Made of all substructures in order, the scaled positions of all nodes, (n_nodes, 2), and the
    degrees of freedom of the problem among those of all nodes.

    Attributes
    ----------
    nodes
        Coordinates of all nodes, shape (n_nodes, 2), m.
    elements
        Corners of every element, counter-clockwise, shape (n_elements, 4); a biquadratic one counts
        as its four quarters.
    bodies, parts
        Body and substructure of every element, shape (n_elements,).
    components
        Of every degree of freedom of the problem, 0 along x and 1 along y, shape (n_dofs,).
    """

    def __init__(
        self,
        parts: Sequence[Part],
        positions: Array,
        skeleton: Indices,
        scales: Scales,
        n_instants: int,
    ) -> None:
        length = scales.displacement
        self._parts, self._length, self._young = parts, length, scales.force / length
        self._size = len(skeleton), n_instants
        self._dofs = [np.searchsorted(skeleton, part.dofs) for part in parts]
        self.nodes: Array = positions * length
        corners = [part.nodes.ravel()[part.rectangle.cells] for part in parts]
        self.elements: Indices = np.concatenate(corners)
        sizes = [len(own) for own in corners]
        self.parts: Indices = np.repeat(np.arange(len(parts)), sizes)
        self.bodies: Indices = np.repeat([part.body for part in parts], sizes)
        self.components: Indices = skeleton % 2

    def displacement(self, skeleton: Array, instants: slice | list[int]) -> Array:
        """Displacement of all nodes, (n_nodes, 2, n), m, by that of the degrees of freedom, m."""
        chosen = skeleton[:, instants] / self._length
        whole = np.zeros((len(self.nodes), 2, chosen.shape[1]))
        for part, dofs in zip(self._parts, self._dofs, strict=True):
            force = None if part.force is None else part.force[:, instants]
            whole[part.nodes.ravel()] = part.condensed.recover(chosen[dofs], force)
        return whole * self._length

    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Bring a weighted sum of all nodes' displacements onto the degrees of freedom.

        Weights of the problem's degrees of freedom, (n_dofs,), from those of the nodes,
        (n_nodes, 2); and what loads inside add, (n_instants,), m.
        """
        total, constant = np.zeros(self._size[0]), np.zeros(self._size[1])
        # Substructures share the nodes on their cuts.
        counts = np.bincount(np.concatenate([part.nodes.ravel() for part in self._parts]))
        shares = weights / counts[:, None]
        for part, dofs in zip(self._parts, self._dofs, strict=True):
            own = shares[part.nodes.ravel()].reshape(-1, 1)
            if own.any():
                np.add.at(total, dofs, part.condensed.condense(own)[:, 0])
                if part.force is not None:
                    still = np.zeros((len(dofs), self._size[1]))
                    inner = part.condensed.recover(still, part.force).reshape(len(own), -1)
                    constant += own[:, 0] @ inner
        return total, constant * self._length

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), Pa.

        `displacement` is that of all nodes at one instant, shape (n_nodes, 2), m.
        """
        scaled = displacement / self._length
        parts = [part.rectangle.stress(scaled[part.nodes.ravel()]) for part in self._parts]
        return self._young * np.concatenate(parts)


def problem_of(
    parts: Sequence[Part],
    skeleton: Indices,
    positions: Array,
    interfaces: Mapping[str, Interface],
    *,
    scales: Scales,
    instants: Array,
    rest: Array | None = None,
) -> Problem:
    """Discrete problem of numbered parts, with what is inside them and how bodies move freely.

    Search direction: E / l_sub per area, with l_sub the geometric mean of a part's sides, for cuts,
    contacts and supports alike (the paper's ES / l_sub). Equal parts share their operator.

    Parameters
    ----------
    parts, skeleton
        All substructures, body by body, and what `number_rows` returned for them.
    positions
        Coordinates of all nodes, shape (n_nodes, 2), scaled.
    interfaces, scales, instants, rest
        As of `Problem`.
    """
    shared: dict[tuple[Hashable, ...], Elasticity] = {}
    places = positions[skeleton // 2]
    bodies = np.empty(len(positions), dtype=np.intp)
    for part in parts:
        bodies[part.nodes] = part.body
    problem = Problem(
        substructures=tuple(_substructure(part, skeleton, shared) for part in parts),
        interfaces=interfaces,
        positions=places * scales.displacement,
        instants=instants,
        scales=scales,
        inside=Inside(parts, positions, skeleton, scales, len(instants)),
        rest=rest,
    )
    fixed = problem.prescribed[0]
    motions = rigid_motions(places, skeleton % 2, bodies[skeleton // 2], fixed)
    return replace(problem, motions=motions)
