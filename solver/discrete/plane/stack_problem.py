"""Discrete problem of bodies in the plane: interface laws at joints and outer sides.

Substructures of one body are glued where they meet. Different bodies, and a body and
the support, are in contact. Contact forces are lumped at the nodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy import sparse
from scipy.linalg import block_diag

from solver.arrays import Array, Indices
from solver.discrete.inside import Inside, RectangularSubstructure
from solver.discrete.plane.bricks import Joint
from solver.discrete.plane.cut_stack import CutStack, Span
from solver.discrete.plane.rigid_stack import rigid_rest, rigid_slide
from solver.discrete.problem import Problem, Scales
from solver.discrete.substructure import Substructure
from solver.laws import (
    BodyStiffness,
    Component,
    Contact,
    Dirichlet,
    Friction,
    FrictionLaw,
    Interface,
    Perfect,
    Unilateral,
)
from solver.laws.friction import compliance_of
from solver.refusal import RefusedError, Words

if TYPE_CHECKING:
    from solver.discrete.plane.stack import Side, Spring, Stack


def problem_of(stack: Stack) -> Problem:
    """Discrete problem of a stack: its substructures, interfaces and inside.

    Raises
    ------
    RefusedError
        If bodies can move though all contacts are closed and stick.
    """
    cut = CutStack(stack)
    scales = Scales(stack.length, stack.young * stack.length, stack.duration)
    inside = Inside(cut.parts, cut.positions, scales, len(stack.instants))
    has_short_joints = any(
        joint.is_upright and not cut.is_within_body(joint) for joint in cut.pairs
    )
    problem = Problem(
        substructures=tuple(
            _substructure(part, dofs)
            for part, dofs in zip(cut.parts, inside.dofs, strict=True)
        ),
        interfaces=dict(_interfaces(cut)),
        positions=inside.positions * scales.displacement,
        instants=stack.instants,
        scales=scales,
        inside=inside,
        rest=_rest(stack, inside),
        has_short_joints=has_short_joints,
    )
    if problem.is_loose:
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


def _substructure(part: RectangularSubstructure, dofs: Indices) -> Substructure:
    """Substructure of a rectangular part, with its degrees of freedom, (n_kept,)."""
    body_force = None
    if part.force is not None:
        body_force = part.condensed.condense(part.force)
    return Substructure(
        elasticity=part.elasticity,
        dofs=dofs,
        rows=np.concatenate([rows.ravel() for rows in part.rows.values()]),
        body_force=body_force,
    )


def _rest(stack: Stack, inside: Inside) -> Array | None:
    """Displacement of the body that rests on its support, (n_dofs, n_instants), scaled.

    None where the body has not to be brought onto its support.
    """
    rigid = rigid_rest(stack)
    if rigid is None:
        return None
    x, y = inside.positions.T
    components = inside.components
    modes = np.stack([components, np.where(components == 1, x, -y)], axis=1)
    rest = np.asarray(modes @ (rigid / np.array([[stack.length], [1.0]])))
    if stack.spring is not None:
        slide = rigid_slide(stack, stack.spring) / stack.length
        rest += np.outer(components == 0, slide)
    return rest


def _interfaces(cut: CutStack) -> Iterator[tuple[str, Interface]]:
    """All interfaces by name: contacts, then cuts, then prescribed sides."""
    stack = cut.stack
    contacts = dict[str, list[Joint]]()
    cuts = list[Joint]()
    for joint in cut.pairs:
        if cut.is_within_body(joint):
            cuts.append(joint)
        else:
            contacts.setdefault(cut.name(joint), []).append(joint)
    for name, joints in contacts.items():
        yield name, _contact(cut, joints)
    if stack.spring is not None:
        yield "spring", _spring(cut, stack.spring)
    # By the substructure below; upright cuts before lying ones.
    cuts.sort(key=lambda joint: (joint.sides[1][0], not joint.is_upright))
    for joint in cuts:
        yield cut.name(joint), _glued(cut, joint)
    # A corner that two sides prescribe is held by the first: as `_prescribed` moves it.
    for side in ("top", "bottom", "left", "right"):
        given = stack.sides[side]
        if _is_moved(given):
            yield from _prescribed(cut, side, given)


def _glued(cut: CutStack, joint: Joint) -> Perfect:
    """Perfect interface of two substructures of one body."""
    rows_above, rows_below = _rows_of(cut, [joint])
    macro = np.asarray(np.kron(cut.basis(joint, 1), np.eye(2)))
    return Perfect(rows_below.ravel(), rows_above.ravel(), macro)


class _Pairs(NamedTuple):
    """Pairs of nodes of a contact.

    Attributes
    ----------
    joints
        Joints of the contact, one after the other.
    body, under
        Body above, or to the right, and the other one; None is the support.
    nodes
        Node of each pair on the grid of all elements, along the contact, (n_pairs,).
    areas
        Tributary area of each pair for a metre of thickness, (n_pairs,), m^2.
    """

    joints: Sequence[Joint]
    body: int
    under: int | None
    nodes: Indices
    areas: Array


def _contact(cut: CutStack, joints: Sequence[Joint]) -> Contact:
    """Contact of a body with the body, or support, below it or to its left."""
    stack = cut.stack
    body, under = cut.bodies(joints[0])
    grid_nodes = [cut.pairs[joint][0] for joint in joints]
    lengths = [cut.pairs[joint][1] for joint in joints]
    pairs = _Pairs(
        joints=joints,
        body=body,
        under=under,
        nodes=np.concatenate(grid_nodes),
        areas=stack.length * np.concatenate(lengths),
    )
    support = None
    if under is None:
        support = stack.support
    gap = np.zeros(len(pairs.nodes))
    if support is not None:
        gap = support.gap[pairs.nodes] / stack.length
    touching, points = np.unique(pairs.nodes, return_inverse=True)
    is_upright = joints[0].is_upright
    tangent, normal = _components(cut, joints)
    return Contact(
        normal=_normal_law(stack, normal, pairs, gap),
        tangential=_friction(stack, tangent, pairs, gap),
        points=points,
        positions=touching.astype(float) * _element_size(stack, is_upright=is_upright),
        weights=pairs.areas,
        stiffness_beside=_stiffness_beside(stack, pairs),
        macro=_macro_basis(cut, joints),
        slip_ratio=2.0 if support is not None and support.is_image else 1.0,
    )


def _element_size(stack: Stack, *, is_upright: bool) -> float:
    """Length, or height, of an element, m."""
    if is_upright:
        return stack.height / stack.elements[1]
    return stack.length / stack.elements[0]


def _components(
    cut: CutStack, joints: Sequence[Joint]
) -> tuple[Component, Component | None]:
    """Tangential and normal component of a contact; no normal one at a known bound."""
    rows = _rows_of(cut, joints)
    tangential = int(joints[0].is_upright)
    along = [rows_of_side[:, tangential] for rows_of_side in rows]
    tangent = Component(*along)
    has_normal = rows[0].shape[1] > 1
    if not has_normal:
        return tangent, None
    across = [rows_of_side[:, 1 - tangential] for rows_of_side in rows]
    return tangent, Component(*across)


def _normal_law(
    stack: Stack, component: Component | None, pairs: _Pairs, gap: Array
) -> Unilateral | None:
    """Unilateral law across a contact, with its opening, (n_pairs,), scaled."""
    if component is None:
        return None
    scales = (stack.length, stack.young * stack.length)
    compliance = compliance_of(stack.friction_law.normal_stiffness, pairs.areas, scales)
    return Unilateral(component=component, gap=gap, compliance=compliance)


def _friction(
    stack: Stack, component: Component, pairs: _Pairs, gap: Array
) -> Friction:
    """Friction law along a contact, whose opening is `gap`, (n_pairs,), scaled."""
    scales = (stack.length, stack.young * stack.length)
    law = stack.friction_law
    support = None
    if pairs.under is None:
        support = stack.support
    if support is not None and support.is_image:
        law = law.of_one_side()
    if support is not None and support.bound is not None:
        scaled = support.bound[pairs.nodes] / (stack.young * stack.length)
        known = scaled * pairs.areas[:, None]
        return law.at(component, pairs.areas, scales, known=known)
    mu = _coefficients(stack, pairs)
    friction = law.at(component, pairs.areas, scales, friction=mu)
    # Nothing is bonded across a gap.
    is_closed = (gap <= 0.0)[:, None]
    return replace(friction, bound=friction.bound * is_closed)


def _coefficients(stack: Stack, pairs: _Pairs) -> Array:
    """Coefficient of friction of each pair, (n_pairs,)."""
    if pairs.under is None and stack.support is not None:
        mu = np.asarray(stack.support.friction)
    else:
        mu = np.asarray(stack.friction)
    if mu.ndim == 2:
        mu = mu[pairs.body - 1]
    if mu.size > 1:
        mu = mu[pairs.nodes]
    return np.broadcast_to(mu, pairs.nodes.shape)


def _stiffness_beside(stack: Stack, pairs: _Pairs) -> BodyStiffness:
    """Moduli and depth of the bodies at a contact, for its search direction."""
    below = np.inf
    if pairs.under is not None:
        below = stack.modulus(pairs.under)
    depth = stack.height * (stack.rectangles[pairs.body].rows / stack.elements[1])
    return BodyStiffness(moduli=(stack.modulus(pairs.body), below), depth=depth)


def _macro_basis(cut: CutStack, joints: Sequence[Joint]) -> sparse.csr_array | None:
    """Macro basis of one component, (n_pairs, n_macro), or None."""
    if not cut.has_macro(joints[0]):
        return None
    bases = [cut.basis(joint, 0) for joint in joints]
    # Most joints of a wall have one part, and SciPy takes long for one block.
    if len(bases) == 1:
        return sparse.csr_array(bases[0])
    return sparse.csr_array(block_diag(*bases))


def _rows_of(cut: CutStack, joints: Sequence[Joint]) -> list[Indices]:
    """Boundary rows of each side of joints, the one above first.

    Each has shape (n_points, n_components); a support has no rows.
    """
    n_sides = len(joints[0].sides)
    return [_rows_of_side(cut, joints, side) for side in range(n_sides)]


def _rows_of_side(cut: CutStack, joints: Sequence[Joint], side: int) -> Indices:
    """Boundary rows of side 0 (above) or 1 of joints, (n_points, n_components)."""
    numbers = [joint.sides[side][0] for joint in joints]
    rows = [
        cut.parts[number].rows[joint]
        for number, joint in zip(numbers, joints, strict=True)
    ]
    return np.concatenate(rows)


def _spring(cut: CutStack, spring: Spring) -> Contact:
    """Contact of a spring, which pushes the foot to the right as if from the left."""
    stack = cut.stack
    (part,) = [part for part in cut.parts if "spring" in part.rows]
    rows = part.rows["spring"]
    areas = part.rectangle.edge_weights("right")
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
        stiffness_beside=BodyStiffness(moduli=(stack.modulus(0), np.inf)),
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
                    _move_corners(cut, part, side, component, moved)
                rows.append(of_span[:, column])
                values.append(moved / cut.stack.length)
    if rows:
        yield side, Dirichlet(np.concatenate(rows), np.concatenate(values))


def _move_corners(
    cut: CutStack,
    part: RectangularSubstructure,
    side: str,
    component: int,
    moved: Array,
) -> None:
    """Write the displacement of top and bottom into the corners of an upright side.

    Only where top or bottom prescribe the component; `moved` is the displacement of the
    side's nodes, (n_nodes, n_instants), m.
    """
    sign = 1.0 if side == "right" else -1.0
    spans = [name for name in part.rows if isinstance(name, Span)]
    for level, corner in (("bottom", 0), ("top", -1)):
        given = cut.stack.sides[level][component]
        on_level = [span for span in spans if span.side == level]
        if side == "right":
            columns = part.rectangle.columns
            is_prescribed = any(span.last == columns for span in on_level)
        else:
            is_prescribed = any(span.first == 0 for span in on_level)
        if given.prescribed and is_prescribed:
            moved[corner] = given.mean + sign * given.slope
