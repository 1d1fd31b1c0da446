"""Stacked bodies that are cut into rectangles: what lies beyond their sides, and acts on them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.cut_rods import substructure_sizes
from solver.discrete.elements import edge_mass, elastic_matrix
from solver.discrete.plane import Condensed, Rectangle
from solver.discrete.plane_parts import Part, Trace, keep

if TYPE_CHECKING:
    from solver.discrete.stack import Given, Stack

SIDES = "left", "right", "bottom", "top"
Place = tuple[int, int, int]
"""Column and row of a substructure in its body, and the body."""


def ends_along(elements: int, cuts: int, spans: Sequence[int]) -> Indices:
    """Where substructures end along bodies, in elements: at the cuts, and where a body ends."""
    return np.union1d(np.cumsum(substructure_sizes(elements, cuts)), spans)


class CutStack:
    """The bodies of a stack, cut into substructures.

    Attributes
    ----------
    nodes
        Number of every node, shape (nodes up, nodes along) for each body.
    positions
        Of all nodes, shape (n_nodes, 2), in lengths of a body.
    columns
        Number of substructures along every body.
    parts
        All substructures by their place, body by body and row by row. Equal ones share what is
        condensed; their rows are still to be numbered.
    """

    def __init__(self, stack: Stack) -> None:
        self.stack = stack
        (along, up), cuts = stack.elements, stack.substructures
        spans = [along] * stack.bodies if stack.spans is None else stack.spans
        height, rows = stack.height / stack.length, stack.order * up
        x = np.linspace(0.0, 1.0, stack.order * along + 1)
        self.nodes: list[Indices] = []
        positions, first = [], 0
        for body, span in enumerate(spans):
            y = body * height + np.linspace(0.0, height, rows + 1)
            everywhere = np.meshgrid(x[: stack.order * span + 1], y)
            positions.append(np.stack(everywhere, axis=-1).reshape(-1, 2))
            shape = everywhere[0].shape
            self.nodes.append(first + np.arange(shape[0] * shape[1]).reshape(shape))
            first += shape[0] * shape[1]
        self.positions = np.concatenate(positions)
        ends = ends_along(along, cuts[0], spans)
        self.columns = [int(np.searchsorted(ends, span)) + 1 for span in spans]
        self._across = stack.order * np.append(0, ends)
        self._up = stack.order * np.append(0, np.cumsum(substructure_sizes(up, cuts[1])))
        self._outlines: dict[tuple[int, int, float], Condensed] = {}
        self._kept: dict[tuple[object, ...], Condensed] = {}
        self.parts = {
            (column, row, body): self._part((column, row, body))
            for body in range(stack.bodies)
            for row in range(stack.substructures[1])
            for column in range(self.columns[body])
        }

    def neighbour(self, place: Place, side: str) -> str | Place:
        """What lies beyond a side: a substructure, "support", or the name of an outer side.

        That of the end of a shorter body is "end".
        """
        column, row, body = place
        rows = self.stack.substructures[1]
        if side in ("left", "right"):
            beyond = column + (1 if side == "right" else -1)
            if 0 <= beyond < self.columns[body]:
                return beyond, row, body
            return "end" if 0 < beyond < max(self.columns) else side
        step = 1 if side == "top" else -1
        if 0 <= row + step < rows:
            return column, row + step, body
        if 0 <= body + step < self.stack.bodies and column < self.columns[body + step]:
            return column, 0 if step > 0 else rows - 1, body + step
        return "support" if side == "bottom" and self.stack.support is not None else side

    def along(self, place: Place, side: str, given: Given) -> Array:
        """2 s / length - 1 at the nodes of a substructure on an outer side, (n_nodes, 1)."""
        column, row, body = place
        if side in ("left", "right"):
            body, bodies = (0, 1) if given.each_body else (body, self.stack.bodies)
            height = self.stack.order * self.stack.elements[1]
            whole, first, last = bodies * height, self._up[row], self._up[row + 1]
            first, last = body * height + first, body * height + last
        else:
            whole = self.stack.order * self.stack.elements[0]
            first, last = self._across[column], self._across[column + 1]
        return np.asarray(2.0 * np.arange(first, last + 1)[:, None] / whole - 1.0)

    def _part(self, place: Place) -> Part:
        stack, (column, row, body) = self.stack, place
        x, right = self._across[column : column + 2]
        y, top = self._up[row : row + 2]
        shape = int(right - x), int(top - y), stack.modulus(body)
        if shape not in self._outlines:
            elastic = elastic_matrix(shape[2], stack.poisson, stack.state)
            size = shape[0] // stack.order, shape[1] // stack.order
            width = 1.0 / stack.elements[0]
            height = stack.height / stack.length / stack.elements[1]
            mesh = Rectangle(*size, width, height, elastic, stack.order)
            self._outlines[shape] = Condensed(mesh)
        traces = {side: trace for side in SIDES if (trace := self._trace(place, side))}
        kind = shape, *traces.values()
        if kind not in self._kept:
            self._kept[kind] = keep(self._outlines[shape], traces.values())
        return Part(
            condensed=self._kept[kind],
            nodes=self.nodes[body][y : top + 1, x : right + 1],
            body=body,
            traces=traces,
            modulus=shape[2],
            force=self._nodal_force(place, self._outlines[shape].rectangle),
        )

    def _trace(self, place: Place, side: str) -> Trace | None:
        """Rows of a side: all at an interface, or those of prescribed components, or None.

        A contact has none at an end where the left or right side prescribes the normal
        displacement: any pressing force would be a solution there, and so would any friction up to
        it. A support of known bound has the component along it, everywhere.
        """
        stack, beyond = self.stack, self.neighbour(place, side)
        if beyond == "support" and stack.support is not None and stack.support.bound is not None:
            return Trace(side, (0,))
        if beyond == "support" or (not isinstance(beyond, str) and beyond[2] != place[2]):
            first = place[0] == 0 and stack.sides["left"].y.prescribed
            last = place[0] == max(self.columns) - 1 and stack.sides["right"].y.prescribed
            ends = 1 if first else 0, -1 if last else None
            return Trace(side, (0, 1), *ends, has_macro=beyond != "support")
        if not isinstance(beyond, str):
            return Trace(side, has_macro=True)
        if beyond == "right" and stack.spring is not None:
            return Trace(side, (0, 1), 0, 1) if place[1:] == (0, 0) else None
        if beyond == "end":
            return None
        sides = enumerate(stack.sides[beyond])
        held = tuple(component for component, given in sides if given.prescribed)
        return Trace(side, held) if held else None

    def _nodal_force(self, place: Place, mesh: Rectangle) -> Array | None:
        """Forces of tractions and weight on all nodes, (2 n_nodes, n_instants); None without."""
        stack, order = self.stack, self.stack.order
        total = np.zeros((mesh.n_nodes, 2, len(stack.instants)))
        for side in SIDES:
            if self.neighbour(place, side) != side:
                continue
            nodes = mesh.edge(side)
            step = mesh.height if side in ("left", "right") else mesh.width
            edges = np.arange(0, len(nodes) - 1, order)[:, None] + np.arange(order + 1)
            for component, given in enumerate(stack.sides[side]):
                if given.prescribed:
                    continue
                where = self.along(place, side, given)
                traction = (given.mean + where * given.slope) / stack.young
                force = step * np.matmul(edge_mass(order), traction[edges])
                np.add.at(total[:, component], nodes[edges], force)
        if stack.body_force is not None:
            areas = np.outer(mesh.edge_weights("left"), mesh.edge_weights("bottom"))
            density = stack.body_force * stack.length / stack.young
            total += areas.reshape(-1, 1, 1) * density
        return total.reshape(-1, len(stack.instants)) if total.any() else None
