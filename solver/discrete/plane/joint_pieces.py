"""Directions of the degrees of freedom of nodes, and the pieces of joints.

Degrees of freedom at the nodes of a joint are those along its tangent and its normal.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.plane.body import Body, Held, Joint
from solver.discrete.plane.cut_shapes import CutShape
from solver.refusal import RefusedError, Words

ALIKE = 1e-9
"""Largest difference of two directions that are the same."""
ON_AXIS = 1e-12
"""Component of a unit normal up to which it counts as zero."""


class JointPiece(NamedTuple):
    """Part of a joint between a part of the body above and a part of what is below.

    Attributes
    ----------
    joint
        Number of the joint.
    parts
        Number of the part above, and of that below, among the parts of their bodies.
    places
        Numbers of its pairs along the joint, ascending, (n,).
    weights
        Length that belongs to each pair, (n,), m.
    """

    joint: int
    parts: tuple[int, int]
    places: Indices
    weights: Array


def snapped(vectors: Array) -> Array:
    """Unit vectors, (n, 2), of which those along an axis are that exactly."""
    vectors = np.where(np.abs(vectors) <= ON_AXIS, 0.0, vectors)
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


class NodeFrames:
    """Directions of the degrees of freedom of the nodes of all bodies.

    Nodes of a joint have its tangent and normal, held ones the global axes, others the
    axes of their body.

    Attributes
    ----------
    frames
        Of each body the first and the second direction at every node, in global axes,
        (n_nodes, 2, 2).
    """

    def __init__(
        self, bodies: Sequence[Body], joints: Sequence[Joint], held: Sequence[Held]
    ) -> None:
        self._joints = joints
        self.frames = [
            np.tile(snapped(body.rotation.T), (len(body.nodes), 1, 1))
            for body in bodies
        ]
        # Nodes with the directions of a joint, and those of which joints disagree.
        self._of_joint = [np.zeros(len(body.nodes), dtype=bool) for body in bodies]
        self._unlike = [np.zeros(len(body.nodes), dtype=bool) for body in bodies]
        for joint in joints:
            for number, nodes in joint.sides:
                self._turn(number, nodes, snapped(joint.normals))
        self._held = [np.zeros((len(body.nodes), 2), dtype=bool) for body in bodies]
        for each in held:
            if each.axis < 2:
                self._held[each.body][each.nodes, each.axis] = True
        for number in range(len(bodies)):
            self._hold(number)

    def _turn(self, number: int, nodes: Indices, normals: Array) -> None:
        """Give nodes of a body the directions of a joint, whose normals are (n, 2)."""
        tangents = np.stack([normals[:, 1], -normals[:, 0]], axis=1)
        wanted = np.stack([tangents, normals], axis=1)
        found = self.frames[number][nodes]
        before = self._of_joint[number][nodes]
        differs = np.abs(found - wanted).max(axis=(1, 2)) > ALIKE
        self._unlike[number][nodes] |= before & differs
        self.frames[number][nodes[~before]] = wanted[~before]
        self._of_joint[number][nodes] = True

    def _hold(self, number: int) -> None:
        """Give held nodes of a body the global axes, unless theirs are axes already."""
        held = self._held[number]
        frames = self.frames[number]
        is_axis = np.abs(frames).max(axis=1) == 1.0
        is_skew = (held & ~is_axis).any(axis=1)
        unlike = self._unlike[number]
        unlike |= is_skew & self._of_joint[number]
        frames[is_skew | (unlike & held.any(axis=1))] = np.eye(2)

    def held_at(self, number: int, nodes: Indices, axis: int) -> tuple[Indices, Array]:
        """Degree of freedom along an axis, and its sign, of held nodes, (n,) both."""
        along = self.frames[number][nodes, :, axis]
        which = np.abs(along).argmax(axis=1)
        return which, along[np.arange(len(nodes)), which]

    def has_pair(self, joint: Joint) -> Flags:
        """Check which pairs of a joint there are, (n,).

        None where directions differ, and where both sides are held across the joint, so
        that any pressing force would be a solution.
        """
        has_pair = np.ones(len(joint.nodes), dtype=bool)
        held_across = np.ones(len(joint.nodes), dtype=bool)
        normals = snapped(joint.normals)
        for number, nodes in joint.sides:
            has_pair &= ~self._unlike[number][nodes]
            across = np.abs(normals) > 0.0
            held_across &= (self._held[number][nodes] & across).any(axis=1)
        return has_pair & ~held_across


def pieces_of(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    cuts: Sequence[CutShape],
    frames: NodeFrames,
) -> list[JointPiece]:
    """Pieces of all joints, joint by joint and along each.

    Raises
    ------
    RefusedError
        For a joint without any pair.
    """
    pieces = list[JointPiece]()
    for number, joint in enumerate(joints):
        has_pair = frames.has_pair(joint)
        found = _pieces_of_joint(bodies, number, joint, cuts)
        kept = [piece for piece in found if has_pair[piece.places].any()]
        if not kept:
            raise RefusedError(
                f"{joint}.nodes",
                Words("without a pair"),
                "a joint with nodes at which no other joint and no hold has another "
                "direction",
                "make its elements smaller, or leave it out",
            )
        pieces += [_paired(piece, has_pair[piece.places]) for piece in kept]
    return pieces


def _pieces_of_joint(
    bodies: Sequence[Body], number: int, joint: Joint, cuts: Sequence[CutShape]
) -> list[JointPiece]:
    """Pieces of a joint, with pairs at all nodes."""
    elements, shares = bodies[joint.above].shape.steps(joint.nodes)
    above = cuts[joint.above].labels[elements]
    below = np.zeros_like(above)
    if joint.below is not None and joint.nodes_below is not None:
        elements, _ = bodies[joint.below].shape.steps(joint.nodes_below)
        below = cuts[joint.below].labels[elements]
    changes = np.flatnonzero(np.diff(above) | np.diff(below)) + 1
    ends = [0, *changes.tolist(), len(above)]
    pieces = []
    for first, last in pairwise(ends):
        weights = np.zeros(last - first + 1)
        weights[:-1] += shares[first:last, 0]
        weights[1:] += shares[first:last, 1]
        parts = int(above[first]), int(below[first])
        places = np.arange(first, last + 1)
        pieces.append(JointPiece(number, parts, places, weights))
    return pieces


def _paired(piece: JointPiece, has_pair: Flags) -> JointPiece:
    """A piece without some pairs, whose length goes to the nearest that are left."""
    if has_pair.all():
        return piece
    kept = np.flatnonzero(has_pair)
    places = np.arange(len(has_pair))
    nearest = np.abs(places[:, None] - kept).argmin(axis=1)
    weights = np.zeros(len(kept))
    np.add.at(weights, nearest, piece.weights)
    return piece._replace(places=piece.places[kept], weights=weights)
