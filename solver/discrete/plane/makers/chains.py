"""Chains of edges given in any order; chains end at corners, forks and loose ends."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from solver.arrays import Array

KINK = 40.0
"""Angle between two edges beyond which a chain ends, degrees: a circle of ten edges is
one smooth ring."""


class Chain(NamedTuple):
    """Vertices in order along edges.

    Attributes
    ----------
    vertices
        Indices of the vertices, in order.
    overlap
        Number of vertices at each end that belong to the neighbouring chain: 1 for the
        two halves of a smooth ring, so that their normals at the ends are the ring's.
    """

    vertices: list[int]
    overlap: int = 0

    @property
    def inner(self) -> list[int]:
        """Vertices of the chain without those that belong to its neighbours."""
        return self.vertices[self.overlap : len(self.vertices) - self.overlap]


def chains_of(edges: Array, positions: Array) -> Iterator[Chain]:
    """Yield the chains of edges, (n_edges, 2), each edge once.

    An edge is a pair of indices of vertices; positions have the shape
    (n_vertices, 2), m.
    """
    neighbours_of: dict[int, list[int]] = {}
    for first, second in edges.tolist():
        neighbours_of.setdefault(first, []).append(second)
        neighbours_of.setdefault(second, []).append(first)
    left = set(map(frozenset, edges.tolist()))
    ends = [
        vertex
        for vertex in neighbours_of
        if _is_end(vertex, neighbours_of[vertex], positions)
    ]
    for start in ends:
        for second in neighbours_of[start]:
            if frozenset((start, second)) in left:
                yield Chain(_walk(start, second, neighbours_of, set(ends), left))
    while left:
        # Edges that no chain has taken are smooth rings.
        start = min(min(edge) for edge in left)
        ring = _walk(start, min(neighbours_of[start]), neighbours_of, {start}, left)
        half = len(ring) // 2
        yield Chain([ring[-2], *ring[: half + 2]], overlap=1)
        yield Chain([*ring[half - 1 :], ring[1]], overlap=1)


def _is_end(vertex: int, neighbours: list[int], positions: Array) -> bool:
    """Check whether chains end at a vertex: it has one edge, several, or a corner."""
    if len(neighbours) != 2:
        return True
    before = positions[vertex] - positions[neighbours[0]]
    after = positions[neighbours[1]] - positions[vertex]
    lengths = np.linalg.norm(before) * np.linalg.norm(after)
    return bool(before @ after < np.cos(np.radians(KINK)) * lengths)


def _walk(
    start: int,
    second: int,
    neighbours_of: dict[int, list[int]],
    ends: set[int],
    left: set[frozenset[int]],
) -> list[int]:
    """Vertices from a start over a neighbour of it to an end.

    Its edges are removed from `left`, the edges that no chain has taken.
    """
    vertices = [start, second]
    left.discard(frozenset((start, second)))
    while vertices[-1] not in ends:
        first, other = neighbours_of[vertices[-1]]
        following = other if first == vertices[-2] else first
        left.discard(frozenset((vertices[-1], following)))
        vertices.append(following)
    return vertices
