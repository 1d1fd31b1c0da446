"""Substructures of stacked bodies: where they are cut, what they keep, what acts on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.cut_rods import substructure_sizes
from solver.discrete.elements import elastic_matrix
from solver.discrete.plane import Condensed, Kept, Rectangle, both
from solver.discrete.stack.data import StackData
from solver.discrete.stack.sides import Corner, Place, neighbour, nodal_force


@dataclass(frozen=True)
class Held:
    """Which rows a side of a substructure has: components, and nodes in order along the side."""

    components: tuple[int, ...]
    first: int = 0
    last: int | None = None

    @property
    def span(self) -> slice:
        """Which of the side's nodes have rows."""
        return slice(self.first, self.last)


@dataclass(eq=False)
class Part:
    """A substructure as it is made."""

    kept: Kept
    place: Place
    corner: Corner
    nodes: Indices
    held: dict[str, Held]
    rows: dict[str, Indices]
    force: Array | None

    @property
    def rectangle(self) -> Rectangle:
        """Its mesh."""
        return self.kept.condensed.rectangle

    @property
    def dofs(self) -> Indices:
        """What is kept, among the degrees of freedom of all nodes."""
        return both(self.nodes.ravel())[self.kept.dofs]


class Grid:
    """Nodes of all bodies, and where they are cut."""

    def __init__(self, scene: StackData) -> None:
        columns, rows = (scene.order * number for number in scene.elements)
        bodies = scene.bodies
        self.nodes = np.arange(bodies * (rows + 1) * (columns + 1)).reshape(
            bodies, rows + 1, columns + 1
        )
        height = scene.height / scene.length
        x = np.linspace(0.0, 1.0, columns + 1)
        y = np.arange(bodies)[:, None] * height + np.linspace(0.0, height, rows + 1)
        everywhere = np.broadcast_arrays(x, y[:, :, None])
        self.positions = np.stack(everywhere, axis=-1).reshape(-1, 2)
        across, up = (
            scene.order * np.concatenate([[0], np.cumsum(substructure_sizes(number, cuts))])
            for number, cuts in zip(scene.elements, scene.substructures, strict=True)
        )
        self.cuts = across, up


def parts_of(scene: StackData, grid: Grid) -> list[Part]:
    """Cut all bodies; equal parts share what is condensed. Their rows are still to be numbered."""
    across, up = grid.cuts
    width = 1.0 / scene.elements[0]
    height = scene.height / scene.length / scene.elements[1]
    shapes: dict[tuple[int, int, float], Condensed] = {}
    kinds: dict[tuple[object, ...], Kept] = {}
    parts = []
    for body in range(scene.bodies):
        for row in range(scene.substructures[1]):
            for column in range(scene.substructures[0]):
                x, y = across[column], up[row]
                span = int(across[column + 1] - x), int(up[row + 1] - y)
                shape = *span, scene.modulus(body)
                if shape not in shapes:
                    elastic = elastic_matrix(shape[2], scene.poisson, scene.state)
                    size = span[0] // scene.order, span[1] // scene.order
                    rectangle = Rectangle(*size, width, height, elastic, scene.order)
                    shapes[shape] = Condensed(rectangle)
                nodes = grid.nodes[body, y : y + span[1] + 1, x : x + span[0] + 1]
                place = column, row, body
                held = {
                    side: found
                    for side in ("left", "right", "bottom", "top")
                    if (found := _held(scene, place, side)).components
                }
                kind = shape, *held.items()
                if kind not in kinds:
                    kinds[kind] = _kept(shapes[shape], held)
                force = nodal_force(scene, shapes[shape].rectangle, place, (int(x), int(y)))
                parts.append(Part(kinds[kind], place, (int(x), int(y)), nodes, held, {}, force))
    return parts


def _kept(condensed: Condensed, held: dict[str, Held]) -> Kept:
    edges = [
        (2 * condensed.rectangle.edge(side)[one.span, None] + np.array(one.components)).ravel()
        for side, one in held.items()
    ]
    return Kept(condensed, np.unique(np.concatenate(edges)))


def _held(scene: StackData, place: Place, side: str) -> Held:
    """Tell which rows a side has: all at an interface, or those of prescribed components.

    A spring has those of one node.

    A contact has none at an end where the left or right side prescribes the normal displacement:
    any pressing force would be a solution there, and so would any friction up to it. A support of
    known bound has the component along it, everywhere.
    """
    beyond = neighbour(scene, place, side)
    if beyond == "support" and scene.support is not None and scene.support.bound is not None:
        return Held((0,))
    if beyond == "support" or (not isinstance(beyond, str) and beyond[2] != place[2]):
        first = place[0] == 0 and scene.sides["left"].y.prescribed
        last = place[0] == scene.substructures[0] - 1 and scene.sides["right"].y.prescribed
        return Held((0, 1), 1 if first else 0, -1 if last else None)
    if not isinstance(beyond, str):
        return Held((0, 1))
    if beyond == "right" and scene.spring is not None:
        return Held((0, 1), 0, 1) if place[1:] == (0, 0) else Held(())
    given = scene.sides[beyond]
    return Held(tuple(place for place, one in enumerate((given.x, given.y)) if one.prescribed))
