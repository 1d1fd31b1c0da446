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


class CutRods:
    """Parallel rods that are all cut alike, and the numbers of degrees of freedom and rows.

    Each rod rubs on a support of its own, or on the rods before and behind it. Degrees of freedom
    run along rod after rod; a broken one has two at its break, and no boundary row there. Rows are
    ordered by law, so that those of one law follow each other: the lower sides of all contacts, if
    they are between rods, the upper sides of all contacts, then the left ends and the right ends,
    cut by cut.

    Parameters
    ----------
    sizes
        Elements of the pieces of a rod.
    rods
        Number of rods.
    on_supports
        Whether rods rub on supports.
    rub_at_ends
        Whether the first and the last node of a rod rub.
    broken
        Number of the broken rod, and of the piece to the left of its break, from 0; or None.

    Attributes
    ----------
    starts
        First nodes of the pieces.
    rubbing
        Nodes of each piece that rub, numbered from its first.
    nodes
        Node of every pair of one contact, piece after piece; a cut's has two.
    nodes_of_dofs
        Node of every degree of freedom, one array per rod.
    left, right
        Rows of the ends, shape (n_pieces, n_rods), `NO_ROW` at the break.
    lower
        Number of contacts that have a rod below.
    """

    def __init__(
        self,
        sizes: Sequence[int],
        rods: int,
        on_supports: bool,
        rub_at_ends: tuple[bool, bool],
        broken: tuple[int, int] | None = None,
    ) -> None:
        self.sizes, self.broken = sizes, broken
        self.starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
        self.rubbing = [np.arange(size + 1) for size in sizes]
        if not rub_at_ends[0]:
            self.rubbing[0] = self.rubbing[0][1:]
        if not rub_at_ends[1]:
            self.rubbing[-1] = self.rubbing[-1][:-1]
        pieces = list(zip(self.starts, self.rubbing, strict=True))
        self.nodes = np.concatenate([start + rubbing for start, rubbing in pieces])
        self.nodes_of_dofs = [np.arange(sum(sizes) + 1)] * rods
        ends = np.ones((2, len(sizes), rods), dtype=bool)
        if broken is not None:
            rod, before = broken
            node = self.starts[before + 1]
            self.nodes_of_dofs[rod] = np.insert(self.nodes_of_dofs[rod], node, node)
            ends[1, before, rod] = ends[0, before + 1, rod] = False
        self._first_dof = np.concatenate([[0], np.cumsum([len(x) for x in self.nodes_of_dofs])])
        self._first_row = np.concatenate([[0], np.cumsum([len(own) for own in self.rubbing])])
        self.lower = 0 if on_supports else rods - 1
        sides = rods if on_supports else 2 * (rods - 1)
        rows = sides * self._first_row[-1] - 1 + np.cumsum(ends.ravel())
        self.left, self.right = np.where(ends.ravel(), rows, NO_ROW).reshape(ends.shape)

    def dofs(self, rod: int, piece: int) -> Indices:
        """Degrees of freedom of one piece."""
        start = self._first_dof[rod] + self.starts[piece]
        if self.broken is not None and rod == self.broken[0] and piece > self.broken[1]:
            start += 1
        return np.arange(start, start + self.sizes[piece] + 1)

    def component(self, rod: int) -> Component:
        """Rows of a rod on its support, or on the rod before it."""
        if not self.lower:
            return Component(self._side(rod))
        return Component(self._side(self.lower + rod - 1), self._side(rod - 1))

    def _side(self, number: int) -> Indices:
        size = self._first_row[-1]
        return np.arange(number * size, (number + 1) * size)

    def rows(self, rod: int, piece: int) -> tuple[Indices, Indices, int]:
        """Rows of one piece, the node of it under each, and how many, the last, are its ends."""
        some = slice(self._first_row[piece], self._first_row[piece + 1])
        numbers = [rod]
        if self.lower:
            # On the rod before it, and below the one behind it.
            numbers = [self.lower + rod - 1] * (rod > 0) + [rod] * (rod < self.lower)
        sides = [self._side(number)[some] for number in numbers]
        ends = np.array([self.left[piece, rod], self.right[piece, rod]])
        there = ends != NO_ROW
        held = np.array([0, self.sizes[piece]])[there]
        trace = np.concatenate([*[self.rubbing[piece]] * len(sides), held])
        return np.concatenate([*sides, ends[there]]), trace, len(held)

    def points(self, rod: int) -> Indices:
        """Point of every pair of what a rod rubs on; there are two at a break of either rod."""
        places: Indices = self.nodes - self.nodes[0]
        if self.broken is not None and self.broken[0] in (rod, rod - 1):
            piece = np.repeat(np.arange(len(self.sizes)), [len(own) for own in self.rubbing])
            places += piece > self.broken[1]
        return places

    def weights(self, element_length: float) -> Array:
        """Tributary lengths of all pairs of one contact."""
        pieces = zip(self.sizes, self.rubbing, strict=True)
        return np.concatenate([tributary(size, element_length)[own] for size, own in pieces])

    def macro(self) -> sparse.csr_array | None:
        """Macro basis of a contact between rods: polynomials on every piece."""
        if not self.lower:
            return None
        counts = [len(nodes) for nodes in self.rubbing]
        bases = [np.vander(np.linspace(-1.0, 1.0, n), min(MACRO_DEGREE + 1, n)) for n in counts]
        return sparse.csr_array(block_diag(*bases))

    def cuts(self) -> Iterator[tuple[str, Interface]]:
        """Cuts through all rods by name; the macro problem balances the force of each rod."""
        for piece in range(len(self.sizes) - 1):
            first, second = self.right[piece], self.left[piece + 1]
            whole = first != NO_ROW
            macro = np.eye(int(whole.sum()))
            yield f"cut {piece + 1}-{piece + 2}", Perfect(first[whole], second[whole], macro)


