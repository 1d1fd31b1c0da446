"""Stacked bodies as a discrete problem: laws of contacts, cuts and prescribed sides."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.cut_stack import CutStack, Place
from solver.discrete.plane import side_basis
from solver.discrete.plane_parts import lined_up, number_rows, problem_of
from solver.discrete.problem import Problem, Scales
from solver.discrete.rigid_stack import rigid_rest, rigid_slide
from solver.laws import (
    Bodies,
    Component,
    Contact,
    Dirichlet,
    FrictionLaw,
    Interface,
    Perfect,
    PointOfBody,
    Unilateral,
)

if TYPE_CHECKING:
    from solver.discrete.stack import Side, Spring, Stack

OPPOSITE = {"right": "left", "top": "bottom"}


def discretise_stack(stack: Stack) -> Problem:
    """Cut the bodies into rectangles and write the laws of their interfaces.

    Lengths are scaled by the length of a body, stresses by E. Tractions act on the substructures
    themselves, and need no interface. Contact forces are lumped at the nodes.
    """
    cut = CutStack(stack)
    parts = list(cut.parts.values())
    skeleton = number_rows(parts)
    return problem_of(
        parts,
        skeleton,
        cut.positions,
        dict(_interfaces(cut)),
        scales=Scales(stack.length, stack.young * stack.length, stack.duration),
        instants=stack.instants,
        rest=_rest(stack, cut.positions[skeleton // 2], skeleton % 2),
    )


def _rest(stack: Stack, positions: Array, components: Indices) -> Array | None:
    """Displacement of degrees of freedom where the body rests, (n_dofs, n_instants), scaled."""
    rigid = rigid_rest(stack)
    if rigid is None:
        return None
    x, y = positions.T
    modes = np.stack([components, np.where(components == 1, x, -y)], axis=1)
    rest = np.asarray(modes @ (rigid / np.array([[stack.length], [1.0]])))
    if stack.spring is not None:
        rest += np.outer(components == 0, rigid_slide(stack, stack.spring) / stack.length)
    return rest


def _interfaces(cut: CutStack) -> Iterator[tuple[str, Interface]]:
    """All interfaces by name: contacts, then cuts, then prescribed sides."""
    stack = cut.stack
    for body in range(stack.bodies):
        if body or stack.support is not None:
            yield "support" if body == 0 else f"contact {body}-{body + 1}", _contact(cut, body)
    if stack.spring is not None:
        yield "spring", _spring(cut, stack.spring)
    for place, part in cut.parts.items():
        for side, opposite in OPPOSITE.items():
            beyond = cut.neighbour(place, side)
            if isinstance(beyond, str) or beyond[2] != place[2]:
                continue
            rows, other = part.rows[side], cut.parts[beyond].rows[opposite]
            basis = side_basis(part.rectangle, side, len(rows), stack.macro_degree)
            macro = np.asarray(np.kron(basis, np.eye(2)))
            name = f"cut {_name(place)} to {_name(beyond)}"
            yield name, Perfect(rows.ravel(), other.ravel(), macro)
    for side, given in stack.sides.items():
        if any(one.prescribed for one in given):
            yield from _prescribed(cut, side, given)


def _name(place: Place) -> str:
    column, row, body = place
    return f"{column + 1}.{row + 1}" + (f" of {body + 1}" if body else "")


def _contact(cut: CutStack, body: int) -> Contact:
    """Law of a body on the one below it, or of the lowest on its support."""
    stack, rows = cut.stack, cut.stack.substructures[1]
    columns = min(cut.columns[max(body - 1, 0) : body + 1])
    above = [cut.parts[column, 0, body] for column in range(columns)]
    upper, weights, macro = lined_up(above, "bottom", stack.macro_degree)
    lower, below = None, np.inf
    if body:
        under = [cut.parts[column, rows - 1, body - 1] for column in range(columns)]
        lower = np.concatenate([part.rows["top"] for part in under])
        below = stack.modulus(body - 1)
    spans = [part.nodes[0, part.traces["bottom"].span] for part in above]
    node = np.concatenate(spans) - cut.nodes[body][0, 0]
    x = np.linspace(0.0, stack.length, stack.order * stack.elements[0] + 1)
    touching, points = np.unique(node, return_inverse=True)
    support = None if body else stack.support
    gap = np.zeros(len(node)) if support is None else support.gap[node] / stack.length
    along, *across = (
        Component(upper[:, axis], None if lower is None else lower[:, axis])
        for axis in range(upper.shape[1])
    )
    areas = stack.length * weights
    law, scales = stack.friction_law, (stack.length, stack.young * stack.length)
    if support is not None and support.bound is not None:
        known = support.bound[node] / (stack.young * stack.length) * areas[:, None]
        friction = law.at(along, areas, scales, known=known)
    else:
        mu = stack.friction if support is None else support.friction
        along_each = np.broadcast_to(mu, (max(stack.bodies - 1, 1), len(x)))
        mu = along_each[max(body - 1, 0), node]
        friction = law.at(along, areas, scales, friction=mu)
        # Nothing is bonded across a gap.
        friction = replace(friction, bound=friction.bound * (gap <= 0.0)[:, None])
    normal = None
    if across:
        softness = law.softness_across(areas, scales)
        normal = Unilateral(component=across[0], gap=gap, softness=softness)
    return Contact(
        normal=normal,
        tangential=friction,
        points=points,
        positions=x[touching],
        weights=areas,
        around=Bodies(moduli=(stack.modulus(body), below), depth=stack.height),
        macro=None if lower is None else macro,
    )


def _spring(cut: CutStack, spring: Spring) -> Contact:
    """Law of a spring: it pushes to the right, as if from the left."""
    stack = cut.stack
    part = cut.parts[stack.substructures[0] - 1, 0, 0]
    rows = part.rows["right"]
    return Contact(
        normal=Unilateral(
            component=Component(rows[:, 0]),
            gap=np.array([spring.slack / stack.length]),
            softness=np.array([stack.young / spring.stiffness]),
        ),
        tangential=FrictionLaw().at(Component(rows[:, 1]), np.ones(1), (1.0, 1.0)),
        points=np.zeros(1, dtype=np.intp),
        positions=np.array([stack.length]),
        weights=stack.length * part.traces["right"].weights(part.rectangle),
        around=PointOfBody(stack.modulus(0)),
    )


def _prescribed(cut: CutStack, side: str, given: Side) -> Iterator[tuple[str, Dirichlet]]:
    rows, values = [], []
    for place, part in cut.parts.items():
        if cut.neighbour(place, side) != side or side not in part.traces:
            continue
        for number, component in enumerate(part.traces[side].components):
            one = given[component]
            rows.append(part.rows[side][:, number])
            moved = one.mean + cut.along(place, side, one) * one.slope
            if side in ("left", "right"):
                _settle_corners(cut, place, side, component, moved)
            values.append(moved / cut.stack.length)
    if rows:
        yield side, Dirichlet(np.concatenate(rows), np.concatenate(values))


def _settle_corners(cut: CutStack, place: Place, side: str, component: int, moved: Array) -> None:
    """Let a corner have one displacement, that of the top or bottom, if both sides prescribe it."""
    for level, node in (("bottom", 0), ("top", -1)):
        if cut.neighbour(place, level) != level:
            continue
        other = cut.stack.sides[level][component]
        if other.prescribed:
            sign = 1.0 if side == "right" else -1.0
            moved[node] = other.mean + sign * other.slope
