"""Checks of bodies beside each other, of joints, and of what holds and loads them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.checks import Count, Numbers, check_value
from solver.discrete.plane.body import Body, Held, Joint, Load, along_joints
from solver.discrete.plane.meshes import Mesh
from solver.refusal import RefusedError, Words

RESERVED = "contacts", "supports"
"""Names of the laws of all joints between bodies, and of all on supports."""
UNIT = 1e-9
"""Largest difference of the length of a normal from 1."""
APART = 0.05
"""Largest distance of the nodes of a pair beyond their gap, over the distance to the
next node: the middles of edges lie inside a round body."""


def check_names(named: Sequence[Body | Joint | Held | Load]) -> None:
    """Refuse names that occur twice, and those of laws for interfaces."""
    for each in named:
        if isinstance(each, Joint | Held) and each.name in RESERVED:
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
    """Refuse a weight of another shape."""
    if body.weight is not None:
        check_value(f"{body}.weight", body.weight, Numbers(((2, instants),)))


def check_held(bodies: Sequence[Body], held: Held, instants: int) -> None:
    """Refuse a body, nodes and an axis that do not exist, and other instants."""
    check_value(f"{held} on body", held.body, Count(0, len(bodies) - 1))
    _check_nodes(bodies[held.body], str(held), held.nodes)
    shapes = (instants,), (len(held.nodes), instants)
    check_value(f"{held}.displacement", held.displacement, Numbers(shapes))
    highest = 2
    if isinstance(bodies[held.body].shape, Mesh):
        highest = 1
    check_value(f"{held}.axis", held.axis, Count(0, highest))


def check_load(bodies: Sequence[Body], load: Load, instants: int) -> None:
    """Refuse a body and nodes that do not exist, and other instants."""
    check_value(f"{load} on body", load.body, Count(0, len(bodies) - 1))
    _check_nodes(bodies[load.body], str(load), load.nodes)
    shape = (len(load.nodes), 2, instants)
    check_value(f"{load}.force", load.force, Numbers((shape,)))


def check_joints(bodies: Sequence[Body], joints: Sequence[Joint]) -> None:
    """Refuse chains that follow no edges or do not face each other."""
    any_body = Count(0, len(bodies) - 1)
    # Equal chains of one shape are checked once: voussoirs are alike.
    known = set[tuple[int, bytes]]()
    for joint in joints:
        for number, nodes in joint.sides:
            if any_body.flaw(number) is not None:
                check_value(f"{joint} on body", number, any_body)
            body = bodies[number]
            key = _key(body, nodes)
            if key not in known:
                _check_chain(body, joint, nodes)
                known.add(key)
    if joints:
        _check_lengths(joints)
    _check_normals(bodies, joints)
    _check_opposite(bodies, joints)


def _key(body: Body, nodes: Indices) -> tuple[int, bytes]:
    """Key of a chain of nodes, (n,), the same for equal chains of one shape."""
    return id(body.shape), nodes.tobytes()


def _check_chain(body: Body, joint: Joint, nodes: Indices) -> None:
    """Refuse nodes, (n,), that a body does not have, or that follow no edges."""
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


def _check_lengths(joints: Sequence[Joint]) -> None:
    """Refuse normals of another length than 1."""
    lengths = np.hypot(*np.concatenate([joint.normals for joint in joints]).T)
    is_wrong = np.abs(lengths - 1.0) > UNIT
    if is_wrong.any():
        joint, number, _ = _first(np.abs(lengths - 1.0), is_wrong, joints)
        length = float(np.hypot(*joint.normals[number]))
        raise RefusedError(
            f"{joint}.normals",
            Words(f"normal {number} of length {length:g}"),
            "vectors of length 1",
            "divide each by its length",
        )


def _check_normals(bodies: Sequence[Body], joints: Sequence[Joint]) -> None:
    """Refuse normals that point out of the body above."""
    on_meshes = [each for each in joints if isinstance(bodies[each.above].shape, Mesh)]
    if not on_meshes:
        return
    # Normals in the axes of a shape are the same at equal chains of nodes.
    known = dict[tuple[int, bytes], Array]()
    outward = []
    for joint in on_meshes:
        key = _key(bodies[joint.above], joint.nodes)
        if key not in known:
            normals = bodies[joint.above].shape.outward(joint.nodes)
            known[key] = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        outward.append(known[key])
    rotations = np.array([bodies[joint.above].rotation for joint in on_meshes])
    turned = np.repeat(rotations, [len(joint.nodes) for joint in on_meshes], axis=0)
    normals = np.concatenate([joint.normals for joint in on_meshes])
    along = np.einsum("nab,nb,na->n", turned, np.concatenate(outward), normals)
    if np.any(along >= 0.0):
        joint, number, _ = _first(along, along >= 0.0, on_meshes)
        raise RefusedError(
            f"{joint}.normals",
            Words(f"normal {number} out of {bodies[joint.above]}"),
            "normals that point into the body above",
            "turn them round, or exchange both bodies",
        )


def _check_opposite(bodies: Sequence[Body], joints: Sequence[Joint]) -> None:
    """Refuse nodes of a pair that are farther apart than their gap."""
    of_two = [joint for joint in joints if joint.below is not None]
    if not of_two:
        return
    sizes = [len(joint.nodes) for joint in of_two]
    above, below = _positions(bodies, of_two)
    # Steps from a joint to the next are none.
    starts = np.cumsum([0, *sizes[:-1]])
    steps = np.linalg.norm(np.diff(above, axis=0, prepend=np.inf), axis=1)
    steps[starts] = np.inf
    shortest = np.repeat(np.minimum.reduceat(steps, starts), sizes)
    gaps = along_joints([joint.gap for joint in of_two], sizes)
    apart = np.linalg.norm(above - below, axis=1) - np.abs(gaps)
    if np.any(apart > APART * shortest):
        joint, number, distance = _first(apart, apart > APART * shortest, of_two)
        raise RefusedError(
            f"{joint}.nodes_below",
            Words(f"nodes {number} of both chains {distance:g} m too far apart"),
            f"nodes that face each other, up to the gap and {APART:g} of a step",
            "list both chains in the same order, and mesh both bodies alike there",
        )


def _positions(bodies: Sequence[Body], joints: Sequence[Joint]) -> tuple[Array, Array]:
    """Positions of all nodes above and below of joints of bodies, (n, 2) both, m."""
    positions: tuple[list[Array], list[Array]] = [], []
    for joint in joints:
        for side, (number, nodes) in zip(positions, joint.sides, strict=True):
            side.append(bodies[number].nodes[nodes])
    above, below = positions
    return np.concatenate(above), np.concatenate(below)


def _first(
    values: Array, is_refused: Flags, joints: Sequence[Joint]
) -> tuple[Joint, int, float]:
    """First joint with a pair that is refused, its worst pair, and the value of that.

    Values, large where they are bad, and flags are those of the pairs of all joints,
    shape (n,).
    """
    of_joint = np.repeat(np.arange(len(joints)), [len(each.nodes) for each in joints])
    first = of_joint[is_refused.argmax()]
    of_first = values[of_joint == first]
    return joints[first], int(of_first.argmax()), float(of_first.max())
