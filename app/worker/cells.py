"""Cells, outlines and rims of bodies for drawing, from their meshes.

Grids of rectangles are thinned line by line, other meshes by groups of elements.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from app.frame import Floats
from app.worker.borders import (
    begins,
    border_of,
    closed_lines,
    is_corner,
    is_free,
    meeting,
    polygons,
)
from solver.arrays import Array, Indices
from solver.discrete import Beam, Bodies, Structure
from solver.discrete.inside import Inside
from solver.discrete.plane.cut_shapes import bisected

MOST_CELLS = 400
"""Largest number of cells that are drawn, or one for each substructure."""
MOST_AROUND = 1200
"""Largest number of nodes on the outlines of thinned meshes, about."""
BAND = 0.03
"""Least thickness of a drawn band of beams, over the size of all bodies."""
NONE = -1
"""Number in place of a missing degree of freedom, and between two lines of nodes."""


def floats(values: NDArray[np.generic]) -> Floats:
    """Arrays as float32, of the same shape."""
    return values.astype(np.float32, order="C")


def thinned(size: int, limit: int) -> Indices:
    """Indices of a thinned axis, (n,), with first and last; n is at most the limit."""
    if size <= limit:
        return np.arange(size)
    return np.unique(np.linspace(0, size - 1, limit).round().astype(np.intp))


@dataclass(frozen=True, eq=False)
class Drawing:
    """Drawing of some elements of a substructure.

    Attributes
    ----------
    part
        Index of the substructure.
    numbers
        Indices of the nodes among those of all bodies, (n,).
    positions
        Where the nodes are drawn, (n, 2), m: a band has two for each node of its line.
    cells
        Corners of each cell among these nodes, (n_cells, n_corners); the last is
        repeated where a cell has fewer.
    rings
        Closed lines round the cells, the first of these nodes again at the end.
    cell_of_elements
        Index of the cell that each element lies in, (n_elements,).
    """

    part: int
    numbers: Indices
    positions: Array
    cells: Indices
    rings: Sequence[Indices]
    cell_of_elements: Indices


def drawings_of(structure: Structure, inside: Inside) -> list[Drawing]:
    """Drawings of the substructures of bodies in the plane.

    Rectangular ones keep some lines of their grids, others groups of their elements.
    """
    drawings = _drawings_of_grids(inside)
    if isinstance(structure, Bodies):
        drawings += _drawings_of_shapes(structure, inside)
    return sorted(drawings, key=lambda drawing: drawing.part)


def is_rectangle(grid: Indices) -> bool:
    """Check whether nodes of a substructure are in rows and columns, not in a list."""
    return grid.ndim == 2


def lower_corner(inside: Inside) -> Array:
    """Lower left corner of all bodies, from which on they are drawn, (2,), m."""
    return np.asarray(inside.nodes.min(axis=0))


def kept_ring(grid: Indices, limit: int) -> Indices:
    """Closed ring of outer nodes of a grid, as places in its order, (n,).

    `limit` is the largest number of nodes on a side.
    """
    places = np.arange(grid.size).reshape(grid.shape)
    up, across = [thinned(size, limit) for size in grid.shape]
    return _ring_of(places[np.ix_(up, across)])


def _drawings_of_grids(inside: Inside) -> list[Drawing]:
    """Drawings of rectangular substructures, with a subset of their grid lines."""
    grids = {part: grid for part, grid in enumerate(inside.grids) if is_rectangle(grid)}
    if not grids:
        return []
    # All grids are thinned alike, so that bodies of one size look alike.
    limit = max(MOST_CELLS // len(inside.grids), 1)
    shapes = np.array([np.subtract(grid.shape, 1) for grid in grids.values()])
    share = min(np.sqrt(limit / shapes.prod(axis=1).max()), 1.0)
    drawings = []
    for part, grid in grids.items():
        up, across = _kept_lines(grid, share, limit)
        kept = grid[np.ix_(up, across)]
        positions = inside.nodes[kept]
        drawings.append(_drawn_grid(part, kept, positions, _quads_of(grid, up, across)))
    return drawings


def _drawings_of_shapes(structure: Bodies, inside: Inside) -> list[Drawing]:
    """Drawings of substructures of any other shape."""
    others = [part for part, grid in enumerate(inside.grids) if not is_rectangle(grid)]
    share = min(MOST_CELLS / len(inside.elements), 1.0)
    around = 4.0 * sum(body.shape.size for body in structure.bodies)
    sides = _sides_in_contact(structure)
    thinnest = BAND * float(structure.box[1].max())
    bodies = inside.bodies[np.searchsorted(inside.parts, np.arange(len(inside.grids)))]
    drawings = []
    for part in others:
        elements = inside.elements[inside.parts == part]
        count = max(round(share * len(elements)), 1)
        shape = structure.bodies[bodies[part]].shape
        if isinstance(shape, Beam):
            thickness = np.sqrt(12.0 * shape.second_moment / shape.area)
            thickness = max(float(thickness), thinnest)
            drawings += _bands(part, inside, elements, count, thickness, sides)
        elif count < len(elements):
            step = around / MOST_AROUND
            drawings.append(_grouped(part, inside.nodes, elements, count, step))
        else:
            drawings.append(_as_meshed(part, inside.nodes, elements))
    return drawings


def mesh_of(grids: Sequence[Array], parts: ArrayLike) -> dict[str, Any]:
    """Nodes, cells and outlines of `Geometry` from grids of nodes.

    Each grid is of one of the parts, (n_rows, n_columns, 2), m, row by row from below.
    """
    drawings = []
    for part, grid in zip(np.asarray(parts).tolist(), grids, strict=True):
        numbers = np.zeros(grid.shape[:2], dtype=np.intp)
        drawings.append(_drawn_grid(part, numbers, grid, numbers))
    return joined(drawings)


def joined(drawings: Sequence[Drawing]) -> dict[str, Any]:
    """Nodes, cells and outlines of `Geometry` from drawings."""
    widest = max(drawing.cells.shape[1] for drawing in drawings)
    cells = []
    rings = []
    first = 0
    for drawing in drawings:
        missing = widest - drawing.cells.shape[1]
        padded = np.pad(drawing.cells, ((0, 0), (0, missing)), mode="edge")
        cells.append(first + padded)
        rings += [first + ring for ring in drawing.rings]
        first += len(drawing.numbers)
    nodes = np.concatenate([drawing.positions for drawing in drawings])
    sides = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    free = sides[is_free(sides, nodes)]
    sizes = [len(drawing.cells) for drawing in drawings]
    return {
        "nodes": floats(nodes),
        "cells": np.concatenate(cells).astype(np.int32),
        "parts": np.repeat([drawing.part for drawing in drawings], sizes),
        "outlines": np.concatenate([np.append(ring, NONE) for ring in rings]),
        "rims": np.insert(free, 2, NONE, axis=1).ravel(),
    }


def cells_of(drawings: Sequence[Drawing]) -> Indices:
    """Index of the cell of each element among those of all drawings, (n_elements,)."""
    numbers = []
    first = 0
    for drawing in drawings:
        numbers.append(first + drawing.cell_of_elements)
        first += len(drawing.cells)
    return np.concatenate(numbers)


def _drawn_grid(
    part: int, numbers: Indices, positions: Array, cell_of_elements: Indices
) -> Drawing:
    """Drawing of a grid of nodes, (n_rows, n_columns), at positions, (..., 2), m."""
    n = np.arange(numbers.size).reshape(numbers.shape)
    corners = (n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1])
    return Drawing(
        part=part,
        numbers=numbers.ravel(),
        positions=positions.reshape(-1, 2),
        cells=np.stack(corners, axis=-1).reshape(-1, 4),
        rings=[_ring_of(n)],
        cell_of_elements=cell_of_elements,
    )


def _ring_of(grid: Indices) -> Indices:
    """Closed ring of the outer nodes of a grid, (n_rows, n_columns): (n,)."""
    sides = (grid[0], grid[1:, -1], grid[-1, -2::-1], grid[-2::-1, 0])
    return np.concatenate(sides)


def _kept_lines(grid: Indices, share: float, limit: int) -> tuple[Indices, Indices]:
    """Drawn rows and columns of a grid of nodes, (n_up,) and (n_across,).

    They are a share of all lines, and make no more cells than a limit.
    """
    n_rows, n_columns = np.subtract(grid.shape, 1)
    rows = max(int(share * n_rows), 1)
    columns = max(min(int(share * n_columns), limit // rows), 1)
    return thinned(n_rows + 1, rows + 1), thinned(n_columns + 1, columns + 1)


def _quads_of(grid: Indices, up: Indices, across: Indices) -> Indices:
    """Index of the drawn quadrilateral that contains each element, (n_elements,)."""
    n_rows, n_columns = np.subtract(grid.shape, 1)
    row = np.searchsorted(up, np.arange(n_rows), side="right") - 1
    column = np.searchsorted(across, np.arange(n_columns), side="right") - 1
    return np.add.outer(row * (len(across) - 1), column).ravel()


def _sides_in_contact(structure: Bodies) -> Array:
    """Normals into the bodies at nodes with contact, (n_nodes, 2); else 0."""
    normals = np.zeros((structure.first_nodes[-1], 2))
    for joint in structure.joints:
        for (body, nodes), sign in zip(joint.sides, (1.0, -1.0), strict=False):
            normals[structure.first_nodes[body] + nodes] = sign * joint.normals
    return normals


def _bands(
    part: int,
    inside: Inside,
    elements: Indices,
    count: int,
    thickness: float,
    sides: Array,
) -> list[Drawing]:
    """Drawing of a line of beams, (n_elements, 4), as bands of about `count` cells.

    A band lies on what it touches, by `sides`, (n_nodes, 2), else about its line. The
    line of a substructure may be in several stretches, as turns round a drum are.
    """
    breaks = np.flatnonzero(elements[1:, 0] != elements[:-1, 1]) + 1
    drawings = []
    for stretch in np.split(elements, breaks):
        line = np.append(stretch[:, 0], stretch[-1, 1])
        along = np.gradient(inside.nodes[line], axis=0)
        left = np.stack([-along[:, 1], along[:, 0]], axis=1)
        left *= thickness / np.linalg.norm(left, axis=1, keepdims=True)
        side = np.sign(np.sum(left * sides[line]))
        # From the line to its free side, or half on either.
        low = inside.nodes[line] + 0.5 * (side - 1.0) * left
        grid = np.stack([line, line])
        across = thinned(len(line), max(count * len(stretch) // len(elements), 1) + 1)
        positions = np.stack([low, low + left])[:, across]
        quads = _quads_of(grid, np.arange(2), across)
        drawings.append(_drawn_grid(part, grid[:, across], positions, quads))
    return drawings


def _as_meshed(part: int, nodes: Array, elements: Indices) -> Drawing:
    """Drawing of elements, (n_elements, 4), with a cell for each."""
    numbers, cells = np.unique(elements, return_inverse=True)
    cells = cells.reshape(elements.shape)
    return Drawing(
        part=part,
        numbers=numbers,
        positions=nodes[numbers],
        cells=cells,
        rings=closed_lines(border_of(cells, np.zeros(len(cells), dtype=np.intp))[0]),
        cell_of_elements=np.arange(len(cells)),
    )


def _grouped(
    part: int, nodes: Array, elements: Indices, count: int, step: float
) -> Drawing:
    """Drawing of elements, (n_elements, 4), with cells of grouped elements.

    Of the nodes on borders stay those at which groups meet, corners of the outline, and
    one in each step along it, m.
    """
    labels = bisected(nodes[elements].mean(axis=1), count)
    sides, owners = border_of(elements, labels)
    around, _ = border_of(elements, np.zeros_like(labels))
    outlines = closed_lines(around)
    is_kept = meeting(sides, owners, around)
    for line in outlines:
        is_kept[line[:-1][is_corner(nodes[line]) | begins(nodes[line], step)]] = True
    borders = [closed_lines(sides[owners == group]) for group in range(count)]
    for line in chain.from_iterable(borders):
        # A piece in the midst of a group meets no two others.
        if len(np.unique(line[is_kept[line]])) < 3:
            is_kept[line] = True
    cells = polygons(borders, is_kept)
    rings = [line[is_kept[line]] for line in outlines]
    numbers = np.unique(np.concatenate([cells.ravel(), *rings]))
    return Drawing(
        part=part,
        numbers=numbers,
        positions=nodes[numbers],
        cells=np.searchsorted(numbers, cells),
        rings=[np.searchsorted(numbers, ring) for ring in rings],
        cell_of_elements=labels,
    )
