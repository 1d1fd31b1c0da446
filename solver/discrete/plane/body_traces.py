"""Boundary rows of the parts of bodies: at joints, cuts, holds and springs."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from itertools import chain

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.condensed_part import Trace
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Held
from solver.discrete.plane.body_parts import ShapePart
from solver.discrete.plane.cut_shapes import CutShape
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.joint_pieces import JOINT_SIDES, JointPiece, NodeFrames

Named = tuple[int, Hashable, Trace]
"""A trace, with the index of its part and its name there."""


def traces_of(
    structure: Bodies,
    cuts: Sequence[CutShape],
    frames: NodeFrames,
    pieces: Sequence[JointPiece],
    of_bodies: Sequence[Sequence[ShapePart]],
) -> list[dict[Hashable, Trace]]:
    """Boundary rows of every part by name, with the search direction k of each.

    The names are ("above", piece), ("below", piece), ("first", body, seam),
    ("second", body, seam), ("held", number) and ("spring", number).

    Parameters
    ----------
    structure, cuts, frames, pieces
        Bodies, how each is cut, the directions at their nodes, and the pieces of
        joints.
    of_bodies
        Parts of every body.
    """
    parts = list(chain.from_iterable(of_bodies))
    counts = [len(of_body) for of_body in of_bodies]
    firsts = np.cumsum([0, *counts]).tolist()
    traces: list[dict[Hashable, Trace]] = [{} for _ in parts]
    for owner, name, trace in chain(
        _at_joints(structure, pieces, parts),
        _at_cuts(cuts, of_bodies, firsts),
        _at_holds(structure, frames, of_bodies, firsts),
        _at_springs(structure, of_bodies, firsts),
    ):
        traces[owner][name] = trace
    return traces


def _at_joints(
    structure: Bodies, pieces: Sequence[JointPiece], parts: Sequence[ShapePart]
) -> Iterator[Named]:
    """Yield the rows of joints; pieces of joints that are alike share theirs."""
    known = dict[Hashable, Trace]()
    for number, piece in enumerate(pieces):
        joint = structure.joints[piece.joint]
        has_macro = structure.has_macro(joint)
        alike = (
            structure.joint_kinds[piece.joint],
            id(piece.weights),
            has_macro,
            joint.strength is None,
        )
        sides = zip(JOINT_SIDES, joint.sides, piece.parts, strict=False)
        for name, (_, nodes), owner in sides:
            own = parts[owner]
            key = id(own), name, *alike
            if key not in known:
                known[key] = _at_joint(own, joint, nodes, piece, has_macro=has_macro)
            yield owner, (name, number), known[key]


def _at_joint(
    own: ShapePart,
    joint: Joint,
    nodes: Indices,
    piece: JointPiece,
    *,
    has_macro: bool,
) -> Trace:
    """Rows of a part at a piece of a joint, along its chain of nodes, (n,).

    Where the pressure is known nothing moves across the joint.
    """
    axes = np.arange(2)
    if joint.strength is not None:
        axes = np.array([joint.along])
    lengths = own.lengths_on_side(nodes, piece.weights, piece.places)
    k = own.direction_per_length * lengths
    return Trace(
        dofs=own.dofs_at(nodes[piece.places], axes),
        direction=np.repeat(k[:, None], len(axes), axis=1),
        has_macro=has_macro,
    )


def _at_cuts(
    cuts: Sequence[CutShape],
    of_bodies: Sequence[Sequence[ShapePart]],
    firsts: Sequence[int],
) -> Iterator[Named]:
    """Yield the rows of both sides of cuts; bodies that are alike share theirs."""
    known = dict[Hashable, Trace]()
    for body, cut in enumerate(cuts):
        for number, seam in enumerate(cut.seams):
            for name, part in zip(("first", "second"), seam.parts, strict=True):
                own = of_bodies[body][part]
                key = id(own), id(seam)
                if key not in known:
                    dofs = own.dofs_at(seam.nodes, np.arange(own.n_axes))
                    k = own.direction_on_cut(seam.nodes, seam.weights)
                    known[key] = Trace(dofs, k, has_macro=True)
                yield firsts[body] + part, (name, body, number), known[key]


def _at_holds(
    structure: Bodies,
    frames: NodeFrames,
    of_bodies: Sequence[Sequence[ShapePart]],
    firsts: Sequence[int],
) -> Iterator[Named]:
    """Yield the rows of prescribed displacements, in every part with the node."""
    for number, held in enumerate(structure.held):
        weights = _weights_held(structure, held)
        shape = structure.bodies[held.body].shape
        for part, own in enumerate(of_bodies[held.body]):
            is_own = own.has(held.nodes)
            if not is_own.any():
                continue
            nodes = held.nodes[is_own]
            axes, _ = frames.axes_held(held, nodes)
            lengths = weights[is_own]
            if shape.edges_of(nodes) is not None:
                lengths = own.lengths_on_side(nodes, lengths)
            k = own.direction_per_length * lengths[:, None]
            if held.axis == 2:
                k = np.full_like(k, own.direction_of_turn)
            trace = Trace(own.dofs_at(nodes, axes[:, None]), k, has_macro=False)
            yield firsts[held.body] + part, ("held", number), trace


def _weights_held(structure: Bodies, held: Held) -> Array:
    """Tributary length of each held node, (n,), m; equal ones without a chain."""
    shape = structure.bodies[held.body].shape
    if shape.edges_of(held.nodes) is None:
        return np.full(len(held.nodes), shape.size / len(held.nodes))
    return shape.shares(held.nodes)


def _at_springs(
    structure: Bodies,
    of_bodies: Sequence[Sequence[ShapePart]],
    firsts: Sequence[int],
) -> Iterator[Named]:
    """Yield the rows of nodes under springs, in the first part with each."""
    for number, spring in enumerate(structure.springs):
        node = np.array([spring.node])
        for part, own in enumerate(of_bodies[spring.body]):
            if own.has(node).all():
                k = own.direction_per_length * spring.length
                dofs = own.dofs_at(node, np.arange(2))
                trace = Trace(dofs, np.full((1, 2), k), has_macro=False)
                yield firsts[spring.body] + part, ("spring", number), trace
                break
