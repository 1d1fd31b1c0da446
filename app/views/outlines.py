"""Lines of the bodies: round every substructure, round the bodies, and along what rubs."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.frame import Geometry
from solver.arrays import Array

Indices = NDArray[np.intp]
BREAK = -1
"""Stands between two lines in a list of nodes."""


@dataclass(frozen=True, eq=False)
class Outlines:
    """Nodes of lines, `BREAK` between them."""

    geometry: Geometry
    """What they are of."""
    parts: Indices
    """Closed lines round substructures."""
    rims: Indices
    """Sides of the bodies that nothing touches, two nodes each."""
    broken: Indices
    """Nodes of the sides at the break of the broken body, shape (n, 2)."""

    def suits(self, geometry: Geometry) -> bool:
        """Whether it is also that of another geometry, alike but for its size."""
        known = self.geometry
        shapes = [each.nodes / each.nodes.max() for each in (known, geometry)]
        return (
            np.array_equal(known.quads, geometry.quads)
            and np.array_equal(known.parts, geometry.parts)
            and shapes[0].shape == shapes[1].shape
            and np.allclose(*shapes)
            and known.description.broken == geometry.description.broken
        )


def outlines_of(geometry: Geometry) -> Outlines:
    """Find them."""
    loops, sides = [], []
    for part in np.unique(geometry.parts):
        own = _boundary(geometry.quads[geometry.parts == part])
        sides.append(own)
        loops += _loops(own)
    rims = _untouched(np.concatenate(sides), geometry.nodes)
    return Outlines(
        geometry,
        np.concatenate([np.append(loop, BREAK) for loop in loops])[:-1],
        np.append(rims, np.full((len(rims), 1), BREAK), axis=1).ravel(),
        _at_break(np.concatenate(sides), geometry),
    )


def drawn(lines: Indices, nodes: Array) -> Array:
    """Places of lines, (n, 2), NaN between them."""
    return np.append(nodes, [[np.nan, np.nan]], axis=0)[lines]


def _boundary(quads: NDArray[np.int32]) -> Indices:
    """Directed sides, (n, 2), that only one quadrilateral has."""
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2).astype(np.intp)
    sides = sides[sides[:, 0] != sides[:, 1]]
    size = int(sides.max()) + 1
    code, back = sides @ [size, 1], sides @ [1, size]
    return np.asarray(sides[~np.isin(code, back)])


def _loops(sides: Indices) -> list[Indices]:
    """Closed lines of directed sides."""
    following = defaultdict(list)
    for first, second in sides.tolist():
        following[first].append(second)
    loops = []
    while following:
        node = next(iter(following))
        loop = [node]
        while following.get(node):
            after = following[node].pop()
            if not following[node]:
                del following[node]
            node = after
            loop.append(node)
        loops.append(np.array(loop, dtype=np.intp))
    return loops


def _untouched(sides: Indices, nodes: Array) -> Indices:
    """Sides that have no other one, the other way round, at the same place."""
    places = np.round(nodes / np.ptp(nodes) * 1e5).astype(np.int64)
    _, place = np.unique(places, axis=0, return_inverse=True)
    ends = place.ravel()[sides]
    size = int(place.max()) + 1
    return np.asarray(sides[~np.isin(ends @ [size, 1], ends @ [1, size])])


def _at_break(sides: Indices, geometry: Geometry) -> Indices:
    """Upright sides at the break of a rod."""
    description = geometry.description
    if description.broken is None:
        return np.zeros((0, 2), dtype=np.intp)
    body, place = description.broken
    ends = geometry.nodes[sides]
    height = geometry.nodes[:, 1].max() / description.bodies
    x, y = ends[:, :, 0], ends[:, :, 1].mean(axis=1)
    at = np.abs(x - place).max(axis=1) < 1e-4 * description.length
    return np.asarray(sides[at & ((y / height).astype(np.intp) == body)])


def bands(
    points: Array, chains: Indices, status: NDArray[np.int8]
) -> tuple[list[Array], list[int]]:
    """Stretches of contact points of one status, each to the middle between it and the next.

    Points are on the screen, shape (n, 2), NaN where their chain is broken, px. What comes back are
    lines, (n, 2) each, and their status.
    """
    is_drawn = np.isfinite(points).all(axis=1)
    joined = (chains[1:] == chains[:-1]) & is_drawn[1:] & is_drawn[:-1]
    middles = 0.5 * (points[1:] + points[:-1])
    cuts = np.flatnonzero(~joined | (status[1:] != status[:-1])) + 1
    lines, kinds = [], []
    for first, end in zip([0, *cuts], [*cuts, len(points)], strict=True):
        if not is_drawn[first]:
            continue
        line = points[first:end]
        if first > 0 and joined[first - 1]:
            line = np.concatenate([middles[first - 1 : first], line])
        if end < len(points) and joined[end - 1]:
            line = np.concatenate([line, middles[end - 1 : end]])
        lines.append(_straightened(line))
        kinds.append(int(status[first]))
    return lines, kinds


def _straightened(line: Array) -> Array:
    """A line that is straight on the screen by its ends alone."""
    along = line[-1] - line[0]
    length = float(np.hypot(*along))
    if len(line) < 3 or length == 0.0:
        return line
    away = (line - line[0]) @ np.array([-along[1], along[0]]) / length
    return line[[0, -1]] if np.abs(away).max() < 0.3 else line