def discretise_rods(rods: Rods) -> Problem:
    """Cut all rods at the same nodes and write the laws of their interfaces.

    Lengths are scaled by L, forces by ES of one rod (solver/README.md, 1). On the support the
    interface is "friction"; "contact 1-2" lies between rods 1 and 2, the second being the body
    above. Its points run along the rods; at the break of either there are two, one for each of the
    parts that have come apart.

    Elements are dealt to substructures, with a cut at the break. Between rods held ends do not rub:
    nothing slips there, and friction could not be told from the reactions.
    """
    sizes, broken, rubs = substructure_sizes(rods.elements, rods.substructures), None, (True, True)
    if rods.broken is not None:
        node, count = rods.broken[1], max(rods.substructures, 2)
        beyond = rods.elements - node
        before = round(count * node / rods.elements)
        before = min(max(before, 1, count - beyond), node, count - 1)
        sizes = substructure_sizes(node, before) + substructure_sizes(beyond, count - before)
        broken = rods.broken[0] - 1, before - 1
    names = ["friction"]
    if rods.wires > 1:
        rubs = not rods.left.is_prescribed, not rods.right.is_prescribed
        names = [f"contact {number}-{number + 1}" for number in range(1, rods.wires)]
    cut = CutRods(sizes, rods.wires, rods.wires == 1, rubs, broken)
    scales = Scales(rods.length, rods.stiffness, rods.duration)
    return assembled(cut, [rods] * rods.wires, [rods.nodes] * rods.wires, names, scales)


def assembled(
    cut: CutRods,
    rods: Sequence[Rods],
    places: Sequence[Array],
    names: Sequence[str],
    scales: Scales,
) -> Problem:
    """Discrete problem of rods that are cut alike, and have ends and instants alike.

    The search direction of the cuts and ends is ES/l_sub, with ES the harmonic mean over the
    substructure. On the friction points it is that of a density ES/l_sub^2 over one element's
    length, the same at every node and on both sides of a contact: with the halved tributary length
    at the two sides of a cut, the iterations miss the figures that an independent implementation
    reports (displacement error 0.15 against 0.21 at iteration 10 of its test), with the whole
    element length they meet them.

    Each is one of `rods`; `places` are those of its nodes, shape (n_nodes,), m, and `names` are of
    the interfaces on supports, or between two rods.
    """
    shared: dict[tuple[object, ...], Elasticity] = {}
    first, carried = rods[0], rods[0].settlement
    rubbing = range(len(rods) - len(names), len(rods))
    interfaces: dict[str, Interface] = {
        name: _friction(cut, rod, rods[rod], places[rod], scales)
        for name, rod in zip(names, rubbing, strict=True)
    }
    interfaces[SIDES["left"]] = _held_or_pulled(first, first.left, cut.left[0], 0, scales)
    interfaces |= cut.cuts()
    interfaces[SIDES["right"]] = _held_or_pulled(first, first.right, cut.right[-1], -1, scales)
    return Problem(
        substructures=tuple(
            _substructure(cut, rod, piece, rods[rod], scales, shared)
            for rod in range(len(rods))
            for piece in range(len(cut.sizes))
        ),
        interfaces=interfaces,
        positions=np.concatenate(
            [own[nodes] for own, nodes in zip(places, cut.nodes_of_dofs, strict=True)]
        ),
        instants=first.instants,
        carried=None if carried is None else carried / scales.displacement,
        scales=scales,
    )


