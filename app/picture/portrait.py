"""From a problem to the bodies, cuts and contacts that a picture of the scene shows."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from app.picture.shown import Bytes, Floats, Mesh, MeshField, floats, thinned
from solver.arrays import Array, Indices
from solver.discrete import Problem
from solver.discrete.structure import Description
from solver.latin import Iterate

THICKNESS, PITCH = 0.07, 0.1
"""Of a rod as it is drawn, which has none here, and between two of them; shares of its length."""
MOST_POINTS = 200
"""Contact points of an interface, and nodes of a rod's substructure, that are shown at most."""


def size_of(described: Description) -> tuple[float, float]:
    """Give length and height of all bodies as they are drawn, m."""
    thickness = described.length * (PITCH * (described.bodies - 1) + THICKNESS)
    return described.length, thickness if described.height is None else described.height


@dataclass(frozen=True, eq=False)
class Portrait:
    """What a picture of a scene shows of every iterate alike.

    Attributes
    ----------
    described
        Bodies, what holds them and what acts on them.
    mesh
        Of the bodies; rods are drawn with a thickness.
    places
        Contact points, interface after interface, shape (n_points, 2), m.
    chains
        Number of the interface of each of them, shape (n_points,).
    seams
        Lines on the bodies, as between the wires of a strand, broken by NaN, shape (n, 2), m.
    """

    described: Description
    mesh: Mesh
    places: Floats
    chains: NDArray[np.intp]
    seams: Floats = field(default_factory=lambda: np.zeros((0, 2), dtype=np.float32))

    @property
    def size(self) -> tuple[float, float]:
        """Length and height of all bodies as they are drawn, m."""
        return size_of(self.described)


@dataclass(frozen=True, eq=False)
class Pose:
    """What has moved at the chosen instant.

    Attributes
    ----------
    displacement
        Of the portrait's nodes, shape (n_nodes, 2), m.
    largest
        Largest displacement over the whole time, m.
    slid
        Displacement of the contact points, shape (n_points, 2), m.
    status
        Of the contact points, shape (n_points,).
    colors
        Status of every quadrilateral, where these are the wires that slip; else None.
    seams
        Displacement of the portrait's seams, shape (n, 2), m.
    """

    displacement: Floats
    largest: float
    slid: Floats
    status: Bytes
    colors: Bytes | None = None
    seams: Floats | None = None


def rims(portrait: Portrait) -> list[NDArray[np.intp]]:
    """Give the nodes around every body, a rectangle while undeformed, back to the first."""
    mesh, found = portrait.mesh, []
    for quads in mesh.quads.reshape(portrait.described.bodies, -1):
        own = np.unique(quads)
        x, y = mesh.nodes[own].T
        sides = ((y == y.min(), x), (x == x.max(), y), (y == y.max(), -x), (x == x.min(), -y))
        found.append(np.concatenate([own[on][np.argsort(along[on])] for on, along in sides]))
    return found


class DrawnGeometry:
    """A problem as its portraits see it.

    Parameters
    ----------
    problem, described
        What is solved, and what it was made of.
    mesh
        Of plane bodies; None of rods.
    """

    def __init__(self, problem: Problem, described: Description, mesh: Mesh | None) -> None:
        self._rods = _RodMesh(problem, described) if mesh is None else None
        heights = self._rods.heights if self._rods else None
        chosen, above, normal, chains = [], [], [], []
        first = 0
        for number, law in enumerate(problem.rubbing.values()):
            points, pairs = np.unique(law.points, return_index=True)
            kept = thinned(len(points), MOST_POINTS if len(points) > 1 else 0)
            chosen.append(first + kept)
            rows = law.tangent.above[pairs[kept]]
            above.append(problem.row_dofs[rows])
            across = law.normal.component.above[pairs[kept]] if law.normal else rows
            normal.append(problem.row_dofs[across])
            chains.append(np.full(len(kept), number))
            first += len(points)
        self._points = np.concatenate(chosen)
        self._dofs = np.stack([np.concatenate(above), np.concatenate(normal)], axis=1)
        self._moves = np.array([1.0, 0.0 if heights is not None else 1.0])
        along = self._dofs[:, 0]
        places = problem.positions[along]
        if heights is not None:
            places = np.stack([places, heights[along]], axis=1)
        whole = mesh or (self._rods.mesh if self._rods else None)
        assert whole is not None
        self.portrait = Portrait(described, whole, floats(places), np.concatenate(chains))

    def pose(self, iterate: Iterate, column: int, bodies: MeshField | None) -> Pose:
        """Show an iterate at one instant; plane bodies are given."""
        whole = iterate.displacement
        largest = bodies.largest if bodies else float(np.abs(whole).max())
        moved = self._rods.moved(whole[:, column]) if self._rods else None
        if moved is None:
            assert bodies is not None
            moved = bodies.displacement
        return Pose(
            displacement=moved,
            largest=largest,
            slid=floats(whole[:, column][self._dofs] * self._moves),
            status=iterate.status[self._points, column],
        )


class _RodMesh:
    """Rods as rectangles above each other, one row of quadrilaterals a substructure."""

    def __init__(self, problem: Problem, described: Description) -> None:
        per_rod = len(problem.substructures) // described.bodies
        kept, corners, parts = [], [], []
        lows: list[Array] = []
        self.heights = np.zeros(problem.n_dofs)
        size = 0
        for number, part in enumerate(problem.substructures):
            dofs = part.dofs[thinned(len(part.dofs), max(MOST_POINTS // per_rod, 2))]
            low = PITCH * described.length * (number // per_rod)
            self.heights[part.dofs] = low
            first = size + 2 * np.arange(len(dofs) - 1)
            corners.append(np.stack([first, first + 2, first + 3, first + 1], axis=1))
            parts.append(np.full(len(dofs) - 1, number))
            kept.append(np.repeat(dofs, 2))
            lows.append(np.tile([low, low + THICKNESS * described.length], len(dofs)))
            size += 2 * len(dofs)
        self._dofs: Indices = np.concatenate(kept)
        nodes = np.stack([problem.positions[self._dofs], np.concatenate(lows)], axis=1)
        self.mesh = Mesh(
            floats(nodes), np.concatenate(corners).astype(np.int32), np.concatenate(parts)
        )

    def moved(self, displacement: Array) -> Floats:
        """Give the displacement of the nodes, shape (n_nodes, 2), m."""
        along = displacement[self._dofs]
        return floats(np.stack([along, np.zeros_like(along)], axis=1))
