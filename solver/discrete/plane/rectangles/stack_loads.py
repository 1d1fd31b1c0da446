"""Loads on the rectangles into which a stack is cut: tractions and weight."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from solver.arrays import Array, read_only
from solver.discrete.condensed_part import PartForce
from solver.discrete.elements import EDGE_MASS, Rectangle
from solver.discrete.plane.rectangles.cut_rectangles import CutRectangles, Span
from solver.discrete.plane.rectangles.sides import SideComponent


def values_along(
    rectangles: CutRectangles, number: int, span: Span, given: SideComponent
) -> Array:
    """Prescribed displacement or traction at the nodes of a span of an outer side.

    The span is of the rectangle of that number; shape (n_nodes, n_instants), m or Pa.
    """
    stack = rectangles.stack
    rectangle, body, _ = rectangles.each[number]
    if span.side in ("left", "right"):
        brick = stack.rectangles[body]
        corner = rectangle.y - brick.y
        whole = brick.rows
    else:
        corner = rectangle.x
        whole = stack.grid[0]
    mean = given.mean
    if mean.ndim > 1:
        mean = mean[body]
    nodes = corner + np.arange(span.first, span.last + 1)[:, None]
    return np.asarray(mean + (2.0 * nodes / whole - 1.0) * given.slope)


class StackLoads:
    """Nodal forces of tractions and weight on rectangles, scaled.

    Equal rectangles share the forces of the weight.
    """

    def __init__(self, rectangles: CutRectangles) -> None:
        self._rectangles = rectangles
        self._stack = rectangles.stack
        self._weight = cache(self._weight_of)

    def of(self, number: int, mesh: Rectangle) -> PartForce | None:
        """Forces on the nodes of a rectangle by its index, or None."""
        stack = self._stack
        weight = None
        if self._rectangles.body_of(number) >= stack.strips:
            weight = self._weight(mesh)
        tractions = list(self._tractions(number))
        if not tractions:
            return weight
        total = np.zeros((mesh.n_nodes, 2, len(stack.instants)))
        for span, component, given in tractions:
            traction = values_along(self._rectangles, number, span, given)
            scaled = traction / stack.young
            _add_traction(total[:, component], mesh, span, scaled)
        force = total.reshape(-1, len(stack.instants))
        if weight is not None:
            force += weight.patterns
        if force.any():
            return PartForce.over_time(force)
        return None

    def _tractions(self, number: int) -> Iterator[tuple[Span, int, SideComponent]]:
        """Yield tractions on outer sides of a rectangle, with their spans and axes."""
        for span in self._rectangles.outer[number]:
            for component, given in enumerate(self._stack.sides[span.side]):
                if not given.prescribed and not given.is_zero:
                    yield span, component, given

    def _weight_of(self, mesh: Rectangle) -> PartForce | None:
        """Nodal forces of the weight, with a pattern for each instant, or None."""
        stack = self._stack
        if stack.body_force is None:
            return None
        areas = np.outer(mesh.edge_weights("left"), mesh.edge_weights("bottom"))
        density = stack.body_force * stack.length / stack.young
        # Zero is added so that -0 is 0.
        force = areas.reshape(-1, 1, 1) * density + 0.0
        if not force.any():
            return None
        return PartForce.over_time(read_only(force.reshape(-1, len(stack.instants))))


def _add_traction(force: Array, mesh: Rectangle, span: Span, traction: Array) -> None:
    """Add nodal forces of a traction on a span of a side to those of all nodes.

    `force` is (n_nodes, n_instants), `traction` that of the nodes of the span, (nodes
    along, n_instants); both scaled, of one component.
    """
    nodes = mesh.edge(span.side)[span.first : span.last + 1]
    size = mesh.height if span.side in ("left", "right") else mesh.width
    ends = np.arange(len(nodes) - 1)[:, None] + np.arange(2)
    of_edges = size * np.matmul(EDGE_MASS, traction[ends])
    np.add.at(force, nodes[ends], of_edges)
