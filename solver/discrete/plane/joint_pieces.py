"""Directions of the degrees of freedom of nodes, and the pieces of joints.

Degrees of freedom at the nodes of a joint are those along its tangent and its normal.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.plane.body import Body, Held, NodeSpring
from solver.discrete.plane.cut_shapes import CutShape
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.node_pairs import NodePairs
from solver.refusal import RefusedError, Words

ALIKE = 1e-9
"""Largest difference of two directions that are the same."""
ON_AXIS = 1e-12
"""Component of a unit normal up to which it counts as zero."""
JOINT_SIDES = "above", "below"
"""Sides of joints; the rows of a part at a piece are by these and its number."""


class JointPiece(NamedTuple):
    """Part of a joint: between one part of the body above and one part below.

    Attributes
    ----------
    joint
        Index of the joint.
    parts
        Index of the part above, and of that below, among all parts; on a rigid support
        of the part above alone.
    places
        Indices of the nodes of its pairs along the joint, ascending, (n,).
    weights
        Length that belongs to each pair, (n,), m.
    along
        Component along the joint among those of a node: 0 the first, 1 the second.
    """

    joint: int
    parts: tuple[int, ...]
    places: Indices
    weights: Array
    along: int = 0


def snapped(vectors: Array) -> Array:
    """Unit vectors, (n, 2), rounded to an axis if they are along it."""
    vectors = np.where(np.abs(vectors) <= ON_AXIS, 0.0, vectors)
    x, y = vectors.T
    sizes = np.sqrt(x * x + y * y)
    return np.asarray(vectors / sizes[:, None])


class NodeFrames:
    """Directions of the degrees of freedom of the nodes of all bodies.

    Nodes of a joint have its tangent and normal, held ones the global axes, as have
    those under a spring, others the axes of their body. Nodes of all bodies follow each
    other. `rotations` are those of the bodies, (n_bodies, 2, 2).

    Attributes
    ----------
    first_nodes
        Index of the first node of each body, (n_bodies + 1,).
    frames
        The first and the second direction at every node, in global axes, (n_nodes, 2,
        2).
    first_pairs
        Index of the first pair of each joint, (n_joints + 1,).
    has_pair
        Which pairs of the joints there are, (n_pairs,). None where the joint has none
        by itself, where directions differ, and where `is_held`.
    is_held
        Where both sides are held across the joint, so that any pressing force would be
        a solution, (n_pairs,).
    """

    def __init__(
        self,
        rotations: Array,
        first_nodes: Indices,
        pairs: NodePairs,
        held: Sequence[Held],
        springs: Sequence[NodeSpring] = (),
    ) -> None:
        self.first_nodes = first_nodes
        sizes = np.diff(first_nodes)
        turned = rotations.swapaxes(1, 2)
        axes = snapped(turned.reshape(-1, 2)).reshape(-1, 2, 2)
        self.frames = np.repeat(axes, sizes, axis=0)
        self._held = np.zeros((len(self.frames), 2), dtype=bool)
        for each in held:
            if each.axis < 2:
                self._held[first_nodes[each.body] + each.nodes, each.axis] = True
        sprung = [first_nodes[spring.body] + spring.node for spring in springs]
        self._sprung = np.array(sprung, dtype=np.intp)
        # Nodes with the directions of a joint, and those of which joints disagree.
        self._of_joint = np.zeros(len(self.frames), dtype=bool)
        self._unlike = np.zeros(len(self.frames), dtype=bool)
        self._turn(pairs)
        self._hold()
        self._pull()
        self.first_pairs = pairs.first
        self.is_held = self._held_across(pairs) & pairs.is_paired & ~pairs.is_known
        has_below = pairs.below >= 0
        differs = self._unlike[pairs.above] | (self._unlike[pairs.below] & has_below)
        self.has_pair = pairs.is_paired & ~differs & ~self.is_held

    def _turn(self, pairs: NodePairs) -> None:
        """Turn frames of nodes to the tangent and the normal of their first joint."""
        wanted = np.stack([pairs.tangents, pairs.normals], axis=1)
        wanted = snapped(wanted.reshape(-1, 2)).reshape(-1, 2, 2)
        # Of upright joints of rectangles they are x and y, in this order.
        wanted[pairs.along == 1] = np.eye(2)
        chosen = pairs.is_paired
        below = chosen & (pairs.below >= 0)
        nodes = np.concatenate([pairs.above[chosen], pairs.below[below]])
        wanted = np.concatenate([wanted[chosen], wanted[below]])
        along = np.concatenate([pairs.along[chosen], pairs.along[below]])
        # The last write wins.
        self.frames[nodes[::-1]] = wanted[::-1]
        along_first = np.zeros(len(self.frames), dtype=np.intp)
        along_first[nodes[::-1]] = along[::-1]
        differs = np.abs(self.frames[nodes] - wanted).max(axis=(1, 2)) > ALIKE
        self._unlike[nodes[differs | (along_first[nodes] != along)]] = True
        self._of_joint[nodes] = True

    def _hold(self) -> None:
        """Turn the frames of held nodes back to the global axes."""
        held = np.flatnonzero(self._held.any(axis=1))
        is_axis = np.abs(self.frames[held]).max(axis=1) == 1.0
        is_skew = (self._held[held] & ~is_axis).any(axis=1)
        self._unlike[held] |= is_skew & self._of_joint[held]
        turned_back = held[is_skew | self._unlike[held]]
        self.frames[turned_back] = np.eye(2)

    def _pull(self) -> None:
        """Turn the frames of nodes under springs to the global axes."""
        differs = np.any(self.frames[self._sprung] != np.eye(2), axis=(1, 2))
        turned = self._sprung[differs]
        self._unlike[turned] |= self._of_joint[turned]
        self.frames[turned] = np.eye(2)

    def _held_across(self, pairs: NodePairs) -> Flags:
        """Mask of pairs, (n_pairs,), of which both nodes are held across.

        A support is.
        """
        across = np.abs(snapped(pairs.normals)) > 0.0
        held_above = (self._held[pairs.above] & across).any(axis=1)
        held_below = (self._held[pairs.below] & across).any(axis=1) | (pairs.below < 0)
        return np.asarray(held_above & held_below)

    @property
    def is_turned(self) -> Flags:
        """Mask of nodes whose directions may differ from their body's, (n_nodes,)."""
        is_turned = self._of_joint | self._held.any(axis=1)
        is_turned[self._sprung] = True
        return is_turned

    def axes_held(self, held: Held, nodes: Indices) -> tuple[Indices, Array]:
        """Degree of freedom that is held, and its sign, of nodes, (n,) all."""
        if held.axis == 2:
            return np.full(len(nodes), 2), np.ones(len(nodes))
        along = self.frames[self.first_nodes[held.body] + nodes, :, held.axis]
        which = np.abs(along).argmax(axis=1)
        return which, along[np.arange(len(nodes)), which]


