"""Pieces of rods: where rods are cut, their degrees of freedom, rows and points."""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from solver.arrays import Indices
from solver.cache import content_of
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.discrete.substructure import Substructure, substructure_sizes
from solver.laws import Component

NO_ROW = -1
"""Number of a boundary row that a node does not have."""
OF_FRICTION = {"strength", "factors", "pressure", "friction_law"}
"""Fields of rods on which their substructures do not depend."""


def pieces_of(rods: Rods) -> tuple[list[int], int]:
    """Elements of the pieces of each rod, and number of pieces before the broken node.

    The number is 0 where no rod is broken.
    """
    if rods.broken is None:
        return substructure_sizes(rods.elements, rods.substructures), 0
    _, node = rods.broken
    count = max(rods.substructures, 2)
    beyond = rods.elements - node
    # Pieces are shared out by length, but each side of the break has at least one
    # piece, and no more than it has elements.
    before = round(count * node / rods.elements)
    before = min(max(before, 1, count - beyond), node, count - 1)
    sizes_before = substructure_sizes(node, before)
    sizes_beyond = substructure_sizes(beyond, count - before)
    return sizes_before + sizes_beyond, before


class Piece(NamedTuple):
    """A piece of a rod: its number, its first element, and how many elements it has."""

    number: int
    first: int
    size: int

    @property
    def elements(self) -> slice:
        """Elements of the piece among those of the rod."""
        return slice(self.first, self.first + self.size)

    @property
    def nodes(self) -> slice:
        """Nodes of the piece, among those of all pieces (nodes of cuts count twice)."""
        first = self.first + self.number
        return slice(first, first + self.size + 1)

    def springs(self, rods: Rods) -> dict[int, End]:
        """Ends of the rod that springs hold, by their node in this piece."""
        held = dict[int, End]()
        for node, end in ((0, rods.left), (rods.elements, rods.right)):
            if end.is_on_spring and self.first <= node <= self.first + self.size:
                held[node - self.first] = end
        return held


class RodPieces:
    """Substructures of all rods, rod after rod, as cached between runs.

    Attributes
    ----------
    substructures
        The substructures, whose own arrays are made read-only.
    nbytes
        Memory of these arrays, B.
    """

    def __init__(self, substructures: Iterable[Substructure]) -> None:
        self.substructures = tuple(substructures)
        self.nbytes = 0
        for each in self.substructures:
            for array in (each.dofs, each.rows, each.body_force, each.free_force):
                if array is not None:
                    array.flags.writeable = False
                    self.nbytes += array.nbytes


def content_without_friction(data: Rods | End) -> Hashable:
    """Values of all fields except those of friction; of arrays their digests.

    Substructures that are kept between runs depend on these alone.
    """
    values: list[Hashable] = []
    for field in dataclasses.fields(data):
        if field.name in OF_FRICTION:
            continue
        value = getattr(data, field.name)
        if isinstance(value, np.ndarray):
            value = content_of(value)
        elif isinstance(value, End):
            value = content_without_friction(value)
        values.append(value)
    return tuple(values)


