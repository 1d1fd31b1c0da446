"""Pairs of nodes of all joints as arrays, in the order of joints and their nodes."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.plane.body import Body
from solver.discrete.plane.joint import Joint


class NodePairs(NamedTuple):
    """Pairs of nodes of all joints, as indices of the nodes of all bodies.

    Attributes
    ----------
    first
        Indices of the first pair of each joint, and of the pairs, (n_joints + 1,).
    above, below
        Nodes of each pair, (n_pairs,); that below is -1 on a support.
    normals
        Unit normals as they are given, (n_pairs, 2).
    is_left_handed, along
        Whether tangents are the normals turned counter-clockwise, and the component
        along the joint where directions are x and y, (n_pairs,).
    is_paired, is_known
        Whether the joint has a pair there, and whether its strength is known,
        (n_pairs,).
    """

    first: Indices
    above: Indices
    below: Indices
    normals: Array
    is_left_handed: Flags
    along: Indices
    is_paired: Flags
    is_known: Flags

    @classmethod
    def of(cls, joints: Sequence[Joint], first_nodes: Indices) -> NodePairs:
        """Pairs of joints; `first_nodes` are those of the bodies, (n_bodies + 1,)."""
        sizes = np.array([len(joint.nodes) for joint in joints], dtype=np.intp)
        above = [joint.sides[0] for joint in joints]
        below = [joint.sides[1] for joint in joints if len(joint.sides) > 1]
        has_below = np.array([len(joint.sides) > 1 for joint in joints], dtype=bool)
        nodes_below = np.full(sizes.sum(), -1)
        nodes_below[np.repeat(has_below, sizes)] = _nodes_of(below, first_nodes)
        # There may be no joint at all.
        normals = [np.zeros((0, 2))]
        normals += [joint.normals for joint in joints]
        left_handed = np.array([joint.is_left_handed for joint in joints], dtype=bool)
        along = np.array([joint.along for joint in joints], dtype=np.intp)
        is_known = [joint.strength is not None for joint in joints]
        is_paired = np.ones(len(nodes_below), dtype=bool)
        firsts = np.cumsum(sizes) - sizes
        for first, joint in zip(firsts.tolist(), joints, strict=True):
            if joint.paired is not None:
                is_paired[first : first + len(joint.nodes)] = joint.paired
        return cls(
            first=np.cumsum([0, *sizes]),
            above=_nodes_of(above, first_nodes),
            below=nodes_below,
            normals=np.concatenate(normals),
            is_left_handed=np.repeat(left_handed, sizes),
            along=np.repeat(along, sizes),
            is_paired=is_paired,
            is_known=np.repeat(np.array(is_known, dtype=bool), sizes),
        )

    @property
    def tangents(self) -> Array:
        """Unit tangents, (n_pairs, 2)."""
        x, y = self.normals.T
        signs = np.where(self.is_left_handed, -1.0, 1.0)
        return np.stack([signs * y, -signs * x], axis=1)

    @property
    def joints(self) -> Indices:
        """Index of the joint of each pair, ascending, (n_pairs,)."""
        return np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))


def kinds_of(bodies: Sequence[Body], joints: Sequence[Joint]) -> list[int]:
    """Index of the kind of each joint, (n_joints,).

    Joints of one kind are along equal chains of nodes of the same shapes, which are cut
    alike.
    """
    of_bodies = [body.cut_key for body in bodies]
    known = dict[Hashable, int]()
    kinds = []
    for joint in joints:
        key = tuple([(of_bodies[body], nodes.tobytes()) for body, nodes in joint.sides])
        kinds.append(known.setdefault(key, len(known)))
    return kinds


def _nodes_of(sides: Sequence[tuple[int, Indices]], first_nodes: Indices) -> Indices:
    """Nodes of sides of joints, (n_nodes,), among those of all bodies.

    Sides are numbers of bodies and of nodes of these.
    """
    bodies = np.array([body for body, _ in sides], dtype=np.intp)
    sizes = np.array([len(nodes) for _, nodes in sides], dtype=np.intp)
    nodes = [np.zeros(0, dtype=np.intp)]
    nodes += [of_side for _, of_side in sides]
    return np.repeat(first_nodes[bodies], sizes) + np.concatenate(nodes)


def along_joints(values: Sequence[Array | float], sizes: Sequence[int]) -> Array:
    """Values of joints, repeated for the nodes of each joint: (n_nodes,)."""
    constants = [value for value in values if isinstance(value, float)]
    if len(constants) == len(values):
        return np.repeat(constants, sizes)
    along = zip(values, sizes, strict=True)
    return np.concatenate([np.broadcast_to(value, size) for value, size in along])
