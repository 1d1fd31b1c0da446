"""Rods as a discrete problem: linear elements that are cut, friction lumped at the nodes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse
from scipy.linalg import block_diag

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem, Scales
from solver.discrete.substructure import Elasticity, Substructure
from solver.laws import Component, Contact, Dirichlet, Interface, Neumann, Perfect, Rod

if TYPE_CHECKING:
    from solver.discrete.rods import End, Rods

MACRO_DEGREE = 1
"""Polynomials of the friction force on each piece of a contact: resultant and first moment. Without
them both sides balance each other but slowly: 1 % of the friction force then takes more than 200
iterations instead of 40 (measured by default, with Anderson acceleration and automatic k). 3 saves
up to half of the iterations with 20 wires or more in 4 pieces each, and so do 10 pieces; few wires
gain nothing."""
NO_ROW = -1
SIDES = {"left": "support", "right": "load"}
"""Interfaces of the ends, by their side."""


def rod_stiffness(element_stiffness: Array) -> sparse.csr_array:
    """Stiffness of linear elements in a row, (n + 1, n + 1), of ES/h of each of them, (n,)."""
    elements = len(element_stiffness)
    diagonal = np.zeros(elements + 1)
    diagonal[:-1] = element_stiffness
    diagonal[1:] += element_stiffness
    # Written out as it is stored: a general constructor takes ten times as long.
    entries = np.empty(3 * elements + 1)
    entries[::3] = diagonal
    entries[1::3] = entries[2::3] = np.negative(element_stiffness)
    nodes = np.arange(elements + 1)
    columns = np.repeat(nodes, 3)[1:-1]
    columns[1::3] += 1
    columns[2::3] -= 1
    ends = np.clip(3 * np.arange(elements + 2) - 1, 0, len(entries))
    return sparse.csr_array((entries, columns, ends), shape=(elements + 1, elements + 1))


def tributary(elements: int, element_length: float) -> Array:
    """Tributary lengths of the nodes of a row of elements, halved at its ends."""
    weights = np.full(elements + 1, element_length)
    weights[[0, -1]] = 0.5 * element_length
    return weights


def substructure_sizes(elements: int, substructures: int) -> list[int]:
    """Deal elements to substructures; sizes differ by at most one, the larger ones come first."""
    size, extra = divmod(elements, substructures)
    return [size + 1] * extra + [size] * (substructures - extra)


def _pieces_of(rods: Rods) -> tuple[list[int], tuple[int, int] | None]:
    """Elements of the pieces of each rod, which are cut at the break of one.

    And the number of the broken rod and of the piece to the left of its break, from 0; or None.
    """
    if rods.broken is None:
        return substructure_sizes(rods.elements, rods.substructures), None
    (rod, node), count = rods.broken, max(rods.substructures, 2)
    beyond = rods.elements - node
    before = round(count * node / rods.elements)
    before = min(max(before, 1, count - beyond), node, count - 1)
    sizes = substructure_sizes(node, before) + substructure_sizes(beyond, count - before)
    return sizes, (rod - 1, before - 1)


class CutRods:
    """Parallel rods that are all cut alike.

    Each rod rubs on a support of its own, or on the rods before and behind it. Degrees of freedom
    run along rod after rod; a broken one has two at its break, and no boundary row there. Rows are
    ordered by law, so that those of one law follow each other: the lower sides of all contacts, if
    they are between rods, the upper sides of all contacts, then the left ends and the right ends,
    cut by cut.

    The search direction of the cuts and ends is ES/l_sub, with ES the harmonic mean over the
    substructure. On the friction points it is that of a density ES/l_sub^2 over one element's
    length, the same at every node and on both sides of a contact: with the halved tributary length
    at the two sides of a cut, the iterations miss the figures that an independent implementation
    reports (displacement error 0.15 against 0.21 at iteration 10 of its test), with the whole
    element length they meet them.

    Parameters
    ----------
    rods
        Each rod is one of these; they have ends, numbers of elements and instants alike.
    places
        Positions of the nodes of each, shape (n_nodes,), m.
    names
        Of the interfaces: on the support of each rod, or between each two.
    rub_at_ends
        Whether the first and the last node of a rod rub.
    scales
        As of `Problem`.
    """

    def __init__(
        self,
        rods: Sequence[Rods],
        places: Sequence[Array],
        names: Sequence[str],
        rub_at_ends: tuple[bool, bool],
        scales: Scales,
    ) -> None:
        self._rods, self._places, self._names, self._scales = rods, places, names, scales
        self._sizes, self._broken = _pieces_of(rods[0])
        self._starts = np.concatenate([[0], np.cumsum(self._sizes)[:-1]])
        # Nodes of each piece that rub, numbered from its first, and of one contact; a cut's twice.
        self._rubbing = [np.arange(size + 1) for size in self._sizes]
        if not rub_at_ends[0]:
            self._rubbing[0] = self._rubbing[0][1:]
        if not rub_at_ends[1]:
            self._rubbing[-1] = self._rubbing[-1][:-1]
        pieces = list(zip(self._starts, self._rubbing, strict=True))
        self._nodes = np.concatenate([start + rubbing for start, rubbing in pieces])
        self._nodes_of_dofs = [np.arange(len(own)) for own in places]
        ends = np.ones((2, len(pieces), len(rods)), dtype=bool)
        if self._broken is not None:
            rod, before = self._broken
            node = self._starts[before + 1]
            self._nodes_of_dofs[rod] = np.insert(self._nodes_of_dofs[rod], node, node)
            ends[1, before, rod] = ends[0, before + 1, rod] = False
        self._first_dof = np.concatenate([[0], np.cumsum([len(x) for x in self._nodes_of_dofs])])
        self._first_row = np.concatenate([[0], np.cumsum([len(own) for own in self._rubbing])])
        # Contacts that have a rod below.
        self._lower = 0 if len(names) == len(rods) else len(names)
        rows = (len(names) + self._lower) * len(self._nodes) - 1 + np.cumsum(ends.ravel())
        self._left, self._right = np.where(ends.ravel(), rows, NO_ROW).reshape(ends.shape)

    def problem(self) -> Problem:
        """The discrete problem."""
        rods, places, scales = self._rods, self._places, self._scales
        carried = rods[0].settlement
        shared: dict[tuple[object, ...], Elasticity] = {}
        return Problem(
            substructures=tuple(
                self._substructure(rod, piece, shared)
                for rod in range(len(rods))
                for piece in range(len(self._sizes))
            ),
            interfaces=dict(self._interfaces()),
            positions=np.concatenate(
                [own[nodes] for own, nodes in zip(places, self._nodes_of_dofs, strict=True)]
            ),
            instants=rods[0].instants,
            carried=None if carried is None else carried / scales.displacement,
            scales=scales,
        )

    def _side(self, number: int) -> Indices:
        return np.arange(number * len(self._nodes), (number + 1) * len(self._nodes))

    def _rows(self, rod: int, piece: int) -> tuple[Indices, Indices, int]:
        """Rows of one piece, the node of it under each, and how many, the last, are its ends."""
        some = slice(self._first_row[piece], self._first_row[piece + 1])
        numbers = [rod]
        if self._lower:
            # On the rod before it, and below the one behind it.
            numbers = [self._lower + rod - 1] * (rod > 0) + [rod] * (rod < self._lower)
        sides = [self._side(number)[some] for number in numbers]
        ends = np.array([self._left[piece, rod], self._right[piece, rod]])
        there = ends != NO_ROW
        held = np.array([0, self._sizes[piece]])[there]
        trace = np.concatenate([*[self._rubbing[piece]] * len(sides), held])
        return np.concatenate([*sides, ends[there]]), trace, len(held)

    def _substructure(
        self, rod: int, piece: int, shared: dict[tuple[object, ...], Elasticity]
    ) -> Substructure:
        rods, scales, size = self._rods[rod], self._scales, self._sizes[piece]
        rows, trace, ends = self._rows(rod, piece)
        start, length = self._starts[piece], rods.length / scales.displacement
        stiffness = self._stiffness(rods)[start : start + size]
        springs = {0: rods.left} if piece == 0 else {}
        springs |= {size: rods.right} if piece == len(self._sizes) - 1 else {}
        springs = {node: end for node, end in springs.items() if end.is_on_spring}
        key = trace.tobytes(), stiffness.tobytes(), length, tuple(springs)
        if key not in shared:
            part = size * (element := length / rods.elements)
            at_ends = 1.0 / part / float(np.mean(1.0 / stiffness))
            direction = np.full(len(trace), at_ends)
            direction[: len(trace) - ends] = at_ends * element / part
            matrix = rod_stiffness(stiffness * (rods.elements / length))
            for node, end in springs.items():
                matrix[node, node] += end.spring / (scales.force / scales.displacement)
            shared[key] = Elasticity(matrix, trace, direction)
        forces: list[Array] = []
        if rods.body_force is not None:
            along = np.broadcast_to(rods.body_force, (rods.elements + 1, len(rods.instants)))
            scaled = along[start : start + size + 1] * scales.displacement / scales.force
            forces.append(tributary(size, length / rods.elements)[:, None] * scaled)
        strain, needed = rods.free_strain, None
        if strain is not None:
            needed = strain[start : start + size] * stiffness[:, None]
            # Elements push against their nodes with the force that would keep them as they were.
            forces.append(np.diff(-needed, axis=0, prepend=0.0, append=0.0))
        for node, end in springs.items():
            pulled = np.zeros((size + 1, len(rods.instants)))
            pulled[node] = end.spring / scales.force * _seen(rods, end, start + node)
            forces.append(pulled)
        body_force = sum(forces[1:], forces[0]) if forces else None
        first_dof = self._first_dof[rod] + start
        if self._broken is not None and rod == self._broken[0] and piece > self._broken[1]:
            first_dof += 1
        dofs = np.arange(first_dof, first_dof + size + 1)
        return Substructure(shared[key], dofs, rows, body_force, needed)

    def _stiffness(self, rods: Rods) -> Array:
        """ES of every element of a rod, scaled."""
        section = np.ones(rods.elements) if rods.section is None else rods.section
        return np.asarray(section * (rods.stiffness / self._scales.force))

    def _interfaces(self) -> Iterator[tuple[str, Interface]]:
        """Contacts, and then ends and cuts from the left to the right."""
        first_above = len(self._rods) - len(self._names)
        for number, name in enumerate(self._names):
            yield name, self._friction(first_above + number)
        yield SIDES["left"], self._held_or_pulled(self._rods[0].left, self._left[0], 0)
        for piece in range(len(self._sizes) - 1):
            first, second = self._right[piece], self._left[piece + 1]
            whole = first != NO_ROW
            # The macro problem balances the force of each rod.
            macro = np.eye(int(whole.sum()))
            yield f"cut {piece + 1}-{piece + 2}", Perfect(first[whole], second[whole], macro)
        yield SIDES["right"], self._held_or_pulled(self._rods[0].right, self._right[-1], -1)

    def _held_or_pulled(self, end: End, rows: Indices, node: int) -> Interface:
        """Law of the ends of all rods; a spring that holds one is part of the rod."""
        if end.is_prescribed:
            held = _seen(self._rods[0], end, node) / self._scales.displacement
            return Dirichlet(rows, np.tile(held, (len(rows), 1)))
        force = np.zeros(len(self._rods[0].instants)) if end.force is None else end.force
        pulled = np.tile(force / self._scales.force, (len(rows), 1))
        return Neumann(rows, pulled, np.eye(len(rows)))

    def _friction(self, rod: int) -> Contact:
        """Law of a rod on its support, or on the rod before it."""
        rods, units = self._rods[rod], (self._scales.displacement, self._scales.force)
        component, macro = Component(self._side(rod)), None
        if self._lower:
            component = Component(self._side(self._lower + rod - 1), self._side(rod - 1))
            macro = _macro([len(nodes) for nodes in self._rubbing])
        pieces = list(zip(self._sizes, self._rubbing, strict=True))
        weights = rods.length * np.concatenate(
            [tributary(size, 1.0 / rods.elements)[own] for size, own in pieces]
        )
        points: Indices = self._nodes - self._nodes[0]
        if self._broken is not None and self._broken[0] in (rod, rod - 1):
            piece = np.repeat(np.arange(len(pieces)), [len(own) for own in self._rubbing])
            points += piece > self._broken[1]
        positions = np.zeros(points[-1] + 1)
        positions[points] = self._places[rod][self._nodes]
        known = rods.bounds[self._nodes] * weights[:, None] / units[1]
        if rods.factors is not None:
            known = known * rods.factors[rod - 1]
        # Around a node are half an element on either side, in series.
        soft = np.pad(1.0 / self._stiffness(rods), 1, mode="edge")
        around = 2.0 / (soft[:-1] + soft[1:]) * (units[0] / rods.length)
        return Contact(
            tangential=rods.friction_law.at(component, weights, units, known=known),
            points=points,
            positions=positions,
            weights=weights,
            around=Rod(around[self._nodes]),
            macro=macro,
        )


def _seen(rods: Rods, end: End, node: int) -> Array:
    """Displacement of what holds an end, as seen from the support, shape (n_instants,), m."""
    assert end.displacement is not None
    settled = 0.0 if rods.settlement is None else rods.settlement[node]
    return np.asarray(end.displacement - settled)


def _macro(counts: list[int]) -> sparse.csr_array:
    """Macro basis of a contact between rods: polynomials on every piece, of so many pairs."""
    bases = [np.vander(np.linspace(-1.0, 1.0, n), min(MACRO_DEGREE + 1, n)) for n in counts]
    return sparse.csr_array(block_diag(*bases))
