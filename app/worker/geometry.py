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
from solver.laws.contact import Contact
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
MOST_QUADS = 400
"""Largest number of quadrilaterals that are drawn, or one for each body."""
NONE = -1
"""Number in place of a missing degree of freedom, and between two lines of nodes."""
StressField = tuple[str, str, Floats]
"""Title, SI unit, and values in the quadrilaterals, (n_quads, n_instants)."""
Extras = dict[str, Callable[[Iterate, Needs], Any]]
"""Extras of an iterate for some views, by the names in `View.needs`."""


def floats(values: NDArray[np.generic]) -> Floats:
    """Arrays as frames have them, of the same shape."""
    return values.astype(np.float32, order="C")


def thinned(size: int, limit: int) -> Indices:
    """Indices of a thinned axis, (n,), first and last included, n up to a limit."""
    if size <= limit:
        return np.arange(size)
    return np.unique(np.linspace(0, size - 1, limit).round().astype(np.intp))


def _shares_of_points(pressed: Array, whole: Array, sizes: Indices) -> Array:
    """Share of each point in the resultant of its joint, (n_points, n_shown).

    A resultant acts at the mean of the points by their pressing force, (n_points,
    n_shown), N; in the middle of a joint that is open. `whole` are the sums of these
    forces, (n_joints, n_shown), N, `sizes` the numbers of points, (n_joints,).
    """
    divisor = np.repeat(np.where(whole > 0.0, whole, 1.0), sizes, axis=0)
    is_closed = np.repeat(whole > 0.0, sizes, axis=0)
    even = np.repeat(1.0 / sizes, sizes)[:, None]
    return np.where(is_closed, pressed / divisor, even)


