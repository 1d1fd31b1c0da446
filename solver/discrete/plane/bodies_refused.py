"""Checks of bodies together: names, joints, holds and loads."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.checks import Count, Numbers, check_value
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.body import Body, Held, Load, NodeSpring
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.node_pairs import NodePairs, along_joints
from solver.refusal import RefusedError, Words

RESERVED = "contacts", "supports"
"""Names of the laws of all joints between bodies, and of all on supports."""
UNIT = 1e-9
"""Largest difference of the length of a normal from 1."""
APART = 0.05
"""Largest distance of the nodes of a pair beyond their gap, over the distance to the
next node: the middles of edges lie inside a round body."""


def check_names(named: Sequence[Body | Joint | Held | Load | NodeSpring]) -> None:
    """Refuse names that occur twice, and those of laws for interfaces."""
    for each in named:
        if isinstance(each, Joint | Held | NodeSpring) and each.name in RESERVED:
            raise RefusedError(
                f"{each}.name",
                each.name,
                f"a name other than {' and '.join(RESERVED)}",
                "choose another one, as laws of all joints together have these",
            )
    for name, count in Counter(each.name for each in named).items():
        if count > 1:
            raise RefusedError(
                "Bodies",
                Words(f"{count} with the name {name!r}"),
                "a name of its own for each",
                "rename all but one",
            )


def check_weight(body: Body, instants: int) -> None:
    """Refuse a weight whose shape does not fit the instants."""
    if body.weight is not None:
        check_value(f"{body}.weight", body.weight, Numbers(((2, instants),)))


def check_held(bodies: Sequence[Body], held: Held, instants: int) -> None:
    """Refuse a hold whose body, nodes, axis or instants do not exist."""
    check_value(f"{held} on body", held.body, Count(0, len(bodies) - 1))
    _check_nodes(bodies[held.body], str(held), held.nodes)
    shapes = (instants,), (len(held.nodes), instants)
    check_value(f"{held}.displacement", held.displacement, Numbers(shapes))
    highest = 1
    if isinstance(bodies[held.body].shape, Beam):
        highest = 2
    check_value(f"{held}.axis", held.axis, Count(0, highest))


def check_load(bodies: Sequence[Body], load: Load, instants: int) -> None:
    """Refuse a load whose body, nodes or instants do not exist."""
    check_value(f"{load} on body", load.body, Count(0, len(bodies) - 1))
    _check_nodes(bodies[load.body], str(load), load.nodes)
    shape = (len(load.nodes), 2, instants)
    check_value(f"{load}.force", load.force, Numbers((shape,)))


def check_spring(bodies: Sequence[Body], spring: NodeSpring) -> None:
    """Refuse a spring whose body or node does not exist."""
    check_value(f"{spring} on body", spring.body, Count(0, len(bodies) - 1))
    last = len(bodies[spring.body].shape.nodes) - 1
    check_value(f"{spring}.node", spring.node, Count(0, last))


def check_strengths(joints: Sequence[Joint], instants: int) -> None:
    """Refuse strengths of other instants, and joints on supports of several kinds.

    All joints on supports have one law, and so have all between bodies.
    """
    known = [joint for joint in joints if joint.strength is not None]
    for joint in known:
        shape = len(joint.nodes), instants
        check_value(f"{joint}.strength", joint.strength, Numbers((shape,), low=0.0))
        for other in joints:
            is_alike = other.strength is not None and other.is_image == joint.is_image
            if (other.below is None) == (joint.below is None) and not is_alike:
                raise RefusedError(
                    f"{other}.strength",
                    Words("of another kind than that of other joints"),
                    f"a known strength, as {joint} has one",
                    "give one to all joints on supports, or to none",
                )


def check_joined(bodies: Sequence[Body], joints: Sequence[Joint]) -> None:
    """Refuse bodies of joints that do not exist."""
    last = len(bodies) - 1
    for joint in joints:
        for number, _ in joint.sides:
            # Mostly they are plain numbers, and there are hundreds of them.
            if type(number) is not int or not 0 <= number <= last:
                check_value(f"{joint} on body", number, Count(0, last))


def check_chains(
    bodies: Sequence[Body], joints: Sequence[Joint], kinds: Sequence[int]
) -> None:
    """Refuse chains of nodes that are not along edges.

    Of joints of one kind (`kinds_of`) the first is checked: voussoirs are alike.
    """
    known = set[int]()
    for joint, kind in zip(joints, kinds, strict=True):
        if kind not in known:
            known.add(kind)
            for number, nodes in joint.sides:
                _check_chain(bodies[number], joint, nodes)


def _check_chain(body: Body, joint: Joint, nodes: Indices) -> None:
    """Refuse nodes, (n,), that a body does not have, or that are not along edges."""
    _check_nodes(body, str(joint), nodes)
    if body.shape.edges_of(nodes) is None:
        raise RefusedError(
            f"{joint}.nodes",
            Words(f"{len(nodes)} nodes of {body}"),
            "a chain of nodes along edges, with the middles of edges of a mesh",
            "take them from shape.along",
        )


def _check_nodes(body: Body, owner: str, nodes: Indices) -> None:
    """Refuse nodes, (n,), that a body does not have."""
    last = len(body.shape.nodes) - 1
    kind = Numbers(((len(nodes),),), low=0, high=last, whole=True)
    check_value(f"{owner}.nodes", nodes, kind)
    if len(np.unique(nodes)) < len(nodes) or not len(nodes):
        raise RefusedError(
            f"{owner}.nodes",
            Words(f"{len(nodes)} of them"),
            "one or more nodes, each once",
            "leave out those that come again",
        )


def check_pairs(
    bodies: Sequence[Body],
    rotations: Array,
    joints: Sequence[Joint],
    kinds: Sequence[int],
    pairs: NodePairs,
    nodes: Array,
) -> None:
    """Refuse wrong normals, pairs beyond their gap, and joints that come twice.

    `rotations` are those of all bodies, (n_bodies, 2, 2), `kinds` those of the joints
    (`kinds_of`), `nodes` the positions of all nodes, (n_nodes, 2), m.

    Raises
    ------
    RefusedError
        For the first joint with a wrong pair.
    """
    _check_lengths(joints, pairs)
    _check_directions(bodies, rotations, joints, kinds, pairs)
    _check_opposite(joints, pairs, nodes)
    _check_once(joints, pairs)


def _check_lengths(joints: Sequence[Joint], pairs: NodePairs) -> None:
    """Refuse normals that are no unit vectors."""
    differences = np.abs(np.hypot(*pairs.normals.T) - 1.0)
    if np.any(differences > UNIT):
        joint, number, _ = _first(differences, differences > UNIT, joints, pairs)
        length = float(np.hypot(*joint.normals[number]))
        raise RefusedError(
            f"{joint}.normals",
            Words(f"normal {number} of length {length:g}"),
            "vectors of length 1",
            "divide each by its length",
        )


def _check_directions(
    bodies: Sequence[Body],
    rotations: Array,
    joints: Sequence[Joint],
    kinds: Sequence[int],
    pairs: NodePairs,
) -> None:
    """Refuse normals that point out of the body above, if that is no line."""
    # Normals in the axes of a shape are the same at equal chains of nodes.
    known = dict[int, Array]()
    for joint, kind in zip(joints, kinds, strict=True):
        if kind not in known:
            shape = bodies[joint.above].shape
            # The line of beams has a body on both of its sides.
            known[kind] = np.zeros((len(joint.nodes), 2))
            if not isinstance(shape, Beam):
                normals = shape.outward(joint.nodes)
                sizes = np.linalg.norm(normals, axis=1, keepdims=True)
                known[kind] = normals / sizes
    outward = np.concatenate([known[kind] for kind in kinds])
    above = np.array([joint.above for joint in joints])
    turned = rotations[above[pairs.joints]]
    along = np.einsum("nab,nb,na->n", turned, outward, pairs.normals)
    is_line = np.array([isinstance(bodies[each.above].shape, Beam) for each in joints])
    is_refused = (along >= 0.0) & ~is_line[pairs.joints]
    if is_refused.any():
        joint, number, _ = _first(along, is_refused, joints, pairs)
        raise RefusedError(
            f"{joint}.normals",
            Words(f"normal {number} out of {bodies[joint.above]}"),
            "normals that point into the body above",
            "turn them round, or exchange both bodies",
        )


def _check_opposite(joints: Sequence[Joint], pairs: NodePairs, nodes: Array) -> None:
    """Refuse pairs of nodes, at positions in m, farther apart than their gap."""
    sizes = np.diff(pairs.first)
    above = nodes[pairs.above]
    # From the last node of a joint to the first of the next there is no step.
    steps = np.linalg.norm(np.diff(above, axis=0, prepend=np.inf), axis=1)
    steps[pairs.first[:-1]] = np.inf
    shortest = np.repeat(np.minimum.reduceat(steps, pairs.first[:-1]), sizes)
    gaps = along_joints([joint.gap for joint in joints], sizes.tolist())
    apart = np.linalg.norm(above - nodes[pairs.below], axis=1) - np.abs(gaps)
    is_refused = (pairs.below >= 0) & (apart > APART * shortest)
    if is_refused.any():
        joint, number, distance = _first(apart, is_refused, joints, pairs)
        raise RefusedError(
            f"{joint}.nodes_below",
            Words(f"nodes {number} of both chains {distance:g} m too far apart"),
            f"nodes that face each other, up to the gap and {APART:g} of a step",
            "list both chains in the same order, and mesh both bodies alike there",
        )


def _check_once(joints: Sequence[Joint], pairs: NodePairs) -> None:
    """Refuse a joint with the very pairs, and the direction, of another one.

    Two joints would share the force of one contact in any proportion. They may share
    the node at which one ends and the other begins.
    """
    both = np.sort(np.stack([pairs.above, pairs.below], axis=1), axis=1)
    known = dict[bytes, tuple[Joint, Array]]()
    for number, joint in enumerate(joints):
        own = slice(pairs.first[number], pairs.first[number + 1])
        order = np.lexsort(both[own].T)
        normals = pairs.normals[own][order]
        other = known.setdefault(both[own][order].tobytes(), (joint, normals))
        is_along = np.abs((normals * other[1]).sum(axis=1)) > 0.5
        if other[0] is not joint and is_along.any():
            raise RefusedError(
                f"{joint}.nodes",
                Words(f"the pairs of nodes of {other[0]}"),
                "pairs that touch in one joint only",
                "take one of the two joints away",
            )


def _first(
    values: Array, is_refused: Flags, joints: Sequence[Joint], pairs: NodePairs
) -> tuple[Joint, int, float]:
    """First joint with a refused pair, the worst of its pairs, and its value.

    Values, large where they are bad, and flags are those of the pairs of all joints,
    shape (n,).
    """
    first = int(pairs.joints[is_refused.argmax()])
    of_first = values[pairs.first[first] : pairs.first[first + 1]]
    return joints[first], int(of_first.argmax()), float(of_first.max())