def pieces_of(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    kinds: Sequence[int],
    cuts: Sequence[CutShape],
    frames: NodeFrames,
) -> list[JointPiece]:
    """Pieces of all joints, joint by joint and along each.

    Parts of bodies are numbered one body after the other. `kinds` are those of the
    joints (`kinds_of`).

    Raises
    ------
    RefusedError
        For a joint without any pair.
    """
    pieces = list[JointPiece]()
    # Joints along the same nodes of the same shapes have the same pieces.
    known = dict[Hashable, list[JointPiece]]()
    counts = [len(cut.elements) for cut in cuts]
    first_parts = np.cumsum([0, *counts]).tolist()
    ends = frames.first_pairs.tolist()
    for number, joint in enumerate(joints):
        own = slice(ends[number], ends[number + 1])
        flags = frames.has_pair[own], frames.is_held[own]
        of_flags = b"".join(each.tobytes() for each in flags)
        key = kinds[number], joint.along, of_flags
        if key not in known:
            whole = _pieces_of_joint(bodies, number, joint, cuts)
            known[key] = _with_pairs(whole, *flags)
        if not known[key]:
            raise RefusedError(
                f"{joint}.nodes",
                Words("without a pair"),
                "a joint with nodes at which no other joint and no hold has another "
                "direction",
                "make its elements smaller, or leave it out",
            )
        pieces += [_of_joint(piece, number, joint, first_parts) for piece in known[key]]
    return pieces


def _with_pairs(
    pieces: Sequence[JointPiece], has_pair: Flags, is_held: Flags
) -> list[JointPiece]:
    """Pieces of a joint that have pairs, by flags of its nodes, (n_nodes,) both."""
    return [
        _paired(piece, has_pair[piece.places], is_held[piece.places])
        for piece in pieces
        if has_pair[piece.places].any()
    ]


def _of_joint(
    piece: JointPiece, number: int, joint: Joint, first_parts: Sequence[int]
) -> JointPiece:
    """Copy of a piece for another joint, with the parts of that joint's bodies."""
    parts: tuple[int, ...] = (first_parts[joint.above] + piece.parts[0],)
    if joint.below is not None:
        parts = parts[0], first_parts[joint.below] + piece.parts[1]
    return JointPiece(number, parts, piece.places, piece.weights, piece.along)


def _pieces_of_joint(
    bodies: Sequence[Body], number: int, joint: Joint, cuts: Sequence[CutShape]
) -> list[JointPiece]:
    """Pieces of a joint, with pairs at all nodes and the numbers of parts of bodies."""
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
        pieces.append(JointPiece(number, parts, places, weights, joint.along))
    return pieces


def _paired(piece: JointPiece, has_pair: Flags, is_held: Flags) -> JointPiece:
    """A piece without some pairs, (n,): their lengths go to the nearest other pairs.

    But not the lengths of those where both sides are held, which nothing loads.
    """
    if has_pair.all():
        return piece
    kept = np.flatnonzero(has_pair)
    places = np.arange(len(has_pair))
    nearest = np.abs(places[:, None] - kept).argmin(axis=1)
    weights = np.zeros(len(kept))
    np.add.at(weights, nearest, np.where(is_held, 0.0, piece.weights))
    return piece._replace(places=piece.places[kept], weights=weights)
