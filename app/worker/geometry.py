"""From a problem to the bodies that are drawn, and how they move."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.frame import DeformedGeometry, Floats, Geometry
from app.messages import Needs
from solver.arrays import Array, Indices
from solver.discrete import Problem
from solver.discrete.elements import von_mises
from solver.discrete.plane_parts import Inside
from solver.discrete.probes import AxialForce
from solver.discrete.structure import Description
from solver.latin import Iterate
from solver.settings import Settings

THICKNESS, PITCH = 0.08, 0.1
"""Of a rod as it is drawn, which has none in the model, and between two rods; shares of length."""
MOST_POINTS = 201
"""Contact points of an interface, and nodes of a rod, that are shown at most."""
MOST_WIRES = 6
"""Wires whose axial force is shown at most, beside a broken one."""
MOST_QUADS = 400
"""Quadrilaterals that are drawn at most, or one for each body."""
NONE = -1
"""In place of a degree of freedom, and between two lines in a list of nodes."""
StressField = tuple[str, str, Floats]
"""What colours the quadrilaterals: title, SI unit, and values, (n_quads, n_instants)."""
Extras = dict[str, Callable[[Iterate, Needs], Any]]
"""What only some views need of an iterate, by the name that they need it by."""


def floats(values: NDArray[np.generic]) -> Floats:
    """Numbers as frames have them."""
    return values.astype(np.float32, order="C")


def thinned(size: int, most: int) -> Indices:
    """Indices that stand for a long axis, first and last included."""
    return np.unique(np.linspace(0, size - 1, min(size, most)).round().astype(np.intp))


class Drawn:
    """Bodies as they are drawn at some instants, and the contact points of all interfaces.

    The mesh is nodes, quadrilaterals and substructures of `Geometry`; heights are those of every
    degree of freedom along rods, m, None in the plane.
    """

    def __init__(
        self,
        problem: Problem,
        description: Description,
        columns: Indices,
        mesh: tuple[Floats, NDArray[np.int32], Indices],
        heights: Array | None,
    ) -> None:
        chosen, dofs, chains = [], [], []
        first = 0
        for number, law in enumerate(problem.rubbing.values()):
            points, pairs = np.unique(law.points, return_index=True)
            kept = thinned(len(points), MOST_POINTS)
            chosen.append(first + kept)
            moving = [law.tangent, *([law.normal.component] if law.normal else [])]
            rows = np.stack([component.above[pairs[kept]] for component in moving], axis=1)
            # What does not move off its support has no degree of freedom there.
            own = problem.row_dofs[rows]
            dofs.append(np.pad(own, ((0, 0), (0, 2 - len(moving))), constant_values=NONE))
            chains.append(np.full(len(kept), number))
            first += len(points)
        self._problem, self._columns = problem, columns
        self._points = np.concatenate(chosen)
        self._dofs = np.concatenate(dofs)
        places = problem.positions[self._dofs[:, 0]]
        if heights is not None:
            places = np.stack([places, heights[self._dofs[:, 0]]], axis=1)
        self.geometry = Geometry(
            description, *mesh, floats(places), np.concatenate(chains), *outlines_of(*mesh)
        )

    def deformed(self, iterate: Iterate) -> DeformedGeometry:
        """How the bodies have moved."""
        moved = iterate.problem.at_rest(iterate.displacement)[self._dofs][:, :, self._columns]
        moved[self._dofs == NONE] = 0.0
        status = iterate.status[np.ix_(self._points, self._columns)]
        return DeformedGeometry(self._nodes_moved(iterate), floats(moved), status)

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        raise NotImplementedError


class DrawnRods(Drawn):
    """Rods as rectangles above each other; they rub between them, or on what is below."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        description = settings.structure().described()
        rods, length = problem.substructures, description.length
        per_rod = len(rods) // description.bodies
        lows = PITCH * length * (np.arange(len(rods)) // per_rod)
        heights = np.zeros(problem.n_dofs)
        for rod, low in zip(rods, lows, strict=True):
            heights[rod.dofs] = low - 0.5 * (PITCH - THICKNESS) * length
        kept = [thinned(len(rod.dofs), max(MOST_POINTS // per_rod, 2)) for rod in rods]
        parts = np.repeat(np.arange(len(rods)), list(map(len, kept)))
        dofs = np.concatenate([rod.dofs[own] for rod, own in zip(rods, kept, strict=True)])
        first = np.flatnonzero(parts[1:] == parts[:-1])
        quads = (2 * first[:, None] + [0, 2, 3, 1]).astype(np.int32)
        y = lows[parts, None] + [0.0, THICKNESS * length]
        self._along = np.repeat(dofs, 2)
        nodes = np.stack([problem.positions[self._along], y.ravel()], axis=1)
        elements = np.cumsum([0, *(len(rod.dofs) - 1 for rod in rods[:-1])])
        middles = [n + (own[:-1] + own[1:]) // 2 for n, own in zip(elements, kept, strict=True)]
        self._force, self._elements = AxialForce(problem, columns), np.concatenate(middles)
        self._broken = None if description.broken is None else description.broken[0]
        mesh = floats(nodes), quads, parts[first]
        super().__init__(problem, description, columns, mesh, heights)

    @property
    def extras(self) -> Extras:
        """Stress, and the force in each rod."""
        return {"stress": self._stress, "axial force": self._axial_force}

    def _stress(self, iterate: Iterate, needs: Needs) -> StressField:
        """Axial force, as rods have no height."""
        return "axial force", "N", floats(self._forces(iterate)[self._elements])

    def _axial_force(self, iterate: Iterate, needs: Needs) -> dict[str, Any]:
        """Axial force in some rods at all instants.

        "x" of the middles of elements, (n_places,), m; "force", (n_rods, n_places, n_instants), N;
        "names" of the rods; "stuck", what the force would be if nothing slipped, of a strand that
        is bent, else None.
        """
        count, broken = int(self._force.wires.max()) + 1, self._broken
        places = thinned(len(self._force.wires) // count, MOST_POINTS)
        shown = sorted(
            {*thinned(count, MOST_WIRES).tolist(), *([] if broken is None else [broken])}
        )
        names = [f"{n + 1}, broken" if n == broken else str(n + 1) for n in shown]
        forces = self._forces(iterate).reshape(count, -1, len(self._columns))
        return {
            "x": floats(self._force.positions[places]),
            "force": floats(forces[np.ix_(shown, places)]),
            "names": names if count > 1 else ["rod"],
            "stuck": None,
        }

    def _forces(self, iterate: Iterate) -> Array:
        """Those in all elements, shape (n_elements, n_instants), N."""
        return self._force(iterate.displacement[:, self._columns])

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        """They move along themselves."""
        moved = iterate.problem.at_rest(iterate.displacement)
        along = moved[np.ix_(self._along, self._columns)]
        return floats(np.stack([along, np.zeros_like(along)], axis=1))


class DrawnMesh(Drawn):
    """Plane bodies, each with its mesh thinned where that is a grid."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        self._inside = problem.inside
        self._poisson, self._state = (settings.values()[name] for name in ("poisson", "plane"))
        self._has_bricks = bool(settings.features.bricks)
        self._nodes, quads, self._quad = thinned_mesh(problem.inside)
        self._counts = np.bincount(self._quad)
        parts = np.zeros(len(self._counts), dtype=np.intp)
        parts[self._quad] = problem.inside.parts
        mesh = floats(problem.inside.nodes[self._nodes]), quads, parts
        super().__init__(problem, settings.structure().described(), columns, mesh, None)

    @property
    def extras(self) -> Extras:
        """Stress, and lines of thrust through bricks."""
        return {"stress": self._stress} | ({"thrust": self._thrust} if self._has_bricks else {})

    def _stress(self, iterate: Iterate, needs: Needs) -> StressField:
        """Von Mises' equivalent stress, its mean in every quadrilateral."""
        means = []
        for moved in np.moveaxis(self._moved(iterate), -1, 0):
            stress = self._inside.stress(moved)
            shown = von_mises(stress, self._poisson, self._state)
            means.append(np.bincount(self._quad, weights=shown) / self._counts)
        return "von Mises stress", "Pa", floats(np.stack(means, axis=1))

    def _thrust(self, iterate: Iterate, needs: Needs) -> dict[str, Floats]:
        """Resultant force in every joint of bricks, and where it acts.

        "lines" go from the middle of one brick over the point where the resultant acts to the
        middle of the other, (n_joints, 3, 2, n_instants), m; on a support they end there. "forces"
        are their sizes, (n_joints, n_instants), N.
        """
        lines, forces = [], []
        for name, (places, above, below) in self._joints.items():
            components = self._problem.contact_places[name]
            normal, tangential = (
                iterate.contact_force[own][:, self._columns] for own in components
            )
            pressed = np.maximum(normal, 0.0)
            whole = pressed.sum(axis=0)
            share = pressed / np.where(whole > 0.0, whole, 1.0)
            point = places.T @ np.where(whole > 0.0, share, 1.0 / len(places))
            ends = above, point, point if below is None else below
            lines.append(np.stack(np.broadcast_arrays(*ends)))
            forces.append(np.hypot(whole, tangential.sum(axis=0)))
        return {"lines": floats(np.stack(lines)), "forces": floats(np.stack(forces))}

    @cached_property
    def _joints(self) -> dict[str, tuple[Array, Array, Array | None]]:
        """Points of each joint, (n_points, 2), and middles of its bricks, (2, 1), m."""
        problem, inside = self._problem, self._inside
        centres = inside.nodes[inside.elements].mean(axis=1)
        middles = np.zeros((problem.n_dofs, 2))
        for number, part in enumerate(problem.substructures):
            middles[part.dofs] = centres[inside.parts == number].mean(axis=0)
        joints = {}
        for name, law in problem.rubbing.items():
            _, pairs = np.unique(law.points, return_index=True)
            sides = [problem.row_dofs[rows[pairs]] for rows in law.tangent.sides]
            ends = [middles[dofs[0]][:, None] for dofs in sides]
            joints[name] = problem.positions[sides[0]], ends[0], (*ends, None)[1]
        return joints

    def nodes_of(self, displacement: Array) -> Floats:
        """Displacement of the nodes, (n_nodes, 2), of that of degrees of freedom, (n_dofs,), m."""
        moved, still = (
            self._inside.displacement(size * displacement[:, None], [0]) for size in (1.0, 0.0)
        )
        return floats((moved - still)[self._nodes, :, 0])

    def _moved(self, iterate: Iterate) -> Array:
        return self._inside.displacement(iterate.displacement, slice(None))[:, :, self._columns]

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        return floats(self._moved(iterate)[self._nodes])


def thinned_mesh(inside: Inside) -> tuple[Indices, NDArray[np.int32], Indices]:
    """Nodes and quadrilaterals that are drawn of bodies, and in which each element lies.

    The mesh of each body is a grid, of which some lines are left out.
    """
    nodes, quads, quad_of = [], [], np.zeros(len(inside.elements), dtype=np.intp)
    n_nodes = n_quads = 0
    most = max(MOST_QUADS // len(np.unique(inside.bodies)), 1)
    for body in np.unique(inside.bodies):
        elements = np.flatnonzero(inside.bodies == body)
        kept, corners = np.unique(inside.elements[elements], return_inverse=True)
        (x, column), (y, row) = (
            np.unique(values.round(9), return_inverse=True)
            for values in inside.nodes[kept].T / np.ptp(inside.nodes)
        )
        grid = np.zeros((len(y), len(x)), dtype=np.intp)
        grid[row, column] = kept
        share = min(np.sqrt(most / len(elements)), 1.0)
        rows = max(int(share * (len(y) - 1)), 1)
        columns = max(min(int(share * (len(x) - 1)), most // rows), 1)
        up, across = thinned(len(y), rows + 1), thinned(len(x), columns + 1)
        drawn = n_nodes + np.arange(len(up) * len(across)).reshape(len(up), len(across))
        around = drawn[:-1, :-1], drawn[:-1, 1:], drawn[1:, 1:], drawn[1:, :-1]
        nodes.append(grid[np.ix_(up, across)].ravel())
        quads.append(np.stack([corner.ravel() for corner in around], axis=1))
        first_row, first_column = (
            lines[corners.reshape(-1, 4)].min(axis=1) for lines in (row, column)
        )
        at = np.searchsorted(up, first_row, side="right") - 1
        beside = np.searchsorted(across, first_column, side="right") - 1
        quad_of[elements] = n_quads + at * (len(across) - 1) + beside
        n_nodes, n_quads = n_nodes + len(nodes[-1]), n_quads + len(quads[-1])
    return np.concatenate(nodes), np.concatenate(quads).astype(np.int32), quad_of


def outlines_of(nodes: Array, quads: NDArray[np.int32], parts: Indices) -> tuple[Indices, Indices]:
    """Closed lines round substructures, and sides of bodies that nothing touches."""
    # Parts that meet at a node may share it, or have one each at the same place.
    places = np.round(nodes / np.ptp(nodes) * 1e5).astype(np.int64)
    _, place = np.unique(places, axis=0, return_inverse=True)
    own = [_boundary(quads[parts == part], np.arange(len(nodes))) for part in np.unique(parts)]
    rims = _boundary(np.concatenate(own), place.ravel())
    loops = [np.append(loop, NONE) for sides in own for loop in _loops(sides)]
    return np.concatenate(loops), np.insert(rims, 2, NONE, axis=1).ravel()


def _boundary(cells: Indices, place: Indices) -> Indices:
    """Directed sides of cells, (n, 2), that no other one has the other way round.

    Cells are quadrilaterals, or sides; `place` is that of each node.
    """
    sides = cells
    if cells.shape[1] > 2:
        sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    ends, size = place[sides], int(place.max()) + 1
    is_single = ~np.isin(ends @ [size, 1], ends @ [1, size]) & (ends[:, 0] != ends[:, 1])
    return np.asarray(sides[is_single], dtype=np.intp)


def _loops(sides: Indices) -> list[Indices]:
    """Closed lines of directed sides."""
    following = defaultdict(list)
    for first, second in sides.tolist():
        following[first].append(second)
    loops = []
    for start in list(following):
        loop = [start]
        while following[loop[-1]]:
            loop.append(following[loop[-1]].pop())
        if len(loop) > 1:
            loops.append(np.array(loop, dtype=np.intp))
    return loops
