"""Geometry of the drawn bodies of a problem, and their displacements."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from app.frame import DeformedGeometry, Floats, Geometry
from app.messages import Needs
from app.worker.cells import (
    cells_of,
    drawings_of,
    floats,
    joined,
    lower_corner,
    mesh_of,
    thinned,
)
from app.worker.thrust import Thrusts
from solver.arrays import Array, Indices
from solver.discrete import Problem
from solver.discrete.elements import von_mises
from solver.discrete.probes import AxialForce
from solver.discrete.structure import Description
from solver.latin import Iterate
from solver.scenes.plane import poisson_in
from solver.settings.scene import Settings

THICKNESS = 0.08
PITCH = 0.1
"""Thickness of a drawn rod, which has none in the model, and distance of two rods, over
the length."""
MOST_POINTS = 201
"""Largest number of contact points of an interface, and of nodes of a rod, in a
frame."""
MOST_WIRES = 6
"""Largest number of wires whose axial force is shown, beside a broken one."""
StressField = tuple[str, str, Floats]
"""Title, SI unit, and values in the cells, (n_cells, n_instants)."""
Extras = dict[str, Callable[[Iterate, Needs], Any]]
"""Extras of an iterate for some views, by the names in `View.needs`."""


class Drawn:
    """Drawn bodies at some instants, and their contact points.

    The mesh is as of `mesh_of`; positions are those of all degrees of freedom, (n_dofs,
    2), m.
    """

    def __init__(
        self,
        problem: Problem,
        description: Description,
        columns: Indices,
        mesh: dict[str, Any],
        positions: Array,
    ) -> None:
        # Indices of the shown contact points among all, a degree of freedom of the node
        # at each, and numbers of their interfaces.
        contacts = problem.contacts
        kept = [thinned(size, MOST_POINTS) for size in contacts.sizes.tolist()]
        chains = np.repeat(np.arange(len(kept)), [len(some) for some in kept])
        firsts = np.cumsum(contacts.sizes) - contacts.sizes
        dofs = []
        for law in contacts.laws.values():
            _, pairs = np.unique(law.points, return_index=True)
            dofs.append(problem.row_dofs[law.tangent.above[pairs]])
        self._columns = columns
        self._points = firsts[chains] + np.concatenate(kept)
        self._dofs = contacts.of_points(dofs)[self._points]
        points = floats(positions[self._dofs])
        self.geometry = Geometry(
            description=description,
            points=points,
            chains=chains,
            **mesh,
        )

    def deformed(self, iterate: Iterate) -> DeformedGeometry:
        """Displacements of nodes and points, and status, at the shown instants."""
        status = iterate.status[np.ix_(self._points, self._columns)]
        return DeformedGeometry(*self._moved(iterate), status)

    def _moved(self, iterate: Iterate) -> tuple[Floats, Floats]:
        """Displacements of drawn nodes and points, as of `DeformedGeometry`."""
        raise NotImplementedError


class DrawnRods(Drawn):
    """Rods as rectangles above each other, with interfaces below them."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        description = settings.structure().description()
        grids, dofs, elements = _rectangles(problem, description)
        self._along = np.concatenate(dofs)
        self._elements = np.concatenate(elements)
        self._force = AxialForce(problem, columns)
        self._broken: int | None = None
        if description.broken is not None:
            self._broken = description.broken[0]
        mesh = mesh_of(grids, np.arange(len(grids)))
        self.extras: Extras = {"stress": self._stress, "axial force": self._axial_force}
        positions = np.stack([problem.positions, np.zeros(problem.n_dofs)], axis=1)
        # Contact points lie in the gap below a rod.
        gap = (PITCH - THICKNESS) * description.length
        for part, grid in zip(problem.substructures, grids, strict=True):
            positions[part.dofs, 1] = grid[0, 0, 1] - 0.5 * gap
        super().__init__(problem, description, columns, mesh, positions)

    def _stress(self, iterate: Iterate, needs: Needs) -> StressField:
        """Axial force as stress, as rods have no height."""
        return "axial force", "N", floats(self._forces(iterate)[self._elements])

    def _axial_force(self, iterate: Iterate, needs: Needs) -> dict[str, Any]:
        """Axial force in some rods at all instants.

        "x" of the middles of elements, (n_places,), m; "force", (n_rods, n_places,
        n_instants), N; "names" of the rods; "stuck", what the force would be if nothing
        slipped, (n_places, n_instants) of a strand that is bent, else (0, n_instants).
        """
        count = int(self._force.wires.max()) + 1
        kept = thinned(len(self._force.wires) // count, MOST_POINTS)
        shown = set(thinned(count, MOST_WIRES).tolist())
        if self._broken is not None:
            shown.add(self._broken)
        numbers = sorted(shown)
        names = []
        for number in numbers:
            name = str(number + 1)
            if number == self._broken:
                name += ", broken"
            names.append(name)
        if count > 1:
            names[0] = f"wire {names[0]}"
        else:
            names[0] = "rod"
        forces = self._forces(iterate).reshape(count, -1, len(self._columns))
        return {
            "x": floats(self._force.positions[kept]),
            "force": floats(forces[np.ix_(numbers, kept)]),
            "names": names,
            "stuck": floats(forces[0, :0]),
        }

    def _forces(self, iterate: Iterate) -> Array:
        """Axial forces in all elements, shape (n_elements, n_instants), N."""
        return self._force(iterate.displacement[:, self._columns])

    def _moved(self, iterate: Iterate) -> tuple[Floats, Floats]:
        """Displacements of nodes and points along the rods."""
        moved = iterate.problem.absolute(iterate.displacement)[:, self._columns]
        vectors = np.stack([moved, np.zeros_like(moved)], axis=1)
        return floats(vectors[self._along]), floats(vectors[self._dofs])


def _rectangles(
    problem: Problem, description: Description
) -> tuple[list[Array], list[Indices], list[Indices]]:
    """Rectangles of the substructures of rods, one rod above the other.

    Returns
    -------
    For each substructure its nodes, (2, n, 2), m; their degrees of freedom along the
    rod, (2 n,); and the element in the middle of each quadrilateral, (n - 1,).
    """
    parts = problem.substructures
    length = description.length
    per_rod = len(parts) // description.bodies
    grids = []
    dofs = []
    elements = []
    first = 0
    for number, part in enumerate(parts):
        low = PITCH * length * (number // per_rod)
        kept = thinned(len(part.dofs), max(MOST_POINTS // per_rod, 2))
        shown = part.dofs[kept]
        heights = [low, low + THICKNESS * length]
        grid = np.meshgrid(problem.positions[shown], heights)
        grids.append(np.stack(grid, axis=-1))
        dofs.append(np.tile(shown, 2))
        elements.append(first + (kept[:-1] + kept[1:]) // 2)
        first += len(part.dofs) - 1
    return grids, dofs, elements


class DrawnMesh(Drawn):
    """Plane bodies, drawn by some lines or groups of the elements of substructures."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        inside = problem.inside
        structure = settings.structure()
        self._inside = inside
        self._poisson = poisson_in(settings, inside)
        self._state = settings.values()["plane"]
        self._corner = lower_corner(inside)
        drawings = drawings_of(structure, inside)
        self.extras: Extras = {"stress": self._stress}
        if settings.has_joints:
            self.extras["thrust"] = Thrusts(problem, self._corner, columns).of
        self._nodes = np.concatenate([drawing.numbers for drawing in drawings])
        # The cell that each element lies in.
        self._cells = cells_of(drawings)
        mesh = joined(drawings)
        mesh["nodes"] = mesh["nodes"] - floats(self._corner)
        description = structure.description()
        positions = problem.positions - self._corner
        super().__init__(problem, description, columns, mesh, positions)

    def _stress(self, iterate: Iterate, needs: Needs) -> StressField:
        """Von Mises' equivalent stress, its mean in every cell."""
        means = []
        for moved in np.moveaxis(self._inside_moved(iterate), -1, 0):
            stress = self._inside.stress(moved)
            shown = von_mises(stress, self._poisson, self._state)
            means.append(
                np.bincount(self._cells, weights=shown) / np.bincount(self._cells)
            )
        return "von Mises stress", "Pa", floats(np.stack(means, axis=1))

    def nodes_of(self, displacement: Array) -> Floats:
        """Displacement of drawn nodes, (n_nodes, 2), m, from that of all dofs."""
        moved = self._inside.displacement(displacement[:, None], [0])
        # Given displacements are added to all, and are no part of a motion.
        still = self._inside.displacement(np.zeros((len(displacement), 1)), [0])
        return floats((moved - still)[self._nodes, :, 0])

    def _inside_moved(self, iterate: Iterate) -> Array:
        """Displacement of all nodes at the shown instants, (n_nodes, 2, n_shown), m."""
        moved = self._inside.displacement(iterate.displacement, slice(None))
        return moved[:, :, self._columns]

    def _moved(self, iterate: Iterate) -> tuple[Floats, Floats]:
        """Displacements of nodes and points in global axes."""
        moved = self._inside_moved(iterate)
        points = moved[self._inside.nodes_of_dofs[self._dofs]]
        return floats(moved[self._nodes]), floats(points)
