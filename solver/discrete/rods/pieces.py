"""Pieces of rods: where rods are cut, and the substructures cached between runs."""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Iterable
from typing import NamedTuple

import numpy as np

from solver.cache import content_of
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.discrete.substructure import Substructure, substructure_sizes

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
        ends = {0: rods.left, rods.elements: rods.right}
        return {
            node - self.first: end
            for node, end in ends.items()
            if self._is_held(node, end)
        }

    def _is_held(self, node: int, end: End) -> bool:
        """Check whether a node of the piece is an end of the rod on a spring."""
        return end.is_on_spring and self.first <= node <= self.first + self.size


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
