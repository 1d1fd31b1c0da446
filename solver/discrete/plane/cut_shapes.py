"""Shapes cut into parts along edges of their elements."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.body import Shape
from solver.discrete.plane.meshes import Mesh


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
    """A shape cut into parts: as is given, or by bisection of its elements' centres.

    Attributes
    ----------
    labels
        Index of the part of each element, (n_elements,).
    elements, nodes
        Elements and nodes of each part, ascending, (n,) each.
    seams
        Where parts are glued.
    """

    def __init__(self, shape: Shape, count: int, labels: Indices | None = None) -> None:
        if labels is None:
            labels = _labels_of(shape, count)
        self.labels = labels
        if count == 1:
            # Every node belongs to an element.
            self.elements = [np.arange(len(self.labels))]
            self.nodes = [np.arange(len(shape.nodes))]
            self.seams = list[Seam]()
            return
        numbers = range(count)
        self.elements = [np.flatnonzero(self.labels == part) for part in numbers]
        self.nodes = [np.unique(shape.element_nodes[some]) for some in self.elements]
        self.seams = _seams_of(shape, self.labels)


def _labels_of(shape: Shape, count: int) -> Indices:
    """Index of the part of each element, (n_elements,), for a number of parts."""
    if count == 1:
        return np.zeros(len(shape.centres), dtype=np.intp)
    if isinstance(shape, Beam):
        # A line may wind back beside itself, and is cut along itself.
        return bisected(shape.laid_out, count)
    labels = bisected(shape.centres, count)
    if isinstance(shape, Mesh):
        return in_one_piece(shape, labels)
    return labels


def bisected(centres: Array, count: int) -> Indices:
    """Index of the group of each point, (n,): groups by repeated bisection.

    Each group of the points, (n, 2), is halved across its longer direction.
    """
    labels = np.zeros(len(centres), dtype=np.intp)
    _bisect(centres, np.arange(len(centres)), count, 0, labels)
    return labels


def in_one_piece(mesh: Mesh, labels: Indices) -> Indices:
    """Labels of parts, (n_elements,), changed so that each part is one piece.

    The largest piece of a part stays; others go one by one, the smallest first, to the
    part with which they share most edges. `labels` are of the same shape.
    """
    labels = labels.copy()
    first, second = mesh.neighbours
    while True:
        pieces = mesh.pieces(labels)
        sizes = np.bincount(pieces)
        of_pieces = np.zeros(len(sizes), dtype=np.intp)
        of_pieces[pieces] = labels
        # From small to large: the last one of each part is its largest.
        order = np.argsort(sizes, kind="stable")
        _, largest = np.unique(of_pieces[order][::-1], return_index=True)
        others = np.delete(order, len(order) - 1 - largest)
        if not len(others):
            return labels
        inside = pieces == others[0]
        beside = np.concatenate(
            [
                labels[second[inside[first] & ~inside[second]]],
                labels[first[inside[second] & ~inside[first]]],
            ]
        )
        labels[inside] = np.bincount(beside).argmax()


def _bisect(
    centres: Array, members: Indices, count: int, first: int, labels: Indices
) -> None:
    """Number the parts of the members from `first` on, halving across their length.

    `centres` are those of all elements, (n_elements, 2), `labels` are written,
    (n_elements,).
    """
    if count == 1:
        labels[members] = first
        return
    places = centres[members]
    longest = int(np.ptp(places, axis=0).argmax())
    # Rounded, so that elements side by side are distinguished by the other direction.
    rounded = np.round(places / np.ptp(places), 9)
    order = np.lexsort((rounded[:, 1 - longest], rounded[:, longest]))
    half = count // 2
    size = max(round(len(members) * half / count), half)
    size = min(size, len(members) - (count - half))
    _bisect(centres, members[order[:size]], half, first, labels)
    _bisect(centres, members[order[size:]], count - half, first + half, labels)


def _seams_of(shape: Shape, labels: Indices) -> list[Seam]:
    """Seams between parts, by the indices of the parts."""
    both, nodes, lengths = shape.seams(labels)
    seams = list[Seam]()
    keys, of_edges = np.unique(both, axis=0, return_inverse=True)
    for number, (first, second) in enumerate(keys.tolist()):
        own = of_edges.ravel() == number
        seam = _seam_of(shape, (first, second), nodes[own], lengths[own])
        seams.append(seam)
    return seams


def _seam_of(
    shape: Shape, parts: tuple[int, int], nodes: Indices, lengths: Array
) -> Seam:
    """Seam between two parts, from the nodes of its edges and tributary lengths.

    Both have shape (n_edges, n_nodes of an edge); shares are in m.
    """
    some, inverse = np.unique(nodes, return_inverse=True)
    weights = np.zeros(len(some))
    np.add.at(weights, inverse.ravel(), lengths.ravel())
    along = _along_longest(shape.nodes[some])
    order = np.argsort(along, kind="stable")
    return Seam(parts, some[order], along[order], weights[order])


def _along_longest(places: Array) -> Array:
    """Coordinates, (n,), of positions, (n, 2), along their longest direction, m."""
    away = places - places.mean(axis=0)
    direction = np.linalg.svd(away, full_matrices=False)[2][0]
    return np.asarray(away @ direction)
