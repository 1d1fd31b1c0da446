"""Outlines of the pieces of a structure: corners and their displacements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.worker.cells import (
    Drawing,
    drawings_of,
    is_rectangle,
    kept_ring,
    lower_corner,
    thinned,
)
from app.worker.geometry import PITCH, THICKNESS
from solver.arrays import Array, Indices
from solver.discrete import Problem, Structure
from solver.discrete.inside import Inside
from solver.discrete.substructure import Substructure

MOST_CORNERS = 600
"""Largest number of corners of outlines, about."""


@dataclass(frozen=True, eq=False)
class Outline:
    """Outline of a piece: corners, (n, 2), m, and maps to their displacements.

    `motion` is the map from the rows of the piece, (2 n, n_boundary), and `given` what
    is added, (2 n, n_instants), scaled, or None.
    """

    corners: Array
    motion: Array
    given: Array | None


def _mean_of_rows(part: Substructure) -> Array:
    """Mean over the rows of each degree of freedom of a piece, (n_dofs, n_boundary)."""
    trace = part.elasticity.trace
    mean = np.zeros((len(part.dofs), len(trace)))
    mean[trace, np.arange(len(trace))] = 1.0
    return np.asarray(mean / np.maximum(mean.sum(axis=1), 1.0)[:, None])


def outlines_in_the_plane(problem: Problem, structure: Structure) -> list[Outline]:
    """Outlines of the substructures of bodies in the plane."""
    inside = problem.inside
    assert inside is not None
    corner = lower_corner(inside)
    outlines = []
    for number, (places, positions) in enumerate(_rings_of(structure, inside)):
        matrix, given = inside.of_part(number, places)
        motion = matrix @ _mean_of_rows(problem.substructures[number])
        outlines.append(Outline(positions - corner, motion, given))
    return outlines


def _rings_of(structure: Structure, inside: Inside) -> list[tuple[Indices, Array]]:
    """Longest closed line round each substructure, by places and positions.

    The places, (n,), are those in the order of the nodes of the substructure, and the
    positions are where these are drawn, (n, 2), m.
    """
    count = len(inside.grids)
    on_side = int(np.clip(MOST_CORNERS / (4 * count), 2, 9))
    around = max(MOST_CORNERS // count, 8)
    longest = dict[int, tuple[Drawing, Indices]]()
    for drawing in drawings_of(structure, inside):
        for ring in drawing.rings:
            if drawing.part not in longest or len(ring) > len(longest[drawing.part][1]):
                longest[drawing.part] = drawing, ring
    found = []
    for number, grid in enumerate(inside.grids):
        nodes = grid.ravel()
        if is_rectangle(grid):
            places = kept_ring(grid, on_side)
            found.append((places, inside.nodes[nodes[places]]))
            continue
        drawing, ring = longest[number]
        kept = ring[thinned(len(ring), around)]
        order = np.argsort(nodes)
        places = order[np.searchsorted(nodes[order], drawing.numbers[kept])]
        found.append((places, drawing.positions[kept]))
    return found


def outlines_of_rods(
    problem: Problem, numbers: Indices, rods: Indices
) -> tuple[list[Outline], Array]:
    """Outlines of the pieces of some rods, and positions of all rows, (n_rows, 2), m.

    `numbers` are those of their substructures and `rods` those of their rods, from
    below, (n_pieces,).
    """
    parts = [problem.substructures[number] for number in numbers]
    length = max(float(np.ptp(problem.positions[part.dofs])) for part in parts)
    length = max(length, float(problem.positions.max()))
    thickness = THICKNESS * length
    positions = np.zeros((problem.n_rows, 2))
    positions[:, 0] = problem.positions[problem.row_dofs]
    outlines = []
    for part, rod in zip(parts, rods, strict=True):
        low = PITCH * length * rod
        # Cuts are in the middle of a rod, contacts at its foot or its top.
        positions[part.rows, 1] = low + 0.5 * thickness
        ends = [0, -1, -1, 0, 0]
        x = problem.positions[part.dofs[ends]]
        corners = np.stack([x, low + thickness * np.array([0, 0, 1, 1, 0])], axis=1)
        motion = np.zeros((10, len(part.rows)))
        motion[::2] = _mean_of_rows(part)[ends]
        given = None
        if problem.carried is not None:
            given = np.zeros((10, problem.n_instants))
            given[::2] = problem.carried[part.dofs[ends]]
        outlines.append(Outline(corners, motion, given))
    for law in problem.contacts.laws.values():
        positions[law.tangent.above, 1] -= 0.5 * thickness
        if law.tangent.below is not None:
            positions[law.tangent.below, 1] += 0.5 * thickness
    return outlines, positions
