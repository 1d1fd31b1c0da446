"""Round wires that touch: meshes graded towards their contacts, and packings.

Wires lie on a triangular grid, so that all contacts are at multiples of 30 degrees.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import scipy

from solver.arrays import Array, Indices
from solver.discrete.plane.meshes import Mesh

TURN = np.pi / 6.0
"""Angle of which all directions of contacts are multiples, rad."""
TURNS = 12
"""Number of such angles in a whole turn."""
GRADED = 0.45
"""Distance from a contact up to which a mesh is graded, over the radius: neighbours are
apart by as much as the radius."""
COARSE = 0.3
"""Distance of the nodes of the mesh elsewhere, over the radius."""
GROWTH = 1.0
"""Step from one ring of nodes about a contact to the next, in the angle between nodes
of a ring."""
FINE = 3
"""Number of rings with all nodes."""
DOWN = 9
UP = 3


@dataclass(frozen=True)
class Zone:
    """Zone of contact: half of its width, m, and its number of elements."""

    half_width: float
    elements: int

    @cached_property
    def offsets(self) -> Array:
        """Positions of the corners along the zone, (elements + 1,), m."""
        return np.linspace(-self.half_width, self.half_width, self.elements + 1)

    def rings(self, radius: float) -> tuple[Array, Array]:
        """Positions about a contact: on the surface, and below it.

        Confocal ellipses about the zone, which become circles. Those on the surface
        ascend, (n,); below it there are positions along it and depths, (n, 2), m.
        """
        angles = np.arccos(self.offsets / self.half_width)[1:-1]
        step = GROWTH * 2.0 / self.elements
        last = np.arccosh(max(GRADED * radius / self.half_width, 1.0))
        # Steps grow as ellipses become circles, on which half of the nodes will do.
        near = step * np.arange(1.0, FINE + 1.0)
        count = int(np.ceil((last - near[-1]) / (2.0 * step)))
        growing = np.append(near, np.linspace(near[-1], last, count + 1)[1:])
        surface = self.half_width * np.cosh(growing)
        below = []
        for number, ring in enumerate(growing.tolist()):
            every = angles
            if number >= FINE:
                every = angles[::2]
            along = np.cosh(ring) * np.cos(every)
            depth = np.sinh(ring) * np.sin(every)
            below.append(self.half_width * np.stack([along, depth], axis=1))
        return (
            np.concatenate([-surface[::-1], self.offsets, surface]),
            np.concatenate(below),
        )


@dataclass(frozen=True, eq=False)
class Disc:
    """A round wire: its mesh, and chains of nodes that may touch.

    Attributes
    ----------
    mesh
        The mesh about the axis of the wire.
    zones
        Chains of the zones by their direction in turns, counter-clockwise.
    """

    mesh: Mesh
    zones: dict[int, Indices]

    @property
    def nbytes(self) -> int:
        """Memory of the mesh, B."""
        return self.mesh.nbytes

    @classmethod
    def of(cls, radius: float, contacts: Mapping[int, Zone]) -> Disc:
        """Mesh of a disc with zones of contact by their directions, in turns."""
        rims = []
        inside = []
        for direction, zone in contacts.items():
            angle = direction * TURN
            surface, below = zone.rings(radius)
            rims.append(angle + surface / radius)
            inside.append(_polar(radius - below[:, 1], angle + below[:, 0] / radius))
        near = np.concatenate(rims)
        # Elsewhere the surface has a node at every half of a turn.
        others = TURN * np.arange(0.0, TURNS, 0.5)
        apart = np.abs(_wrapped(others[:, None] - near)).min(axis=1)
        angles = np.concatenate([near, others[apart > 0.5 * COARSE]])
        rim = _polar(np.full(len(angles), radius), angles)
        graded = np.concatenate([rim, *inside])
        mesh = triangulated(np.concatenate([graded, _coarse(graded, radius)]))
        return cls(
            mesh,
            dict(zip(contacts, _chains(mesh, contacts.values(), rims), strict=True)),
        )

    def facing(self, direction: int) -> Indices:
        """Chain of nodes of the surface over 60 degrees about a free direction."""
        angles = TURN * (direction + np.arange(-1.0, 1.25, 0.5))
        radius = np.linalg.norm(self.mesh.corners, axis=1).max()
        wanted = _polar(np.full(len(angles), radius), angles)
        distances = np.linalg.norm(self.mesh.corners - wanted[:, None], axis=2)
        return self.mesh.along(distances.argmin(axis=1))


def triangulated(corners: Array) -> Mesh:
    """Mesh of triangles between corners, (n, 2), of a convex body."""
    return Mesh(corners, scipy.spatial.Delaunay(corners).simplices.astype(np.intp))


def _polar(radius: Array, angle: Array) -> Array:
    """Points by their distances from the axis, m, and angles, (n,) both: (n, 2), m."""
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _wrapped(angle: Array) -> Array:
    """Angles of any shape, rad, within half a turn about 0."""
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _coarse(graded: Array, radius: float) -> Array:
    """Points inside a disc, away from the graded meshes, (n, 2), m."""
    circles = [np.zeros((1, 2))]
    for number in (1, 2):
        angles = TURN * (np.arange(6.0 * number) * 2.0 / number)
        circles.append(_polar(np.full(len(angles), COARSE * number * radius), angles))
    points = np.concatenate(circles)
    distance = np.linalg.norm(points[:, None] - graded, axis=2).min(axis=1)
    return np.asarray(points[distance > 0.5 * COARSE * radius])


@dataclass(frozen=True, eq=False)
class Plate:
    """A plate on the highest wires: its mesh, whose lower side is at 0, and chains.

    Attributes
    ----------
    mesh
        The mesh.
    zones
        Chains of its zones of contact, from left to right.
    top, ends
        Chains of its upper side, and of its left and right end.
    """

    mesh: Mesh
    zones: list[Indices]
    top: Indices
    ends: tuple[Indices, Indices]

    @property
    def nbytes(self) -> int:
        """Memory of the mesh, B."""
        return self.mesh.nbytes

    @classmethod
    def of(cls, places: Array, radius: float, thickness: float, zone: Zone) -> Plate:
        """Mesh of a plate on wires at places along it, (n_wires,), m."""
        surface, below = zone.rings(radius)
        surface = radius * np.sin(surface / radius)
        lines = [surface + x for x in places]
        left = places.min() - radius
        right = places.max() + radius
        # Between wires and beyond them.
        lines.append(np.arange(left, right + radius, 2.0 * radius))
        bottom = np.concatenate(lines)
        upper = np.linspace(left, right, 4 * len(places) + 1)
        middle = 0.5 * thickness
        inside = [below + np.array([x, 0.0]) for x in places]
        corners = [
            np.stack([bottom, np.zeros_like(bottom)], axis=1),
            np.stack([upper, np.full_like(upper, thickness)], axis=1),
            np.array([(left, middle), (right, middle)]),
            *inside,
        ]
        mesh = triangulated(np.concatenate(corners))
        first = len(bottom)
        last = first + len(upper)
        lower = len(bottom) - len(lines[-1])
        return cls(
            mesh,
            _chains(mesh, [zone] * len(places), lines),
            mesh.along(np.arange(first, last)),
            (
                mesh.along([lower, last, first]),
                mesh.along([first - 1, last + 1, last - 1]),
            ),
        )


def _chains(mesh: Mesh, zones: Iterable[Zone], lines: Sequence[Array]) -> list[Indices]:
    """Chains of zones in the middles of lines, which are a mesh's first corners."""
    chains = []
    first = 0
    for zone, line in zip(zones, lines, strict=False):
        size = zone.elements + 1
        start = first + (len(line) - size) // 2
        chains.append(mesh.along(np.arange(start, start + size)))
        first += len(line)
    return chains


