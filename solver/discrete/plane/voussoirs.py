"""Arches: a ring of voussoirs between two abutments, as bodies and joints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Body, Held, Joint, Load
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
    """Equal voussoirs between radial joints, about a centre at the origin.

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
    """

    voussoirs: int
    span: float
    radius: float
    thickness: float
    elements: int

    @property
    def outer(self) -> float:
        """Outer radius, m."""
        return self.radius + 0.5 * self.thickness

    @cached_property
    def angles(self) -> Array:
        """Clockwise angles of the joints from the crown, (voussoirs + 1,), rad."""
        return np.linspace(-0.5 * self.span, 0.5 * self.span, self.voussoirs + 1)

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
        """Number of elements of a voussoir along the ring, about square ones."""
        arc = self.radius * self.span / self.voussoirs
        return max(round(self.elements * arc / self.thickness), 1)

    @cached_property
    def wedge(self) -> Mesh:
        """A voussoir at the crown, about the centre of the ring."""
        half = 0.5 * self.span / self.voussoirs
        angles = np.linspace(-half, half, self.along + 1)
        radii = self.outer - self.thickness * np.linspace(1.0, 0.0, self.elements + 1)
        directions = np.stack([np.sin(angles), np.cos(angles)], axis=1)
        return _mapped(radii[:, None, None] * directions)

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
        middles = 0.5 * (self.angles[:-1] + self.angles[1:])
        bodies = []
        for number, angle in enumerate(middles.tolist(), start=1):
            body = Body(
                f"voussoir {number}",
                self.wedge,
                young,
                poisson,
                angle=-angle,
                weight=weight,
                substructures=substructures,
            )
            bodies.append(body)
        ends = []
        # Upwards of a block is into the ring, which the left one meets clockwise.
        for name, angle, sign in (
            (LEFT, self.angles[0], 1),
            (RIGHT, self.angles[-1], -1),
        ):
            origin = self.radius * np.array([np.sin(angle), np.cos(angle)])
            turn = np.arctan2(-sign * np.cos(angle), -sign * np.sin(angle))
            ends.append(
                Body(name, self.block, young, poisson, origin=origin, angle=float(turn))
            )
        return [ends[0], *bodies, ends[1]]

    def joints(self, friction: float) -> list[Joint]:
        """Joints between neighbours, from left to right."""
        left, right = self.sides
        _, face = self.faces
        joints = []
        for number, name in enumerate(self.joint_names):
            nodes = left
            below = right
            if number == 0:
                # The left block stands with its right side inwards.
                below = face[::-1]
            if number == self.voussoirs:
                nodes = face
            angle = self.angles[number]
            normals = np.tile([np.cos(angle), -np.sin(angle)], (len(nodes), 1))
            joint = Joint(
                name, number + 1, nodes, number, below, normals, friction=friction
            )
            joints.append(joint)
        return joints

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

    def backs(self) -> Array:
        """Positions of the nodes on the outer side, (voussoirs, n_nodes, 2), m."""
        shape = self.wedge.nodes[self.back]
        middles = 0.5 * (self.angles[:-1] + self.angles[1:])
        c = np.cos(middles)
        s = np.sin(middles)
        turns = np.stack([np.stack([c, s], axis=1), np.stack([-s, c], axis=1)], axis=1)
        return np.asarray(shape @ turns.swapaxes(1, 2))

    def under_fill(self, top: float) -> Array:
        """Volumes of columns from the outer side up to a height.

        Their shares of each node, (voussoirs, n_nodes), m^3 for a metre of thickness.
        The height is above the centre of the ring, m.
        """
        points = self.backs()
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
        for number, force in enumerate(downwards, start=1):
            if np.any(force):
                both = np.stack([np.zeros_like(force), -force], axis=1)
                yield Load(f"{name} {number}", number, self.back, both)


def _mapped(corners: Array) -> Mesh:
    """Mesh of quadrilaterals between rows and columns of corners, (rows, columns, 2).

    Columns are on the right of each other, and rows above each other.
    """
    n_rows, n_columns = corners.shape[:2]
    n = np.arange(n_rows * n_columns).reshape(n_rows, n_columns)
    elements = np.stack([n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]], axis=-1)
    return Mesh(corners.reshape(-1, 2), elements.reshape(-1, 4))


@dataclass(frozen=True, eq=False)
class Arch(Bodies):
    """A ring between abutments as bodies, and the loads as they are drawn.

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
        """Weight of all, with the loads on the outer side, shape (n_instants,), N."""
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
        return ("Movement of the right abutment", "m"), ("Thrust", "N")

    def loop(self, problem: Problem) -> Loop:
        """Horizontal thrust over the displacement of the right abutment."""
        name, axis = self._movement
        moved = mean_held(problem, name, axis)
        if self.settles:
            moved = moved.times(-1.0)
        thrust = reaction(problem, f"{RIGHT} x", 0).times(-1.0)
        return Loop(*self.axes, moved, thrust.of)

    def _acts(self) -> Iterator[Act]:
        """Loads as they are drawn, movements of the abutment, and the weight."""
        for act in self.above:
            yield replace(act, points=self._as_shares(act.points))
        for act in super()._acts():
            # Those on every voussoir are drawn together.
            if not act.where.startswith((FILL, LIVE)):
                yield act