class Drawn:
    """Bodies as they are drawn at some instants, and their contact points.

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
        # Numbers of the shown contact points among all, their degrees of freedom along
        # and across the interface, and numbers of their interfaces.
        contacts = problem.rubbing
        kept = [thinned(size, MOST_POINTS) for size in contacts.sizes.tolist()]
        chains = np.repeat(np.arange(len(kept)), [len(some) for some in kept])
        firsts = np.cumsum(contacts.sizes) - contacts.sizes
        dofs = []
        for law in contacts.laws.values():
            _, pairs = np.unique(law.points, return_index=True)
            dofs.append(_dofs_of(problem, law, pairs))
        self._problem = problem
        self._columns = columns
        self._points = firsts[chains] + np.concatenate(kept)
        self._dofs = contacts.of_points(dofs)[self._points]
        points = floats(positions[self._dofs[:, 0]])
        self.geometry = Geometry(
            description=description,
            points=points,
            chains=chains,
            **mesh,
        )

    def deformed(self, iterate: Iterate) -> DeformedGeometry:
        """Displacements of nodes and points, and the status, at the shown instants."""
        absolute = iterate.problem.absolute(iterate.displacement)
        moved = absolute[self._dofs][:, :, self._columns]
        moved[self._dofs == NONE] = 0.0
        status = iterate.status[np.ix_(self._points, self._columns)]
        return DeformedGeometry(self._nodes_moved(iterate), floats(moved), status)

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        raise NotImplementedError


def _dofs_of(problem: Problem, law: Contact, pairs: Indices) -> Indices:
    """Degrees of freedom of pairs of an interface, along and across it, (n_points, 2).

    Where bodies do not open, the degree of freedom across is `NONE`.
    """
    components = [law.tangent]
    if law.normal:
        components.append(law.normal.component)
    rows = np.stack([component.above[pairs] for component in components], axis=1)
    missing = 2 - len(components)
    dofs = problem.row_dofs[rows]
    return np.pad(dofs, ((0, 0), (0, missing)), constant_values=NONE)


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
        """Axial force, as rods have no height."""
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

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        """Displacement of the nodes, which move along the rods, m."""
        moved = iterate.problem.absolute(iterate.displacement)
        along = moved[np.ix_(self._along, self._columns)]
        return floats(np.stack([along, np.zeros_like(along)], axis=1))


def _rectangles(
    problem: Problem, description: Description
) -> tuple[list[Array], list[Indices], list[Indices]]:
    """Rectangles of the substructures of rods, which stand above each other.

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
    """Plane bodies, with some lines of the mesh of each substructure."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        inside = problem.inside
        values = settings.values()
        self._inside = inside
        self._poisson = values["poisson"]
        self._state = values["plane"]
        self.extras: Extras = {"stress": self._stress}
        if settings.has_joints:
            self.extras["thrust"] = self._thrust
        # All grids are thinned alike, so that bodies of one size look alike.
        limit = max(MOST_QUADS // len(inside.grids), 1)
        shapes = np.array([np.subtract(grid.shape, 1) for grid in inside.grids])
        share = min(np.sqrt(limit / shapes.prod(axis=1).max()), 1.0)
        grids = []
        quads = []
        first = 0
        for grid in inside.grids:
            up, across = _kept_lines(grid, share, limit)
            grids.append(grid[np.ix_(up, across)])
            quads.append(first + _quads_of(grid, up, across))
            first += (len(up) - 1) * (len(across) - 1)
        self._nodes = np.concatenate([grid.ravel() for grid in grids])
        # The quadrilateral that each element lies in.
        self._quad = np.concatenate(quads)
        mesh = mesh_of([inside.nodes[grid] for grid in grids], np.arange(len(grids)))
        description = settings.structure().description()
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
        contacts = self._problem.rubbing
        lines = np.zeros((len(contacts), 3, 2, len(self._columns)))
        forces = np.zeros((len(contacts), len(self._columns)))
        for stacked in contacts.stacks:
            normal, tangential = [
                iterate.contact_force[numbers][:, self._columns]
                for numbers in stacked.forces
            ]
            sizes = stacked.law.sizes
            firsts = np.cumsum(sizes) - sizes
            pressed = np.maximum(normal, 0.0)
            whole = np.add.reduceat(pressed, firsts)
            sheared = np.add.reduceat(tangential, firsts)
            weights = _shares_of_points(pressed, whole, sizes)
            lines[stacked.numbers] = self._lines(stacked.law, firsts, weights)
            forces[stacked.numbers] = np.hypot(whole, sheared)
        return {"lines": floats(lines), "forces": floats(forces)}

    def _lines(self, law: Contact, firsts: Indices, weights: Array) -> Array:
        """Lines of thrust over joints, (n_joints, 3, 2, n_shown), m.

        `firsts` are the first points of the joints, (n_joints,), `weights` those with
        which each point counts, (n_points, n_shown).
        """
        problem = self._problem
        middles = self._middles()
        _, pairs = np.unique(law.points, return_index=True)
        above, *below = [problem.row_dofs[rows[pairs]] for rows in law.tangent.sides]
        moments = problem.positions[above][:, :, None] * weights[:, None]
        points = np.add.reduceat(moments, firsts)
        ends = points
        if below:
            ends = middles[below[0][firsts]]
        begins = middles[above[firsts]]
        return np.stack(np.broadcast_arrays(begins, points, ends), axis=1)

    def _middles(self) -> Array:
        """Middle of the body of each degree of freedom, shape (n_dofs, 2, 1), m."""
        problem = self._problem
        middles = np.zeros((problem.n_dofs, 2, 1))
        for grid, part in zip(self._inside.grids, problem.substructures, strict=True):
            middles[part.dofs, :, 0] = self._inside.nodes[grid].mean(axis=(0, 1))
        return middles

    def nodes_of(self, displacement: Array) -> Floats:
        """Displacement of nodes, (n_nodes, 2), m, from that of all, (n_dofs,), m."""
        moved = self._inside.displacement(displacement[:, None], [0])
        # Given displacements are added to all, and are no part of a motion.
        still = self._inside.displacement(np.zeros((len(displacement), 1)), [0])
        return floats((moved - still)[self._nodes, :, 0])

    def _moved(self, iterate: Iterate) -> Array:
        """Displacement of all nodes at the shown instants, (n_nodes, 2, n_shown), m."""
        moved = self._inside.displacement(iterate.displacement, slice(None))
        return moved[:, :, self._columns]

    def _nodes_moved(self, iterate: Iterate) -> Floats:
        return floats(self._moved(iterate)[self._nodes])


def _kept_lines(grid: Indices, share: float, limit: int) -> tuple[Indices, Indices]:
    """Rows and columns of a grid of nodes that are drawn, (n_up,) and (n_across,).

    They are a share of all lines, and make no more cells than a limit.
    """
    n_rows, n_columns = np.subtract(grid.shape, 1)
    rows = max(int(share * n_rows), 1)
    columns = max(min(int(share * n_columns), limit // rows), 1)
    return thinned(n_rows + 1, rows + 1), thinned(n_columns + 1, columns + 1)


def _quads_of(grid: Indices, up: Indices, across: Indices) -> Indices:
    """Quadrilateral of kept rows and columns about each element, (n_elements,)."""
    n_rows, n_columns = np.subtract(grid.shape, 1)
    row = np.searchsorted(up, np.arange(n_rows), side="right") - 1
    column = np.searchsorted(across, np.arange(n_columns), side="right") - 1
    return np.add.outer(row * (len(across) - 1), column).ravel()


def ring_of(grid: Indices) -> Indices:
    """Numbers around a grid, (n_rows, n_columns), the first again at the end, (n,)."""
    sides = (grid[0], grid[1:, -1], grid[-1, -2::-1], grid[-2::-1, 0])
    return np.concatenate(sides)


def mesh_of(grids: Sequence[Array], parts: ArrayLike) -> dict[str, Any]:
    """Nodes, quadrilaterals and outlines, as `Geometry` has them, of grids of nodes.

    Each grid is of one of the parts, (n_rows, n_columns, 2), m, row by row from below.
    """
    quads = []
    rings = []
    first = 0
    for grid in grids:
        n_rows, n_columns = grid.shape[:2]
        size = n_rows * n_columns
        n = np.arange(first, first + size).reshape(n_rows, n_columns)
        corners = (n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1])
        quads.append(np.stack(corners, axis=-1).reshape(-1, 4))
        rings.append(ring_of(n))
        first += size
    nodes = np.concatenate([grid.reshape(-1, 2) for grid in grids])
    sides = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    free = sides[_is_free(sides, nodes)]
    return {
        "nodes": floats(nodes),
        "quads": np.concatenate(quads).astype(np.int32),
        "parts": np.repeat(parts, [len(some) for some in quads]),
        "outlines": np.concatenate([np.append(ring, NONE) for ring in rings]),
        "rims": np.insert(free, 2, NONE, axis=1).ravel(),
    }


def _is_free(sides: Indices, nodes: Array) -> NDArray[np.bool_]:
    """Check which sides, (n_sides, 2), of grids no other grid has, (n_sides,).

    A shared side runs the other way round in the other grid; grids share positions,
    not nodes, (n_nodes, 2), m.
    """
    rounded = np.round(nodes / np.ptp(nodes) * 1e5).astype(np.int64)
    position = np.unique(rounded, axis=0, return_inverse=True)[1].ravel()
    ends = position[sides]
    there = ends @ [len(nodes), 1]
    back = ends @ [1, len(nodes)]
    has_length = ends[:, 0] != ends[:, 1]
    return ~np.isin(there, back) & has_length
