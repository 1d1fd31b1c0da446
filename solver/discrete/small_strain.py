"""Whether an answer is one that small strains allow."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.plane_parts import Inside
from solver.discrete.problem import Problem
from solver.discrete.rope import Rope
from solver.discrete.structure import Structure
from solver.discrete.wire_forces import wire_forces

SMALL = 0.05
"""Largest strain, or slope of a body, for which small strains hold."""
AT_ONCE = 2_000_000
"""Nodes times instants whose displacements are held together."""


def largest_strain(structure: Structure, problem: Problem, displacement: Array) -> float:
    """Largest strain or slope of a solution: the largest derivative of displacement.

    A motion without rotation counts for nothing. Along rods it is that of an element; in the plane
    the mean over an element, rotation included; of wires the axial strain and that of bending.
    `displacement` is that of the problem's degrees of freedom, (n_dofs, n_instants), m.
    """
    if isinstance(structure, Rope):
        return _of_wires(structure, displacement)
    if problem.inside is None:
        return _of_rods(problem.positions, displacement)
    return _in_plane(problem.inside, displacement)


def beyond_small_strain(structure: Structure, problem: Problem, displacement: Array) -> str | None:
    """That an answer is outside of what is modelled, or return None where it is not."""
    strain = largest_strain(structure, problem, displacement)
    if strain <= SMALL:
        return None
    return (
        f"this model does not hold: strains or slopes reach {strain:.3g}, and it is for small "
        f"ones, up to {SMALL}; lower the loads, or take a stiffer body"
    )


def _of_rods(positions: Array, displacement: Array) -> float:
    lengths = np.diff(positions)
    inside = lengths > 0.0  # not from one rod to the next, nor across a break
    steps = np.diff(displacement, axis=0)[inside]
    return float(np.abs(steps / lengths[inside, None]).max(initial=0.0))


def _of_wires(rope: Rope, displacement: Array) -> float:
    forces = wire_forces(rope, displacement, slice(None))
    largest = 0.0
    for wire, force in zip(rope.wires, forces, strict=True):
        axial = np.abs(force).max(initial=0.0) / wire.helix.stiffness
        bent = 0.5 * wire.diameter * np.abs(wire.curvature).max(initial=0.0)
        largest = max(largest, float(axial + bent))
    return largest


def _in_plane(inside: Inside, displacement: Array) -> float:
    corners = inside.nodes[inside.elements]
    width = corners[:, 1, 0] - corners[:, 0, 0]
    height = corners[:, 3, 1] - corners[:, 0, 1]
    step = max(1, AT_ONCE // len(inside.nodes))
    largest = 0.0
    for first in range(0, displacement.shape[1], step):
        moved = inside.displacement(displacement, slice(first, first + step))
        a, b, c, d = (moved[corner] for corner in inside.elements.T)
        along = 0.5 * (b - a + c - d) / width[:, None, None]
        up = 0.5 * (d - a + c - b) / height[:, None, None]
        sizes = (float(np.abs(one).max(initial=0.0)) for one in (along, up))
        largest = max(largest, *sizes)
    return largest
