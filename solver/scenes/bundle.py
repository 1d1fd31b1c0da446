"""Round wires that touch, in a hexagon or a heap, under a plate that moves."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.makers.bundle import Wires
from solver.discrete.plane.makers.wires import Packing, Zone
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.laws import FrictionLaw
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.elastic_bodies import HalfPlane
from solver.refusal import plain
from solver.scenes.exact import contact_modulus, hertz, is_coupled
from solver.scenes.plane import RectangleSettings, ShapedSettings
from solver.settings.definitions import BODY, LOAD, redefined
from solver.settings.scene import Icon

WIDER = 1.6
"""Half of a zone of contact, over that of Hertz's contact under the load's share of
each wire: forces differ from wire to wire."""
NARROWEST = 0.0005
WIDEST = 0.12
"""Smallest and largest half of a zone, over the radius of a wire. In wider ones a
half-plane is no picture of a wire."""
NODES = 15
"""Number of nodes of a mesh about a contact, over its elements, nearly."""


class BundleSettings(ShapedSettings):
    """Settings of the bundle; by default wires are pressed and moved to and fro."""

    scene = "bundle"
    title = "Bundle of wires"
    source = "K. L. Johnson, Contact Mechanics, 1985: contact of cylinders"
    icon = Icon(
        ground="M3 30H45",
        body="M13 25A4 4 0 1 0 21 25A4 4 0 1 0 13 25ZM23 25A4 4 0 1 0 31 25A4 4 0 1 0 "
        "23 25ZM8 17A4 4 0 1 0 16 17A4 4 0 1 0 8 17ZM18 17A4 4 0 1 0 26 17A4 4 0 1 0 "
        "18 17ZM28 17A4 4 0 1 0 36 17A4 4 0 1 0 28 17ZM13 9A4 4 0 1 0 21 9A4 4 0 1 0 "
        "13 9ZM23 9A4 4 0 1 0 31 9A4 4 0 1 0 23 9Z",
        load="M14 3H34M30 0L34 3L30 6",
    )
    CHIEF = ("shear_load", "displacement", "press", "rings", "arrangement")
    ALSO_CHIEF = ("friction", "multiscale", "k_scale")
    GROWS = ("rings",)
    PARTS: ClassVar = {}
    SMALL: ClassVar = {"rings": 1, "elements": 2, "instants": 13}

    arrangement = BODY.choice(
        "hexagon",
        ["hexagon", "heap"],
        "hexagon: rings of wires round one in the middle, held together by a band. "
        "heap: rows on the ground, each with one wire less than the row below; three "
        "rows or more need much friction to hold.",
        title="Wires lie in a",
    )
    rings = BODY.count(
        2,
        (1, 6),
        (1, 3),
        "Rings round the wire in the middle: 1, 2 and 3 make 7, 19 and 37 wires. Rows "
        "of a heap: 1, 2 and 3 make 1, 3 and 6 wires.",
        title="Rings or rows of wires",
    )
    length = shared.size(
        2.5e-3, (5e-4, 0.2), "Radius of a wire r", "Radius of a wire.", BODY
    )
    press, press_load = shared.sized_path(
        "press_load",
        "force of the plate",
        "N",
        1e5,
        (0.0, 1e15),
        (0.0, 3e5),
        "Largest force by which a plate presses on the highest wires, for a metre of "
        "their length. 0: there is no plate.",
        "hold",
        places=("plate along y",),
    )
    displacement, shear_load = shared.sized_path(
        "shear_load",
        "displacement of the plate",
        "m",
        3e-6,
        (-1e3, 1e3),
        (-1e-5, 1e-5),
        "Largest displacement of the plate along it.",
        "delayed",
        applies=lambda settings: settings.has_plate,
        places=("plate along x",),
    )
    band = LOAD.quantity(
        1.0,
        (0.0, 1e6),
        (0.0, 3.0),
        "Force towards the middle by which a band presses each outer wire between the "
        "lowest and the highest row, over the force of the plate on one wire.",
        title="Force of the band",
        applies=lambda settings: (
            settings.arrangement == "hexagon" and settings.has_plate
        ),
    )
    unit_weight = shared.unit_weight(0.0, "the wires")
    friction = redefined(ShapedSettings.param["friction"], 0.3)
    young = redefined(ShapedSettings.param["young"], 2e11)
    elements = redefined(
        RectangleSettings.param["elements"],
        8,
        (4, 16),
        doc="Number of elements across a zone of contact, which is 1.6 times as wide "
        "as a contact under an even share of the load.",
        title="Elements across a contact",
    )
    substructures = redefined(
        ShapedSettings.param["substructures"], 1, applies=lambda _: False
    )

    @property
    def has_plate(self) -> bool:
        """Check whether a plate presses on the highest wires."""
        return self.is_active("press_load")

    @cached_property
    def packing(self) -> Packing:
        """Arrangement of the wires."""
        if self.arrangement == "heap":
            return Packing.heap(self.rings)
        return Packing.hexagon(self.rings)

    @property
    def n_wires(self) -> int:
        """Number of wires."""
        return sum(self.packing.rows)

    @property
    def n_bodies(self) -> int:
        """Number of wires, and the plate."""
        return self.n_wires + self.has_plate

    @property
    def n_interfaces(self) -> int:
        """Number of contacts."""
        rows = self.packing.rows
        between = sum(len(wires) for wires in self.packing.neighbours) // 2
        under_plate = 0
        if self.has_plate:
            under_plate = rows[-1]
        return between + rows[0] + under_plate

    @property
    def n_nodes(self) -> int:
        """Estimated number of nodes of all bodies: most are near contacts."""
        zones = 2 * self.n_interfaces + self.n_wires
        return zones * NODES * int(self.elements)

    @property
    def n_jumps(self) -> int:
        """Number of components of all contacts."""
        return 2 * self.n_interfaces * (2 * int(self.elements) + 1)

    @property
    def modulus(self) -> float:
        """Modulus of contact of a wire pressed along a line, Pa."""
        return contact_modulus(self.young, self.poisson, self.plane)

    def hertz(self, force: float) -> HalfPlane:
        """Contact of two wires under a force, N for a metre."""
        return HalfPlane(force, 0.5 * self.length, 0.5 * self.modulus)

    @property
    def _pressed(self) -> Array:
        """Force of the plate on one wire, (n_instants,), N for a metre."""
        return self.path("press_load") / self.packing.rows[-1]

    @property
    def _band(self) -> float:
        """Force of the band over that of the plate on one wire; 0 in a heap."""
        if not self.applies("band"):
            return 0.0
        return float(self.band)

    @property
    def share(self) -> float:
        """Force on a wire if all of a row carry equal forces, N per metre."""
        weight = self.unit_weight * np.pi * self.length**2 * self.n_wires
        pressed = float(np.abs(self._pressed).max())
        return max(1.0, self._band) * pressed + weight / self.packing.rows[0]

    @cached_property
    def zone(self) -> Zone:
        """Zone of contact of two wires."""
        reach = max(WIDER * self.hertz(self.share).half_width, NARROWEST * self.length)
        return Zone(reach, self.elements)

    @cached_property
    def wires(self) -> Wires:
        """The wires, and how they touch."""
        return Wires(self.packing, self.length, self.zone, self.has_plate)

    def check_together(self) -> None:
        """Refuse contacts as wide as wires."""
        super().check_together()
        if self.zone.half_width > WIDEST * self.length:
            share = self.zone.half_width / WIDER / self.length
            raise self.refusal(
                "young",
                "wires whose contacts are narrow beside their radius",
                f"half of a contact is {share:.2g} of the radius, and at most "
                f"{plain(WIDEST / WIDER)} is modelled: raise it, or lower press",
            )

    @cached_property
    def bodies(self) -> Bodies:
        """The wires and the plate; one metre long."""
        bodies = self.wires.bodies(
            self.young, self.poisson, self.weight(self.unit_weight)
        )
        loads = []
        if self._band:
            loads = list(self.wires.band(bodies, self._band * self._pressed))
        held = []
        shown = None
        if self.has_plate:
            loads.append(self.wires.pressing(bodies, self.path("press_load")))
            held.append(self.wires.moved(self.path("shear_load")))
            shown = held[0].name
        return Bodies(
            bodies=bodies,
            joints=self.wires.joints(self.friction),
            held=held,
            loads=loads,
            instants=self.times(),
            duration=self.duration,
            state=self.plane,
            friction_law=self.law,
            macro_degree=self.macro_degree,
            shown=shown,
        )

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterator[ExactCurve]:
        """Pressure of Hertz at every contact, for the force of the solution there.

        Not on the rigid ground under friction, which keeps a wire from widening.
        """
        if solution is None or self.law != FrictionLaw():
            return
        for joint in self.bodies.joints:
            force = solution.contact(joint.name).normal_force
            if force is None or not force.any():
                continue
            rounder, softer = self.wires.contact_of(joint)
            is_on_ground = joint.below is None
            if is_on_ground and self.friction and is_coupled(self.poisson, self.plane):
                continue
            positions = problem.contacts[joint.name].positions
            sizes = rounder * self.length, softer * self.modulus
            pressure = hertz(positions, force, *sizes)
            yield ExactCurve("pressure", positions, pressure, interface=joint.name)

    def sentence(self) -> str:
        """Describe the bundle in a sentence."""
        lie = "in a heap on the ground"
        if self.arrangement == "hexagon":
            lie = "side by side on the ground"
            if self._band:
                lie = "side by side on the ground, held together by a band"
        done = ""
        if self.has_plate:
            path = self.path("shear_load")
            words = "moved to the right", "moved to the left", "moved to and fro"
            done = "; a plate presses on them"
            if np.any(path):
                done = f"{done}, and is {shared.acting(path, *words)}"
        if self.n_wires == 1:
            # A heap of a single row.
            done = done.replace("them", "it")
            return f"One round wire lies on the ground{done}."
        wires = f"{self.n_wires} round wires lie {lie}"
        return f"{wires}, and {self.touch} each other{done}."