def _substructure(
    cut: CutRods,
    rod: int,
    piece: int,
    rods: Rods,
    scales: Scales,
    shared: dict[tuple[object, ...], Elasticity],
) -> Substructure:
    size, start = cut.sizes[piece], cut.starts[piece]
    rows, trace, ends = cut.rows(rod, piece)
    length, stiffness = rods.length / scales.displacement, _stiffness(rods, scales)
    stiffness = stiffness[start : start + size]
    springs = {
        node: end
        for node, end, is_there in (
            (0, rods.left, piece == 0),
            (size, rods.right, piece == len(cut.sizes) - 1),
        )
        if is_there and end.is_on_spring
    }
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
    strain = rods.free_strain
    needed = None
    if strain is not None:
        needed = strain[start : start + size] * stiffness[:, None]
        # Elements push against their nodes with the force that would keep them as they were.
        forces.append(np.diff(-needed, axis=0, prepend=0.0, append=0.0))
    for node, end in springs.items():
        pulled = np.zeros((size + 1, len(rods.instants)))
        pulled[node] = end.spring / scales.force * _seen(rods, end, start + node)
        forces.append(pulled)
    body_force = sum(forces[1:], forces[0]) if forces else None
    return Substructure(shared[key], cut.dofs(rod, piece), rows, body_force, needed)


def _stiffness(rods: Rods, scales: Scales) -> Array:
    """ES of every element of a rod, scaled."""
    section = np.ones(rods.elements) if rods.section is None else rods.section
    return np.asarray(section * (rods.stiffness / scales.force))


def _seen(rods: Rods, end: End, node: int) -> Array:
    """Displacement of what holds an end, as seen from the support, shape (n_instants,), m."""
    assert end.displacement is not None
    settled = 0.0 if rods.settlement is None else rods.settlement[node]
    return np.asarray(end.displacement - settled)


def _held_or_pulled(rods: Rods, end: End, rows: Indices, node: int, scales: Scales) -> Interface:
    """Law of the ends of all rods; a spring that holds one is part of the rod."""
    if end.is_prescribed:
        held = _seen(rods, end, node) / scales.displacement
        return Dirichlet(rows, np.tile(held, (len(rows), 1)))
    force = np.zeros(len(rods.instants)) if end.force is None else end.force
    return Neumann(rows, np.tile(force / scales.force, (len(rows), 1)), np.eye(len(rows)))


def _friction(cut: CutRods, rod: int, rods: Rods, places: Array, scales: Scales) -> Contact:
    weights, points = rods.length * cut.weights(1.0 / rods.elements), cut.points(rod)
    positions = np.zeros(points[-1] + 1)
    positions[points] = places[cut.nodes]
    known = rods.bounds[cut.nodes] * weights[:, None] / scales.force
    if rods.factors is not None:
        known = known * rods.factors[rod - 1]
    # Around a node are half an element on either side, in series.
    soft = np.pad(1.0 / _stiffness(rods, scales), 1, mode="edge")
    around = 2.0 / (soft[:-1] + soft[1:]) * (scales.displacement / rods.length)
    component, units = cut.component(rod), (scales.displacement, scales.force)
    return Contact(
        tangential=rods.friction_law.at(component, weights, units, known=known),
        points=points,
        positions=positions,
        weights=weights,
        around=Rod(around[cut.nodes]),
        macro=cut.macro(),
    )
