"""Discrete problem of bodies in the plane: interface laws at joints and outer sides.

Substructures of one body are glued where they meet. Different bodies, and a body and
the support, are in contact. Contact forces are lumped at the nodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.inside import Inside
from solver.discrete.loose_bodies import loose_bodies
from solver.discrete.plane.joint_laws import (
    JointPairs,
    Surface,
    contact_of,
    glued,
    laws_of,
)
from solver.discrete.plane.rectangles.bricks import BrickJoint
from solver.discrete.plane.rectangles.cut_rectangles import Span
from solver.discrete.plane.rectangles.cut_stack import CutStack
from solver.discrete.plane.rectangles.rigid_stack import rigid_rest, rigid_slide
from solver.discrete.plane.rectangles.sides import Side, Spring, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.plane.rectangles.stack_loads import values_along
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
"""In place of the index of a body: the support."""


def problem_of(stack: Stack) -> Problem:
    """Discrete problem of a stack: its substructures, interfaces and inside.

    Raises
    ------
    RefusedError
        If bodies can move though all contacts are closed and stick.
    """
    cut = CutStack(stack)
    order = [*cut.joint_names]
    if stack.spring is not None:
        order.append("spring")
    scales = cut.scales
    inside = Inside(cut.parts, cut.positions, scales, len(stack.instants))
    problem = Problem(
        substructures=inside.substructures(),
        interfaces=dict(_interfaces(cut)),
        positions=inside.positions * scales.displacement,
        instants=stack.instants,
        scales=scales,
        inside=inside,
        rest=_rest(stack, inside),
        has_short_joints=any(joint.is_upright for joint in cut.rectangles.joints),
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
    """Displacement of a body at rest on its support, (n_dofs, n_instants), scaled.

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


def _interfaces(cut: CutStack) -> Iterator[tuple[str, Interface]]:
    """All interfaces by name: contacts, then cuts, then prescribed sides."""
    stack = cut.stack
    yield from laws_of(cut, partial(_contact, cut))
    if stack.spring is not None:
        yield "spring", _spring(cut, stack.spring)
    for joint in cut.rectangles.cuts:
        yield cut.rectangles.cut_name(joint), _glued(cut, joint)
    # A corner that two sides prescribe is held by the first: as `_prescribed` moves it.
    for side in ("top", "bottom", "left", "right"):
        given = stack.sides[side]
        if _is_moved(given):
            yield from _prescribed(cut, side, given)


def _glued(cut: CutStack, joint: BrickJoint) -> Perfect:
    """Perfect interface of two substructures of one body."""
    above, below = [cut.parts[number].rows(joint) for number, _ in joint.sides]
    return glued(below, above, cut.macro_basis_of_cut(joint))


class _Adjacent(NamedTuple):
    """Bodies adjacent to pairs of nodes.

    Attributes
    ----------
    bodies, others
        Body above, or to the right, of each pair, and the other one, (n_pairs,);
        `NO_BODY` is the support.
    is_upright
        Whether the joint of each pair is upright, (n_pairs,).
    """

    bodies: Indices
    others: Indices
    is_upright: Flags

    @classmethod
    def of(cls, cut: CutStack, pairs: JointPairs) -> _Adjacent:
        """Bodies adjacent to the pairs of joints."""
        joints = [cut.rectangles.joints[number] for number in pairs.pieces]
        both = [cut.rectangles.bodies(joint) for joint in joints]
        others = [NO_BODY if below is None else below for _, below in both]
        return cls(
            bodies=np.repeat([above for above, _ in both], pairs.counts),
            others=np.repeat(others, pairs.counts),
            is_upright=np.repeat([joint.is_upright for joint in joints], pairs.counts),
        )


def _contact(cut: CutStack, numbers: Sequence[int]) -> Contact:
    """Law of contacts by index: of bodies with the support, or with each other."""
    pairs = JointPairs.of(cut, numbers)
    beside = _Adjacent.of(cut, pairs)
    return contact_of(
        pairs,
        _surface(cut, pairs, beside),
        cut.scales,
        _stiffness_beside(cut.stack, beside),
        [cut.macro_basis(number) for number in pairs.pieces],
    )


