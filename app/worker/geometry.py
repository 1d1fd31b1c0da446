"""Geometry of the drawn bodies of a problem, and their displacements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from app.frame import DeformedGeometry, Floats, Geometry
from app.messages import Needs
from solver.arrays import Array, Indices
from solver.discrete import Problem
from solver.discrete.elements import von_mises
from solver.discrete.probes import AxialForce
from solver.discrete.structure import Description
from solver.latin import Iterate
from solver.settings.scene import Settings

THICKNESS = 0.08
PITCH = 0.1
"""Of a rod as it is drawn, which has none in the model, and between two rods; shares of
length."""
MOST_POINTS = 201
"""Contact points of an interface, and nodes of a rod, that are shown at most."""
MOST_WIRES = 6
"""Wires whose axial force is shown at most, beside a broken one."""
MOST_QUADS = 400
"""Quadrilaterals that are drawn at most, or one for each body."""
NONE = -1
"""In place of a degree of freedom, and between two lines in a list of nodes."""
StressField = tuple[str, str, Floats]
"""What colours the quadrilaterals: title, SI unit, and values, (n_quads,
n_instants)."""
Extras = dict[str, Callable[[Iterate, Needs], Any]]
"""What only some views need of an iterate, by the name that they need it by."""


def floats(values: NDArray[np.generic]) -> Floats:
    """Arrays as frames have them, of the same shape."""
    return values.astype(np.float32, order="C")


def thinned(size: int, most: int) -> Indices:
    """Indices of a thinned axis, first and last included, at most `most`."""
    return np.unique(np.linspace(0, size - 1, min(size, most)).round().astype(np.intp))


class Drawn:
    """Bodies as they are drawn at some instants, and the contact points of all interfaces.

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
        chosen = []
        dofs = []
        chains = []
        first = 0
        for number, law in enumerate(problem.rubbing.values()):
            points, pairs = np.unique(law.points, return_index=True)
            kept = thinned(len(points), MOST_POINTS)
            chosen.append(first + kept)
            moving = [law.tangent, *([law.normal.component] if law.normal else [])]
            rows = np.stack(
                [component.above[pairs[kept]] for component in moving], axis=1
            )
            # What does not move off its support has no degree of freedom there.
            own = problem.row_dofs[rows]
            dofs.append(
                np.pad(own, ((0, 0), (0, 2 - len(moving))), constant_values=NONE)
            )
            chains.append(np.full(len(kept), number))
            first += len(points)
        self._problem = problem
        self._columns = columns
        self._points = np.concatenate(chosen)
        self._dofs = np.concatenate(dofs)
        points = floats(positions[self._dofs[:, 0]])
        self.geometry = Geometry(
            description=description,
            points=points,
            chains=np.concatenate(chains),
            **mesh,
        )

    def deformed(self, iterate: Iterate) -> DeformedGeometry:
        """Displacements of nodes and points, and the status, at the shown instants."""
        moved = iterate.problem.at_rest(iterate.displacement)[self._dofs][
            :, :, self._columns
        ]
        moved[self._dofs == NONE] = 0.0
        status = iterate.status[np.ix_(self._points, self._columns)]
        return DeformedGeometry(self._nodes_moved(iterate), floats(moved), status)

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        raise NotImplementedError


