"""Pairs of nodes of all joints as arrays: joint by joint, node by node of each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.plane.body import Joint


class NodePairs(NamedTuple):
    """Pairs of nodes of all joints. Nodes of all bodies follow each other.

    Attributes
    ----------
    first
        Numbers of the first pair of each joint, and of the pairs, (n_joints + 1,).
    above, below
        Nodes of each pair, (n_pairs,); that below is -1 on a support.
    normals
        Unit normals as they are given, (n_pairs, 2).
    """

    first: Indices
    above: Indices
    below: Indices
    normals: Array

    @classmethod
    def of(cls, joints: Sequence[Joint], first_nodes: Indices) -> NodePairs:
        """Pairs of joints; `first_nodes` are those of the bodies, (n_bodies + 1,)."""
        # There may be no joint at all.
        above = [np.zeros(0, dtype=np.intp)]
        below = [np.zeros(0, dtype=np.intp)]
        normals = [np.zeros((0, 2))]
        for joint in joints:
            above.append(first_nodes[joint.above] + joint.nodes)
            if joint.below is not None and joint.nodes_below is not None:
                below.append(first_nodes[joint.below] + joint.nodes_below)
            else:
                below.append(np.full(len(joint.nodes), -1))
            normals.append(joint.normals)
        sizes = [len(joint.nodes) for joint in joints]
        return cls(
            first=np.cumsum([0, *sizes]),
            above=np.concatenate(above),
            below=np.concatenate(below),
            normals=np.concatenate(normals),
        )

    @property
    def joints(self) -> Indices:
        """Number of the joint of each pair, ascending, (n_pairs,)."""
        return np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))


def along_joints(values: Sequence[Array | float], sizes: Sequence[int]) -> Array:
    """Values of joints of these sizes, node by node: (n_nodes,)."""
    constants = [value for value in values if isinstance(value, float)]
    if len(constants) == len(values):
        return np.repeat(constants, sizes)
    along = zip(values, sizes, strict=True)
    return np.concatenate([np.broadcast_to(value, size) for value, size in along])
