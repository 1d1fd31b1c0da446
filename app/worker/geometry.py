"""From a problem to the bodies that are drawn, and how they move."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from app.frame import DeformedGeometry, Floats, Geometry
from solver.arrays import Array
from solver.discrete import Problem
from solver.discrete.inside import Inside
from solver.discrete.structure import Description
from solver.latin import Iterate

THICKNESS, PITCH = 0.07, 0.1
"""Of a rod as it is drawn, which has none in the model, and between two rods; shares of length."""
MOST_POINTS = 200
"""Contact points of an interface, and nodes of a rod, that are drawn at most."""
MOST_QUADS = 400
"""Quadrilaterals that are drawn at most, or one for each body."""


class Drawn(Protocol):
    """The bodies of a scene as they are drawn."""

    geometry: Geometry

    def deformed(self, iterate: Iterate) -> DeformedGeometry:
        """How they have moved in an iterate."""


def floats(values: NDArray[np.generic]) -> Floats:
    """Numbers as frames have them."""
    return values.astype(np.float32, order="C")


def thinned(size: int, most: int) -> NDArray[np.intp]:
    """Indices that stand for a long axis, first and last included."""
    return np.unique(np.linspace(0, size - 1, min(size, most)).round().astype(np.intp))


class DrawnContacts:
    """The contact points of all interfaces that are drawn.

    Parameters
    ----------
    problem
        What is solved.
    columns
        The instants that are shown.
    heights
        Height of every degree of freedom along rods, m; None in the plane.
    """

    def __init__(self, problem: Problem, columns: NDArray[np.intp], heights: Array | None) -> None:
        chosen, along, across, chains = [], [], [], []
        first = 0
        for number, law in enumerate(problem.rubbing.values()):
            points, pairs = np.unique(law.points, return_index=True)
            kept = thinned(len(points), MOST_POINTS)
            chosen.append(first + kept)
            tangent = law.tangent.above[pairs[kept]]
            normal = law.normal.component.above[pairs[kept]] if law.normal else tangent
            along.append(problem.row_dofs[tangent])
            across.append(problem.row_dofs[normal])
            chains.append(np.full(len(kept), number))
            first += len(points)
        self._points, self._columns = np.concatenate(chosen), columns
        self._dofs = np.stack([np.concatenate(along), np.concatenate(across)], axis=1)
        self._moves = np.array([1.0, 0.0 if heights is not None else 1.0])[:, None]
        places = problem.positions[self._dofs[:, 0]]
        if heights is not None:
            places = np.stack([places, heights[self._dofs[:, 0]]], axis=1)
        self.points, self.chains = floats(places), np.concatenate(chains)

    def moved(self, iterate: Iterate) -> tuple[Floats, NDArray[np.int8]]:
        """Displacement, (n_points, 2, n_instants), and status, (n_points, n_instants)."""
        moved = iterate.displacement[self._dofs][:, :, self._columns] * self._moves
        return floats(moved), iterate.status[np.ix_(self._points, self._columns)]


class DrawnRods:
    """Rods as rectangles above each other."""

    def __init__(
        self, problem: Problem, description: Description, columns: NDArray[np.intp]
    ) -> None:
        per_rod = len(problem.substructures) // description.bodies
        kept, corners, parts, lows = [], [], [], []
        heights = np.zeros(problem.n_dofs)
        size = 0
        for number, part in enumerate(problem.substructures):
            dofs = part.dofs[thinned(len(part.dofs), max(MOST_POINTS // per_rod, 2))]
            low = PITCH * description.length * (number // per_rod)
            heights[part.dofs] = low
            first = size + 2 * np.arange(len(dofs) - 1)
            corners.append(np.stack([first, first + 2, first + 3, first + 1], axis=1))
            parts.append(np.full(len(dofs) - 1, number))
            kept.append(np.repeat(dofs, 2))
            lows.append(np.tile([low, low + THICKNESS * description.length], len(dofs)))
            size += 2 * len(dofs)
        self._dofs, self._columns = np.concatenate(kept), columns
        self._contacts = DrawnContacts(problem, columns, heights)
        nodes = np.stack([problem.positions[self._dofs], np.concatenate(lows)], axis=1)
        self.geometry = Geometry(
            description,
            floats(nodes),
            np.concatenate(corners).astype(np.int32),
            np.concatenate(parts),
            self._contacts.points,
            self._contacts.chains,
        )

    def deformed(self, iterate: Iterate) -> DeformedGeometry:
        """How the rods have moved; they do so along themselves."""
        along = iterate.displacement[np.ix_(self._dofs, self._columns)]
        nodes = floats(np.stack([along, np.zeros_like(along)], axis=1))
        return DeformedGeometry(nodes, *self._contacts.moved(iterate))


class DrawnMesh:
    """Plane bodies of the same size, each with a mesh thinned alike.

    Attributes
    ----------
    quad
        The drawn quadrilateral that each element lies in, shape (n_elements,).
    """

    def __init__(
        self, problem: Problem, description: Description, columns: NDArray[np.intp]
    ) -> None:
        assert problem.inside is not None
        self._inside, self._columns = problem.inside, columns
        self._contacts = DrawnContacts(problem, columns, None)
        self._nodes, quads, self.quad = thinned_mesh(problem.inside)
        self._counts = np.bincount(self.quad)
        parts = np.zeros(len(self._counts), dtype=np.intp)
        parts[self.quad] = problem.inside.parts
        self.geometry = Geometry(
            description,
            floats(problem.inside.nodes[self._nodes]),
            quads,
            parts,
            self._contacts.points,
            self._contacts.chains,
        )

    def deformed(self, iterate: Iterate) -> DeformedGeometry:
        """How the bodies have moved."""
        whole = self._inside.displacement(iterate.displacement, slice(None))
        nodes = floats(whole[self._nodes][:, :, self._columns])
        return DeformedGeometry(nodes, *self._contacts.moved(iterate))


def thinned_mesh(
    inside: Inside,
) -> tuple[NDArray[np.intp], NDArray[np.int32], NDArray[np.intp]]:
    """Nodes and quadrilaterals that are drawn of a mesh, and in which each element lies.

    Bodies have the same size, and their nodes run body by body, row by row.
    """
    bodies = int(inside.bodies.max()) + 1
    columns = len(np.unique(inside.nodes[:, 0])) - 1
    rows = len(inside.nodes) // (bodies * (columns + 1)) - 1
    across, up = _lines(columns, rows, max(MOST_QUADS // bodies, 1))
    grid = np.arange(len(inside.nodes)).reshape(bodies, rows + 1, columns + 1)
    kept = grid[np.ix_(np.arange(bodies), up, across)]
    corners = np.arange(kept.size).reshape(kept.shape)
    around = ((0, 0), (0, 1), (1, 1), (1, 0))
    quads = [corners[:, a : a - 1 or None, b : b - 1 or None].ravel() for a, b in around]
    body, row, column = np.unravel_index(inside.elements[:, 0], grid.shape)
    place = (
        body,
        np.searchsorted(up, row, side="right") - 1,
        np.searchsorted(across, column, side="right") - 1,
    )
    quad = np.ravel_multi_index(place, (bodies, len(up) - 1, len(across) - 1))
    return kept.ravel(), np.stack(quads, axis=1).astype(np.int32), quad


def _lines(columns: int, rows: int, most: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Node lines of a body, so that few enough quadrilaterals lie between them."""
    share = min(np.sqrt(most / (columns * rows)), 1.0)
    up = rows if share == 1.0 else min(max(int(rows * share), 1), most)
    across = columns if share == 1.0 else min(max(int(columns * share), 1), max(most // up, 1))
    return thinned(columns + 1, across + 1), thinned(rows + 1, up + 1)
