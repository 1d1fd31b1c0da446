"""Rods as a discrete problem: linear elements that are cut, friction lumped at the nodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse
from scipy.linalg import block_diag

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem, Scales
from solver.discrete.substructure import (
    Elasticity,
    Substructure,
    substructure_sizes,
    tributary,
)
from solver.laws import Component, Contact, Dirichlet, Interface, Neumann, Perfect, Rod

if TYPE_CHECKING:
    from solver.discrete.rods.rods import End, Rods

DEGREES = 2
"""Polynomials of the friction force on each piece of a contact: resultant and first
moment. Without them both sides balance each other but slowly: 1 % of the friction force
then takes more than 200 iterations instead of 40 (measured by default, with Anderson
acceleration and automatic k). 4 save up to half of the iterations with 20 wires or more
in 4 pieces each, and so do 10 pieces; few wires gain nothing."""
NO_ROW = -1
SIDES = {"left": "support", "right": "load"}
"""Interfaces of the ends, by their side."""


def _pieces_of(rods: Rods) -> tuple[list[int], int]:
    """Elements of the pieces of each rod, and how many pieces lie before the break of one."""
    if rods.broken is None:
        return substructure_sizes(rods.elements, rods.substructures), 0
    node = rods.broken[1]
    count = max(rods.substructures, 2)
    beyond = rods.elements - node
    before = round(count * node / rods.elements)
    before = min(max(before, 1, count - beyond), node, count - 1)
    return substructure_sizes(node, before) + substructure_sizes(
        beyond, count - before
    ), before


class CutRods:
    """Parallel rods that are all cut alike, with ends, elements and instants alike.

    Lengths are scaled by the longest rod, forces by ES of the stiffest
    (solver/README.md, 1).

    Each rod rubs on a support of its own, or on the rods before and behind it; `names`
    are those of the interfaces, and `places` the positions of the nodes of each rod,
    (n_nodes,), m. Degrees of freedom run along rod after rod; a broken one has two at
    its break, and no boundary row there. Rows of one law follow each other: the lower
    sides of all contacts, if they are between rods, the upper sides of all contacts,
    then the left ends and the right ends, cut by cut.

    The search direction of the cuts and ends is ES/l_sub, with ES the harmonic mean
    over the substructure. On the friction points it is that of a density ES/l_sub^2
    over one element's length, the same at every node and on both sides of a contact:
    with the halved tributary length at the two sides of a cut, the iterations miss the
    figures that an independent implementation reports (displacement error 0.15 against
    0.21 at iteration 10 of its test), with the whole element length they meet them.
    """

    def __init__(
        self,
        rods: Sequence[Rods],
        places: Sequence[Array],
        names: Sequence[str],
        rub_at_ends: tuple[bool, bool],
    ) -> None:
        self._rods = rods
        self._places = places
        self._names = names
        length = max(one.length for one in rods)
        stiffness = max(one.stiffness for one in rods)
        self._scales = Scales(length, stiffness, rods[0].duration)
        self._sizes, before = _pieces_of(rods[0])
        # Nodes of piece after piece: a cut's are there twice.
        self._piece = np.repeat(np.arange(len(self._sizes)), np.add(self._sizes, 1))
        self._nodes = np.arange(len(self._piece)) - self._piece
        self._shares = np.concatenate([tributary(size) for size in self._sizes])
        self._rubs = slice(1 - rub_at_ends[0], len(self._nodes) - 1 + rub_at_ends[1])
        # Beyond its break a rod has one degree of freedom more.
        self._beyond = np.zeros((len(rods), len(self._sizes)), dtype=np.intp)
        if rods[0].broken is not None:
            self._beyond[rods[0].broken[0] - 1, before:] = 1
        breaks = np.diff(self._beyond, axis=1)
        self._dofs_at = np.ones((len(rods), rods[0].elements + 1), dtype=np.intp)
        self._dofs_at[:, np.cumsum(self._sizes)[:-1]] += breaks
        # Contacts that have a rod below.
        if len(names) == len(rods):
            self._lower = 0
        else:
            self._lower = len(names)
        self._sides = np.full((len(names) + self._lower, len(self._nodes)), NO_ROW)
        rubbing = self._sides[:, self._rubs]
        rubbing[:] = np.arange(rubbing.size).reshape(rubbing.shape)
        is_there = np.ones((2, len(self._sizes), len(rods)), dtype=bool)
        is_there[0, 1:] = is_there[1, :-1] = breaks.T == 0
        rows = rubbing.size - 1 + np.cumsum(is_there).reshape(is_there.shape)
        self._ends = np.where(is_there, rows, NO_ROW)

    def problem(self) -> Problem:
        """The discrete problem."""
        carried = self._rods[0].settlement
        scales = self._scales
        shared: dict[tuple[object, ...], Elasticity] = {}
        wholes = zip(self._places, self._dofs_at, strict=True)
        return Problem(
            substructures=tuple(
                piece
                for rod in range(len(self._rods))
                for piece in self._pieces(rod, shared)
            ),
            interfaces=dict(self._interfaces()),
            positions=np.concatenate([np.repeat(own, dofs) for own, dofs in wholes]),
            instants=self._rods[0].instants,
            carried=None if carried is None else carried / scales.displacement,
            scales=scales,
        )

    def _pieces(
        self, rod: int, shared: dict[tuple[object, ...], Elasticity]
    ) -> Iterator[Substructure]:
        """All pieces of a rod; those of equal operators share it."""
        rods = self._rods[rod]
        stiffness = self._stiffness(self._rods[rod])
        sides = self._sides[[rod]]
        if self._lower:
            # On the rod before it, and below the one behind it.
            sides = self._sides[
                [self._lower + rod - 1] * (rod > 0) + [rod] * (rod < self._lower)
            ]
        strain = rods.strain
        if rods.settlement is not None:
            # Seen from a support that moves by s, a rod is as if it shrank by ds/dx.
            moved = np.diff(rods.settlement, axis=0) * (rods.elements / rods.length)
            if strain is None:
                strain = -moved
            else:
                strain = strain - moved
        if strain is None:
            needed = None
        else:
            needed = strain * stiffness[:, None]
        inner = self._inner_force(rods, needed)
        held = {0: rods.left, rods.elements: rods.right}
        on_springs = {node: end for node, end in held.items() if end.is_on_spring}
        start = 0
        first_dof = int(self._dofs_at[:rod].sum())
        for piece, size in enumerate(self._sizes):
            elements = slice(start, start + size)
            span = range(start, start + size + 1)
            nodes = slice(span.start + piece, span.stop + piece)
            rows = np.concatenate([sides[:, nodes].ravel(), self._ends[:, piece, rod]])
            trace = np.concatenate([*[np.arange(size + 1)] * len(sides), [0, size]])
            is_row = rows != NO_ROW
            springs = {
                node - start: on_springs[node] for node in on_springs if node in span
            }
            key = (
                is_row.tobytes(),
                stiffness[elements].tobytes(),
                rods.length,
                tuple(springs),
            )
            if key not in shared:
                own = stiffness[elements]
                ends = int(is_row[-2:].sum())
                shared[key] = self._operator(rods, own, trace[is_row], ends, springs)
            if inner is None:
                force = None
            else:
                force = inner[nodes]
            for node, end in springs.items():
                if force is None:
                    force = np.zeros((size + 1, len(rods.instants)))
                else:
                    force = force
                force[node] += (
                    end.spring / self._scales.force * _seen(rods, end, start + node)
                )
            first = first_dof + start + int(self._beyond[rod, piece])
            yield Substructure(
                elasticity=shared[key],
                dofs=np.arange(first, first + size + 1),
                rows=rows[is_row],
                body_force=force,
                free_force=None if needed is None else needed[elements],
            )
            start += size

    def _inner_force(self, rods: Rods, needed: Array | None) -> Array | None:
        """Forces inside the pieces of a rod, piece after piece, (n_nodes, n_instants), scaled.

        Of body forces, and of elements that push against their nodes with the force
        that would keep them as they were; None of neither.
        """
        forces: list[Array] = []
        if rods.body_force is not None:
            unit = self._scales.displacement
            along = np.broadcast_to(
                rods.body_force, (rods.elements + 1, len(rods.instants))
            )
            element = rods.length / unit / rods.elements * self._shares
            forces.append(
                element[:, None] * (along * unit / self._scales.force)[self._nodes]
            )
        if needed is not None:
            pushing = np.insert(-needed, np.cumsum([0, *self._sizes]), 0.0, axis=0)
            forces.append(np.diff(pushing, axis=0))
        if forces:
            return sum(forces[1:], forces[0])
        return None

    def _operator(
        self,
        rods: Rods,
        stiffness: Array,
        trace: Indices,
        ends: int,
        springs: Mapping[int, End],
    ) -> Elasticity:
        """Operator of a piece by what its elements have for stiffness, its rows and springs."""
        units = self._scales
        size = len(stiffness)
        length = rods.length / units.displacement
        part = size * (element := length / rods.elements)
        at_ends = 1.0 / part / float(np.mean(1.0 / stiffness))
        direction = np.full(len(trace), at_ends)
        direction[: len(trace) - ends] = at_ends * element / part
        springs_of = stiffness * (rods.elements / length)
        at_nodes = np.append(springs_of, 0.0) + np.insert(springs_of, 0, 0.0)
        bands = [-springs_of, at_nodes, -springs_of]
        matrix = sparse.csr_array(sparse.diags_array(bands, offsets=[-1, 0, 1]))
        for node, end in springs.items():
            matrix[node, node] += end.spring / (units.force / units.displacement)
        return Elasticity(matrix, trace, direction)

    def _stiffness(self, rods: Rods) -> Array:
        """ES of every element of a rod, scaled."""
        if rods.section is None:
            section = np.ones(rods.elements)
        else:
            section = rods.section
        return np.asarray(section * (rods.stiffness / self._scales.force))

    def _interfaces(self) -> Iterator[tuple[str, Interface]]:
        """Contacts, and then ends and cuts from the left to the right."""
        first_above = len(self._rods) - len(self._names)
        for number, name in enumerate(self._names):
            yield name, self._friction(first_above + number)
        yield (
            SIDES["left"],
            self._held_or_pulled(self._rods[0].left, self._ends[0, 0], 0),
        )
        for piece in range(len(self._sizes) - 1):
            first = self._ends[1, piece]
            second = self._ends[0, piece + 1]
            whole = first != NO_ROW
            # The macro problem balances the force of each rod.
            macro = np.eye(int(whole.sum()))
            yield (
                f"cut {piece + 1}-{piece + 2}",
                Perfect(first[whole], second[whole], macro),
            )
        yield (
            SIDES["right"],
            self._held_or_pulled(self._rods[0].right, self._ends[1, -1], -1),
        )

    def _held_or_pulled(self, end: End, rows: Indices, node: int) -> Interface:
        """Law of the ends of all rods; a spring that holds one is part of the rod."""
        if end.is_prescribed:
            held = _seen(self._rods[0], end, node) / self._scales.displacement
            return Dirichlet(rows, np.tile(held, (len(rows), 1)))
        if end.force is None:
            force = np.zeros(len(self._rods[0].instants))
        else:
            force = end.force
        pulled = np.tile(force / self._scales.force, (len(rows), 1))
        return Neumann(rows, pulled, np.eye(len(rows)))

    def _friction(self, rod: int) -> Contact:
        """Law of a rod on its support, or on the rod before it."""
        rods = self._rods[rod]
        units = (self._scales.displacement, self._scales.force)
        component = Component(self._sides[rod, self._rubs])
        macro = None
        piece = self._piece[self._rubs]
        nodes = self._nodes[self._rubs]
        if self._lower:
            above, below = self._sides[[self._lower + rod - 1, rod - 1], self._rubs]
            component = Component(above, below)
            on_pieces = np.bincount(piece).tolist()
            bases = [
                np.vander(np.linspace(-1.0, 1.0, n), min(DEGREES, n)) for n in on_pieces
            ]
            macro = sparse.csr_array(block_diag(*bases))
        weights = rods.length * (self._shares[self._rubs] / rods.elements)
        # Where one of both is broken there are two points.
        points = (
            nodes
            - nodes[0]
            + self._beyond[max(rod - 1, 0) : rod + 1].max(axis=0)[piece]
        )
        positions = np.zeros(points[-1] + 1)
        positions[points] = self._places[rod][nodes]
        known = rods.bounds[nodes] * weights[:, None] / units[1]
        known = known * np.broadcast_to(rods.factors, len(self._names))[rod - 1]
        # Around a node are half an element on either side, in series.
        soft = np.pad(1.0 / self._stiffness(rods), 1, mode="edge")
        around = 2.0 / (soft[:-1] + soft[1:]) * (units[0] / rods.length)
        return Contact(
            tangential=rods.friction_law.at(component, weights, units, known=known),
            points=points,
            positions=positions,
            weights=weights,
            around=Rod(around[nodes]),
            macro=macro,
        )


def _seen(rods: Rods, end: End, node: int) -> Array:
    """Displacement of what holds an end, as seen from the support, shape (n_instants,), m."""
    assert end.displacement is not None
    if rods.settlement is None:
        settled = 0.0
    else:
        settled = rods.settlement[node]
    return np.asarray(end.displacement - settled)
