"""Discrete problem of rods: linear elements that are cut, friction lumped at nodes."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import block_diag

from solver.arrays import Array, Indices
from solver.cache import CACHE
from solver.discrete.problem import Problem
from solver.discrete.rods.end import SIDES, End
from solver.discrete.rods.loads import (
    displacement_of,
    force_of_strains,
    sliding_length,
)
from solver.discrete.rods.pieces import (
    NO_ROW,
    Piece,
    RodPieces,
    RodRows,
    content_without_friction,
)
from solver.discrete.rods.rods import Rods
from solver.discrete.substructure import Elasticity, Scales, Substructure, tributary
from solver.laws import Contact, Dirichlet, Interface, Neumann, Perfect, RodStiffness

DEGREES = 2
"""Macro modes of the friction force on each piece of a contact between rods: resultant
and first moment. Without them the forces of both sides balance only slowly: 1 % of the
friction force then takes more than 200 iterations instead of 40 (measured by default,
with Anderson acceleration and automatic k). 4 modes save up to half of the iterations
with 20 wires or more in 4 pieces each, and so do 10 pieces; few wires gain nothing."""


def problem_of(rods: Rods) -> Problem:
    """Make the discrete problem of rods.

    The interface with a support is "friction"; "contact 1-2" lies between rods 1 and 2,
    of which rod 2 is the body above. Its points run along the rods; at the break of
    either there are two, one for each of the parts that have come apart.

    Between rods, ends of prescribed displacement do not rub: nothing slips there, and
    friction could not be told from the reactions.
    """
    if rods.wires == 1:
        names = ["friction"]
        rub_at_ends = (True, True)
    else:
        numbers = range(1, rods.wires)
        names = [f"contact {number}-{number + 1}" for number in numbers]
        rub_at_ends = (not rods.left.is_prescribed, not rods.right.is_prescribed)
    places = [rods.nodes] * rods.wires
    return CutRods([rods] * rods.wires, places, names, rub_at_ends).problem()


class CutRods:
    """Parallel rods with the same cuts, ends, elements and instants.

    Lengths are scaled by the longest rod, forces by ES of the stiffest
    (MATHEMATICS.md, 1).

    Each rod rubs on a support of its own, or on the rods before and behind it; `names`
    are the names of these interfaces, `positions` those of the nodes of each rod,
    (n_nodes,), m, and `rub_at_ends` says whether the first and the last node rub. Each
    interface represents a number of `copies`, by default for itself alone.

    The search direction of the cuts and ends is ES/l_sub, with ES the harmonic mean
    over the substructure. On the friction points it is the density ES/l_sub^2 times one
    element's length, the same at every node and on both sides of a contact: with the
    halved tributary length at the two sides of a cut, the iterations miss the figures
    that an independent implementation reports (displacement error 0.15 against 0.21 at
    iteration 10 of its test); with the whole element length they meet them.
    """

    def __init__(
        self,
        rods: Sequence[Rods],
        positions: Sequence[Array],
        names: Sequence[str],
        rub_at_ends: tuple[bool, bool],
        copies: Sequence[float] = (),
    ) -> None:
        self._rods = rods
        self._copies = copies or [1.0] * len(names)
        self._positions = positions
        self._names = names
        length = max(each.length for each in rods)
        stiffness = max(each.stiffness for each in rods)
        self._scales = Scales(length, stiffness, rods[0].duration)
        self._rows = RodRows(rods, len(names), rub_at_ends)
        self._shares = np.concatenate([tributary(size) for size in self._rows.sizes])

    def problem(self) -> Problem:
        """Discrete problem of the rods."""
        rods = self._rods[0]
        scales = self._scales
        carried = None
        if rods.settlement is not None:
            carried = rods.settlement / scales.displacement
        # Both degrees of freedom of a break stand at its node.
        positions = []
        for of_rod, dofs in zip(self._positions, self._rows.dofs_at, strict=True):
            positions.append(np.repeat(of_rod, dofs))
        parts = CACHE.get(self._content(), self._parts)
        return Problem(
            substructures=parts.substructures,
            interfaces=dict(self._interfaces()),
            positions=np.concatenate(positions),
            instants=rods.instants,
            carried=carried,
            scales=scales,
        )

    def _content(self) -> Hashable:
        """Digest of the data on which substructures depend: all except friction."""
        contents = {id(rods): content_without_friction(rods) for rods in self._rods}
        return (
            "substructures of rods",
            self._scales,
            self._rows.sides.shape,
            (self._rows.rubbing.start, self._rows.rubbing.stop),
            tuple(contents[id(rods)] for rods in self._rods),
        )

    def _parts(self) -> RodPieces:
        """All substructures, rod after rod, from the cache if possible."""
        # Pieces of equal operators share them, also those of different rods.
        shared: dict[tuple[object, ...], Elasticity] = {}
        substructures = list[Substructure]()
        for rod in range(len(self._rods)):
            substructures.extend(self._substructures(rod, shared))
        return RodPieces(substructures)

    def _substructures(
        self, rod: int, shared: dict[tuple[object, ...], Elasticity]
    ) -> Iterator[Substructure]:
        """Substructures of a rod from left to right; `shared` are earlier operators."""
        rods = self._rods[rod]
        stiffness = self._stiffness(rods)
        free_force = force_of_strains(rods, stiffness)
        inner_force = self._inner_force(rods, free_force)
        for piece in self._rows.pieces():
            rows = self._rows.rows_of(rod, piece)
            springs = piece.springs(rods)
            # A node of a break, or one that does not rub, has no row.
            is_row = rows != NO_ROW
            key = self._key(rods, piece, stiffness, springs, is_row)
            if key not in shared:
                make = partial(self._operator, rods, piece, stiffness, springs, is_row)
                shared[key] = CACHE.get(key, make)
            pushing = None
            if free_force is not None:
                pushing = free_force[piece.elements]
            yield Substructure(
                elasticity=shared[key],
                dofs=self._rows.dofs_of(rod, piece),
                rows=rows[is_row],
                body_force=self._body_force(rods, piece, springs, inner_force),
                free_force=pushing,
            )

    def _key(
        self,
        rods: Rods,
        piece: Piece,
        stiffness: Array,
        springs: Mapping[int, End],
        is_row: NDArray[np.bool_],
    ) -> tuple[object, ...]:
        """Cache key of the operator of a piece; parameters as `_operator`."""
        unit = self._scales.force / self._scales.displacement
        return (
            "rod",
            is_row.tobytes(),
            stiffness[piece.elements].tobytes(),
            (rods.length / self._scales.displacement, rods.elements),
            tuple((node, end.spring / unit) for node, end in springs.items()),
        )

    def _body_force(
        self,
        rods: Rods,
        piece: Piece,
        springs: Mapping[int, End],
        inner_force: Array | None,
    ) -> Array | None:
        """Nodal forces of a piece, (n_nodes, n_instants), scaled; None without any.

        Springs at the ends push with the displacement of what holds them.
        """
        force = None
        if inner_force is not None:
            force = inner_force[piece.nodes]
        for node, end in springs.items():
            if force is None:
                force = np.zeros((piece.size + 1, len(rods.instants)))
            held = displacement_of(end, rods, piece.first + node)
            force[node] += end.spring / self._scales.force * held
        return force

    def _inner_force(self, rods: Rods, free_force: Array | None) -> Array | None:
        """Nodal forces of a rod, piece after piece, (n_nodes + n_cuts, n_instants).

        Scaled; sum of the body force, and of `free_force`, (n_elements, n_instants),
        with which elements push against their nodes; None without both.
        """
        forces: list[Array] = []
        if rods.body_force is not None:
            unit = self._scales.displacement
            shape = (rods.elements + 1, len(rods.instants))
            along = np.broadcast_to(rods.body_force, shape)
            density = (along * unit / self._scales.force)[self._rows.nodes]
            lengths = rods.length / unit / rods.elements * self._shares
            forces.append(lengths[:, None] * density)
        if free_force is not None:
            # Nothing pushes from beyond the ends of a piece.
            ends = np.cumsum([0, *self._rows.sizes])
            pushing = np.insert(-free_force, ends, 0.0, axis=0)
            forces.append(np.diff(pushing, axis=0))
        if forces:
            return sum(forces[1:], forces[0])
        return None

    def _operator(
        self,
        rods: Rods,
        piece: Piece,
        stiffness: Array,
        springs: Mapping[int, End],
        is_row: NDArray[np.bool_],
    ) -> Elasticity:
        """Operator of a piece, from the cache if possible (`solver.cache`).

        `stiffness` is ES of the elements of the rod, (n_elements,), scaled; `springs`
        hold nodes of the piece; `is_row` says which boundary rows there are, (n,), of
        those of `RodRows.rows_of`.
        """
        units = self._scales
        own_stiffness = stiffness[piece.elements]
        length = rods.length / units.displacement
        element = length / rods.elements
        whole = piece.size * element
        at_ends = 1.0 / whole / float(np.mean(1.0 / own_stiffness))
        # Each contact has a row at every node, and both ends have one.
        nodes = np.append(
            np.arange(len(is_row) - 2) % (piece.size + 1), [0, piece.size]
        )
        direction = np.full(len(nodes), at_ends)
        # The last two rows are the ends, all others the points that rub.
        direction[:-2] = at_ends * element / whole
        of_springs = own_stiffness * (rods.elements / length)
        at_nodes = np.append(of_springs, 0.0) + np.insert(of_springs, 0, 0.0)
        bands = [-of_springs, at_nodes, -of_springs]
        matrix = sparse.csr_array(sparse.diags_array(bands, offsets=[-1, 0, 1]))
        for node, end in springs.items():
            matrix[node, node] += end.spring / (units.force / units.displacement)
        return Elasticity(matrix, nodes[is_row], direction[is_row])

    def _stiffness(self, rods: Rods) -> Array:
        """ES of every element of a rod, (n_elements,), scaled."""
        if rods.section is None:
            section = np.ones(rods.elements)
        else:
            section = rods.section
        return np.asarray(section * (rods.stiffness / self._scales.force))

    def _interfaces(self) -> Iterator[tuple[str, Interface]]:
        """All interfaces: contacts, then ends and cuts from the left to the right."""
        rods = self._rods[0]
        first_above = len(self._rods) - len(self._names)
        for number, name in enumerate(self._names):
            yield name, self._friction(first_above + number, self._copies[number])
        yield SIDES["left"], self._held_or_pulled(rods.left, self._rows.ends[0, 0], 0)
        for piece in range(len(self._rows.sizes) - 1):
            first = self._rows.ends[1, piece]
            second = self._rows.ends[0, piece + 1]
            whole = first != NO_ROW
            # The macro problem balances the force of each rod.
            macro = np.eye(int(whole.sum()))
            law = Perfect(first[whole], second[whole], macro)
            yield f"cut {piece + 1}-{piece + 2}", law
        yield (
            SIDES["right"],
            self._held_or_pulled(rods.right, self._rows.ends[1, -1], -1),
        )

    def _held_or_pulled(self, end: End, rows: Indices, node: int) -> Interface:
        """Law of the ends of all rods on a side, at their rows, (n_rods,).

        A spring that holds the end is part of the rod: then the end is free.
        """
        if end.is_prescribed:
            held = displacement_of(end, self._rods[0], node)
            held = held / self._scales.displacement
            return Dirichlet(rows, np.tile(held, (len(rows), 1)))
        if end.force is None:
            force = np.zeros(len(self._rods[0].instants))
        else:
            force = end.force
        pulled = np.tile(force / self._scales.force, (len(rows), 1))
        return Neumann(rows, pulled, np.eye(len(rows)))

    def _friction(self, rod: int, copies: float) -> Contact:
        """Contact law of a rod with its support, or with the rod before it."""
        rods = self._rods[rod]
        units = (self._scales.displacement, self._scales.force)
        component = self._rows.component_of(rod)
        if component.below is None:
            macro = None
            sliding = sliding_length(rods) / rods.length
        else:
            # Of rods beside each other all slide, or those of a broken one alone.
            macro = self._macro_basis()
            sliding = 1.0
        nodes = self._rows.nodes_of_pairs
        weights = rods.length * (self._shares[self._rows.rubbing] / rods.elements)
        # The strength is per length: a pair has that of its tributary length.
        known = rods.strengths[nodes] * weights[:, None] / units[1]
        known = known * np.broadcast_to(rods.factors, len(self._names))[rod - 1]
        points = self._rows.points_of(rod)
        positions = np.zeros(points[-1] + 1)
        positions[points] = self._positions[rod][nodes]
        return Contact(
            tangential=rods.friction_law.at(component, weights, units, known=known),
            points=points,
            positions=positions,
            weights=weights,
            stiffness_beside=RodStiffness(
                self._stiffness_at_nodes(rods)[nodes], sliding
            ),
            macro=macro,
            copies=copies,
        )

    def _macro_basis(self) -> sparse.csr_array:
        """Macro basis of a contact between rods, (n_pairs, n_macro), piece by piece."""
        # Macro forces balance on each piece, whose operator sees no others.
        counts = np.bincount(self._rows.pieces_of_pairs).tolist()
        bases = list[Array]()
        for count in counts:
            along = np.linspace(-1.0, 1.0, count)
            bases.append(np.vander(along, min(DEGREES, count)))
        return sparse.csr_array(block_diag(*bases))

    def _stiffness_at_nodes(self, rods: Rods) -> Array:
        """ES around each node of a rod, (n_nodes,), scaled, over the rod's length.

        Around a node are half an element on either side, in series.
        """
        compliance = np.pad(1.0 / self._stiffness(rods), 1, mode="edge")
        in_series = 2.0 / (compliance[:-1] + compliance[1:])
        return in_series * (self._scales.displacement / rods.length)
