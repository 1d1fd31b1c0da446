"""Edges in any order as chains, which end at corners, forks and loose ends."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from solver.arrays import Array

KINK = 40.0
"""Angle between two edges beyond which a chain ends, degrees: of a circle of ten edges
all are on one line."""


class Chain(NamedTuple):
    """Places in turn along edges.

    Attributes
    ----------
    places
        Numbers of the places.
    beside
        Number of places at each end that belong to the chain of its neighbour: 1 of
        both halves of a smooth ring, whose direction at the end is that of the ring.
    """

    places: list[int]
    beside: int = 0

    @property
    def own(self) -> list[int]:
        """Numbers of the places without those of the neighbours."""
        return self.places[self.beside : len(self.places) - self.beside]


def chains_of(edges: Array, positions: Array) -> Iterator[Chain]:
    """Yield the chains of edges, (n_edges, 2), each edge once.

    Edges are given by the numbers of places, whose positions have the shape
    (n_places, 2).
    """
    beside: dict[int, list[int]] = {}
    for first, second in edges.tolist():
        beside.setdefault(first, []).append(second)
        beside.setdefault(second, []).append(first)
    left = set(map(frozenset, edges.tolist()))
    ends = [place for place in beside if _is_end(place, beside[place], positions)]
    for start in ends:
        for second in beside[start]:
            if frozenset((start, second)) in left:
                yield Chain(_walk(start, second, beside, set(ends), left))
    while left:
        # What is left are smooth rings.
        start = min(min(edge) for edge in left)
        ring = _walk(start, min(beside[start]), beside, {start}, left)
        half = len(ring) // 2
        yield Chain([ring[-2], *ring[: half + 2]], beside=1)
        yield Chain([*ring[half - 1 :], ring[1]], beside=1)


def _is_end(place: int, neighbours: list[int], positions: Array) -> bool:
    """Check whether chains end at a place: it has one edge, several, or a corner."""
    if len(neighbours) != 2:
        return True
    before = positions[place] - positions[neighbours[0]]
    after = positions[neighbours[1]] - positions[place]
    lengths = np.linalg.norm(before) * np.linalg.norm(after)
    return bool(before @ after < np.cos(np.radians(KINK)) * lengths)


def _walk(
    start: int,
    second: int,
    beside: dict[int, list[int]],
    ends: set[int],
    left: set[frozenset[int]],
) -> list[int]:
    """Places from a start over its neighbour to an end.

    The edges on the way are taken off those `left`.
    """
    places = [start, second]
    left.discard(frozenset((start, second)))
    while places[-1] not in ends:
        first, other = beside[places[-1]]
        following = other if first == places[-2] else first
        left.discard(frozenset((places[-1], following)))
        places.append(following)
    return places
