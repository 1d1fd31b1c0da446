"""Parallel wires as a discrete problem: linear elements, friction between opposite nodes."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.discrete.bar import substructure_sizes
from solver.discrete.problem import Elasticity, Problem, Scales, Substructure
from solver.discrete.rod import rod_stiffness, tributary
from solver.laws import Component, Dirichlet, Friction, Interface, Neumann, Perfect
from solver.scenes.strand import Strand

NO_ROW = -1
MACRO_DEGREE = 1
"""Polynomials of the friction force on each piece of a contact: resultant and first moment. Without
them both sides balance each other but slowly: 1 % of the friction force then takes more than 200
iterations instead of 40 (measured by default, with Anderson acceleration and automatic k). 3 saves
up to half of the iterations with 20 wires or more in 4 pieces each, and so do 10 pieces; few wires
gain nothing."""


def discretise_strand(scene: Strand) -> Problem:
    """Cut all wires at the same nodes and write the laws of their interfaces.

    Lengths are scaled by L, forces by ES of one wire; search directions are those of the bar
    (`discretise_bar`), the same on both sides of a contact. Degrees of freedom run along wire
    after wire; the broken wire has two at its break, and no boundary row there. "contact 1-2" lies
    between wires 1 and 2, the second being the body above. Its points run along the wires; at the
    break of either there are two, one for each of the parts that have come apart. Held ends are
    no points: nothing slips there, and friction could not be told from the reactions.
    """
    pieces = _Pieces(scene)
    shared: dict[tuple[object, ...], Elasticity] = {}
    return Problem(
        substructures=tuple(
            _substructure(scene, pieces, wire, column, shared)
            for wire in range(scene.wires)
            for column in range(pieces.count)
        ),
        interfaces=_interfaces(scene, pieces),
        positions=np.concatenate([scene.nodes[nodes] for nodes in pieces.nodes_of_dofs]),
        instants=scene.instants,
        scales=Scales(scene.length, scene.stiffness, scene.duration),
    )


class _Pieces:
    """How the wires are cut, and the numbers of degrees of freedom and rows.

    Rows are ordered by law, so that those of one law follow each other: the lower sides of all
    contacts, their upper sides, then the left ends and the right ends, cut by cut.

    Attributes
    ----------
    count
        Pieces of every wire.
    sizes, starts
        Their elements and first nodes.
    rubbing
        Nodes of each piece that rub, numbered from its first.
    broken
        Index of the broken wire, and of the piece to the left of its break; or None.
    nodes_of_dofs
        Node of every degree of freedom, one array per wire.
    left, right
        Rows of the ends, shape (count, n_wires), `NO_ROW` at the break.
    """

    def __init__(self, scene: Strand) -> None:
        self.sizes, before = _dealt(scene)
        self.count = len(self.sizes)
        self.starts = np.concatenate([[0], np.cumsum(self.sizes)[:-1]])
        self.rubbing = [np.arange(size + 1) for size in self.sizes]
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
        self._contacts = scene.wires - 1
        ends = np.ones((2, self.count, scene.wires), dtype=bool)
        if self.broken is not None:
            wire, column = self.broken
            ends[1, column, wire] = ends[0, column + 1, wire] = False
        first = 2 * self._contacts * self._first_row[-1]
        rows = np.where(ends.ravel(), first - 1 + np.cumsum(ends.ravel()), NO_ROW)
        self.left, self.right = rows.reshape(ends.shape)

    def dofs(self, wire: int, column: int) -> Indices:
        """Give the degrees of freedom of one piece."""
        start = self._first_dof[wire] + self.starts[column]
        if self.broken is not None and wire == self.broken[0] and column > self.broken[1]:
            start += 1
        return np.arange(start, start + self.sizes[column] + 1)

    def contact_rows(self, contact: int, side: int) -> Indices:
        """Give the rows of a contact, 0 the first, of its lower (0) or upper (1) side."""
        size = self._first_row[-1]
        first = (side * self._contacts + contact) * size
        return np.arange(first, first + size)

    def rows(self, wire: int, column: int) -> list[Indices]:
        """Give the rows of one piece on the wire before, on the wire after, and at its ends."""
        own = slice(self._first_row[column], self._first_row[column + 1])
        found = []
        if wire > 0:
            found.append(self.contact_rows(wire - 1, 1)[own])
        if wire < self._contacts:
            found.append(self.contact_rows(wire, 0)[own])
        ends = np.array([self.left[column, wire], self.right[column, wire]])
        return [*found, ends[ends != NO_ROW]]


def _dealt(scene: Strand) -> tuple[list[int], int]:
    """Deal the elements of a wire to substructures; also give how many lie before the break."""
    if scene.broken is None:
        return substructure_sizes(scene.elements, scene.substructures), 0
    node, count = scene.broken[1], max(scene.substructures, 2)
    beyond = scene.elements - node
    before = round(count * node / scene.elements)
    before = min(max(before, 1, count - beyond), node, count - 1)
    return substructure_sizes(node, before) + substructure_sizes(beyond, count - before), before


def _substructure(
    scene: Strand,
    pieces: _Pieces,
    wire: int,
    column: int,
    shared: dict[tuple[object, ...], Elasticity],
) -> Substructure:
    size, rubbing = pieces.sizes[column], pieces.rubbing[column]
    rows = pieces.rows(wire, column)
    ends = pieces.left[column, wire] != NO_ROW, pieces.right[column, wire] != NO_ROW
    key = size, len(rows), ends, len(rubbing), int(rubbing[0])
    if key not in shared:
        held = np.array([0, size])[list(ends)]
        traces = [*[rubbing] * (len(rows) - 1), held]
        shared[key] = _elasticity(size, scene.elements, np.concatenate(traces), len(held))
    dofs = pieces.dofs(wire, column)
    return Substructure(shared[key], dofs, np.concatenate(rows), body_force=None)


def _elasticity(size: int, elements: int, trace: Indices, ends: int) -> Elasticity:
    element = 1.0 / elements
    part = size * element
    direction = np.full(len(trace), 1.0 / part)
    direction[: len(trace) - ends] *= element / part
    return Elasticity(rod_stiffness(size, float(elements)), trace, direction)


def _interfaces(scene: Strand, pieces: _Pieces) -> dict[str, Interface]:
    found: dict[str, Interface] = {
        f"contact {number + 1}-{number + 2}": _contact(scene, pieces, number)
        for number in range(scene.wires - 1)
    }
    still = np.zeros((scene.wires, len(scene.instants)))
    found["support"] = Dirichlet(pieces.left[0], still)
    for column in range(pieces.count - 1):
        first, second = pieces.right[column], pieces.left[column + 1]
        whole = first != NO_ROW
        macro = np.eye(int(whole.sum()))
        found[f"cut {column + 1}-{column + 2}"] = Perfect(first[whole], second[whole], macro)
    # Over ES the tension is a scaled force, and the scaled displacement of an end under it.
    given = np.tile(scene.tension / scene.stiffness, (scene.wires, 1))
    last = pieces.right[-1]
    found["load"] = (
        Dirichlet(last, given) if scene.rigid_grip else Neumann(last, given, np.eye(scene.wires))
    )
    return found


def _contact(scene: Strand, pieces: _Pieces, number: int) -> Friction:
    rubbing = pieces.rubbing
    element = scene.length / scene.elements
    weights = np.concatenate(
        [tributary(size, element)[own] for size, own in zip(pieces.sizes, rubbing, strict=True)]
    )
    node = np.concatenate([start + own for start, own in zip(pieces.starts, rubbing, strict=True)])
    place = node.copy()
    if pieces.broken is not None and number in (pieces.broken[0] - 1, pieces.broken[0]):
        column = np.repeat(np.arange(pieces.count), [len(own) for own in rubbing])
        place += column > pieces.broken[1]
    points = place - place[0]
    positions = np.zeros(points[-1] + 1)
    positions[points] = scene.nodes[node]
    return Friction.of_known_bound(
        Component(pieces.contact_rows(number, 1), pieces.contact_rows(number, 0)),
        scene.bound * weights / scene.stiffness,
        points=points,
        positions=positions,
        weights=weights,
        # Of dense blocks SciPy 1.18 makes a matrix with a warning, and later versions an array.
        macro=sparse.csr_array(
            sparse.block_diag([sparse.coo_array(_polynomials(len(own))) for own in rubbing])
        ),
    )


def _polynomials(nodes: int) -> Array:
    """Give the macro basis on one piece of a contact, shape (nodes, n_macro)."""
    return np.vander(np.linspace(-1.0, 1.0, nodes), min(MACRO_DEGREE + 1, nodes))
