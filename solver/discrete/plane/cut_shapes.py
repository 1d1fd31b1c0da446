"""Shapes cut into parts along edges of their elements."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.body import Shape


class Seam(NamedTuple):
    """Edges along which two parts of a shape are glued.

    Attributes
    ----------
    parts
        Numbers of both parts, the smaller first.
    nodes
        Nodes along it, (n,), in the order of the longer direction.
    positions
        Distances of the nodes along that direction, (n,), m.
    weights
        Length that belongs to each node, (n,), m.
    """

    parts: tuple[int, int]
    nodes: Indices
    positions: Array
    weights: Array


class CutShape:
    """A shape cut into parts by bisection of the centres of its elements.

    Attributes
    ----------
    labels
        Number of the part of each element, (n_elements,).
    elements, nodes
        Elements and nodes of each part, ascending, (n,) each.
    seams
        Where parts are glued.
    """

    def __init__(self, shape: Shape, count: int) -> None:
        self.labels = np.zeros(len(shape.centres), dtype=np.intp)
        places = shape.centres
        if isinstance(shape, Beam):
            # A line may wind back beside itself, and is cut along itself.
            places = shape.laid_out
        _bisect(places, np.arange(len(self.labels)), count, 0, self.labels)
        numbers = range(count)
        self.elements = [np.flatnonzero(self.labels == part) for part in numbers]
        self.nodes = [np.unique(shape.element_nodes[some]) for some in self.elements]
        self.seams = _seams_of(shape, self.labels)


def _bisect(
    centres: Array, members: Indices, count: int, first: int, labels: Indices
) -> None:
    """Number the parts of the members from `first` on, halved across their length.

    `centres` are those of all elements, (n_elements, 2), `labels` are written,
    (n_elements,).
    """
    if count == 1:
        labels[members] = first
        return
    places = centres[members]
    longest = int(np.ptp(places, axis=0).argmax())
    # Rounded, so that elements side by side are told apart by the other direction.
    rounded = np.round(places / np.ptp(places), 9)
    order = np.lexsort((rounded[:, 1 - longest], rounded[:, longest]))
    half = count // 2
    size = max(round(len(members) * half / count), half)
    size = min(size, len(members) - (count - half))
    _bisect(centres, members[order[:size]], half, first, labels)
    _bisect(centres, members[order[size:]], count - half, first + half, labels)


def _seams_of(shape: Shape, labels: Indices) -> list[Seam]:
    """Seams between parts, by the numbers of the parts."""
    both, nodes, lengths = shape.seams(labels)
    seams = list[Seam]()
    keys, of_edges = np.unique(both, axis=0, return_inverse=True)
    for number, (first, second) in enumerate(keys.tolist()):
        own = of_edges.ravel() == number
        some, inverse = np.unique(nodes[own], return_inverse=True)
        weights = np.zeros(len(some))
        np.add.at(weights, inverse.ravel(), lengths[own].ravel())
        along = _along_longest(shape.nodes[some])
        order = np.argsort(along, kind="stable")
        seam = Seam((first, second), some[order], along[order], weights[order])
        seams.append(seam)
    return seams


def _along_longest(places: Array) -> Array:
    """Coordinates, (n,), of places, (n, 2), along their longest direction, both m."""
    away = places - places.mean(axis=0)
    direction = np.linalg.svd(away, full_matrices=False)[2][0]
    return np.asarray(away @ direction)