class RodRows:
    """Numbers by which cut rods are assembled; parallel rods have the same cuts.

    Degrees of freedom run along rod after rod; a broken rod has two at its break, and
    no boundary row there. Rows of one law follow each other: the lower sides of all
    contacts, if they are between rods, the upper sides of all contacts, then the left
    ends and the right ends, cut by cut.

    Parameters
    ----------
    rods
        All rods.
    n_contacts
        Number of contacts: one for each rod, with its support, or one less, each of a
        rod with that before it.
    rub_at_ends
        Whether the first and the last node rub.

    Attributes
    ----------
    sizes
        Numbers of elements of the pieces of each rod.
    nodes
        Node of a rod at each node of its pieces one after another, shape (n_nodes +
        n_cuts,): that of a cut is there twice.
    rubbing
        Those of these that rub, each as a pair of a contact.
    nodes_of_pairs, pieces_of_pairs
        Node of a rod, and piece, of each pair of a contact, shape (n_pairs,).
    dofs_at
        Number of degrees of freedom at every node, shape (n_rods, n_nodes).
    sides
        Rows of the sides of contacts, lower ones first, at the nodes of all pieces,
        shape (n_sides, n_nodes + n_cuts), or NO_ROW.
    ends
        Rows of the left and the right end of every piece, shape (2, n_pieces, n_rods),
        or NO_ROW.
    """

    def __init__(
        self, rods: Sequence[Rods], n_contacts: int, rub_at_ends: tuple[bool, bool]
    ) -> None:
        self.sizes, before = pieces_of(rods[0])
        self._piece = np.repeat(np.arange(len(self.sizes)), np.add(self.sizes, 1))
        self.nodes = np.arange(len(self._piece)) - self._piece
        self.rubbing = slice(1 - rub_at_ends[0], len(self.nodes) - 1 + rub_at_ends[1])
        self.nodes_of_pairs: Indices = self.nodes[self.rubbing]
        self.pieces_of_pairs: Indices = self._piece[self.rubbing]
        # Degrees of freedom more that a rod has beyond its break, (n_rods, n_pieces).
        self._beyond = np.zeros((len(rods), len(self.sizes)), dtype=np.intp)
        if rods[0].broken is not None:
            self._beyond[rods[0].broken[0] - 1, before:] = 1
        breaks = np.diff(self._beyond, axis=1)
        self.dofs_at = np.ones((len(rods), rods[0].elements + 1), dtype=np.intp)
        self.dofs_at[:, np.cumsum(self.sizes)[:-1]] += breaks
        # Contacts that have a rod below.
        if n_contacts == len(rods):
            self._n_lower = 0
        else:
            self._n_lower = n_contacts
        self.sides = np.full((n_contacts + self._n_lower, len(self.nodes)), NO_ROW)
        at_nodes = self.sides[:, self.rubbing]
        at_nodes[:] = np.arange(at_nodes.size).reshape(at_nodes.shape)
        is_whole = breaks.T == 0
        is_there = np.ones((2, len(self.sizes), len(rods)), dtype=bool)
        is_there[0, 1:] = is_whole
        is_there[1, :-1] = is_whole
        rows = at_nodes.size - 1 + np.cumsum(is_there).reshape(is_there.shape)
        self.ends = np.where(is_there, rows, NO_ROW)

    def pieces(self) -> Iterator[Piece]:
        """Pieces of a rod from left to right."""
        first = 0
        for number, size in enumerate(self.sizes):
            yield Piece(number, first, size)
            first += size

    def dofs_of(self, rod: int, piece: Piece) -> Indices:
        """Degrees of freedom of the nodes of a piece of a rod, (n_nodes,)."""
        before = int(self.dofs_at[:rod].sum()) + int(self._beyond[rod, piece.number])
        first = before + piece.first
        return np.arange(first, first + piece.size + 1)

    def rows_of(self, rod: int, piece: Piece) -> Indices:
        """Boundary rows of a piece, (n,), or NO_ROW: of contacts, then of both ends."""
        at_sides = self.sides[self._sides_of(rod), piece.nodes]
        return np.concatenate([at_sides.ravel(), self.ends[:, piece.number, rod]])

    def _sides_of(self, rod: int) -> list[int]:
        """Sides of contacts on a rod: with its support, or with its neighbours."""
        if not self._n_lower:
            return [rod]
        sides = list[int]()
        if rod > 0:
            sides.append(self._n_lower + rod - 1)
        if rod < self._n_lower:
            sides.append(rod)
        return sides

    def component_of(self, rod: int) -> Component:
        """Rows of the pairs of a rod with its support, or with the rod before it."""
        if self._n_lower:
            sides = [self._n_lower + rod - 1, rod - 1]
            above, below = self.sides[sides, self.rubbing]
            return Component(above, below)
        return Component(self.sides[rod, self.rubbing])

    def points_of(self, rod: int) -> Indices:
        """Index of the point of each pair of a rod's contact, (n_pairs,).

        Where the rod or the one before it is broken there are two points.
        """
        nodes = self.nodes_of_pairs
        beyond = self._beyond[max(rod - 1, 0) : rod + 1].max(axis=0)
        return np.asarray(nodes - nodes[0] + beyond[self.pieces_of_pairs])
