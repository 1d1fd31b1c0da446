"""Bodies of any shape, cut into parts: boundary rows, shared operators and forces."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.elements import SchurComplement
from solver.discrete.inside import N_AXES
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Body, Held
from solver.discrete.plane.body_parts import BodyPart, ShapePart
from solver.discrete.plane.cut_shapes import CutShape
from solver.discrete.plane.joint_pieces import NodeFrames, pieces_of, snapped
from solver.discrete.plane.meshes import Mesh
from solver.discrete.substructure import Elasticity
from solver.refusal import RefusedError, Words

DIGITS = 9
"""Decimal digits to which parts agree that share an operator."""


class NodalTrace(NamedTuple):
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


class CutBodies:
    """Bodies of any shape, cut into parts.

    Search direction: E / l_sub per area, with l_sub the side of a square of the area of
    a part, for cuts, contacts and supports alike; of beams E A / l_sub over the length
    l_sub of a part.

    Attributes
    ----------
    length, young
        Units of length, m, and of stress, Pa.
    cuts
        How each body is cut.
    frames
        Directions of the degrees of freedom at all nodes.
    pieces
        Pieces of the joints.
    first_parts
        Number of the first part of each body, (n_bodies + 1,).
    parts
        Parts, body by body. Their rows are by ("above", piece), ("below", piece),
        ("first", body, seam), ("second", body, seam) and ("held", number).
    """

    def __init__(self, structure: Bodies) -> None:
        self.structure = structure
        self.length = float(structure.box[1].max())
        self.young = max(_modulus(body) for body in structure.bodies)
        bodies = structure.bodies
        shapes = dict[tuple[int, int], CutShape]()
        for body in bodies:
            key = id(body.shape), body.substructures
            if key not in shapes:
                shapes[key] = CutShape(body.shape, body.substructures)
        self.cuts = [shapes[id(body.shape), body.substructures] for body in bodies]
        self.frames = NodeFrames(bodies, structure.joints, structure.held)
        self.pieces = pieces_of(bodies, structure.joints, self.cuts, self.frames)
        counts = [body.substructures for body in bodies]
        self.first_parts = np.cumsum([0, *counts])
        self._shape_parts = self._of_shapes()
        self._traces: list[dict[Hashable, NodalTrace]] = [{} for _ in self._shape_parts]
        self._trace_pieces()
        self._trace_seams()
        self._trace_held()
        self._operators = dict[Hashable, tuple[SchurComplement, Elasticity]]()
        self.parts = list(self._parts())

    def modulus(self, number: int) -> float:
        """Young's modulus of a body, or E A / l of beams, over the unit of stress."""
        return _modulus(self.structure.bodies[number]) / self.young

    def owner(self, number: int, part: int) -> int:
        """Number of a part of a body among all."""
        return int(self.first_parts[number]) + part

    def local_frames(self, number: int, nodes: Indices) -> Array:
        """Directions at nodes of a body in its own axes, shape (n, 2, 2)."""
        turned = self.frames.frames[number][nodes]
        own = turned @ self.structure.bodies[number].rotation
        return snapped(own.reshape(-1, 2)).reshape(-1, 2, 2)

    def _of_shapes(self) -> list[ShapePart]:
        """Parts of shapes, body by body; those of one kind are shared."""
        found = dict[Hashable, list[ShapePart]]()
        parts = []
        for body, cut in zip(self.structure.bodies, self.cuts, strict=True):
            key = id(body.shape), body.substructures, body.young, body.poisson
            if key not in found:
                found[key] = [
                    ShapePart(body, elements, nodes, self.young, self.structure.state)
                    for elements, nodes in zip(cut.elements, cut.nodes, strict=True)
                ]
            parts += found[key]
        return parts

    def _dofs(self, owner: int, nodes: Indices, axes: Indices) -> Indices:
        """Degrees of freedom of a part at nodes of its body: (n, 1) or (n, n_axes).

        `axes` are the numbers of those of each node, which broadcast with (n, 1).
        """
        part = self._shape_parts[owner]
        local = np.searchsorted(part.nodes, nodes)
        return part.n_axes * local[:, None] + axes

    def _trace_pieces(self) -> None:
        """Add the rows of the joints."""
        for number, piece in enumerate(self.pieces):
            joint = self.structure.joints[piece.joint]
            has_macro = joint.below is not None
            sides = zip(("above", "below"), joint.sides, piece.parts, strict=False)
            for name, (body, nodes), part in sides:
                owner = self.owner(body, part)
                dofs = self._dofs(owner, nodes[piece.places], np.arange(2))
                k = self._shape_parts[owner].density * piece.weights
                direction = np.repeat(k[:, None], 2, axis=1)
                trace = NodalTrace(dofs, direction, has_macro)
                self._traces[owner][name, number] = trace

    def _trace_seams(self) -> None:
        """Add the rows of both sides of the cuts inside bodies."""
        for body, cut in enumerate(self.cuts):
            for number, seam in enumerate(cut.seams):
                for name, part in zip(("first", "second"), seam.parts, strict=True):
                    owner = self.owner(body, part)
                    own = self._shape_parts[owner]
                    dofs = self._dofs(owner, seam.nodes, np.arange(own.n_axes))
                    if own.n_axes == 2:
                        k = np.repeat(own.density * seam.weights[:, None], 2, axis=1)
                    else:
                        k = np.array([[own.at_a_point, own.at_a_point, own.of_turn]])
                    self._traces[owner][name, body, number] = NodalTrace(dofs, k, True)

    def _trace_held(self) -> None:
        """Add the rows of prescribed displacements, in every part that has the node."""
        for number, held in enumerate(self.structure.held):
            weights = self._weights_held(held)
            for part in range(self.structure.bodies[held.body].substructures):
                owner = self.owner(held.body, part)
                own = self._shape_parts[owner]
                is_own = np.isin(held.nodes, own.nodes)
                if not is_own.any():
                    continue
                nodes = held.nodes[is_own]
                axes, _ = self.axes_held(held, nodes)
                dofs = self._dofs(owner, nodes, axes[:, None])
                k = own.density * weights[is_own, None]
                if held.axis == 2:
                    k = np.full_like(k, own.of_turn)
                self._traces[owner]["held", number] = NodalTrace(dofs, k, False)

    def axes_held(self, held: Held, nodes: Indices) -> tuple[Indices, Array]:
        """Degree of freedom of each node that is held, and its sign, (n,) both."""
        if held.axis == 2:
            return np.full(len(nodes), 2), np.ones(len(nodes))
        return self.frames.held_at(held.body, nodes, held.axis)

    def _weights_held(self, held: Held) -> Array:
        """Length that belongs to each held node, (n,), m; all alike where no chain."""
        shape = self.structure.bodies[held.body].shape
        if shape.edges_of(held.nodes) is None:
            return np.full(len(held.nodes), shape.size / len(held.nodes))
        return shape.shares(held.nodes)

    def _parts(self) -> Iterator[BodyPart]:
        """Parts of all bodies, with their rows numbered part by part."""
        n_rows = 0
        loads = self._loads()
        for body, of_body in enumerate(self.structure.bodies):
            first_node = self.structure.first_nodes[body]
            for part in range(of_body.substructures):
                owner = self.owner(body, part)
                if not self._traces[owner]:
                    raise RefusedError(
                        f"Bodies.bodies[{body}]",
                        Words(f"{of_body} without a joint or hold"),
                        "bodies that something holds",
                        "join it to another body, or hold some of its nodes",
                    )
                own = self._shape_parts[owner]
                frames = self._global_frames(body, own)
                force = own.force(of_body.weight, loads.get(owner))
                if force is not None:
                    turned = frames[:, :, :2] @ force / (self.young * self.length)
                    force = turned.reshape(-1, force.shape[-1])
                condensed, operator = self._operator(body, owner, force is not None)
                rows = dict[Hashable, Indices]()
                for name, trace in self._traces[owner].items():
                    count = trace.dofs.size
                    numbers = n_rows + np.arange(count)
                    rows[name] = numbers.reshape(trace.dofs.shape)
                    n_rows += count
                yield BodyPart(
                    of_shape=own,
                    condensed=condensed,
                    elasticity=operator,
                    nodes=first_node + own.nodes,
                    body=body,
                    rows=rows,
                    force=force,
                    frames=frames,
                    rotation=of_body.rotation,
                    length=self.length,
                )

    def _global_frames(self, body: int, part: ShapePart) -> Array:
        """Motion of the degrees of freedom of a part, (n_nodes, n_axes, 3)."""
        frames = np.zeros((len(part.nodes), part.n_axes, N_AXES))
        frames[:, :2, :2] = self.frames.frames[body][part.nodes]
        frames[:, 2:, 2] = 1.0
        return frames

    def _operator(
        self, body: int, owner: int, has_force: bool
    ) -> tuple[SchurComplement, Elasticity]:
        """Condensed stiffness and operator of a part, the same for parts alike.

        Members of a group of parts have forces inside all or none of them.
        """
        part = self._shape_parts[owner]
        traces = self._traces[owner].values()
        frames = self.local_frames(body, part.nodes)
        dofs = np.concatenate([trace.dofs.ravel() for trace in traces])
        direction = np.concatenate([trace.direction.ravel() for trace in traces])
        of_rows = frames.reshape(-1, 2)
        key = (
            id(part),
            dofs.tobytes(),
            _rounded(direction / direction.max()),
            _rounded(of_rows),
            tuple(trace.has_macro for trace in traces),
            has_force,
        )
        if key not in self._operators:
            condensed = part.condensed(frames, np.unique(dofs))
            trace_of_rows = np.searchsorted(condensed.kept, dofs)
            operator = Elasticity(condensed.stiffness, trace_of_rows, direction)
            self._operators[key] = condensed, operator
        return self._operators[key]

    def _loads(self) -> Mapping[int, Array]:
        """Forces of the loads on the nodes of parts, (n_nodes, 2, n_instants), N.

        A node of several parts is loaded in the first of them.
        """
        found = dict[int, Array]()
        instants = len(self.structure.instants)
        for load in self.structure.loads:
            taken = np.zeros(len(load.nodes), dtype=bool)
            for part in range(self.structure.bodies[load.body].substructures):
                owner = self.owner(load.body, part)
                nodes = self._shape_parts[owner].nodes
                is_own = np.isin(load.nodes, nodes) & ~taken
                taken |= is_own
                if is_own.any():
                    none = np.zeros((len(nodes), 2, instants))
                    force = found.setdefault(owner, none)
                    force[np.searchsorted(nodes, load.nodes[is_own])] += load.force[
                        is_own
                    ]
        return found


def _modulus(body: Body) -> float:
    """Young's modulus, or E A / l of beams for a metre of thickness, Pa."""
    if isinstance(body.shape, Mesh):
        return body.young
    return body.young * body.shape.area / body.shape.size


def _rounded(values: Array) -> bytes:
    """Values of any shape up to rounding, as a key."""
    # Zero is added so that -0 is 0.
    return (np.round(values, DIGITS) + 0.0).tobytes()
