"""The laws of all interfaces of stacked bodies: contacts, cuts, prescribed sides."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy import sparse

from solver.arrays import Array
from solver.discrete.macro import side_basis
from solver.discrete.stack.data import Side, Spring, StackData
from solver.discrete.stack.parts import Part
from solver.discrete.stack.sides import Place, along, neighbour
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

OPPOSITE = {"right": "left", "top": "bottom"}


def interfaces_of(scene: StackData, parts: dict[Place, Part]) -> Iterable[tuple[str, Interface]]:
    """Give all interfaces by name: contacts, then cuts, then prescribed sides."""
    yield from _contacts(scene, parts)
    if scene.spring is not None:
        yield "spring", _spring(scene, scene.spring, parts[scene.substructures[0] - 1, 0, 0])
    for place, part in parts.items():
        for side, opposite in OPPOSITE.items():
            beyond = neighbour(scene, place, side)
            if isinstance(beyond, str) or beyond[2] != place[2]:
                continue
            other = parts[beyond]
            basis = np.asarray(np.kron(_macro_basis(scene, part, side), np.eye(2)))
            yield (
                f"cut {_name(place)} to {_name(beyond)}",
                Perfect(part.rows[side].ravel(), other.rows[opposite].ravel(), basis),
            )
    for side, given in scene.sides.items():
        if given.x.prescribed or given.y.prescribed:
            yield from _prescribed(scene, parts, side, given)


def _name(place: Place) -> str:
    column, row, body = place
    return f"{column + 1}.{row + 1}" + (f" of {body + 1}" if body else "")


def _macro_basis(scene: StackData, part: Part, side: str) -> Array:
    return side_basis(part.rectangle, side, len(part.rows[side]), scene.macro_degree)


def _contacts(scene: StackData, parts: dict[Place, Part]) -> Iterable[tuple[str, Contact]]:
    columns, rows = scene.substructures
    x = np.linspace(0.0, scene.length, scene.order * scene.elements[0] + 1)
    law, scales = scene.friction_law, (scene.length, scene.young * scene.length)
    for body in range(scene.bodies):
        if body == 0 and scene.support is None:
            continue
        above = [parts[column, 0, body] for column in range(columns)]
        under = [parts[column, rows - 1, body - 1] for column in range(columns)] if body else None
        spans = [part.held["bottom"].span for part in above]
        places = [part.corner[0] + np.arange(part.nodes.shape[1]) for part in above]
        weights = [part.rectangle.edge_weights("bottom") for part in above]
        node = np.concatenate([own[span] for own, span in zip(places, spans, strict=True)])
        found, points = np.unique(node, return_inverse=True)
        support = scene.support if body == 0 else None
        gap = np.zeros(len(node)) if support is None else support.gap[node] / scene.length
        upper = np.concatenate([part.rows["bottom"] for part in above])
        lower = None if under is None else np.concatenate([part.rows["top"] for part in under])
        below = np.inf if under is None else scene.modulus(body - 1)
        # Of dense blocks SciPy 1.18 makes a matrix with a warning, and later versions an array.
        bases = [sparse.coo_array(_macro_basis(scene, part, "bottom")) for part in above]
        along, *across = (
            Component(upper[:, axis], None if lower is None else lower[:, axis])
            for axis in range(upper.shape[1])
        )
        areas = scene.length * np.concatenate(
            [own[span] for own, span in zip(weights, spans, strict=True)]
        )
        if support is not None and support.bound is not None:
            known = support.bound[node] / (scene.young * scene.length) * areas[:, None]
            tangential = law.at(along, areas, scales, known=known)
        else:
            friction = scene.friction if support is None else support.friction
            tangential = law.at(along, areas, scales, friction=np.full(len(node), friction))
        normal = None
        if across:
            softness = law.softness_across(areas, scales)
            normal = Unilateral(component=across[0], gap=gap, softness=softness)
        yield (
            "support" if body == 0 else f"contact {body}-{body + 1}",
            Contact(
                normal=normal,
                tangential=tangential,
                points=points,
                positions=x[found],
                weights=areas,
                around=Bodies(moduli=(scene.modulus(body), below), depth=scene.height),
                macro=None if lower is None else sparse.csr_array(sparse.block_diag(bases)),
            ),
        )


def _spring(scene: StackData, spring: Spring, part: Part) -> Contact:
    """Give the law of a spring: it pushes to the right, as if from the left."""
    rows = part.rows["right"]
    return Contact(
        normal=Unilateral(
            component=Component(rows[:, 0]),
            gap=np.array([spring.slack / scene.length]),
            softness=np.array([scene.young / spring.stiffness]),
        ),
        tangential=FrictionLaw().at(Component(rows[:, 1]), np.ones(1), (1.0, 1.0)),
        points=np.zeros(1, dtype=np.intp),
        positions=np.array([scene.length]),
        weights=scene.length * part.rectangle.edge_weights("right")[:1],
        around=PointOfBody(scene.modulus(0)),
    )


def _prescribed(
    scene: StackData, parts: dict[Place, Part], side: str, given: Side
) -> Iterable[tuple[str, Dirichlet]]:
    rows, values = [], []
    for place, part in parts.items():
        if neighbour(scene, place, side) != side or side not in part.held:
            continue
        for number, component in enumerate(part.held[side].components):
            one = (given.x, given.y)[component]
            rows.append(part.rows[side][:, number])
            where = along(scene, part.rectangle, place, part.corner, side, one)
            found = one.mean + where * one.slope
            if side in ("left", "right"):
                _settle_corners(scene, place, side, component, found)
            values.append(found / scene.length)
    if rows:
        yield side, Dirichlet(np.concatenate(rows), np.concatenate(values))


def _settle_corners(
    scene: StackData, place: Place, side: str, component: int, found: Array
) -> None:
    """Let a corner have one displacement, that of the top or bottom, if both sides prescribe it."""
    for level, node in (("bottom", 0), ("top", -1)):
        if neighbour(scene, place, level) != level:
            continue
        other = (scene.sides[level].x, scene.sides[level].y)[component]
        if other.prescribed:
            sign = 1.0 if side == "right" else -1.0
            found[node] = other.mean + sign * other.slope
