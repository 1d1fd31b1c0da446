"""Discrete problem of bodies of any shape: interface laws at joints, cuts and holds.

Parts of one body are glued where they were cut. Contact forces are lumped at the nodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.discrete.elements import legendre_basis
from solver.discrete.inside import Inside
from solver.discrete.loose import is_loose
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body_parts import BodyPart
from solver.discrete.plane.cut_bodies import CutBodies
from solver.discrete.plane.cut_shapes import Seam
from solver.discrete.plane.joint_pieces import JointPiece
from solver.discrete.plane.meshes import Mesh
from solver.discrete.problem import Problem
from solver.discrete.scales import Scales
from solver.discrete.substructure import Substructure
from solver.laws import (
    BodyStiffness,
    Component,
    Contact,
    Dirichlet,
    Friction,
    Interface,
    Perfect,
    Unilateral,
)
from solver.laws.friction import compliance_of
from solver.refusal import RefusedError, Words

QUADRATIC = 0.5
"""k of a joint over that of bilinear elements. Of 31 voussoirs with 1, 2, 4 elements
across, whose abutment moves, 1 % takes 45, 40, 72 iterations; with 1 63, 47, 102; by
areas instead of their roots 55, 42, 78, and 150, 87, 135 with 1 (measured)."""


def problem_of(structure: Bodies) -> Problem:
    """Discrete problem of bodies: their parts, interfaces and inside.

    Raises
    ------
    RefusedError
        If bodies can move though all contacts are closed and stick.
    """
    cut = CutBodies(structure)
    scales = Scales(cut.length, cut.young * cut.length, structure.duration)
    nodes = np.concatenate([body.nodes for body in structure.bodies]) / cut.length
    inside = Inside(cut.parts, nodes, scales, len(structure.instants))
    n_pairs = sum(len(piece.places) for piece in cut.pieces)
    n_steps = sum(len(joint.nodes) for joint in structure.joints)
    problem = Problem(
        substructures=tuple(
            _substructure(part, dofs)
            for part, dofs in zip(cut.parts, inside.dofs, strict=True)
        ),
        interfaces=dict(_interfaces(cut)),
        positions=inside.positions * scales.displacement,
        instants=structure.instants,
        scales=scales,
        inside=inside,
        has_short_joints=n_pairs < n_steps,
        order=tuple(joint.name for joint in structure.joints),
    )
    if is_loose(problem):
        raise RefusedError(
            "Bodies.held",
            Words(f"of {len(structure.held)} displacements"),
            "holds and joints that leave no body free to move or to turn, where all "
            "contacts are closed and stick",
            "hold one more node or axis, or add a joint",
        )
    return problem


def _substructure(part: BodyPart, dofs: Indices) -> Substructure:
    """Substructure of a part, with its degrees of freedom, (n_kept,)."""
    body_force = None
    if part.force is not None:
        body_force = part.condensed.condense(part.force)
    return Substructure(
        elasticity=part.elasticity,
        dofs=dofs,
        rows=np.concatenate([rows.ravel() for rows in part.rows.values()]),
        body_force=body_force,
    )


def _interfaces(cut: CutBodies) -> Iterator[tuple[str, Interface]]:
    """All interfaces by name: contacts, then cuts, then prescribed displacements."""
    kinds = dict[str, list[int]]()
    for number, joint in enumerate(cut.structure.joints):
        kind = "supports" if joint.below is None else "contacts"
        kinds.setdefault(kind, []).append(number)
    for kind, numbers in kinds.items():
        name = kind
        if len(numbers) == 1:
            name = cut.structure.joints[numbers[0]].name
        yield name, _contact(cut, numbers)
    for body, of_body in enumerate(cut.structure.bodies):
        for number, seam in enumerate(cut.cuts[body].seams):
            first, second = seam.parts
            name = f"cut {first + 1} to {second + 1} of {of_body.name}"
            yield name, _glued(cut, body, number, seam)
    for number, held in enumerate(cut.structure.held):
        yield held.name, _prescribed(cut, number)


def _glued(cut: CutBodies, body: int, number: int, seam: Seam) -> Perfect:
    """Perfect interface of two parts of one body.

    Macro forces are polynomials along the seam in both directions of the body's axes.
    """
    first, second = [cut.parts[cut.owner(body, part)] for part in seam.parts]
    rows = first.rows["first", body, number]
    opposite = second.rows["second", body, number]
    if rows.shape[1] == 2:
        reach = np.abs(seam.positions).max()
        length = seam.weights.sum()
        slenderness = (length / first.of_shape.size) ** 2
        along = legendre_basis(
            seam.positions / reach, slenderness, cut.structure.macro_degree
        )
        frames = cut.local_frames(body, seam.nodes)
        macro = (frames[:, :, None, :] * along[:, None, :, None]).reshape(rows.size, -1)
    else:
        macro = np.eye(rows.size)
    return Perfect(rows.ravel(), opposite.ravel(), macro)


def _prescribed(cut: CutBodies, number: int) -> Dirichlet:
    """Dirichlet law of prescribed displacements."""
    held = cut.structure.held[number]
    rows = list[Indices]()
    values = list[Array]()
    shape = len(held.nodes), len(cut.structure.instants)
    given = np.broadcast_to(held.displacement, shape)
    _, signs = cut.axes_held(held, held.nodes)
    scaled = signs[:, None] * given / cut.length
    for part in range(cut.structure.bodies[held.body].substructures):
        own = cut.parts[cut.owner(held.body, part)]
        if ("held", number) in own.rows:
            rows.append(own.rows["held", number].ravel())
            values.append(scaled[np.isin(held.nodes, own.of_shape.nodes)])
    return Dirichlet(np.concatenate(rows), np.concatenate(values))


class _Pairs(NamedTuple):
    """Pairs of nodes of joints, joint by joint and piece by piece.

    Attributes
    ----------
    joints, pieces
        Numbers of the joints, and of their pieces.
    joint_of_pairs
        Place of the joint of each pair in `joints`, ascending, (n_pairs,).
    keys
        Number of the node of each pair among those of all these joints, (n_pairs,).
    firsts
        Number of the first node of each joint, (n_joints + 1,).
    weights
        Tributary area of each pair for a metre of thickness, (n_pairs,), m^2.
    """

    joints: Sequence[int]
    pieces: Sequence[int]
    joint_of_pairs: Indices
    keys: Indices
    firsts: Indices
    weights: Array


def _pairs_of(cut: CutBodies, joints: Sequence[int]) -> _Pairs:
    """Pairs of nodes of joints, by the numbers of these."""
    owners = np.array([piece.joint for piece in cut.pieces])
    numbers = np.flatnonzero(np.isin(owners, joints)).tolist()
    pieces = [cut.pieces[number] for number in numbers]
    counts = [len(piece.places) for piece in pieces]
    joint_of_pairs = np.repeat(np.searchsorted(joints, owners[numbers]), counts)
    sizes = [len(cut.structure.joints[number].nodes) for number in joints]
    firsts = np.cumsum([0, *sizes])
    places = np.concatenate([piece.places for piece in pieces])
    return _Pairs(
        joints=joints,
        pieces=numbers,
        joint_of_pairs=joint_of_pairs,
        keys=firsts[joint_of_pairs] + places,
        firsts=firsts,
        weights=np.concatenate([piece.weights for piece in pieces]),
    )


def _contact(cut: CutBodies, numbers: Sequence[int]) -> Contact:
    """Law of joints: all on a support, or all between bodies."""
    pairs = _pairs_of(cut, numbers)
    joints = [cut.structure.joints[number] for number in numbers]
    known, points = np.unique(pairs.keys, return_inverse=True)
    tangent, normal = _components(cut, pairs.pieces)
    gap = _along_joints([(joint.gap, len(joint.nodes)) for joint in joints])
    mu = _along_joints([(joint.friction, len(joint.nodes)) for joint in joints])
    interfaces = None
    names: tuple[str, ...] = ()
    if len(joints) > 1:
        names = tuple(joint.name for joint in joints)
        interfaces = np.searchsorted(pairs.firsts, known, side="right") - 1
    return Contact(
        normal=_normal_law(cut, normal, pairs, gap[pairs.keys]),
        tangential=_friction(cut, tangent, pairs, gap[pairs.keys], mu[pairs.keys]),
        points=points.ravel(),
        positions=_positions(cut, numbers)[known],
        weights=pairs.weights,
        stiffness_beside=_stiffness_beside(cut, pairs),
        macro=_macro_basis(cut, [cut.pieces[number] for number in pairs.pieces]),
        names=names,
        interfaces=interfaces,
    )


def _normal_law(
    cut: CutBodies, component: Component, pairs: _Pairs, gap: Array
) -> Unilateral:
    """Unilateral law across joints, whose opening is `gap`, (n_pairs,), m."""
    scales = cut.length, cut.young * cut.length
    stiffness = cut.structure.friction_law.normal_stiffness
    return Unilateral(
        component=component,
        gap=gap / cut.length,
        compliance=compliance_of(stiffness, pairs.weights, scales),
    )


def _friction(
    cut: CutBodies, component: Component, pairs: _Pairs, gap: Array, mu: Array
) -> Friction:
    """Friction law along joints of opening `gap`, m, and coefficient mu, (n_pairs,)."""
    scales = cut.length, cut.young * cut.length
    law = cut.structure.friction_law
    friction = law.at(component, pairs.weights, scales, friction=mu)
    # Nothing is bonded across a gap.
    is_closed = (gap <= 0.0)[:, None]
    return replace(friction, bound=friction.bound * is_closed)


def _along_joints(values: Sequence[tuple[Array | float, int]]) -> Array:
    """Values of joints, each with its number of nodes, node by node: (n_nodes,)."""
    return np.concatenate([np.broadcast_to(value, size) for value, size in values])


def _positions(cut: CutBodies, numbers: Sequence[int]) -> Array:
    """Distance of the nodes of joints from the first of each, (n_nodes,), m."""
    found = []
    for number in numbers:
        joint = cut.structure.joints[number]
        nodes = cut.structure.bodies[joint.above].nodes[joint.nodes]
        steps = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
        found.append(np.cumsum(np.append(0.0, steps)))
    return np.concatenate(found)


def _components(cut: CutBodies, pieces: Sequence[int]) -> tuple[Component, Component]:
    """Tangential and normal component of pieces of joints."""
    joints = cut.structure.joints
    sides = list[Indices]()
    for side, name in enumerate(("above", "below")):
        rows = list[Indices]()
        for number in pieces:
            piece = cut.pieces[number]
            bodies = joints[piece.joint].sides
            if side < len(bodies):
                owner = cut.owner(bodies[side][0], piece.parts[side])
                rows.append(cut.parts[owner].rows[name, number])
        if rows:
            sides.append(np.concatenate(rows))
    tangent = Component(*[rows[:, 0] for rows in sides])
    normal = Component(*[rows[:, 1] for rows in sides])
    return tangent, normal


def _stiffness_beside(cut: CutBodies, pairs: _Pairs) -> BodyStiffness:
    """Moduli and depth of the bodies at joints, for their search direction.

    Nodes of elements with a node in the middle have uneven areas, but a body resists
    the displacement of any node by about E: k goes by the roots of the areas.
    """
    bodies = cut.structure.bodies
    above = []
    below = []
    depths = []
    for number in pairs.joints:
        joint = cut.structure.joints[number]
        above.append(cut.modulus(joint.above))
        modulus = np.inf
        if joint.below is not None:
            modulus = cut.modulus(joint.below)
        below.append(modulus)
        shape = bodies[joint.above].shape
        depth = np.inf
        if isinstance(shape, Mesh):
            depth = shape.volume / float(shape.shares(joint.nodes).sum())
        depths.append(depth)
    of_joint = pairs.joint_of_pairs
    roots = np.sqrt(pairs.weights)
    sums = np.bincount(of_joint, weights=roots)[of_joint]
    return BodyStiffness(
        above=np.array(above)[of_joint],
        below=np.array(below)[of_joint],
        depth=np.array(depths)[of_joint],
        shares=QUADRATIC * roots / sums,
    )


def _macro_basis(
    cut: CutBodies, pieces: Sequence[JointPiece]
) -> sparse.csr_array | None:
    """Macro basis of one component, (n_pairs, n_macro), or None on a support.

    Each piece has columns of its own.
    """
    joints = cut.structure.joints
    if joints[pieces[0].joint].below is None:
        return None
    blocks = []
    for piece in pieces:
        above = joints[piece.joint].above
        nodes = cut.structure.bodies[above].nodes[joints[piece.joint].nodes]
        steps = np.linalg.norm(np.diff(nodes[piece.places], axis=0), axis=1)
        along = np.cumsum(np.append(0.0, steps))
        reach = along[-1] or 1.0
        size = cut.parts[cut.owner(above, piece.parts[0])].of_shape.size
        slenderness = (piece.weights.sum() / size) ** 2
        blocks.append(
            legendre_basis(
                2.0 * along / reach - 1.0, slenderness, cut.structure.macro_degree
            )
        )
    return sparse.csr_array(sparse.block_diag(blocks))
