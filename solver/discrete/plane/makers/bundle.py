"""A bundle of round wires as bodies: on rigid ground, and under a plate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial

import numpy as np

from solver.arrays import Array, Indices
from solver.cache import CACHE
from solver.discrete.plane.body import Body, Held, Load
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.makers.wires import (
    DOWN,
    TURN,
    TURNS,
    UP,
    Disc,
    Packing,
    Plate,
    Zone,
)

PLATE = "plate"
THICKNESS = 0.8
"""Thickness of the plate over the radius of a wire."""
WIDER = np.sqrt(2.0)
"""Half width of a contact with an elastic plate, over that of two wires."""
Pattern = tuple[tuple[int, Zone], ...]
"""Zones of a wire with their directions, in turns."""


@dataclass(frozen=True)
class Wires:
    """Round wires, and how they touch.

    Attributes
    ----------
    packing
        How they lie.
    radius
        Radius of a wire, m.
    zone
        Zone of contact of two wires.
    has_plate
        Whether a plate lies on the highest ones.
    """

    packing: Packing
    radius: float
    zone: Zone
    has_plate: bool

    @property
    def under_plate(self) -> Zone:
        """Zone of contact of a wire and the plate."""
        return Zone(WIDER * self.zone.half_width, self.zone.elements)

    @cached_property
    def centres(self) -> Array:
        """Axes of the wires, (n_wires, 2), m; the ground is at 0."""
        return self.radius * self.packing.centres

    @cached_property
    def highest(self) -> list[int]:
        """Indices of the wires of the highest row."""
        count = len(self.centres)
        return list(range(count - self.packing.rows[-1], count))

    @cached_property
    def _placed(self) -> list[tuple[Disc, int]]:
        """Shape of each wire, and its rotation in turns."""
        placed = []
        for wire in range(len(self.centres)):
            pattern, turn = _first_order(tuple(self._contacts(wire).items()))
            # To mesh it takes as long as a few iterations, and loads leave it alone.
            key = Disc, self.radius, pattern
            make = partial(Disc.of, self.radius, dict(pattern))
            placed.append((CACHE.get(key, make), turn))
        return placed

    def _contacts(self, wire: int) -> dict[int, Zone]:
        """Zones of a wire by their direction."""
        directions = self.packing.directions(wire, has_plate=self.has_plate)
        contacts = dict.fromkeys(directions, self.zone)
        if UP in contacts:
            contacts[UP] = self.under_plate
        return contacts

    @cached_property
    def plate(self) -> Plate:
        """The plate on the highest wires."""
        key = Plate, self.packing, self.radius, self.under_plate
        places = self.centres[self.highest, 0]
        thickness = THICKNESS * self.radius
        return CACHE.get(
            key, lambda: Plate.of(places, self.radius, thickness, self.under_plate)
        )

    def chain(self, wire: int, direction: int) -> Indices:
        """Chain of a wire in a direction, counter-clockwise."""
        disc, turn = self._placed[wire]
        return disc.zones[(direction - turn) % TURNS]

    def bodies(self, young: float, poisson: float, weight: Array) -> list[Body]:
        """Bodies of the wires, with a weight along x and y, (2, n_instants), N/m^3."""
        bodies = []
        area = np.pi * self.radius**2
        for number, (disc, turn) in enumerate(self._placed):
            # The polygon of a mesh is smaller than the circle.
            rounded = area / disc.mesh.volume
            body = Body(
                f"wire {number + 1}",
                disc.mesh,
                young,
                poisson,
                origin=self.centres[number],
                angle=turn * TURN,
                weight=rounded * weight,
            )
            bodies.append(body)
        if self.has_plate:
            up = self.centres[-1, 1] + self.radius
            origin = np.array([0.0, up])
            bodies.append(Body(PLATE, self.plate.mesh, young, poisson, origin=origin))
        return bodies

    def joints(self, friction: float) -> list[Joint]:
        """Joints with the ground, of wires with each other, and with the plate."""
        joints = []
        for wire in range(len(self.centres)):
            if self.packing.row_of_wires[wire] == 0:
                joints.append(self._joint(f"ground {wire + 1}", wire, DOWN, friction))
            for direction, other in self.packing.neighbours[wire].items():
                # The lower or left one of both is below.
                if other < wire:
                    name = f"{other + 1} to {wire + 1}"
                    joints.append(self._joint(name, wire, direction, friction, other))
        if self.has_plate:
            for number, wire in enumerate(self.highest):
                joints.append(self._under_plate(number, wire, friction))
        return joints

    def contact_of(self, joint: Joint) -> tuple[float, float]:
        """Radius and modulus of a contact in Hertz's formula, over those of a wire."""
        if joint.below is None:
            return 1.0, 1.0
        if joint.above == len(self.centres):
            return 1.0, 0.5
        return 0.5, 0.5

    def _joint(
        self,
        name: str,
        wire: int,
        direction: int,
        friction: float,
        other: int | None = None,
    ) -> Joint:
        """Joint of a wire with another one, or the ground, in a direction."""
        nodes = self.chain(wire, direction)
        below = None
        rounds = 1
        if other is not None:
            below = self.chain(other, direction + TURNS // 2)[::-1]
            rounds = 2
        return Joint(
            name,
            wire,
            nodes,
            other,
            below,
            normals=np.tile(-_unit(direction), (len(nodes), 1)),
            gap=rounds * self._rise(wire, direction),
            friction=friction,
        )

    def _under_plate(self, number: int, wire: int, friction: float) -> Joint:
        """Joint of the plate, which is above, and one of the highest wires."""
        nodes = self.plate.zones[number]
        return Joint(
            f"{PLATE} {wire + 1}",
            len(self.centres),
            nodes,
            wire,
            self.chain(wire, UP)[::-1],
            normals=np.tile(_unit(UP), (len(nodes), 1)),
            gap=self._rise(wire, UP)[::-1],
            friction=friction,
        )

    def _rise(self, wire: int, direction: int) -> Array:
        """Distance of the nodes of a wire's chain from its tangent, (n_nodes,), m."""
        disc, turn = self._placed[wire]
        x, y = disc.mesh.nodes[self.chain(wire, direction)].T
        # Middles of edges represent points of the circle.
        angles = np.arctan2(y, x) - (direction - turn) * TURN
        return np.asarray(self.radius * (1.0 - np.cos(angles)))

    def band(self, bodies: Sequence[Body], force: Array) -> Iterator[Load]:
        """Loads of a force towards the middle, (n_instants,), N, on each outer wire."""
        for wire in range(len(self.centres)):
            direction = self.packing.outward(wire)
            if direction is not None:
                disc, turn = self._placed[wire]
                chain = disc.facing((direction - turn) % TURNS)
                # The chord of 60 degrees is as long as the radius.
                pressure = force / self.radius
                name = f"band on {wire + 1}"
                yield Load.of_pressure(name, wire, bodies[wire], chain, pressure)

    def pressing(self, bodies: Sequence[Body], force: Array) -> Load:
        """Load of a force downwards on the plate, (n_instants,), N."""
        top = self.plate.top
        pressure = force / float(self.plate.mesh.shares(top).sum())
        return Load.of_pressure(
            "plate along y", len(self.centres), bodies[-1], top, pressure
        )

    def moved(self, displacement: Array) -> Held:
        """Holds of the plate's ends: moved along it, (n_instants,), m, and level."""
        nodes = np.concatenate(self.plate.ends)
        return Held("plate along x", len(self.centres), nodes, 0, displacement)


def _unit(direction: int) -> Array:
    """Unit vector in a direction in turns, shape (2,)."""
    return np.array([np.cos(direction * TURN), np.sin(direction * TURN)])


@lru_cache(1000)
def _first_order(contacts: Pattern) -> tuple[Pattern, int]:
    """Contacts in the turned axes in which they come first, and the turn.

    Wires that are turned copies of each other share the first of all orders.
    """
    turned = [_turned(contacts, turn) for turn in range(TURNS)]
    pattern = min(turned, key=str)
    return pattern, turned.index(pattern)


def _turned(contacts: Pattern, turn: int) -> Pattern:
    """Contacts in axes that are turned, in ascending order of direction."""
    turned = [((each - turn) % TURNS, zone) for each, zone in contacts]
    return tuple(sorted(turned, key=lambda contact: contact[0]))
