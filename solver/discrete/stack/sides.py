"""What lies beyond and along the sides of a substructure of stacked bodies."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.elements import edge_mass
from solver.discrete.plane import Rectangle
from solver.discrete.stack.data import Given, StackData

Place = tuple[int, int, int]
"""Column and row of a substructure in its body, and the body."""
Corner = tuple[int, int]
"""First column and row of its nodes in its body."""


def neighbour(scene: StackData, place: Place, side: str) -> str | Place:
    """Tell what lies beyond a side: a substructure, "support", or the name of an outer side."""
    column, row, body = place
    columns, rows = scene.substructures
    if side in ("left", "right"):
        beyond = column + (1 if side == "right" else -1)
        return (beyond, row, body) if 0 <= beyond < columns else side
    step = 1 if side == "top" else -1
    if 0 <= row + step < rows:
        return column, row + step, body
    if 0 <= body + step < scene.bodies:
        return column, 0 if step > 0 else rows - 1, body + step
    return "support" if side == "bottom" and scene.support is not None else side


def along(
    scene: StackData, rectangle: Rectangle, place: Place, corner: Corner, side: str, given: Given
) -> Array:
    """Give 2 s / length - 1 at the nodes of a substructure on an outer side, (n_nodes, 1)."""
    if side in ("left", "right"):
        body, bodies = (0, 1) if given.each_body else (place[2], scene.bodies)
        height = scene.order * scene.elements[1]
        whole, first = bodies * height, body * height + corner[1]
    else:
        whole, first = scene.order * scene.elements[0], corner[0]
    count = len(rectangle.edge(side))
    return np.asarray(2.0 * (first + np.arange(count)[:, None]) / whole - 1.0)


def nodal_force(
    scene: StackData, rectangle: Rectangle, place: Place, corner: Corner
) -> Array | None:
    """Give nodal forces of tractions and body forces, scaled, (2 n_nodes, n), None without any.

    Tractions vary linearly along a side, body forces are constant; both are work equivalent.
    """
    order = rectangle.order
    total = np.zeros((rectangle.n_nodes, 2, len(scene.instants)))
    for side in ("left", "right", "bottom", "top"):
        if neighbour(scene, place, side) != side:
            continue
        nodes = rectangle.edge(side)
        step = rectangle.height if side in ("left", "right") else rectangle.width
        edges = np.arange(0, len(nodes) - 1, order)[:, None] + np.arange(order + 1)
        for component, given in enumerate((scene.sides[side].x, scene.sides[side].y)):
            if given.prescribed:
                continue
            where = along(scene, rectangle, place, corner, side, given)
            traction = (given.mean + where * given.slope) / scene.young
            force = step * np.matmul(edge_mass(order), traction[edges])
            np.add.at(total[:, component], nodes[edges], force)
    if scene.body_force is not None:
        areas = np.outer(rectangle.edge_weights("left"), rectangle.edge_weights("bottom"))
        density = scene.body_force * scene.length / scene.young
        total += areas.reshape(-1, 1, 1) * density
    return total.reshape(-1, len(scene.instants)) if total.any() else None