def _surface(cut: CutStack, pairs: JointPairs, beside: _Adjacent) -> Surface:
    """Friction and opening of contacts."""
    stack = cut.stack
    support = None
    if beside.others[0] == NO_BODY:
        support = stack.support
    steps: Array = np.where(
        beside.is_upright,
        stack.height / stack.elements[1],
        stack.length / stack.elements[0],
    )
    surface = Surface(
        positions=steps * pairs.places,
        law=stack.friction_law,
        gap=np.zeros(len(steps)),
        friction=_coefficients(stack, support, pairs.places, beside),
    )
    if support is None:
        return surface
    surface = surface._replace(gap=support.gap[pairs.places])
    if support.is_image:
        law = stack.friction_law.of_one_side()
        surface = surface._replace(law=law, slip_ratio=2.0)
    if support.strength is not None:
        scaled = support.strength[pairs.places] / cut.scales.force
        surface = surface._replace(known=scaled * pairs.weights[:, None])
    return surface


def _coefficients(
    stack: Stack, support: Support | None, nodes: Indices, beside: _Adjacent
) -> Array:
    """Coefficient of friction of each pair, (n_pairs,).

    `nodes` are those of the pairs along the grid of all elements, (n_pairs,).
    """
    if support is not None:
        mu = np.asarray(support.friction)
    else:
        mu = np.asarray(stack.friction)
    if mu.ndim < 2:
        mu = np.atleast_2d(mu)
        rows = np.zeros_like(nodes)
    else:
        rows = beside.bodies - 1
    columns = nodes if mu.shape[1] > 1 else 0
    of_pairs = np.asarray(mu[rows, columns])
    if stack.head_friction is not None:
        of_pairs = np.where(beside.is_upright, stack.head_friction, of_pairs)
    if stack.strips and stack.support is not None:
        on_ground = (beside.others >= 0) & (beside.others < stack.strips)
        of_ground = np.broadcast_to(stack.support.friction, stack.grid[0] + 1)
        of_pairs = of_pairs.copy()
        of_pairs[on_ground] = of_ground[nodes[on_ground]]
    return of_pairs


def _stiffness_beside(stack: Stack, beside: _Adjacent) -> BodyStiffness:
    """Moduli and depth of the bodies at contacts, for their search direction."""
    moduli = np.array([stack.modulus(body) for body in range(len(stack.rectangles))])
    rows = np.array([rectangle.rows for rectangle in stack.rectangles])
    depths = stack.height * (rows / stack.elements[1])
    return BodyStiffness(
        above=moduli[beside.bodies],
        below=np.where(beside.others == NO_BODY, np.inf, moduli[beside.others]),
        depth=depths[beside.bodies],
    )


def _spring(cut: CutStack, spring: Spring) -> Contact:
    """Contact law of a spring, which pushes the foot as if it stood on the left."""
    stack = cut.stack
    (number,) = [
        number for number, part in enumerate(cut.parts) if "spring" in part.traces
    ]
    rows = cut.parts[number].rows("spring")
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
        for span in part.traces:
            if not isinstance(span, Span) or span.side != side:
                continue
            for column, component in enumerate(components):
                moved = values_along(cut.rectangles, number, span, given[component])
                if side in ("left", "right"):
                    _move_corners(cut, number, side, component, moved)
                rows.append(part.rows(span)[:, column])
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
    """Overwrite the corners of an upright side with displacements of top and bottom.

    Only where top or bottom prescribe the component; `number` is that of the
    substructure, `moved` the displacement of the side's nodes, (n_nodes, n_instants),
    m.
    """
    sign = 1.0 if side == "right" else -1.0
    spans = [name for name in cut.parts[number].traces if isinstance(name, Span)]
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
