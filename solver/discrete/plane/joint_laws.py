"""Contact laws of joints of bodies of any shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.discrete.elements import legendre_basis
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.cut_bodies import CutBodies
from solver.discrete.plane.joint_pieces import JointPiece
from solver.discrete.plane.meshes import Mesh
from solver.laws import (
    BeamStiffness,
    BodyStiffness,
    Component,
    Contact,
    Friction,
    Unilateral,
)
from solver.laws.friction import compliance_of

QUADRATIC = 0.5
"""k of a joint over that of bilinear elements. Of 31 voussoirs with 1, 2, 4 elements
across, whose abutment moves, 1 % takes 45, 40, 72 iterations; with 1 63, 47, 102; by
areas instead of their roots 55, 42, 78, and 150, 87, 135 with 1 (measured)."""


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


def law_of_joints(cut: CutBodies, numbers: Sequence[int]) -> Contact:
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
    along = [rows[:, 0] for rows in sides]
    across = [rows[:, 1] for rows in sides]
    return Component(*along), Component(*across)


def _stiffness_beside(cut: CutBodies, pairs: _Pairs) -> BodyStiffness | BeamStiffness:
    """Stiffness beside joints: of bodies, or of lines of beams on a support."""
    above = [cut.structure.joints[number].above for number in pairs.joints]
    bodies = cut.structure.bodies
    is_on_support = cut.structure.joints[pairs.joints[0]].below is None
    if is_on_support and all(isinstance(bodies[one].shape, Beam) for one in above):
        moduli = np.array([cut.modulus(number) for number in above])
        return BeamStiffness(moduli[pairs.joint_of_pairs])
    return _of_bodies(cut, pairs)


def _of_bodies(cut: CutBodies, pairs: _Pairs) -> BodyStiffness:
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
