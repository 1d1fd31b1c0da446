"""Joints of bodies of any shape: their pairs, stiffness beside them, macro bases."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.elements import legendre_basis
from solver.discrete.plane.cut_bodies import CutBodies
from solver.discrete.plane.joint_laws import JointPairs, Surface, contact_of
from solver.discrete.plane.joint_pieces import JointPiece
from solver.laws import Component, Contact, NodalStiffness
from solver.laws.stiffness import of_whole_mesh


def law_of_joints(cut: CutBodies, numbers: Sequence[int]) -> Contact:
    """Law of joints by number: all on a support, or all between bodies."""
    joints = [cut.structure.joints[number] for number in numbers]
    of_joints = np.isin([piece.joint for piece in cut.pieces], numbers)
    pieces = np.flatnonzero(of_joints).tolist()
    pairs = _pairs_of(cut, numbers, pieces)
    gap = _along_joints([(joint.gap, len(joint.nodes)) for joint in joints])
    mu = _along_joints([(joint.friction, len(joint.nodes)) for joint in joints])
    law = cut.structure.friction_law
    return contact_of(
        pairs,
        Surface(law, gap[pairs.keys], mu[pairs.keys]),
        cut.scales,
        _stiffness_beside(cut, numbers, pairs),
        _macro_bases(cut, [cut.pieces[number] for number in pieces]),
    )


def _pairs_of(
    cut: CutBodies, numbers: Sequence[int], pieces: Sequence[int]
) -> JointPairs:
    """Pairs of nodes of joints, by the numbers of these and of their pieces."""
    joints = [cut.structure.joints[number] for number in numbers]
    places = [cut.pieces[number].places for number in pieces]
    owners = [cut.pieces[number].joint for number in pieces]
    counts = [len(of_piece) for of_piece in places]
    joint_of_pairs = np.repeat(np.searchsorted(numbers, owners), counts)
    firsts = np.cumsum([0, *[len(joint.nodes) for joint in joints]])
    keys = firsts[joint_of_pairs] + np.concatenate(places)
    tangent, normal = _components(cut, pieces)
    return JointPairs(
        names=[joint.name for joint in joints],
        joints=joint_of_pairs,
        keys=keys,
        positions=_positions(cut, numbers)[keys],
        weights=np.concatenate([cut.pieces[number].weights for number in pieces]),
        tangent=tangent,
        normal=normal,
    )


def _along_joints(values: Sequence[tuple[Array | float, int]]) -> Array:
    """Values of joints, each with its number of nodes, node by node: (n_nodes,)."""
    sizes = [size for _, size in values]
    constants = [value for value, _ in values if isinstance(value, float)]
    if len(constants) == len(values):
        return np.repeat(constants, sizes)
    return np.concatenate([np.broadcast_to(value, size) for value, size in values])


def _positions(cut: CutBodies, numbers: Sequence[int]) -> Array:
    """Distance of the nodes of joints from the first of each, (n_nodes,), m."""
    known = dict[Hashable, Array]()
    found = []
    for number in numbers:
        joint = cut.structure.joints[number]
        shape = cut.structure.bodies[joint.above].shape
        key = id(shape), joint.nodes.tobytes()
        if key not in known:
            known[key] = _distances(shape.nodes[joint.nodes])
        found.append(known[key])
    return np.concatenate(found)


def _distances(nodes: Array) -> Array:
    """Distance of nodes, (n, 2), from the first along the line of them, (n,)."""
    steps = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    return np.cumsum(np.append(0.0, steps))


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


def _stiffness_beside(
    cut: CutBodies, numbers: Sequence[int], pairs: JointPairs
) -> NodalStiffness:
    """Stiffness of the bodies at joints, for their search direction.

    A mesh resists with about E as a whole (`of_whole_mesh`). Beams resist with E A / l
    along a joint of length l; across it they stay where they are pressed.
    """
    assert pairs.normal is not None
    of_joint = pairs.joints
    lengths: Array = np.bincount(of_joint, weights=pairs.weights).astype(float)
    share = pairs.weights / lengths[of_joint]
    components = pairs.tangent, pairs.normal
    rows = np.stack([np.stack(each.sides, axis=1) for each in components], axis=1)
    local = cut.local_stiffness[rows]
    whole = np.empty_like(local)
    squeezed = np.full(len(share), np.inf)
    for side in range(rows.shape[2]):
        bodies = [cut.structure.joints[number].sides[side][0] for number in numbers]
        on_support = rows.shape[2] == 1
        of_joints, across = _whole_joints(cut, bodies, lengths, on_support)
        along = of_joints[of_joint] * share
        # Across beams k is at least that along them, as their tension presses them.
        tension = np.maximum(local[:, 1, side], np.sqrt(along * local[:, 0, side]))
        is_beam = ~_is_mesh(cut, bodies)[of_joint]
        local[is_beam, 1, side] = tension[is_beam]
        whole[:, 0, side] = along
        whole[:, 1, side] = np.where(is_beam, tension, along)
        squeezed = np.minimum(squeezed, across[of_joint] * share)
    return NodalStiffness(whole, local, squeezed)


def _is_mesh(cut: CutBodies, bodies: Sequence[int]) -> Flags:
    """Check which bodies, by number, are meshes, (n,)."""
    return np.array([cut.is_mesh(number) for number in bodies])


def _whole_joints(
    cut: CutBodies, bodies: Sequence[int], lengths: Array, on_support: bool
) -> tuple[Array, Array]:
    """Stiffness of bodies on a side of whole joints: as a whole, and squeezed.

    `bodies` are their numbers, joint by joint, `lengths` those of the joints, m; shape
    (n_joints,) all, the stiffnesses scaled.
    """
    is_mesh = _is_mesh(cut, bodies)
    modulus = cut.moduli[bodies] / np.where(is_mesh, 1.0, lengths)
    depth = np.where(is_mesh, cut.volumes[bodies] / lengths, lengths)
    of_mesh = of_whole_mesh(depth, lengths, on_support=on_support)
    return modulus * np.where(is_mesh, of_mesh, 1.0), modulus * lengths / depth


def _macro_bases(cut: CutBodies, pieces: Sequence[JointPiece]) -> list[Array]:
    """Macro bases of pieces in one component, (n_pairs, n_macro) each.

    Without columns on a support.
    """
    joints = cut.structure.joints
    if joints[pieces[0].joint].below is None:
        return [np.zeros((len(piece.places), 0)) for piece in pieces]
    known = dict[Hashable, Array]()
    bases = []
    for piece in pieces:
        joint = joints[piece.joint]
        part = cut.shape_part(joint.above, piece.parts[0])
        # Pieces of joints that are alike share their arrays.
        key = id(part), joint.nodes.tobytes(), id(piece.weights)
        if key not in known:
            nodes = cut.structure.bodies[joint.above].shape.nodes
            along = _distances(nodes[joint.nodes[piece.places]])
            reach = along[-1] or 1.0
            slenderness = (piece.weights.sum() / part.size) ** 2
            known[key] = legendre_basis(
                2.0 * along / reach - 1.0, slenderness, cut.structure.macro_degree
            )
        bases.append(known[key])
    return bases
