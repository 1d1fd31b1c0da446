"""Joints of bodies of any shape: their pairs, stiffness beside them, macro bases."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.elements import legendre_basis
from solver.discrete.plane.cut_bodies import CutBodies
from solver.discrete.plane.joint_pieces import JOINT_SIDES
from solver.laws import BodyStiffness, Component, NodalStiffness
from solver.laws.stiffness import of_whole_mesh

CUBIC = 3
"""Macro degree of a line over that of a mesh. Two clamped leaves of 80 elements that
are pressed together and bent take 6 iterations to 1 % of the contact force, six of them
51; of degree 2 more than 120, with forces that are 20 to 160 % off then (measured)."""


class JointPairs(NamedTuple):
    """Pairs of nodes of joints of one law, joint by joint and piece by piece.

    Attributes
    ----------
    pieces
        Indices of the pieces of these joints.
    sizes
        Number of nodes of each joint, (n_joints,).
    joints
        Place of the joint of each pair among these joints, ascending, (n_pairs,).
    places
        Index of the node of each pair along its joint, (n_pairs,).
    weights
        Tributary area of each pair for a metre of thickness, (n_pairs,), m^2.
    tangent, normal
        Boundary rows along and across the joints; no normal ones where the pressure is
        known.
    """

    pieces: Sequence[int]
    sizes: list[int]
    joints: Indices
    places: Indices
    weights: Array
    tangent: Component
    normal: Component | None

    @classmethod
    def of(cls, cut: CutBodies, numbers: Sequence[int]) -> JointPairs:
        """Pairs of joints by index, ascending."""
        owners = np.array([piece.joint for piece in cut.pieces])
        chosen = np.flatnonzero(np.isin(owners, numbers)).tolist()
        pieces = [cut.pieces[number] for number in chosen]
        counts = np.array([len(piece.places) for piece in pieces])
        tangent, normal = _components(cut, chosen, counts)
        return cls(
            pieces=chosen,
            sizes=[len(cut.structure.joints[number].nodes) for number in numbers],
            joints=np.repeat(np.searchsorted(numbers, owners[chosen]), counts),
            places=np.concatenate([piece.places for piece in pieces]),
            weights=np.concatenate([piece.weights for piece in pieces]),
            tangent=tangent,
            normal=normal,
        )

    @property
    def nodes(self) -> Indices:
        """Number of the node of each pair among those of all joints, (n_pairs,)."""
        ends: Indices = np.cumsum(self.sizes)
        return (ends - self.sizes)[self.joints] + self.places


def _components(
    cut: CutBodies, numbers: Sequence[int], counts: Indices
) -> tuple[Component, Component | None]:
    """Components along and across pieces, from indices and counts of pairs, (n,).

    There are none across where parts have rows of one component.
    """
    pieces = [cut.pieces[number] for number in numbers]
    along = np.repeat([piece.along for piece in pieces], counts)
    # Indices of the pairs of each piece within it.
    within = np.arange(len(along)) - np.repeat(np.cumsum(counts) - counts, counts)
    tangential = list[Indices]()
    across = list[Indices]()
    for side, name in enumerate(JOINT_SIDES[: len(pieces[0].parts)]):
        parts = [cut.parts[piece.parts[side]] for piece in pieces]
        of_pieces = [
            part.first_rows[name, number]
            for number, part in zip(numbers, parts, strict=True)
        ]
        _, n_components = parts[0].traces[name, numbers[0]].dofs.shape
        rows = np.repeat(of_pieces, counts) + n_components * within
        tangential.append(rows + along)
        if n_components > 1:
            across.append(rows + 1 - along)
    if not across:
        return Component(*tangential), None
    return Component(*tangential), Component(*across)


def positions_along(cut: CutBodies, numbers: Sequence[int]) -> Array:
    """Positions of the nodes of joints along each, from its start, (n_nodes,), m."""
    structure = cut.structure
    known = dict[int, Array]()
    found = []
    for number in numbers:
        joint = structure.joints[number]
        kind = structure.joint_kinds[number]
        if kind not in known:
            nodes = structure.bodies[joint.above].shape.nodes
            known[kind] = _distances(nodes[joint.nodes])
        found.append(joint.start + known[kind])
    return np.concatenate(found)


def _distances(nodes: Array) -> Array:
    """Distance of nodes, (n, 2), m, from the first along their line, (n,), m."""
    steps = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    return np.cumsum(np.append(0.0, steps))


def stiffness_beside(
    cut: CutBodies, numbers: Sequence[int], pairs: JointPairs
) -> BodyStiffness | NodalStiffness:
    """Stiffness of the bodies at joints, for their search direction."""
    if cut.depths is None:
        return _stiffness_of_shapes(cut, numbers, pairs)
    return _stiffness_of_lattices(cut, cut.depths, numbers, pairs)


def _stiffness_of_shapes(
    cut: CutBodies, numbers: Sequence[int], pairs: JointPairs
) -> NodalStiffness:
    """Stiffness of bodies of any shape at joints, for their search direction.

    A mesh resists with about E as a whole (`of_whole_mesh`). Beams resist with E A / l
    along a joint of length l; across it they stay where they are pressed.
    """
    of_joint = pairs.joints
    lengths: Array = np.bincount(of_joint, weights=pairs.weights).astype(float)
    share = pairs.weights / lengths[of_joint]
    rows = _rows_of(pairs)
    local = cut.local_stiffness[rows]
    whole = np.empty_like(local)
    squeezed = np.full(len(share), np.inf)
    for side in range(rows.shape[2]):
        bodies = [cut.structure.joints[number].sides[side][0] for number in numbers]
        of_joints, across = _whole_joints(
            cut, bodies, lengths, on_support=rows.shape[2] == 1
        )
        along = of_joints[of_joint] * share
        # Across beams k is at least that along them, as their tension presses them.
        tension = np.maximum(local[:, 1, side], np.sqrt(along * local[:, 0, side]))
        is_beam = ~cut.is_mesh[bodies][of_joint]
        local[is_beam, 1, side] = tension[is_beam]
        whole[:, 0, side] = along
        whole[:, 1, side] = np.where(is_beam, tension, along)
        squeezed = np.minimum(squeezed, across[of_joint] * share)
    return NodalStiffness(
        whole, local, squeezed, _resting_lines(cut)[numbers][of_joint]
    )


def _stiffness_of_lattices(
    cut: CutBodies, depths: Array, numbers: Sequence[int], pairs: JointPairs
) -> BodyStiffness:
    """Moduli and depth of lattices at joints, for their search direction.

    `depths` are those of all bodies, (n_bodies,), m.
    """
    joints = [cut.structure.joints[number] for number in numbers]
    above = np.array([joint.above for joint in joints])[pairs.joints]
    moduli: Array = np.full(len(above), np.inf)
    if pairs.tangent.below is not None:
        below = np.array([joint.below for joint in joints], dtype=np.intp)
        moduli = cut.moduli[below[pairs.joints]]
    return BodyStiffness(cut.moduli[above], moduli, depths[above])


def _resting_lines(cut: CutBodies) -> Indices:
    """Number of joints between lines only, (n_joints,); 0 at joints with a mesh.

    Of belts and leaves that all lie on supports of their own it is 0, too.
    """
    joints = cut.structure.joints
    if cut.is_mesh.all():
        return np.zeros(len(joints), dtype=np.intp)
    is_of_lines = np.array(
        [not any(cut.is_mesh[body] for body, _ in joint.sides) for joint in joints]
    )
    is_between = np.array([joint.below is not None for joint in joints])
    count = 0
    if np.any(is_of_lines & is_between):
        count = int(is_of_lines.sum())
    return np.where(is_of_lines, count, 0)


def _rows_of(pairs: JointPairs) -> Indices:
    """Boundary rows of pairs, (n_pairs, 2, n_sides): tangential ones, then normal.

    Where the pressure is known there are no normal ones: tangential ones again.
    """
    components = pairs.tangent, pairs.normal or pairs.tangent
    return np.stack([np.stack(each.sides, axis=1) for each in components], axis=1)


def _whole_joints(
    cut: CutBodies, bodies: Sequence[int], lengths: Array, *, on_support: bool
) -> tuple[Array, Array]:
    """Stiffness of bodies on one side of whole joints: in shear, and squeezed.

    `bodies` are their numbers, joint by joint, `lengths` those of the joints, m; shape
    (n_joints,) all, the stiffnesses scaled.
    """
    is_mesh = cut.is_mesh[bodies]
    modulus = cut.moduli[bodies] / np.where(is_mesh, 1.0, lengths)
    depth = np.where(is_mesh, cut.volumes[bodies] / lengths, lengths)
    of_mesh = of_whole_mesh(depth, lengths, on_support=on_support)
    return modulus * np.where(is_mesh, of_mesh, 1.0), modulus * lengths / depth


def macro_bases(cut: CutBodies, pairs: JointPairs) -> list[Array]:
    """Macro bases of pieces in one component, (n_pairs, n_macro) each.

    Without columns where no macro forces balance. A line between forces at its ends
    bends like a cubic.
    """
    joints = cut.structure.joints
    pieces = [cut.pieces[number] for number in pairs.pieces]
    known = dict[Hashable, Array]()
    bases = []
    for piece in pieces:
        if not cut.structure.has_macro(joints[piece.joint]):
            bases.append(np.zeros((len(piece.places), 0)))
            continue
        part = cut.shape_parts[piece.parts[0]]
        # Pieces of joints that are alike share their arrays.
        key = id(part), cut.structure.joint_kinds[piece.joint], id(piece.weights)
        if key not in known:
            joint = joints[piece.joint]
            nodes = cut.structure.bodies[joint.above].shape.nodes
            along = _distances(nodes[joint.nodes[piece.places]])
            reach = along[-1] or 1.0
            slenderness = part.slenderness(joint.nodes, piece.weights.sum())
            degree = cut.structure.macro_degree
            if not cut.is_mesh[joint.above]:
                degree *= CUBIC
            known[key] = legendre_basis(2.0 * along / reach - 1.0, slenderness, degree)
        bases.append(known[key])
    return bases
