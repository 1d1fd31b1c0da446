"""Discrete problem of bodies in the plane: interface laws at joints and outer sides.

Substructures of one body are glued where they meet. Different bodies, and a body and
the support, are in contact. Contact forces are lumped at the nodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.inside import Inside
from solver.discrete.loose import loose_bodies
from solver.discrete.plane.bricks import BrickJoint
from solver.discrete.plane.cut_stack import CutStack, Span
from solver.discrete.plane.joint_laws import (
    JointPairs,
    Surface,
    contact_of,
    glued,
)
from solver.discrete.plane.rigid_stack import rigid_rest, rigid_slide
from solver.discrete.plane.sides import Side, Spring, Support
from solver.discrete.plane.stack import Stack
from solver.discrete.problem import Problem
from solver.laws import (
    BodyStiffness,
    Component,
    Contact,
    Dirichlet,
    FrictionLaw,
    Interface,
    Perfect,
    Unilateral,
)
from solver.refusal import RefusedError, Words

NO_BODY = -1
"""In place of the number of a body: the support."""


def problem_of(stack: Stack) -> Problem:
    """Discrete problem of a stack: its substructures, interfaces and inside.

    Raises
    ------
    RefusedError
        If bodies can move though all contacts are closed and stick.
    """
    cut = CutStack(stack)
    contacts = _contacts_of(cut)
    order = [*contacts]
    if stack.spring is not None:
        order.append("spring")
    scales = cut.scales
    inside = Inside(cut.parts, cut.positions, scales, len(stack.instants))
    has_short_joints = any(
        joint.is_upright and not cut.is_within_body(joint) for joint in cut.pairs
    )
    problem = Problem(
        substructures=inside.substructures(),
        interfaces=dict(_interfaces(cut, contacts)),
        positions=inside.positions * scales.displacement,
        instants=stack.instants,
        scales=scales,
        inside=inside,
        rest=_rest(stack, inside),
        has_short_joints=has_short_joints,
        order=tuple(order),
    )
    if len(loose_bodies(problem)):
        held = [name for name, side in stack.sides.items() if _is_moved(side)]
        raise RefusedError(
            "Stack.sides",
            Words(f"with displacements of {' and '.join(held) or 'no side'}"),
            "sides and supports that leave no body free to move or to turn, where all "
            "contacts are closed and stick",
            "prescribe the displacement of one more side, or along both axes, or add a "
            "support",
        )
    return problem


def _is_moved(side: Side) -> bool:
    """Check whether a displacement of a side is prescribed."""
    return any(component.prescribed for component in side)


def _rest(stack: Stack, inside: Inside) -> Array | None:
    """Displacement of the body that rests on its support, (n_dofs, n_instants), scaled.

    None where the body has not to be brought onto its support.
    """
    rigid = rigid_rest(stack)
    if rigid is None:
        return None
    x, y = inside.positions.T
    along_x, along_y, _ = inside.directions.T
    modes = np.stack([along_y, x * along_y - y * along_x], axis=1)
    rest = np.asarray(modes @ (rigid / np.array([[stack.length], [1.0]])))
    if stack.spring is not None:
        slide = rigid_slide(stack, stack.spring) / stack.length
        rest += np.outer(along_x, slide)
    return rest


def _contacts_of(cut: CutStack) -> dict[str, list[BrickJoint]]:
    """Joints of each contact by its name, in the order of the joints."""
    contacts = dict[str, list[BrickJoint]]()
    for joint in cut.pairs:
        if not cut.is_within_body(joint):
            contacts.setdefault(cut.name(joint), []).append(joint)
    return contacts


def _interfaces(
    cut: CutStack, contacts: Mapping[str, Sequence[BrickJoint]]
) -> Iterator[tuple[str, Interface]]:
    """All interfaces by name: contacts, then cuts, then prescribed sides."""
    stack = cut.stack
    yield from _laws_of_contact(cut, contacts)
    if stack.spring is not None:
        yield "spring", _spring(cut, stack.spring)
    # By the substructure below; upright cuts before lying ones.
    cuts = [joint for joint in cut.pairs if cut.is_within_body(joint)]
    cuts.sort(key=lambda joint: (joint.sides[1][0], not joint.is_upright))
    for joint in cuts:
        yield cut.name(joint), _glued(cut, joint)
    # A corner that two sides prescribe is held by the first: as `_prescribed` moves it.
    for side in ("top", "bottom", "left", "right"):
        given = stack.sides[side]
        if _is_moved(given):
            yield from _prescribed(cut, side, given)


def _laws_of_contact(
    cut: CutStack, contacts: Mapping[str, Sequence[BrickJoint]]
) -> Iterator[tuple[str, Contact]]:
    """Yield a law for all contacts with the support, and one for those of bodies."""
    alike = dict[str, list[str]]()
    for name, joints in contacts.items():
        kind = "supports" if joints[0].below is None else "contacts"
        alike.setdefault(kind, []).append(name)
    for kind, names in alike.items():
        key = kind
        if len(names) == 1:
            key = names[0]
        yield key, _contact(cut, {name: contacts[name] for name in names})


def _glued(cut: CutStack, joint: BrickJoint) -> Perfect:
    """Perfect interface of two substructures of one body."""
    rows_above, rows_below = _rows_of(cut, [joint])
    return glued(rows_below, rows_above, cut.basis(joint, 1))


class _Places(NamedTuple):
    """Where pairs of nodes of contacts are, joint by joint.

    Attributes
    ----------
    bodies, others
        Body above, or to the right, of each pair, and the other one, (n_pairs,);
        `NO_BODY` is the support.
    nodes
        Node of each pair on the grid of all elements, along the contact, (n_pairs,).
    is_upright
        Whether the joint of each pair is upright, (n_pairs,).
    """

    bodies: Indices
    others: Indices
    nodes: Indices
    is_upright: Flags


def _places_of(cut: CutStack, joints: Sequence[BrickJoint]) -> _Places:
    """Places of the pairs of joints."""
    counts = [len(cut.pairs[joint][0]) for joint in joints]
    bodies = [cut.body_of(joint.above) for joint in joints]
    others = [
        NO_BODY if joint.below is None else cut.body_of(joint.below) for joint in joints
    ]
    return _Places(
        bodies=np.repeat(bodies, counts),
        others=np.repeat(others, counts),
        nodes=np.concatenate([cut.pairs[joint][0] for joint in joints]),
        is_upright=np.repeat([joint.is_upright for joint in joints], counts),
    )


def _contact(cut: CutStack, contacts: Mapping[str, Sequence[BrickJoint]]) -> Contact:
    """Law of contacts by name: of bodies with the support, or with each other."""
    joints = list(chain.from_iterable(contacts.values()))
    places = _places_of(cut, joints)
    pairs = _pairs_of(cut, contacts, places)
    bases = [cut.macro_basis(joint) for joint in joints]
    law = contact_of(
        pairs,
        _surface(cut, places, pairs.weights),
        cut.scales,
        _stiffness_beside(cut.stack, places),
        bases,
    )
    support = cut.stack.support
    if support is not None and support.is_image and places.others[0] == NO_BODY:
        return replace(law, slip_ratio=2.0)
    return law


def _pairs_of(
    cut: CutStack, contacts: Mapping[str, Sequence[BrickJoint]], places: _Places
) -> JointPairs:
    """Pairs of nodes of contacts."""
    joints = list(chain.from_iterable(contacts.values()))
    lengths = [cut.pairs[joint][1] for joint in joints]
    n_joints = [len(of_contact) for of_contact in contacts.values()]
    of_joints = np.repeat(np.arange(len(contacts)), n_joints)
    numbers = np.repeat(of_joints, [len(of_joint) for of_joint in lengths])
    stack = cut.stack
    steps: Array = np.where(
        places.is_upright,
        stack.height / stack.elements[1],
        stack.length / stack.elements[0],
    )
    tangent, normal = _components(cut, joints, places.is_upright)
    return JointPairs(
        names=list(contacts),
        joints=numbers,
        keys=numbers * (max(stack.grid) + 1) + places.nodes,
        positions=steps * places.nodes,
        weights=stack.length * np.concatenate(lengths),
        tangent=tangent,
        normal=normal,
    )


def _components(
    cut: CutStack, joints: Sequence[BrickJoint], is_upright: Flags
) -> tuple[Component, Component | None]:
    """Tangential and normal component of joints; no normal one at known strength.

    `is_upright` is of every pair, (n_pairs,).
    """
    rows = _rows_of(cut, joints)
    has_normal = rows[0].shape[1] > 1
    if not has_normal:
        sides = [rows_of_side[:, 0] for rows_of_side in rows]
        return Component(*sides), None
    along = is_upright.astype(np.intp)
    every = np.arange(len(along))
    tangential = [rows_of_side[every, along] for rows_of_side in rows]
    across = [rows_of_side[every, 1 - along] for rows_of_side in rows]
    return Component(*tangential), Component(*across)


def _surface(cut: CutStack, places: _Places, areas: Array) -> Surface:
    """Friction and opening of contacts, whose pairs have the areas, (n_pairs,), m^2."""
    stack = cut.stack
    support = None
    if places.others[0] == NO_BODY:
        support = stack.support
    mu = _coefficients(stack, support, places)
    if support is None:
        return Surface(stack.friction_law, np.zeros(len(areas)), mu)
    law = stack.friction_law
    if support.is_image:
        law = law.of_one_side()
    known = None
    if support.strength is not None:
        known = support.strength[places.nodes] / cut.scales.force * areas[:, None]
    return Surface(law, support.gap[places.nodes], mu, known)


def _coefficients(stack: Stack, support: Support | None, places: _Places) -> Array:
    """Coefficient of friction of each pair, (n_pairs,)."""
    if support is not None:
        mu = np.asarray(support.friction)
    else:
        mu = np.asarray(stack.friction)
    if mu.ndim < 2:
        mu = np.atleast_2d(mu)
        rows = np.zeros_like(places.nodes)
    else:
        rows = places.bodies - 1
    columns = places.nodes if mu.shape[1] > 1 else 0
    of_pairs = np.asarray(mu[rows, columns])
    if stack.head_friction is not None:
        of_pairs = np.where(places.is_upright, stack.head_friction, of_pairs)
    if stack.strips and stack.support is not None:
        on_ground = (places.others >= 0) & (places.others < stack.strips)
        of_ground = np.broadcast_to(stack.support.friction, stack.grid[0] + 1)
        of_pairs = of_pairs.copy()
        of_pairs[on_ground] = of_ground[places.nodes[on_ground]]
    return of_pairs


def _stiffness_beside(stack: Stack, places: _Places) -> BodyStiffness:
    """Moduli and depth of the bodies at contacts, for their search direction."""
    moduli = np.array([stack.modulus(body) for body in range(len(stack.rectangles))])
    rows = np.array([rectangle.rows for rectangle in stack.rectangles])
    depths = stack.height * (rows / stack.elements[1])
    return BodyStiffness(
        above=moduli[places.bodies],
        below=np.where(places.others == NO_BODY, np.inf, moduli[places.others]),
        depth=depths[places.bodies],
    )


def _rows_of(cut: CutStack, joints: Sequence[BrickJoint]) -> list[Indices]:
    """Boundary rows of each side of joints, the one above first.

    Each has shape (n_points, n_components); a support has no rows.
    """
    rows = [np.concatenate([cut.parts[joint.above].rows[joint] for joint in joints])]
    below = [
        cut.parts[joint.below].rows[joint]
        for joint in joints
        if joint.below is not None
    ]
    if below:
        rows.append(np.concatenate(below))
    return rows


def _spring(cut: CutStack, spring: Spring) -> Contact:
    """Contact of a spring, which pushes the foot to the right as if from the left."""
    stack = cut.stack
    (number,) = [
        number for number, part in enumerate(cut.parts) if "spring" in part.rows
    ]
    rows = cut.parts[number].rows["spring"]
    areas = cut.mesh(number).edge_weights("right")
    return Contact(
        normal=Unilateral(
            component=Component(rows[:, 0]),
            gap=np.array([spring.slack / stack.length]),
            compliance=np.array([stack.young / spring.stiffness]),
        ),
        tangential=FrictionLaw().at(Component(rows[:, 1]), np.ones(1), (1.0, 1.0)),
        points=np.zeros(1, dtype=np.intp),
        positions=np.array([stack.length]),
        weights=stack.length * areas[:1],
        stiffness_beside=BodyStiffness(above=stack.modulus(0)),
        is_spring=True,
    )


def _prescribed(
    cut: CutStack, side: str, given: Side
) -> Iterator[tuple[str, Dirichlet]]:
    """Dirichlet law of a side whose displacement is prescribed, by the side's name."""
    rows = list[Indices]()
    values = list[Array]()
    components = [number for number, each in enumerate(given) if each.prescribed]
    for number, part in enumerate(cut.parts):
        for span, of_span in part.rows.items():
            if not isinstance(span, Span) or span.side != side:
                continue
            for column, component in enumerate(components):
                moved = cut.values(number, span, given[component])
                if side in ("left", "right"):
                    _move_corners(cut, number, side, component, moved)
                rows.append(of_span[:, column])
                values.append(moved / cut.stack.length)
    if rows:
        yield side, Dirichlet(np.concatenate(rows), np.concatenate(values))


def _move_corners(
    cut: CutStack,
    number: int,
    side: str,
    component: int,
    moved: Array,
) -> None:
    """Write the displacement of top and bottom into the corners of an upright side.

    Only where top or bottom prescribe the component; `number` is that of the
    substructure, `moved` the displacement of the side's nodes, (n_nodes, n_instants),
    m.
    """
    sign = 1.0 if side == "right" else -1.0
    spans = [name for name in cut.parts[number].rows if isinstance(name, Span)]
    for level, corner in (("bottom", 0), ("top", -1)):
        given = cut.stack.sides[level][component]
        on_level = [span for span in spans if span.side == level]
        if side == "right":
            columns = cut.mesh(number).columns
            is_prescribed = any(span.last == columns for span in on_level)
        else:
            is_prescribed = any(span.first == 0 for span in on_level)
        if given.prescribed and is_prescribed:
            moved[corner] = given.mean + sign * given.slope
