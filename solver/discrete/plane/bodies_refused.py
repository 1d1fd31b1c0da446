"""Checks of bodies beside each other, of joints, and of what holds and loads them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from solver.arrays import Indices
from solver.checks import Count, Numbers, check_value
from solver.discrete.plane.body import Body, Held, Joint, Load
from solver.discrete.plane.meshes import Mesh
from solver.refusal import RefusedError, Words

RESERVED = "contacts", "supports"
"""Names of the laws of all joints between bodies, and of all on supports."""
APART = 1e-6
"""Largest distance of the nodes of a pair beyond their gap, over the length of the
joint."""


def check_names(named: Sequence[Body | Joint | Held | Load]) -> None:
    """Refuse names that occur twice."""
    for name, count in Counter(each.name for each in named).items():
        if name in RESERVED:
            remedy = f"{' and '.join(RESERVED)} are names of laws, choose another"
            raise RefusedError("Bodies", name, "other names", remedy)
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
    _check_nodes(bodies, str(held), held.body, held.nodes)
    shapes = (instants,), (len(held.nodes), instants)
    check_value(f"{held}.displacement", held.displacement, Numbers(shapes))
    highest = 2
    if isinstance(bodies[held.body].shape, Mesh):
        highest = 1
    check_value(f"{held}.axis", held.axis, Count(0, highest))


def check_load(bodies: Sequence[Body], load: Load, instants: int) -> None:
    """Refuse a body and nodes that do not exist, and other instants."""
    _check_nodes(bodies, str(load), load.body, load.nodes)
    shape = (len(load.nodes), 2, instants)
    check_value(f"{load}.force", load.force, Numbers((shape,)))


def check_joint(bodies: Sequence[Body], joint: Joint) -> None:
    """Refuse chains that follow no edges or do not face each other."""
    for number, nodes in joint.sides:
        _check_nodes(bodies, str(joint), number, nodes)
        body = bodies[number]
        if body.shape.edges_of(nodes) is None:
            raise RefusedError(
                f"{joint}.nodes",
                Words(f"{len(nodes)} nodes of {body}"),
                "a chain of nodes along edges, with the middles of edges of a mesh",
                "take them from shape.along",
            )
    _check_normals(bodies[joint.above], joint)
    if joint.below is not None:
        _check_opposite(bodies, joint)


def _check_nodes(
    bodies: Sequence[Body], owner: str, number: int, nodes: Indices
) -> None:
    """Refuse a body that does not exist, and nodes that it does not have."""
    check_value(f"{owner} on body", number, Count(0, len(bodies) - 1))
    last = len(bodies[number].shape.nodes) - 1
    kind = Numbers(((len(nodes),),), low=0, high=last, whole=True)
    check_value(f"{owner}.nodes", nodes, kind)
    if len(np.unique(nodes)) < len(nodes) or not len(nodes):
        raise RefusedError(
            f"{owner}.nodes",
            Words(f"{len(nodes)} of them"),
            "one or more nodes, each once",
            "leave out those that come again",
        )


def _check_normals(above: Body, joint: Joint) -> None:
    """Refuse normals that point out of the body above."""
    if not isinstance(above.shape, Mesh):
        return
    outward = np.einsum("na,na->n", above.outward(joint.nodes), joint.normals)
    if np.any(outward >= 0.0):
        raise RefusedError(
            f"{joint}.normals",
            Words(f"normal {int(outward.argmax())} out of {above}"),
            "normals that point into the body above",
            "turn them round, or exchange both bodies",
        )


def _check_opposite(bodies: Sequence[Body], joint: Joint) -> None:
    """Refuse nodes of a pair that are farther apart than their gap."""
    first, second = [bodies[number].nodes[nodes] for number, nodes in joint.sides]
    length = bodies[joint.above].shape.shares(joint.nodes).sum()
    apart = np.linalg.norm(first - second, axis=1) - np.abs(joint.gap)
    if np.any(apart > APART * length):
        number = int(apart.argmax())
        raise RefusedError(
            f"{joint}.nodes_below",
            Words(f"nodes {number} of both chains {apart[number]:g} m too far apart"),
            f"nodes that face each other, up to the gap and {APART:g} of the length",
            "list both chains in the same order, and mesh both bodies alike there",
        )
