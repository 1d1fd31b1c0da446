"""Contact laws of joints of bodies of any shape."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.arrays import Array, Flags, Indices
from solver.discrete.elements import legendre_basis
from solver.discrete.plane.cut_bodies import CutBodies
from solver.discrete.plane.joint_pieces import JointPiece
from solver.laws import Component, Contact, Friction, NodalStiffness, Unilateral
from solver.laws.friction import compliance_of
from solver.laws.stiffness import of_whole_mesh


class _JointPairs(NamedTuple):
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


def _pairs_of(cut: CutBodies, joints: Sequence[int]) -> _JointPairs:
    """Pairs of nodes of joints, by the numbers of these."""
    owners = np.array([piece.joint for piece in cut.pieces])
    numbers = np.flatnonzero(np.isin(owners, joints)).tolist()
    pieces = [cut.pieces[number] for number in numbers]
    counts = [len(piece.places) for piece in pieces]
    joint_of_pairs = np.repeat(np.searchsorted(joints, owners[numbers]), counts)
    sizes = [len(cut.structure.joints[number].nodes) for number in joints]
    firsts = np.cumsum([0, *sizes])
    places = np.concatenate([piece.places for piece in pieces])
    return _JointPairs(
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
        stiffness_beside=_stiffness_beside(cut, pairs, tangent, normal),
        macro=_macro_basis(cut, [cut.pieces[number] for number in pairs.pieces]),
        names=names,
        interfaces=interfaces,
    )


def _normal_law(
    cut: CutBodies, component: Component, pairs: _JointPairs, gap: Array
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
    cut: CutBodies, component: Component, pairs: _JointPairs, gap: Array, mu: Array
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
    cut: CutBodies, pairs: _JointPairs, tangent: Component, normal: Component
) -> NodalStiffness:
    """Stiffness of the bodies at joints, for their search direction.

    A mesh resists with about E as a whole (`of_whole_mesh`). Beams resist with E A / l
    along a joint of length l; across it they stay where they are pressed.
    """
    of_joint = pairs.joint_of_pairs
    lengths: Array = np.bincount(of_joint, weights=pairs.weights).astype(float)
    share = pairs.weights / lengths[of_joint]
    components = [np.stack(each.sides, axis=1) for each in (tangent, normal)]
    rows = np.stack(components, axis=1)
    local = cut.local_stiffness[rows]
    whole = np.empty_like(local)
    squeezed = np.full(len(share), np.inf)
    for side in range(rows.shape[2]):
        on_support = rows.shape[2] == 1
        of_joints, across = _whole_joints(cut, pairs, side, lengths, on_support)
        along = of_joints[of_joint] * share
        # Across beams k is at least that along them, as their tension presses them.
        tension = np.maximum(local[:, 1, side], np.sqrt(along * local[:, 0, side]))
        is_beam = ~_is_mesh(cut, pairs, side)[of_joint]
        local[is_beam, 1, side] = tension[is_beam]
        whole[:, 0, side] = along
        whole[:, 1, side] = np.where(is_beam, tension, along)
        squeezed = np.minimum(squeezed, across[of_joint] * share)
    return NodalStiffness(whole, local, squeezed)


def _bodies(cut: CutBodies, pairs: _JointPairs, side: int) -> list[int]:
    """Numbers of the bodies on a side of joints, 0 above and 1 below."""
    return [cut.structure.joints[number].sides[side][0] for number in pairs.joints]


def _is_mesh(cut: CutBodies, pairs: _JointPairs, side: int) -> Flags:
    """Check which bodies on a side of joints are meshes, (n_joints,)."""
    return np.array([cut.is_mesh(number) for number in _bodies(cut, pairs, side)])


def _whole_joints(
    cut: CutBodies, pairs: _JointPairs, side: int, lengths: Array, on_support: bool
) -> tuple[Array, Array]:
    """Stiffness of bodies on a side of whole joints: as a whole, and squeezed.

    Shape (n_joints,) both, scaled; `lengths` are those of the joints, (n_joints,), m.
    """
    bodies = _bodies(cut, pairs, side)
    is_mesh = _is_mesh(cut, pairs, side)
    modulus = cut.moduli[bodies] / np.where(is_mesh, 1.0, lengths)
    depth = np.where(is_mesh, cut.volumes[bodies] / lengths, lengths)
    of_mesh = of_whole_mesh(depth, lengths, on_support=on_support)
    return modulus * np.where(is_mesh, of_mesh, 1.0), modulus * lengths / depth


def _macro_basis(
    cut: CutBodies, pieces: Sequence[JointPiece]
) -> sparse.csr_array | None:
    """Macro basis of one component, (n_pairs, n_macro), or None on a support.

    Each piece has columns of its own.
    """
    joints = cut.structure.joints
    if joints[pieces[0].joint].below is None:
        return None
    known = dict[Hashable, Array]()
    blocks = []
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
        blocks.append(known[key])
    return _beside_each_other(blocks)


def _beside_each_other(blocks: Sequence[Array]) -> sparse.csr_array:
    """Diagonal matrix of blocks, (n_rows, n_columns) each."""
    heights = np.array([block.shape[0] for block in blocks])
    widths = np.array([block.shape[1] for block in blocks])
    # Rows of one block are as wide as it.
    of_rows = np.repeat(widths, heights)
    ends = np.append(0, np.cumsum(of_rows))
    first_columns = np.repeat(np.cumsum(widths) - widths, heights)
    columns = np.arange(ends[-1]) - np.repeat(ends[:-1] - first_columns, of_rows)
    values = np.concatenate([block.ravel() for block in blocks])
    shape = len(of_rows), int(widths.sum())
    return sparse.csr_array((values, columns, ends), shape)