class DrawnRods(Drawn):
    """Rods as rectangles above each other, with interfaces between them or at a support."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        description = settings.structure().described()
        rods = problem.substructures
        length = description.length
        per_rod = len(rods) // description.bodies
        lows = PITCH * length * (np.arange(len(rods)) // per_rod)
        positions = np.stack([problem.positions, np.zeros(problem.n_dofs)], axis=1)
        for rod, low in zip(rods, lows, strict=True):
            positions[rod.dofs, 1] = low - 0.5 * (PITCH - THICKNESS) * length
        kept = [thinned(len(rod.dofs), max(MOST_POINTS // per_rod, 2)) for rod in rods]
        dofs = [rod.dofs[own] for rod, own in zip(rods, kept, strict=True)]
        self._along = np.concatenate([np.tile(own, 2) for own in dofs])
        grids = [
            np.stack(
                np.meshgrid(problem.positions[own], [low, low + THICKNESS * length]),
                axis=-1,
            )
            for own, low in zip(dofs, lows, strict=True)
        ]
        elements = np.cumsum([0, *(len(rod.dofs) - 1 for rod in rods[:-1])])
        middles = [
            n + (own[:-1] + own[1:]) // 2 for n, own in zip(elements, kept, strict=True)
        ]
        self._force = AxialForce(problem, columns)
        self._elements = np.concatenate(middles)
        if description.broken is None:
            self._broken = None
        else:
            self._broken = description.broken[0]
        mesh = mesh_of(grids, np.arange(len(rods)))
        self.extras: Extras = {"stress": self._stress, "axial force": self._axial_force}
        super().__init__(problem, description, columns, mesh, positions)

    def _stress(self, iterate: Iterate, needs: Needs) -> StressField:
        """Axial force, as rods have no height."""
        return "axial force", "N", floats(self._forces(iterate)[self._elements])

    def _axial_force(self, iterate: Iterate, needs: Needs) -> dict[str, Any]:
        """Axial force in some rods at all instants.

        "x" of the middles of elements, (n_places,), m; "force", (n_rods, n_places,
        n_instants), N; "names" of the rods; "stuck", what the force would be if nothing
        slipped, (n_places, n_instants) of a strand that is bent, else (0, n_instants).
        """
        count = int(self._force.wires.max()) + 1
        broken = self._broken
        places = thinned(len(self._force.wires) // count, MOST_POINTS)
        shown = sorted(
            {
                *thinned(count, MOST_WIRES).tolist(),
                *([] if broken is None else [broken]),
            }
        )
        names = [f"{n + 1}, broken" if n == broken else str(n + 1) for n in shown]
        if count > 1:
            names[0] = f"wire {names[0]}"
        else:
            names[0] = "rod"
        forces = self._forces(iterate).reshape(count, -1, len(self._columns))
        return {
            "x": floats(self._force.positions[places]),
            "force": floats(forces[np.ix_(shown, places)]),
            "names": names,
            "stuck": floats(forces[0, :0]),
        }

    def _forces(self, iterate: Iterate) -> Array:
        """Axial forces in all elements, shape (n_elements, n_instants), N."""
        return self._force(iterate.displacement[:, self._columns])

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        """Displacement of the nodes, which move along the rods, m."""
        moved = iterate.problem.at_rest(iterate.displacement)
        along = moved[np.ix_(self._along, self._columns)]
        return floats(np.stack([along, np.zeros_like(along)], axis=1))


class DrawnMesh(Drawn):
    """Plane bodies, with some lines of the mesh of each substructure."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        self._inside = inside = problem.inside
        self._poisson, self._state = (
            settings.values()[name] for name in ("poisson", "plane")
        )
        self.extras: Extras = {"stress": self._stress}
        if settings.has_joints:
            self.extras["thrust"] = self._thrust
        most = max(MOST_QUADS // len(inside.grids), 1)
        shapes = np.array([np.subtract(grid.shape, 1) for grid in inside.grids])
        share = min(np.sqrt(most / shapes.prod(axis=1).max()), 1.0)
        grids = []
        quads = []
        count = 0
        for grid, (n_rows, n_columns) in zip(inside.grids, shapes, strict=True):
            rows = max(int(share * n_rows), 1)
            up = thinned(n_rows + 1, rows + 1)
            across = thinned(
                n_columns + 1, max(min(int(share * n_columns), most // rows), 1) + 1
            )
            grids.append(grid[np.ix_(up, across)])
            row, column = (
                np.searchsorted(kept, np.arange(n), side="right") - 1
                for kept, n in ((up, n_rows), (across, n_columns))
            )
            quads.append(count + np.add.outer(row * (len(across) - 1), column).ravel())
            count += (len(up) - 1) * (len(across) - 1)
        self._nodes = np.concatenate([grid.ravel() for grid in grids])
        # The quadrilateral that each element lies in.
        self._quad = np.concatenate(quads)
        mesh = mesh_of([inside.nodes[grid] for grid in grids], np.arange(len(grids)))
        description = settings.structure().described()
        super().__init__(problem, description, columns, mesh, problem.positions)

    def _stress(self, iterate: Iterate, needs: Needs) -> StressField:
        """Von Mises' equivalent stress, its mean in every quadrilateral."""
        means = []
        for moved in np.moveaxis(self._moved(iterate), -1, 0):
            stress = self._inside.stress(moved)
            shown = von_mises(stress, self._poisson, self._state)
            means.append(
                np.bincount(self._quad, weights=shown) / np.bincount(self._quad)
            )
        return "von Mises stress", "Pa", floats(np.stack(means, axis=1))

    def _thrust(self, iterate: Iterate, needs: Needs) -> dict[str, Floats]:
        """Resultant force in every joint of bricks, and where it acts.

        "lines" go from the middle of one brick over the point where the resultant acts
        to the middle of the other, (n_joints, 3, 2, n_instants), m; on a support they
        end there. "forces" are their sizes, (n_joints, n_instants), N.
        """
        problem = self._problem
        lines = []
        forces = []
        middles = np.zeros((problem.n_dofs, 2, 1))
        for grid, part in zip(self._inside.grids, problem.substructures, strict=True):
            middles[part.dofs, :, 0] = self._inside.nodes[grid].mean(axis=(0, 1))
        for name, law in problem.rubbing.items():
            _, pairs = np.unique(law.points, return_index=True)
            above, *below = (
                problem.row_dofs[rows[pairs]] for rows in law.tangent.sides
            )
            normal, tangential = (
                iterate.contact_force[own][:, self._columns]
                for own in problem.contact_places[name]
            )
            pressed = np.maximum(normal, 0.0)
            whole = pressed.sum(axis=0)
            share = pressed / np.where(whole > 0.0, whole, 1.0)
            point = problem.positions[above].T @ np.where(
                whole > 0.0, share, 1.0 / len(above)
            )
            if below:
                end = middles[below[0][0]]
            else:
                end = point
            lines.append(np.stack(np.broadcast_arrays(middles[above[0]], point, end)))
            forces.append(np.hypot(whole, tangential.sum(axis=0)))
        return {"lines": floats(np.stack(lines)), "forces": floats(np.stack(forces))}

    def nodes_of(self, displacement: Array) -> Floats:
        """Displacement of nodes, (n_nodes, 2), m, from degrees of freedom, (n_dofs,), m."""
        moved, still = (
            self._inside.displacement(size * displacement[:, None], [0])
            for size in (1.0, 0.0)
        )
        return floats((moved - still)[self._nodes, :, 0])

    def _moved(self, iterate: Iterate) -> Array:
        return self._inside.displacement(iterate.displacement, slice(None))[
            :, :, self._columns
        ]

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        return floats(self._moved(iterate)[self._nodes])


def mesh_of(grids: Sequence[Array], parts: ArrayLike) -> dict[str, Any]:
    """Nodes, quadrilaterals and outlines, as `Geometry` has them, of grids of nodes.

    Each grid is of one of the parts, (n_rows, n_columns, 2), m, row by row from below.
    """
    sizes = np.cumsum([grid[..., 0].size for grid in grids])
    numbers = [
        own.reshape(grid.shape[:2])
        for own, grid in zip(
            np.split(np.arange(sizes[-1]), sizes[:-1]), grids, strict=True
        )
    ]
    corners = [(n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]) for n in numbers]
    quads = [np.stack(four, axis=-1).reshape(-1, 4) for four in corners]
    rings = [
        np.concatenate([n[0], n[1:, -1], n[-1, -2::-1], n[-2::-1, 0]]) for n in numbers
    ]
    nodes = np.concatenate([grid.reshape(-1, 2) for grid in grids])
    # A side is free where no other one has it the other way round; grids share places,
    # not nodes.
    places = np.round(nodes / np.ptp(nodes) * 1e5).astype(np.int64)
    place = np.unique(places, axis=0, return_inverse=True)[1].ravel()
    sides = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    ends = place[sides]
    is_free = ~np.isin(ends @ [len(nodes), 1], ends @ [1, len(nodes)]) & (
        ends[:, 0] != ends[:, 1]
    )
    return {
        "nodes": floats(nodes),
        "quads": np.concatenate(quads).astype(np.int32),
        "parts": np.repeat(parts, list(map(len, quads))),
        "outlines": np.concatenate([np.append(ring, NONE) for ring in rings]),
        "rims": np.insert(sides[is_free], 2, NONE, axis=1).ravel(),
    }
