"""Borders of groups of elements: their sides, as closed lines, corners, and steps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Array, Flags, Indices

SHARPEST = 0.94
"""Cosine of the angle from which on an outline has a corner (20 degrees)."""


def meeting(sides: Indices, owners: Indices, around: Indices) -> Flags:
    """Mask of nodes at which more than two groups meet, (n_nodes,).

    `sides` are those of the borders of groups, (n, 2), by their `owners`, (n,), and
    `around` those of the outline, (n, 2), beyond which is one more.
    """
    size = int(sides.max()) + 1
    pairs = np.unique(np.stack([sides[:, 0], owners], axis=1), axis=0)
    counts = np.bincount(pairs[:, 0], minlength=size)
    counts += np.bincount(np.unique(around), minlength=size)
    return np.asarray(counts > 2)


def polygons(borders: Sequence[Sequence[Indices]], is_kept: Flags) -> Indices:
    """Kept nodes around each group, (n_groups, n_corners), padded with the last one.

    Round a hole, or a group in several pieces, there are several closed lines, one
    after the other: there and back between them there is no area.
    """
    polygons = []
    for lines in borders:
        path = list[int]()
        for line in lines:
            kept = line[is_kept[line]].tolist()
            path += [*kept, kept[0], *path[:1]]
        polygons.append(path)
    widest = max(len(polygon) for polygon in polygons)
    padded = [
        np.pad(polygon, (0, widest - len(polygon)), mode="edge") for polygon in polygons
    ]
    return np.array(padded)


def border_of(elements: Indices, labels: Indices) -> tuple[Indices, Indices]:
    """Sides of elements, (n_elements, 4), next to another label or to nothing.

    Returns
    -------
    Both ends of each side, counter-clockwise round its element, (n, 2), and the label
    of the element, (n,).
    """
    sides = np.stack([elements, np.roll(elements, -1, axis=1)], axis=-1).reshape(-1, 2)
    owners = np.repeat(labels, elements.shape[1])
    # Triangles have their last corner twice.
    has_length = sides[:, 0] != sides[:, 1]
    sides = sides[has_length]
    owners = owners[has_length]
    size = int(elements.max()) + 1
    there = (owners * size + sides[:, 0]) * size + sides[:, 1]
    back = (owners * size + sides[:, 1]) * size + sides[:, 0]
    is_border = ~np.isin(there, back)
    return sides[is_border], owners[is_border]


def closed_lines(sides: Indices) -> list[Indices]:
    """Closed lines from directed sides, (n, 2); the last node repeats the first."""
    ahead = dict[int, list[int]]()
    for begin, end in sides.tolist():
        ahead.setdefault(begin, []).append(end)
    lines = []
    for begin, ends in ahead.items():
        while ends:
            line = [begin]
            # As many sides lead to a node as away from it.
            while ahead[line[-1]]:
                line.append(ahead[line[-1]].pop())
            lines.append(np.array(line, dtype=np.intp))
    return lines


def begins(line: Array, step: float) -> Flags:
    """Mask of the starts of steps along a closed line, (n + 1, 2), m: (n,)."""
    lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
    steps = np.floor((np.cumsum(lengths) - lengths) / step)
    return np.diff(steps, prepend=-1.0) > 0.0


def is_corner(line: Array) -> Flags:
    """Mask of the corners of a closed line, (n + 1, 2), m: (n,)."""
    along = np.diff(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    turns = np.einsum("na,na->n", along, np.roll(along, 1, axis=0))
    return np.asarray(turns < SHARPEST)


def is_free(sides: Indices, nodes: Array) -> Flags:
    """Mask of sides, (n_sides, 2), that belong to a single outline, (n_sides,).

    A shared side runs the other way round in the other one; outlines share positions,
    not nodes, (n_nodes, 2), m.
    """
    rounded = np.round(nodes / np.ptp(nodes) * 1e5).astype(np.int64)
    position = np.unique(rounded, axis=0, return_inverse=True)[1].ravel()
    ends = position[sides]
    there = ends @ [len(nodes), 1]
    back = ends @ [1, len(nodes)]
    has_length = ends[:, 0] != ends[:, 1]
    return ~np.isin(there, back) & has_length
