"""Bodies of any shape, cut into parts: boundary rows and forces."""

from __future__ import annotations

from collections.abc import Container, Hashable, Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np

from solver.arrays import Array, Flags, Indices, separated
from solver.discrete.condensed_part import (
    N_AXES,
    CondensedPart,
    PartForce,
    Trace,
    numbered,
)
from solver.discrete.loose_bodies import LooseBodiesError
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Body, Held, Load
from solver.discrete.plane.body_parts import ShapePart
from solver.discrete.plane.cut_shapes import CutShape
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.joint_laws import JOINT_SIDES
from solver.discrete.plane.joint_pieces import NodeFrames, pieces_of, snapped
from solver.discrete.plane.lattice import Lattice
from solver.discrete.plane.shared_operators import PartNodes, SharedOperators
from solver.discrete.scales import Scales
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
    joint_names, pieces
        Names of the joints, and their pieces.
    first_parts
        Indices of the first part of each body, and of the parts.
    shape_parts
        All parts in the axes of their shapes.
    parts
        Parts, body by body. Their rows are by ("above", piece), ("below", piece),
        ("first", body, seam), ("second", body, seam), ("held", number) and ("spring",
        number).
    """

    def __init__(self, structure: Bodies) -> None:
        self.structure = structure
        self.length = float(structure.box[1].max())
        self.young = max(_modulus(body) for body in structure.bodies)
        self.scales = Scales(self.length, self.young * self.length, structure.duration)
        bodies = structure.bodies
        shapes = dict[Hashable, CutShape]()
        self.cuts = list[CutShape]()
        for body in bodies:
            key = body.cut_key
            if key not in shapes:
                shapes[key] = CutShape.of(body)
            self.cuts.append(shapes[key])
        self.frames = NodeFrames(
            structure.rotations,
            structure.first_nodes,
            structure.pairs,
            structure.held,
            structure.springs,
        )
        self.joint_names = [joint.name for joint in structure.joints]
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
        self.shape_parts = self._of_shapes()
        self._traces: list[dict[Hashable, Trace]] = [{} for _ in self.shape_parts]
        self._trace_pieces()
        self._trace_seams()
        self._trace_held()
        self._trace_springs()
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

    def _of_shapes(self) -> list[ShapePart]:
        """Parts of shapes, body by body; equal bodies share theirs."""
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
            parts += found[key]
        return parts

    def _dofs(self, owner: int, nodes: Indices, axes: Indices) -> Indices:
        """Degrees of freedom of a part at nodes of its body: (n, 1) or (n, n_axes).

        `axes` are the numbers of those of each node, which broadcast with (n, 1).
        """
        part = self.shape_parts[owner]
        local = np.searchsorted(part.nodes, nodes)
        return part.n_axes * local[:, None] + axes

    def _trace_pieces(self) -> None:
        """Add the rows of the joints."""
        known = dict[Hashable, Trace]()
        kinds = self.structure.joint_kinds
        for number, piece in enumerate(self.pieces):
            joint = self.structure.joints[piece.joint]
            sides = zip(JOINT_SIDES, joint.sides, piece.parts, strict=False)
            for name, (_, nodes), owner in sides:
                own = self.shape_parts[owner]
                has_macro = self.has_macro(joint)
                # Pieces of joints that are alike share their arrays.
                key = (
                    id(own),
                    kinds[piece.joint],
                    name,
                    id(piece.weights),
                    has_macro,
                    joint.strength is None,
                )
                if key not in known:
                    # Where the pressure is known nothing moves across the joint.
                    axes = np.arange(2)
                    if joint.strength is not None:
                        axes = np.array([joint.along])
                    dofs = self._dofs(owner, nodes[piece.places], axes)
                    lengths = own.lengths_on_side(nodes, piece.weights, piece.places)
                    k = own.direction_per_length * lengths
                    direction = np.repeat(k[:, None], len(axes), axis=1)
                    known[key] = Trace(dofs, direction, has_macro)
                self._traces[owner][name, number] = known[key]

    def has_macro(self, joint: Joint) -> bool:
        """Check whether macro forces balance on a joint.

        They do between bodies, but not between those of one group.
        """
        groups = self.structure.groups
        if joint.below is None or groups is None:
            return joint.below is not None
        return bool(groups[joint.above] != groups[joint.below])

    def _trace_seams(self) -> None:
        """Add the rows of both sides of the cuts inside bodies."""
        for body, cut in enumerate(self.cuts):
            for number, seam in enumerate(cut.seams):
                for name, part in zip(("first", "second"), seam.parts, strict=True):
                    owner = self.owner(body, part)
                    own = self.shape_parts[owner]
                    dofs = self._dofs(owner, seam.nodes, np.arange(own.n_axes))
                    if own.n_axes == 2:
                        lengths = own.lengths_on_side(seam.nodes, seam.weights)
                        k = np.repeat(
                            own.direction_per_length * lengths[:, None], 2, axis=1
                        )
                    else:
                        k = np.array(
                            [
                                [
                                    own.direction_at_point,
                                    own.direction_at_point,
                                    own.direction_of_turn,
                                ]
                            ]
                        )
                    self._traces[owner][name, body, number] = Trace(dofs, k, True)

    def _trace_held(self) -> None:
        """Add the rows of prescribed displacements, in every part with the node."""
        for number, held in enumerate(self.structure.held):
            weights = self._weights_held(held)
            shape = self.structure.bodies[held.body].shape
            for part in range(self.structure.bodies[held.body].substructures):
                owner = self.owner(held.body, part)
                own = self.shape_parts[owner]
                is_own = own.has(held.nodes)
                if not is_own.any():
                    continue
                nodes = held.nodes[is_own]
                axes, _ = self.axes_held(held, nodes)
                dofs = self._dofs(owner, nodes, axes[:, None])
                lengths = weights[is_own]
                if shape.edges_of(nodes) is not None:
                    lengths = own.lengths_on_side(nodes, lengths)
                k = own.direction_per_length * lengths[:, None]
                if held.axis == 2:
                    k = np.full_like(k, own.direction_of_turn)
                self._traces[owner]["held", number] = Trace(dofs, k, False)

    def _trace_springs(self) -> None:
        """Add the rows of nodes under springs, in the first part with each."""
        for number, spring in enumerate(self.structure.springs):
            node = np.array([spring.node])
            owner = self.owner(spring.body, 0)
            while not self.shape_parts[owner].has(node).all():
                owner += 1
            k = self.shape_parts[owner].direction_per_length * spring.length
            dofs = self._dofs(owner, node, np.arange(2))
            self._traces[owner]["spring", number] = Trace(dofs, np.full((1, 2), k), False)

    def axes_held(self, held: Held, nodes: Indices) -> tuple[Indices, Array]:
        """Degree of freedom of each node that is held, and its sign, (n,) both."""
        if held.axis == 2:
            return np.full(len(nodes), 2), np.ones(len(nodes))
        return self.frames.held_at(held.body, nodes, held.axis)

    def _weights_held(self, held: Held) -> Array:
        """Tributary length of each held node, (n,), m; equal ones without a chain."""
        shape = self.structure.bodies[held.body].shape
        if shape.edges_of(held.nodes) is None:
            return np.full(len(held.nodes), shape.size / len(held.nodes))
        return shape.shares(held.nodes)

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
                operator=self._operators.of(mesh, on_nodes, list(traces.values())),
                nodes=mesh.arranged(on_nodes.nodes),
                body=body,
                traces=traces,
                first_rows=first_rows,
                force=on_nodes.force,
                frames=on_nodes.frames,
                rotation=rotations[body] if of_body.angle else None,
            )

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
            if force is not None:
                size = len(force.courses)
                patterns = force.patterns.reshape(-1, size) / unit
                force = PartForce(patterns, force.courses)
            # Parts that are alike have the very same force.
            return [
                PartNodes(numbers, key, None, force)
                for numbers, key in zip(nodes, keys, strict=True)
            ]
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
