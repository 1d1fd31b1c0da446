"""Rods as a discrete problem: linear elements, friction lumped at the nodes."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem, Scales
from solver.discrete.rod import rod_stiffness, tributary
from solver.discrete.rods.data import RodsData
from solver.discrete.rods.pieces import NO_ROW, Pieces
from solver.discrete.substructure import Elasticity, Substructure
from solver.laws import Component, Contact, Dirichlet, Interface, Neumann, Perfect, Rod

MACRO_DEGREE = 1
"""Polynomials of the friction force on each piece of a contact: resultant and first moment. Without
them both sides balance each other but slowly: 1 % of the friction force then takes more than 200
iterations instead of 40 (measured by default, with Anderson acceleration and automatic k). 3 saves
up to half of the iterations with 20 wires or more in 4 pieces each, and so do 10 pieces; few wires
gain nothing."""


def discretise_rods(scene: RodsData) -> Problem:
    """Cut all rods at the same nodes and write the laws of their interfaces.

    Lengths are scaled by L, forces by ES of one rod (solver/README.md, 1). Degrees of freedom run
    along rod after rod; a broken one has two at its break, and no boundary row there. On the
    support the interface is "friction"; "contact 1-2" lies between rods 1 and 2, the second being
    the body above. Its points run along the rods; at the break of either there are two, one for
    each of the parts that have come apart.

    The search direction of the cuts and ends is ES/l_sub, with ES the harmonic mean over the
    substructure. On the friction points it is that of a density ES/l_sub^2 over one element's
    length, the same at every node and on both sides of a contact: with the halved tributary length
    at the two sides of a cut, the iterations miss the figures that an independent implementation
    reports (displacement error 0.15 against 0.21 at iteration 10 of its test), with the whole
    element length they meet them.
    """
    pieces = Pieces(scene)
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


def _substructure(
    scene: RodsData,
    pieces: Pieces,
    wire: int,
    column: int,
    shared: dict[tuple[object, ...], Elasticity],
) -> Substructure:
    size, start, rubbing = pieces.sizes[column], pieces.starts[column], pieces.rubbing[column]
    rows = pieces.rows(wire, column)
    ends = pieces.left[column, wire] != NO_ROW, pieces.right[column, wire] != NO_ROW
    section = np.ones(0) if scene.section is None else scene.section[start : start + size]
    key = size, len(rows), ends, len(rubbing), int(rubbing[0]), section.tobytes()
    if key not in shared:
        held = np.array([0, size])[list(ends)]
        traces = [*[rubbing] * (len(rows) - 1), held]
        shared[key] = _elasticity(size, scene.elements, np.concatenate(traces), len(held), section)
    inside = None
    if scene.body_force is not None:
        own = np.s_[None] if scene.body_force.ndim == 1 else np.s_[start : start + size + 1]
        scaled = scene.body_force[own] * scene.length / scene.stiffness
        inside = tributary(size, 1.0 / scene.elements)[:, None] * scaled
    return Substructure(shared[key], pieces.dofs(wire, column), np.concatenate(rows), inside)


def _elasticity(size: int, elements: int, trace: Indices, ends: int, section: Array) -> Elasticity:
    """Make the operator of a substructure, whose last boundary rows are its ends.

    `section` is empty where it is 1 throughout.
    """
    element = 1.0 / elements
    part = size * element
    varies = len(section) > 0
    end = 1.0 / part / float(np.mean(1.0 / section)) if varies else 1.0 / part
    direction = np.full(len(trace), end)
    direction[: len(trace) - ends] = end * element / part
    stiffness = rod_stiffness(size, elements * section if varies else float(elements))
    return Elasticity(stiffness, trace, direction)


def _interfaces(scene: RodsData, pieces: Pieces) -> dict[str, Interface]:
    found: dict[str, Interface] = {
        "friction" if below is None else f"contact {below + 1}-{above + 1}": _friction(
            scene, pieces, number
        )
        for number, (above, below) in enumerate(pieces.contacts)
    }
    held = np.zeros_like(scene.load) if scene.support is None else scene.support / scene.length
    found["support"] = Dirichlet(pieces.left[0], np.tile(held, (scene.wires, 1)))
    for column in range(pieces.count - 1):
        first, second = pieces.right[column], pieces.left[column + 1]
        whole = first != NO_ROW
        macro = np.eye(int(whole.sum()))
        found[f"cut {column + 1}-{column + 2}"] = Perfect(first[whole], second[whole], macro)
    # Over ES the load is a scaled force, and the scaled displacement of an end under it.
    given = np.tile(scene.load / scene.stiffness, (scene.wires, 1))
    last = pieces.right[-1]
    found["load"] = (
        Dirichlet(last, given) if scene.rigid_grip else Neumann(last, given, np.eye(scene.wires))
    )
    return found


def _friction(scene: RodsData, pieces: Pieces, number: int) -> Contact:
    rubbing = pieces.rubbing
    element = 1.0 / scene.elements
    weights = scene.length * np.concatenate(
        [tributary(size, element)[own] for size, own in zip(pieces.sizes, rubbing, strict=True)]
    )
    node = np.concatenate([start + own for start, own in zip(pieces.starts, rubbing, strict=True)])
    place = node.copy()
    if pieces.broken is not None and pieces.broken[0] in pieces.contacts[number]:
        column = np.repeat(np.arange(pieces.count), [len(own) for own in rubbing])
        place += column > pieces.broken[1]
    points = place - place[0]
    positions = np.zeros(points[-1] + 1)
    positions[points] = scene.nodes[node]
    below = pieces.below(number)
    component, scales = Component(pieces.above(number), below), (scene.length, scene.stiffness)
    known = scene.bounds[node] * weights[:, None] / scene.stiffness
    return Contact(
        tangential=scene.friction_law.at(component, weights, scales, known=known),
        points=points,
        positions=positions,
        weights=weights,
        around=Rod(_modulus(scene, node)),
        macro=None if below is None else _macro(rubbing),
    )


def _modulus(scene: RodsData, node: Indices) -> Array | None:
    """Give the stiffness around nodes: of half an element on either side, in series."""
    if scene.section is None:
        return None
    soft = np.pad(1.0 / scene.section, 1, mode="edge")
    around: Array = 2.0 / (soft[:-1] + soft[1:])
    return around[node]


def _macro(rubbing: list[Indices]) -> sparse.csr_array:
    """Give the macro basis of a contact between rods: polynomials on every piece."""
    # Of dense blocks SciPy 1.18 makes a matrix with a warning, and later versions an array.
    parts = [sparse.coo_array(_polynomials(len(own))) for own in rubbing]
    return sparse.csr_array(sparse.block_diag(parts))


def _polynomials(nodes: int) -> Array:
    """Give the macro basis on one piece of a contact, shape (nodes, n_macro)."""
    return np.vander(np.linspace(-1.0, 1.0, nodes), min(MACRO_DEGREE + 1, nodes))
