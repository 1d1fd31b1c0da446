"""Bodies in the plane as a discrete problem: the laws of the joints and sides of cut bodies.

Substructures of one body are glued where they meet; other bodies, and the support, are
in contact. Contact forces are lumped at the nodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse
from scipy.linalg import block_diag

from solver.arrays import Array, Indices
from solver.discrete.inside import Inside
from solver.discrete.plane.bricks import Joint
from solver.discrete.plane.cut_stack import CutStack
from solver.discrete.plane.rigid_stack import rigid_rest, rigid_slide
from solver.discrete.problem import Problem, Scales
from solver.discrete.substructure import Substructure
from solver.laws import (
    Bodies,
    Component,
    Contact,
    Dirichlet,
    FrictionLaw,
    Interface,
    Perfect,
    Unilateral,
)
from solver.laws.friction import softness_of

if TYPE_CHECKING:
    from solver.discrete.plane.stack import Side, Spring, Stack


def problem_of(stack: Stack) -> Problem:
    """The discrete problem of bodies in the plane."""
    cut = CutStack(stack)
    scales = Scales(stack.length, stack.young * stack.length, stack.duration)
    inside = Inside(cut.parts, cut.positions, scales, len(stack.instants))
    return Problem(
        substructures=tuple(
            Substructure(
                elasticity=part.elasticity,
                dofs=dofs,
                rows=np.concatenate([own.ravel() for own in part.rows.values()]),
                body_force=None
                if part.force is None
                else part.condensed.condense(part.force),
            )
            for part, dofs in zip(cut.parts, inside.dofs, strict=True)
        ),
        interfaces=dict(_interfaces(cut)),
        positions=inside.places * scales.displacement,
        instants=stack.instants,
        scales=scales,
        inside=inside,
        rest=_rest(stack, inside),
        has_short_joints=any(
            joint.is_upright and len(set(cut.bodies(joint))) > 1 for joint in cut.pairs
        ),
    )


def _rest(stack: Stack, inside: Inside) -> Array | None:
    """Displacement of degrees of freedom where the body rests, (n_dofs, n_instants), scaled."""
    rigid = rigid_rest(stack)
    if rigid is None:
        return None
    (x, y) = inside.places.T
    components = inside.components
    modes = np.stack([components, np.where(components == 1, x, -y)], axis=1)
    rest = np.asarray(modes @ (rigid / np.array([[stack.length], [1.0]])))
    if stack.spring is not None:
        rest += np.outer(
            components == 0, rigid_slide(stack, stack.spring) / stack.length
        )
    return rest


def _interfaces(cut: CutStack) -> Iterator[tuple[str, Interface]]:
    """All interfaces by name: contacts, then cuts, then prescribed sides."""
    stack = cut.stack
    contacts = dict[str, list[Joint]]()
    cuts = list[Joint]()
    for joint in cut.pairs:
        above, below = cut.bodies(joint)
        if above == below:
            joints = cuts
        else:
            joints = contacts.setdefault(cut.name(joint), [])
        joints.append(joint)
    for name, joints in contacts.items():
        yield name, _contact(cut, joints)
    if stack.spring is not None:
        yield "spring", _spring(cut, stack.spring)
    for joint in sorted(cuts, key=lambda one: (one.sides[1][0], not one.is_upright)):
        rows_above, rows_below = _rows_of(cut, [joint])
        macro = np.asarray(np.kron(cut.basis(joint, 1), np.eye(2)))
        yield cut.name(joint), Perfect(rows_below.ravel(), rows_above.ravel(), macro)
    # A corner that two sides prescribe is held by the first: as `_prescribed` moves it.
    for side in ("top", "bottom", "left", "right"):
        given = stack.sides[side]
        if any(one.prescribed for one in given):
            yield from _prescribed(cut, side, given)


def _contact(cut: CutStack, joints: Sequence[Joint]) -> Contact:
    """Law of a body on what is below or to the left of it."""
    stack = cut.stack
    axis = int(joints[0].is_upright)
    (body, under) = cut.bodies(joints[0])
    node, weights = map(
        np.concatenate, zip(*(cut.pairs[one] for one in joints), strict=True)
    )
    touching, points = np.unique(node, return_inverse=True)
    support = stack.support if under is None else None
    if support is None:
        gap = np.zeros(len(node))
    else:
        gap = support.gap[node] / stack.length
    rows = _rows_of(cut, joints)
    along, *across = (
        Component(*(own[:, one] for own in rows))
        for one in (axis, 1 - axis)[: rows[0].shape[1]]
    )
    areas = stack.length * weights
    law = stack.friction_law
    scales = (stack.length, stack.young * stack.length)
    is_image = support is not None and support.is_image
    if is_image:
        law = law.of_one_side()
    if support is not None and support.bound is not None:
        known = support.bound[node] / (stack.young * stack.length) * areas[:, None]
        friction = law.at(along, areas, scales, known=known)
    else:
        mu = np.asarray(stack.friction if support is None else support.friction)
        if mu.ndim == 2:
            of_each = mu[body - 1]
        else:
            of_each = mu
        mu = np.broadcast_to(of_each[node] if of_each.size > 1 else of_each, node.shape)
        friction = law.at(along, areas, scales, friction=mu)
        # Nothing is bonded across a gap.
        friction = replace(friction, bound=friction.bound * (gap <= 0.0)[:, None])
    normal = None
    if across:
        softness = softness_of(law.normal_stiffness, areas, scales)
        normal = Unilateral(component=across[0], gap=gap, softness=softness)
    macro = None
    if cut.has_macro(joints[0]):
        bases = [cut.basis(joint, 0) for joint in joints]
        # Most joints of a wall have one part, and SciPy takes long for one block.
        macro = sparse.csr_array(bases[0] if len(bases) == 1 else block_diag(*bases))
    size = (stack.length, stack.height)[axis]
    return Contact(
        normal=normal,
        tangential=friction,
        points=points,
        positions=touching * (size / stack.elements[axis]),
        weights=areas,
        around=Bodies(
            moduli=(
                stack.modulus(body),
                np.inf if under is None else stack.modulus(under),
            ),
            depth=stack.height * (stack.rectangles[body].rows / stack.elements[1]),
        ),
        macro=macro,
        slip_ratio=2.0 if is_image else 1.0,
    )


def _rows_of(cut: CutStack, joints: Sequence[Joint]) -> list[Indices]:
    """Rows of each side of joints in a row, the one above first, (n_points, n_components)."""
    return [
        np.concatenate([cut.parts[one.sides[which][0]].rows[one] for one in joints])
        for which in range(len(joints[0].sides))
    ]


def _spring(cut: CutStack, spring: Spring) -> Contact:
    """Law of a spring: it pushes to the right, as if from the left."""
    stack = cut.stack
    (part,) = (part for part in cut.parts if "spring" in part.rows)
    rows = part.rows["spring"]
    sides = part.rectangle.edge_weights("right")
    return Contact(
        normal=Unilateral(
            component=Component(rows[:, 0]),
            gap=np.array([spring.slack / stack.length]),
            softness=np.array([stack.young / spring.stiffness]),
        ),
        tangential=FrictionLaw().at(Component(rows[:, 1]), np.ones(1), (1.0, 1.0)),
        points=np.zeros(1, dtype=np.intp),
        positions=np.array([stack.length]),
        weights=stack.length * sides[:1],
        around=Bodies(moduli=(stack.modulus(0), np.inf)),
        is_spring=True,
    )


def _prescribed(
    cut: CutStack, side: str, given: Side
) -> Iterator[tuple[str, Dirichlet]]:
    """Law of a side whose displacement is given.

    A corner has the displacement of the top or bottom, if both sides prescribe one.
    """
    rows = []
    values = []
    components = [component for component, one in enumerate(given) if one.prescribed]
    for number, part in enumerate(cut.parts):
        if side not in part.rows:
            continue
        for column, component in enumerate(components):
            moved = cut.values(number, side, given[component])
            if side in ("left", "right"):
                corners = {"bottom": 0, "top": -1}
            else:
                corners = {}
            for level, corner in corners.items():
                other = cut.stack.sides[level][component]
                if level in part.rows and other.prescribed:
                    sign = 1.0 if side == "right" else -1.0
                    moved[corner] = other.mean + sign * other.slope
            rows.append(part.rows[side][:, column])
            values.append(moved / cut.stack.length)
    if rows:
        yield side, Dirichlet(np.concatenate(rows), np.concatenate(values))