@dataclass(frozen=True)
class Packing:
    """Arrangement of wires: rows of a triangular grid, from below.

    Attributes
    ----------
    rows
        Number of wires of each row; each differs from the next by one.
    """

    rows: tuple[int, ...]

    # The few packings there are keep their neighbours for all settings.
    @classmethod
    @cache
    def hexagon(cls, rings: int) -> Packing:
        """Rings of wires around a central wire."""
        upper = range(2 * rings, rings, -1)
        rows = [*reversed(upper), 2 * rings + 1, *upper]
        return cls(tuple(rows))

    @classmethod
    @cache
    def heap(cls, rows: int) -> Packing:
        """Rows of wires on the ground, the highest of a single one."""
        return cls(tuple(range(rows, 0, -1)))

    @cached_property
    def centres(self) -> Array:
        """Axes of the wires over the radius, (n_wires, 2): row by row from below."""
        points = []
        for row, count in enumerate(self.rows):
            along = 2.0 * np.arange(count) - (count - 1)
            up = np.full(count, 1.0 + row * np.sqrt(3.0))
            points.append(np.stack([along, up], axis=1))
        return np.concatenate(points)

    @cached_property
    def row_of_wires(self) -> Indices:
        """Row of each wire, (n_wires,)."""
        return np.repeat(np.arange(len(self.rows)), self.rows)

    @cached_property
    def neighbours(self) -> list[dict[int, int]]:
        """Neighbours of every wire by their direction, in turns."""
        found: list[dict[int, int]] = []
        for centre in self.centres:
            apart = self.centres - centre
            numbers = np.flatnonzero(np.abs(np.hypot(*apart.T) - 2.0) < 0.1)
            turns = np.arctan2(apart[numbers, 1], apart[numbers, 0]) / TURN
            directions = np.rint(turns).astype(int) % TURNS
            found.append(dict(zip(directions.tolist(), numbers.tolist(), strict=True)))
        return found

    def directions(self, wire: int, *, has_plate: bool) -> list[int]:
        """Directions of the contacts of a wire, ascending, in turns."""
        directions = list(self.neighbours[wire])
        if self.row_of_wires[wire] == 0:
            directions.append(DOWN)
        if has_plate and self.row_of_wires[wire] == len(self.rows) - 1:
            directions.append(UP)
        return sorted(directions)

    def outward(self, wire: int) -> int | None:
        """Direction out of the bundle at the end of an inner row; None elsewhere."""
        if self.row_of_wires[wire] in (0, len(self.rows) - 1):
            return None
        free = [
            turn for turn in range(0, TURNS, 2) if turn not in self.neighbours[wire]
        ]
        if not free:
            return None
        vector = np.exp(1j * TURN * np.array(free)).sum()
        return int(np.rint(np.angle(vector) / TURN)) % TURNS
