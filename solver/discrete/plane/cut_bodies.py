"""Bodies of any shape, cut into parts: boundary rows and forces."""

from __future__ import annotations

from collections.abc import Container, Hashable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import chain

import numpy as np

from solver.arrays import Array, Flags, Indices, separated
from solver.discrete.condensed_part import (
    N_AXES,
    CondensedPart,
    Operator,
    PartForce,
    numbered,
)
from solver.discrete.loose_bodies import LooseBodiesError
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Body, Load
from solver.discrete.plane.body_parts import ShapePart
from solver.discrete.plane.body_traces import traces_of
from solver.discrete.plane.cut_shapes import CutShape
from solver.discrete.plane.joint_pieces import NodeFrames, pieces_of, snapped
from solver.discrete.plane.lattice import Lattice
from solver.discrete.plane.shared_operators import PartNodes, SharedOperators
from solver.discrete.substructure import Scales
from solver.refusal import Words

FEW = 8
"""Number of components of nodes on which a load acts, up to which each is a pattern."""


class CutBodies:
    """Bodies of any shape, cut into parts.

    Search direction: E / l_sub per area, with l_sub the side of a square of the area of
    a part, for cuts, contacts and supports alike; of beams E A / l_sub over the length
    l_sub of a part.

    Attributes
    ----------
    length, young, scales
        Units of length, m, of stress, Pa, and of fields.
    cuts
        How each body is cut.
    frames
        Directions of the degrees of freedom at all nodes.
    pieces
        Pieces of the joints.
    first_parts
        Indices of the first part of each body, and of the parts.
    shape_parts
        All parts in the axes of their shapes.
    parts
        Parts, body by body; rows are by the names of `traces_of`.
    """

    def __init__(self, structure: Bodies) -> None:
        self.structure = structure
        self.length = float(structure.box[1].max())
        # The softest body deforms most: beside it stiff ones are rounding.
        self.young = min(_modulus(body) for body in structure.bodies)
        self.scales = Scales(self.length, self.young * self.length, structure.duration)
        bodies = structure.bodies
        shapes = dict[Hashable, CutShape]()
        self.cuts = list[CutShape]()
        for body in bodies:
            key = body.cut_key
            if key not in shapes:
                shapes[key] = CutShape(body.shape, body.substructures, body.parts)
            self.cuts.append(shapes[key])
        self.frames = NodeFrames(
            structure.rotations,
            structure.first_nodes,
            structure.pairs,
            structure.held,
            structure.springs,
        )
        self.pieces = pieces_of(
            bodies,
            structure.joints,
            structure.joint_kinds,
            self.cuts,
            self.frames,
        )
        counts = [body.substructures for body in bodies]
        self.first_parts: list[int] = np.cumsum([0, *counts]).tolist()
        self._body_of_parts = np.repeat(np.arange(len(bodies)), counts).tolist()
        of_bodies = self._of_shapes()
        self.shape_parts = list(chain.from_iterable(of_bodies))
        self._traces = traces_of(
            structure, self.cuts, self.frames, self.pieces, of_bodies
        )
        self._operators = SharedOperators(self._own_frames)
        self.parts = list(self._parts())

    @cached_property
    def is_mesh(self) -> Flags:
        """Mask of bodies that are no lines of beams, (n_bodies,)."""
        bodies = self.structure.bodies
        return np.array([not isinstance(body.shape, Beam) for body in bodies])

    @cached_property
    def depths(self) -> Array | None:
        """Height of each body, (n_bodies,), m, where all are lattices; else None."""
        heights = list[float]()
        for body in self.structure.bodies:
            if not isinstance(body.shape, Lattice):
                return None
            heights.append(body.shape.rows * body.shape.height)
        return np.array(heights)

    @cached_property
    def moduli(self) -> Array:
        """Young's modulus of each body, E A of each beam, (n_bodies,), scaled."""
        values = []
        for body in self.structure.bodies:
            if isinstance(body.shape, Beam):
                values.append(body.young * body.shape.area / self.young)
            else:
                values.append(body.young / self.young)
        return np.array(values)

    @cached_property
    def volumes(self) -> Array:
        """Volume of each body, (n_bodies,), m^3."""
        return np.array([body.shape.volume for body in self.structure.bodies])

    @cached_property
    def local_stiffness(self) -> Array:
        """Stiffness of each row while all others are held, (n_rows,), scaled."""
        diagonals = dict[int, Array]()
        found = []
        for part in self.parts:
            operator = part.operator.elasticity
            if id(operator) not in diagonals:
                diagonal = operator.stiffness.diagonal()
                diagonals[id(operator)] = diagonal[operator.trace]
            found.append(diagonals[id(operator)])
        return np.concatenate(found)

    def owner(self, number: int, part: int) -> int:
        """Index of a part of a body among all."""
        return self.first_parts[number] + part

    def local_frames(self, number: int, nodes: Indices) -> Array:
        """Directions at nodes of a body in the axes of the body, shape (n, 2, 2)."""
        first = self.structure.first_nodes[number]
        return np.asarray(self._own_frames[first + nodes])

    @cached_property
    def _own_frames(self) -> Array:
        """Directions at all nodes in the axes of their bodies, (n_nodes, 2, 2)."""
        sizes = np.diff(self.structure.first_nodes)
        bodies = np.repeat(np.arange(len(sizes)), sizes)
        own = np.zeros_like(self.frames.frames)
        own[:] = np.eye(2)
        # Of most nodes they are the axes themselves.
        nodes = np.flatnonzero(self.frames.is_turned)
        turned = self.frames.frames[nodes] @ self.structure.rotations[bodies[nodes]]
        own[nodes] = snapped(turned.reshape(-1, 2)).reshape(-1, 2, 2)
        return own

    def _of_shapes(self) -> list[list[ShapePart]]:
        """Parts of every body; equal bodies share theirs."""
        found = dict[Hashable, list[ShapePart]]()
        parts = []
        for body, cut in zip(self.structure.bodies, self.cuts, strict=True):
            key = body.cut_key, body.young, body.poisson
            if key not in found:
                found[key] = [
                    ShapePart(
                        body,
                        elements,
                        nodes,
                        (self.length, self.young),
                        self.structure.state,
                    )
                    for elements, nodes in zip(cut.elements, cut.nodes, strict=True)
                ]
            parts.append(found[key])
        return parts

    def _parts(self) -> Iterator[CondensedPart]:
        """Parts of all bodies, with their rows numbered part by part."""
        n_rows = 0
        rotations = list(self.structure.rotations)
        for owner, on_nodes in enumerate(self._nodes_of_parts()):
            body = self._body_of_parts[owner]
            of_body = self.structure.bodies[body]
            if not self._traces[owner]:
                raise LooseBodiesError(
                    f"Bodies.bodies[{body}]",
                    Words(f"{of_body} without a joint or hold"),
                    "bodies that something holds",
                    "join it to another body, or hold some of its nodes",
                )
            traces = self._traces[owner]
            first_rows, n_rows = numbered(traces, n_rows)
            mesh = self.shape_parts[owner]
            yield CondensedPart(
                mesh=mesh,
                operator=self._operator(owner, on_nodes),
                nodes=mesh.arranged(on_nodes.nodes),
                body=body,
                traces=traces,
                first_rows=first_rows,
                force=on_nodes.force,
                frames=on_nodes.frames,
                rotation=rotations[body] if of_body.angle else None,
            )

    def _operator(self, owner: int, on_nodes: PartNodes) -> Operator:
        """Operator of a part; refuse one that can move beside all that it keeps."""
        traces = list(self._traces[owner].values())
        try:
            return self._operators.of(self.shape_parts[owner], on_nodes, traces)
        except np.linalg.LinAlgError as trouble:
            # One piece of an elastic body is singular only where it can move.
            body = self.structure.bodies[self._body_of_parts[owner]]
            raise LooseBodiesError.of([body.name]) from trouble

    def _nodes_of_parts(self) -> list[PartNodes]:
        """Nodes, motions and forces of every part; equal parts are made together."""
        loads = self._loads()
        motions = self._motions()
        is_axes = np.all(self.frames.frames == np.eye(2), axis=(1, 2))
        found = dict[int, PartNodes]()
        for owners in self._alike_in_force(loads):
            of_alike = loads.get(owners[0], [])
            of_parts = self._nodes_of_alike(owners, motions, is_axes, of_alike)
            found.update(zip(owners, of_parts, strict=True))
        return [found[owner] for owner in range(len(self.shape_parts))]

    def _motions(self) -> Array:
        """Motions of the degrees of freedom of all nodes, (n_nodes, N_AXES, 3)."""
        motions = np.zeros((self.structure.first_nodes[-1], N_AXES, N_AXES))
        motions[:, :2, :2] = self.frames.frames
        motions[:, 2, 2] = 1.0
        return motions

    def _alike_in_force(self, loads: Container[int]) -> list[list[int]]:
        """Groups of parts with equal shape and weight; loaded parts are in no group."""
        alike = dict[Hashable, list[int]]()
        for owner, own in enumerate(self.shape_parts):
            key: Hashable = owner
            if owner not in loads:
                weight = self.structure.bodies[self._body_of_parts[owner]].weight
                key = id(own), id(weight)
            alike.setdefault(key, []).append(owner)
        return list(alike.values())

    def _nodes_of_alike(
        self,
        owners: Sequence[int],
        motions: Array,
        is_axes: Flags,
        loads: Sequence[PartForce],
    ) -> list[PartNodes]:
        """Nodes, motions and forces of equal parts, by their indices.

        `motions` are those of all nodes, (n_nodes, N_AXES, 3), `is_axes` tells where
        they are along x and y, (n_nodes,), and `loads` are the forces on the nodes of
        the parts, with patterns (n_nodes_of_part, 2, n_patterns), N.
        """
        own = self.shape_parts[owners[0]]
        bodies = [self._body_of_parts[owner] for owner in owners]
        nodes = np.add.outer(self.structure.first_nodes[bodies], own.nodes)
        keys = self._operators.turned(nodes)
        force = own.forces(self.structure.bodies[bodies[0]].weight, loads)
        unit = self.young * self.length
        if own.n_axes == 2 and is_axes[nodes].all():
            return _along_axes(nodes, keys, force, unit)
        frames = motions[nodes, : own.n_axes]
        forces: list[PartForce | None] = [None] * len(owners)
        if force is not None:
            on_nodes = frames[..., :2] @ force.patterns / unit
            turned = on_nodes.reshape(len(owners), -1, len(force.courses))
            forces = [PartForce(patterns, force.courses) for patterns in turned]
        of_parts = zip(nodes, keys, frames, forces, strict=True)
        return [PartNodes(*of_part) for of_part in of_parts]

    def _owners_of(self, load: Load) -> list[int]:
        """Indices of the parts of a loaded body; first those with all loaded nodes."""
        count = self.structure.bodies[load.body].substructures
        owners = [self.owner(load.body, part) for part in range(count)]
        owners.sort(key=lambda owner: not self.shape_parts[owner].has(load.nodes).all())
        return owners

    def _loads(self) -> Mapping[int, Sequence[PartForce]]:
        """Forces of the loads on the nodes of parts, N.

        Patterns have the shape (n_nodes, 2, n_patterns). A node of several parts is
        loaded in the one that has all loaded nodes, or else in the first.
        """
        found = dict[int, list[PartForce]]()
        for load in self.structure.loads:
            if not load.force.any():
                continue
            patterns, courses = _separated(load.force.reshape(2 * len(load.nodes), -1))
            on_nodes = patterns.reshape(len(load.nodes), 2, -1)
            taken = np.zeros(len(load.nodes), dtype=bool)
            for owner in self._owners_of(load):
                own = self.shape_parts[owner]
                is_own = own.has(load.nodes) & ~taken
                taken |= is_own
                if is_own.any():
                    on_part = np.zeros((len(own.nodes), 2, len(courses)))
                    places = np.searchsorted(own.nodes, load.nodes[is_own])
                    on_part[places] = on_nodes[is_own]
                    found.setdefault(owner, []).append(PartForce(on_part, courses))
        return found


def _along_axes(
    nodes: Indices, keys: Sequence[bytes], force: PartForce | None, unit: float
) -> list[PartNodes]:
    """Nodes and forces of equal parts with directions along x and y: the same force.

    `nodes` have the shape (n_parts, n_nodes); `keys` are those of their directions.
    Patterns of the force are (n_nodes, 2, n_patterns), N, and `unit` is its unit, N.
    """
    if force is not None:
        patterns = force.patterns.reshape(-1, len(force.courses)) / unit
        force = PartForce(patterns, force.courses)
    of_parts = zip(nodes, keys, strict=True)
    return [PartNodes(numbers, key, None, force) for numbers, key in of_parts]


def _separated(force: Array) -> tuple[Array, Array]:
    """Forces, (n, n_instants), as patterns, (n, rank), times functions of time."""
    loaded = np.flatnonzero(force.any(axis=1))
    if len(loaded) > FEW:
        return separated(force)
    # To look for a smaller rank takes longer than it saves.
    return np.eye(len(force))[:, loaded], force[loaded]


def _modulus(body: Body) -> float:
    """Young's modulus, or E A / l of beams for a metre of thickness, Pa."""
    if isinstance(body.shape, Beam):
        return body.young * body.shape.area / body.shape.size
    return body.young
