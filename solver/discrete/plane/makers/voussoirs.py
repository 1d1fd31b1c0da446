"""Arches: a ring of voussoirs between two abutments, as bodies and joints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby

import numpy as np

from solver.arrays import Array, Indices
from solver.cache import CACHE, content_of
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Body, Held, Load, turned_by
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.meshes import SIMPSON, Mesh, on_nodes
from solver.discrete.probes import mean_held, reaction
from solver.discrete.problem import Problem
from solver.discrete.structure import Act, Axes, Loop

HAUNCH = 0.2
"""Share of the ring from a springing to its haunch: near there a semicircle under its
own weight opens on its outer side."""
FILL = "fill on voussoir"
LIVE = "load on voussoir"
"""Names of loads on the outer side, before the number of the voussoir."""
LEFT = "left abutment"
RIGHT = "right abutment"


@dataclass(frozen=True)
class Ring:
    """Voussoirs between radial joints, about a centre at the origin.

    Halves of a pointed arch have radial joints about centres of their own, at the
    height of the origin, each beyond the crown; where they meet, a joint is upright.
    Voussoirs are equal, but those at the crown of a pointed arch have only the length
    of the inner side in common with the others.

    Attributes
    ----------
    voussoirs
        Number of voussoirs.
    span
        Angle of the whole ring, rad.
    radius, thickness
        Mean radius and thickness, m.
    elements
        Number of elements across the ring.
    offset
        Distance of the centre of each half beyond the crown, m; 0 is a round arch.
    """

    voussoirs: int
    span: float
    radius: float
    thickness: float
    elements: int
    offset: float = 0.0

    @property
    def outer(self) -> float:
        """Outer radius, m."""
        return self.radius + 0.5 * self.thickness

    @property
    def crown(self) -> float:
        """Height of the outer side at the crown, m."""
        return float(np.sqrt(self.outer**2 - self.offset**2))

    @property
    def half(self) -> float:
        """Angle of the inner side of a half about its centre, rad."""
        inner = self.outer - self.thickness
        return float(0.5 * self.span - np.arcsin(self.offset / inner))

    @cached_property
    def angles(self) -> Array:
        """Clockwise angles of the joints from upright, (voussoirs + 1,), rad."""
        beside = np.linspace(-self.half, self.half, self.voussoirs + 1)
        sides = np.sign(np.arange(-self.voussoirs, self.voussoirs + 1, 2))
        return beside + sides * (0.5 * self.span - self.half)

    @property
    def joint_names(self) -> list[str]:
        """Names of the joints from left to right."""
        last = self.voussoirs
        names = [f"joint {number}" for number in range(last + 1)]
        haunch = round(HAUNCH * last)
        names[haunch] = "left haunch"
        names[last - haunch] = "right haunch"
        names[last // 2] = "crown"
        names[0] = "left springing"
        names[last] = "right springing"
        return names

    @cached_property
    def along(self) -> int:
        """Number of elements of a voussoir along the ring: about square ones."""
        arc = 2.0 * self.radius * self.half / self.voussoirs
        along = max(round(self.elements * arc / self.thickness), 1)
        if self.offset and self.voussoirs % 2:
            # The point of the arch is in the middle of a voussoir.
            along += along % 2
        return along

    @property
    def _radii(self) -> Array:
        """Radii of the nodes at corners of elements, (elements + 1,), m."""
        return self.outer - self.thickness * np.linspace(1.0, 0.0, self.elements + 1)

    @cached_property
    def wedge(self) -> Mesh:
        """A voussoir of a round arch at the crown, about its centre."""
        half = self.half / self.voussoirs
        angles = np.linspace(-half, half, self.along + 1)
        directions = np.stack([np.sin(angles), np.cos(angles)], axis=1)
        return _mapped(self._radii[:, None, None] * directions)

    def _beside_crown(self, columns: int) -> Array:
        """Coordinates of corners from the crown to the first joint on its right, m.

        Of a number of columns of elements, shape (elements + 1, columns + 1, 2).
        """
        radii = self._radii[:, None]
        joint = self.angles[self.voussoirs // 2 + 1]
        angles = np.linspace(
            np.arcsin(self.offset / self._radii), joint, columns + 1, axis=1
        )
        across = radii * np.sin(angles) - self.offset
        # Both halves meet in one line, to the last digit.
        across[:, 0] = 0.0
        return np.stack([across, radii * np.cos(angles)], axis=-1)

    @property
    def _at_crown(self) -> slice:
        """Meshes of voussoirs that end, or have their middle, at a pointed crown."""
        if not self.offset:
            return slice(0)
        return slice((self.voussoirs - 1) // 2, self.voussoirs // 2 + 1)

    @cached_property
    def shapes(self) -> list[Mesh]:
        """Meshes of the voussoirs from left to right."""
        shapes = [self.wedge] * self.voussoirs
        if not self.offset:
            return shapes
        mirrored = np.array([-1.0, 1.0])
        if self.voussoirs % 2:
            right = self._beside_crown(self.along // 2)
            left = right[:, :0:-1] * mirrored
            crown = [_mapped(np.concatenate([left, right], axis=1))]
        else:
            right = self._beside_crown(self.along)
            crown = [_mapped(right[:, ::-1] * mirrored), _mapped(right)]
        shapes[self._at_crown] = crown
        return shapes

    @cached_property
    def turns(self) -> Array:
        """Clockwise angles by which the meshes are turned, (voussoirs,), rad."""
        turns = 0.5 * (self.angles[:-1] + self.angles[1:])
        turns[self._at_crown] = 0.0
        return np.asarray(turns)

    @cached_property
    def origins(self) -> Array:
        """Positions of the axes of the meshes, (voussoirs, 2), m."""
        origins = np.zeros((self.voussoirs, 2))
        sides = np.sign(np.arange(1 - self.voussoirs, self.voussoirs, 2))
        origins[:, 0] -= sides * self.offset
        origins[self._at_crown] = 0.0
        return origins

    @cached_property
    def block(self) -> Mesh:
        """A square abutment, below the middle of the joint on it."""
        across = self.thickness * np.linspace(-0.5, 0.5, self.elements + 1)
        up = self.thickness * np.linspace(-1.0, 0.0, self.elements + 1)
        corners = np.stack(np.meshgrid(across, up), axis=-1)
        return _mapped(corners)

    def _on_wedge(self, rows: slice | int, columns: slice | int) -> Indices:
        """Chain of nodes of a voussoir along a row or a column of its mesh."""
        size = self.elements + 1, self.along + 1
        corners = np.arange(size[0] * size[1]).reshape(size)
        return self.wedge.along(corners[rows, columns])

    @cached_property
    def sides(self) -> tuple[Indices, Indices]:
        """Chains of the left and right side of a voussoir, outwards."""
        return self._on_wedge(slice(None), 0), self._on_wedge(slice(None), -1)

    @cached_property
    def back(self) -> Indices:
        """Chain of the outer side of a voussoir, from left to right."""
        return self._on_wedge(-1, slice(None))

    @cached_property
    def faces(self) -> tuple[Indices, Indices]:
        """Chains of the lower and the upper side of an abutment, from left to right."""
        corners = np.arange((self.elements + 1) ** 2).reshape(self.elements + 1, -1)
        return self.block.along(corners[0]), self.block.along(corners[-1])

    def bodies(
        self, young: float, poisson: float, weight: Array, substructures: int
    ) -> list[Body]:
        """Abutments and voussoirs from left to right.

        `weight` is that of voussoirs along x and y, shape (2, n_instants), N/m^3.
        """
        names = [f"voussoir {number + 1}" for number in range(self.voussoirs)]
        bodies = list[Body]()
        for shape, run in groupby(range(self.voussoirs), self.shapes.__getitem__):
            numbers = list(run)
            own = slice(numbers[0], numbers[-1] + 1)
            first = Body(
                names[numbers[0]],
                shape,
                young,
                poisson,
                weight=weight,
                substructures=substructures,
            )
            bodies += first.placed(names[own], self.origins[own], -self.turns[own])
        ends = []
        # The upward axis of a block points into the ring, on the left side clockwise.
        for name, angle, sign in (
            (LEFT, self.angles[0], 1),
            (RIGHT, self.angles[-1], -1),
        ):
            origin = self.radius * np.array([np.sin(angle), np.cos(angle)])
            origin[0] += sign * self.offset
            turn = np.arctan2(-sign * np.cos(angle), -sign * np.sin(angle))
            ends.append(
                Body(name, self.block, young, poisson, origin=origin, angle=float(turn))
            )
        return [ends[0], *bodies, ends[1]]

    def joints(self, friction: float) -> list[Joint]:
        """Joints between neighbours, from left to right."""
        left, right = self.sides
        _, face = self.faces
        directions = np.stack([np.cos(self.angles), -np.sin(self.angles)], axis=1)
        normals = np.repeat(directions[:, None], len(left), axis=1)
        names = self.joint_names
        last = self.voussoirs
        # The left block stands with its right side inwards.
        begins = Joint(names[0], 1, left, 0, face[::-1], normals[0], friction=friction)
        inner = Joint(names[1], 2, left, 1, right, normals[1], friction=friction)
        ends = Joint(
            names[last], last + 1, face, last, right, normals[last], friction=friction
        )
        between = inner.placed(
            names[1:last], range(2, last + 1), range(1, last), normals[1:last]
        )
        return [begins, *between, ends]

    def abutments(self, moved: Array) -> list[Held]:
        """Feet of both abutments: the left one at rest, the right one moved.

        `moved` is the displacement along x and y, shape (2, n_instants), m.
        """
        feet, _ = self.faces
        held = []
        for name, body in ((LEFT, 0), (RIGHT, self.voussoirs + 1)):
            for axis, path in enumerate(moved):
                displacement = path
                if not body:
                    displacement = np.zeros_like(path)
                where = f"{name} {'xy'[axis]}"
                held.append(Held(where, body, feet, axis, displacement))
        return held

    @cached_property
    def backs(self) -> Array:
        """Positions of the nodes on the outer side, (voussoirs, n_nodes, 2), m."""
        shapes = np.stack([shape.nodes[self.back] for shape in self.shapes])
        # Turns are clockwise here.
        turned = shapes @ turned_by(-self.turns).swapaxes(1, 2)
        return np.asarray(turned + self.origins[:, None])

    def under_fill(self, top: float) -> Array:
        """Volume above each node of the outer side, (voussoirs, n_nodes), m^3.

        For a metre of thickness; the columns end at a height `top` above the centres,
        m.
        """
        points = self.backs
        widths = np.diff(points[:, ::2, 0], axis=1)
        shares = on_nodes(widths.T, SIMPSON).T
        return np.asarray(shares * (top - points[:, :, 1]))

    def under_load(self, places: Array) -> Array:
        """Shares of outer nodes in a load, (voussoirs, n_nodes, n_instants).

        `places` over time are shares of the ring from its left end, (n_instants,).
        """
        passed = self.voussoirs * np.clip(places, 0.0, 1.0)
        below = np.minimum(passed.astype(np.intp), self.voussoirs - 1)
        nodes = np.arange(len(self.back))[:, None]
        distance = np.abs((passed - below) * nodes[-1] - nodes)
        shares = np.zeros((self.voussoirs, len(nodes), len(places)))
        shares[below, :, np.arange(len(places))] = np.maximum(1.0 - distance, 0.0).T
        return shares

    def loads(self, name: str, downwards: Array) -> Iterator[Load]:
        """Loads of forces on the outer side, (voussoirs, n_nodes, n_instants), N."""
        for loaded in np.flatnonzero(downwards.any(axis=(1, 2))).tolist():
            force = downwards[loaded]
            both = np.stack([np.zeros_like(force), -force], axis=1)
            number = loaded + 1
            yield Load(f"{name} {number}", number, self.back, both)


def _mapped(corners: Array) -> Mesh:
    """Mesh of quadrilaterals between rows and columns of corners, (rows, columns, 2).

    Columns are on the right of each other, and rows above each other.
    """
    n_rows, n_columns = corners.shape[:2]
    n = np.arange(n_rows * n_columns).reshape(n_rows, n_columns)
    elements = np.stack([n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]], axis=-1)
    # What is found from a mesh takes as long as an iteration on 100 voussoirs, and
    # loads leave it alone.
    key = "voussoir", content_of(corners)
    return CACHE.get(key, lambda: Mesh(corners.reshape(-1, 2), elements.reshape(-1, 4)))


@dataclass(frozen=True, eq=False)
class Arch(Bodies):
    """A ring between abutments as bodies, with its loads for drawings.

    Attributes
    ----------
    settles
        The loop shows how the right abutment settles, not how it moves apart.
    above
        Loads on the outer side as drawings show them, at positions in m.
    """

    settles: bool = False
    above: Sequence[Act] = ()

    def without(self, name: str) -> Arch:
        """The arch without the loads of a name on its outer side."""
        loads = [load for load in self.loads if not load.name.startswith(name)]
        return replace(self, loads=loads)

    @property
    def downwards(self) -> Array:
        """Weight of all bodies and of the loads on the outer side, (n_instants,), N."""
        loads = [load.force[:, 1].sum(axis=0) for load in self.loads]
        return np.asarray(-np.sum([self.weights[1], *loads], axis=0))

    @property
    def _movement(self) -> tuple[str, int]:
        """Name and axis of the hold that the loop shows."""
        if self.settles:
            return f"{RIGHT} y", 1
        return f"{RIGHT} x", 0

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        moved = "Movement of the right abutment"
        if self.settles:
            # Downwards, while its arrow in a picture has values that count upwards.
            moved = "Settlement of the right abutment"
        return (moved, "m"), ("Thrust", "N")

    def loop(self, problem: Problem) -> Loop:
        """Horizontal thrust over the displacement of the right abutment."""
        name, axis = self._movement
        moved = mean_held(problem, name, axis)
        if self.settles:
            moved = moved.times(-1.0)
        thrust = reaction(problem, f"{RIGHT} x", 0).times(-1.0)
        return Loop(*self.axes, moved, thrust.of)

    def _acts(self) -> Iterator[Act]:
        """Arrows of loads, of movements of the abutment, and of the weight."""
        for act in self.above:
            yield replace(act, points=self._drawn.as_shares(act.points))
        for act in super()._acts():
            # Fill and live load act on many voussoirs, and are drawn once, by `above`.
            if not act.where.startswith((FILL, LIVE)):
                yield act
