"""How rods are cut, and the numbers of their degrees of freedom and boundary rows."""

from __future__ import annotations

import numpy as np

from solver.arrays import Indices
from solver.discrete.rod import substructure_sizes
from solver.discrete.rods.data import RodsData

NO_ROW = -1


class Pieces:
    """How the rods are cut, and the numbers of degrees of freedom and rows.

    Rows are ordered by law, so that those of one law follow each other: the lower sides of all
    contacts between rods, the upper sides of all contacts, then the left ends and the right ends,
    cut by cut.

    Attributes
    ----------
    count
        Pieces of every rod.
    contacts
        Rod above and rod below of every interface with friction, from 0; below is None on the
        support.
    sizes, starts
        Elements and first nodes of the pieces.
    rubbing
        Nodes of each piece that rub, numbered from its first. Between rods held ends are none:
        nothing slips there, and friction could not be told from the reactions.
    broken
        Index of the broken rod, and of the piece to the left of its break; or None.
    nodes_of_dofs
        Node of every degree of freedom, one array per rod.
    left, right
        Rows of the ends, shape (count, n_rods), `NO_ROW` at the break.
    """

    def __init__(self, scene: RodsData) -> None:
        self.sizes, before = _dealt(scene)
        self.count = len(self.sizes)
        self.starts = np.concatenate([[0], np.cumsum(self.sizes)[:-1]])
        self.contacts: list[tuple[int, int | None]] = [(0, None)]
        self.rubbing = [np.arange(size + 1) for size in self.sizes]
        if scene.wires > 1:
            self.contacts = [(wire + 1, wire) for wire in range(scene.wires - 1)]
            self.rubbing[0] = self.rubbing[0][1:]
            if scene.rigid_grip:
                self.rubbing[-1] = self.rubbing[-1][:-1]
        self.broken = None if scene.broken is None else (scene.broken[0] - 1, before - 1)
        self.nodes_of_dofs = [np.arange(scene.elements + 1)] * scene.wires
        if scene.broken is not None:
            wire, node = scene.broken
            self.nodes_of_dofs[wire - 1] = np.insert(self.nodes_of_dofs[wire - 1], node, node)
        self._first_dof = np.concatenate([[0], np.cumsum([len(x) for x in self.nodes_of_dofs])])
        self._first_row = np.concatenate([[0], np.cumsum([len(own) for own in self.rubbing])])
        self._lower = sum(below is not None for _, below in self.contacts)
        ends = np.ones((2, self.count, scene.wires), dtype=bool)
        if self.broken is not None:
            wire, column = self.broken
            ends[1, column, wire] = ends[0, column + 1, wire] = False
        first = (self._lower + len(self.contacts)) * self._first_row[-1]
        rows = np.where(ends.ravel(), first - 1 + np.cumsum(ends.ravel()), NO_ROW)
        self.left, self.right = rows.reshape(ends.shape)

    def dofs(self, wire: int, column: int) -> Indices:
        """Give the degrees of freedom of one piece."""
        start = self._first_dof[wire] + self.starts[column]
        if self.broken is not None and wire == self.broken[0] and column > self.broken[1]:
            start += 1
        return np.arange(start, start + self.sizes[column] + 1)

    def above(self, contact: int) -> Indices:
        """Give the rows of the upper side of a contact, 0 the first."""
        return self._side(self._lower + contact)

    def below(self, contact: int) -> Indices | None:
        """Give the rows of the lower side of a contact, or None on the support."""
        return None if self.contacts[contact][1] is None else self._side(contact)

    def _side(self, number: int) -> Indices:
        size = self._first_row[-1]
        return np.arange(number * size, (number + 1) * size)

    def rows(self, wire: int, column: int) -> list[Indices]:
        """Give the rows of one piece on what is before it, on the rod after it, and at its ends."""
        own = slice(self._first_row[column], self._first_row[column + 1])
        found = [self.above(n)[own] for n, (above, _) in enumerate(self.contacts) if above == wire]
        found += [self._side(n)[own] for n, (_, below) in enumerate(self.contacts) if below == wire]
        ends = np.array([self.left[column, wire], self.right[column, wire]])
        return [*found, ends[ends != NO_ROW]]


def _dealt(scene: RodsData) -> tuple[list[int], int]:
    """Deal the elements of a rod to substructures; also give how many lie before the break."""
    if scene.broken is None:
        return substructure_sizes(scene.elements, scene.substructures), 0
    node, count = scene.broken[1], max(scene.substructures, 2)
    beyond = scene.elements - node
    before = round(count * node / scene.elements)
    before = min(max(before, 1, count - beyond), node, count - 1)
    return substructure_sizes(node, before) + substructure_sizes(beyond, count - before), before
