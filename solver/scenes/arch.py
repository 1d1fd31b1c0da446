"""An arch of voussoirs that only touch, on abutments that may move."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.plane.body import Load
from solver.discrete.plane.makers.voussoirs import FILL, LIVE, RIGHT, Arch, Ring
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.structure import Act
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.arch import VoussoirArch
from solver.scenes.plane import RectangleSettings, ShapedSettings
from solver.settings.definitions import BODY, LOAD, redefined
from solver.settings.load_paths import LATER, PRESETS, Preset
from solver.settings.scene import Icon

ROUND = 180.0
"""Angle of a semicircle, degrees."""
SHOWN = 9
"""Number of arrows of a fill."""
HINGED = 300.0
"""Movement of an abutment, over the radius and the strain of the weight, from which on
the thrust is the least."""
ALIKE = 1e-6
"""Largest relative difference of the thrusts with and without slip that are the same.
"""
DOWN = 0.0, -1.0
"""Direction of a load that weighs."""
PLACES: dict[str, Preset] = {"passes": LATER, **PRESETS}
"""Paths of the place of a load over time."""
MOVES: dict[str, Preset] = {**PRESETS, "later": LATER}
"""Paths of an abutment over time."""


class ArchSettings(ShapedSettings):
    """Settings of the arch; by default an abutment moves outwards, then inwards."""

    scene = "arch"
    title = "Arch of voussoirs"
    source = "J. Heyman, The Stone Skeleton, Int. J. Solids Struct. 2, 1966"
    icon = Icon(
        ground="M2 29H12M36 29H46",
        body="M5 26A19 19 0 0 1 10 13L16 17A12 12 0 0 0 12 26ZM11 12A19 19 0 0 1 23 "
        "7V14A12 12 0 0 0 17 16ZM25 7A19 19 0 0 1 37 12L31 16A12 12 0 0 0 25 14ZM38 "
        "13A19 19 0 0 1 43 26H36A12 12 0 0 0 32 17Z",
        load="M41 29H47M45 27L47 29L45 31",
    )
    CHIEF = ("abutment_load", "displacement", "live", "place", "thickness", "span")
    ALSO_CHIEF = ("centres", "friction", "voussoirs", "multiscale")
    GROWS = ("voussoirs",)
    SMALL: ClassVar = {"voussoirs": 7, "elements": 2, "instants": 13}

    abutment = LOAD.choice(
        "apart",
        ["apart", "down"],
        "How the right abutment moves. apart: outwards, or inwards where the value is "
        "negative. down: it settles.",
        title="The right abutment moves",
    )
    displacement, abutment_load = shared.sized_path(
        "abutment_load",
        "movement of the abutment",
        "m",
        5e-5,
        (-1e3, 1e3),
        (-2e-4, 2e-4),
        "Largest displacement of the right abutment.",
        "delayed",
        MOVES,
        places=(f"{RIGHT} x", f"{RIGHT} y"),
    )
    live, live_load = shared.sized_path(
        "live_load",
        "load on the back",
        "N",
        0.0,
        (0.0, 1e15),
        (0.0, 1e4),
        "Largest load on the back of the arch, downwards.",
        "hold",
        places=("top load",),
    )
    place = LOAD.quantity(
        1.0,
        (0.0, 1.0),
        (0.0, 1.0),
        "Place of the load as a share of the arch from its left end: where its path "
        "ends or turns.",
        title="Place of the load",
        path="place_load",
        applies=lambda settings: settings.has_live,
    )
    place_load = LOAD.curve(
        "passes",
        PLACES,
        {"time": "s", "place": ""},
        "Place of the load over time: a preset, whose value is Place of the load, or "
        "points (s, share of the arch from its left end).",
        bounds=((-1e15, 1e15), (0.0, 1.0)),
        title="Path of the load's place",
        applies=lambda settings: settings.has_live,
    )
    fill = LOAD.quantity(
        0.0,
        (0.0, 1e12),
        (0.0, 3e4),
        "Weight per volume of a fill over the arch, which begins to act in the first "
        "quarter. It weighs on the stones below.",
        title="Unit weight of the fill",
        unit="N/m^3",
        places=("top fill",),
    )
    cover = LOAD.quantity(
        0.2,
        (0.0, 1e4),
        (0.0, 2.0),
        "Height of the fill above the crown.",
        title="Fill above the crown",
        unit="m",
        applies=lambda settings: settings.fill > 0.0,
    )
    unit_weight = shared.unit_weight(2e4, "the voussoirs")
    voussoirs = BODY.count(31, (2, 1000), (3, 61), "Number of voussoirs.")
    span = BODY.quantity(
        ROUND,
        (1.0, ROUND),
        (60.0, ROUND),
        "Angle of the arch about its centre; 180° is a semicircle. Of a pointed arch, "
        "twice the angle from upright to the joints on the abutments.",
        title="Angle of the arch",
        unit="°",
    )
    centres = BODY.quantity(
        0.0,
        (0.0, 10.0),
        (0.0, 2.0),
        "Distance between the centres of the left and the right half, over the clear "
        "width between the abutments. 0: a round arch; more: a pointed one; 1: an "
        "equilateral one, of 180°.",
        title="Centres apart over clear width",
    )
    length = shared.size(
        1.0, (0.5, 10.0), "Mean radius R", "Radius of the middle of the ring.", BODY
    )
    thickness = BODY.quantity(
        0.15,
        (0.001, 1.0),
        (0.05, 0.4),
        "Thickness of the ring over its mean radius.",
        title="Thickness over radius t/R",
    )
    friction = redefined(ShapedSettings.param["friction"], 0.6)
    plane = redefined(ShapedSettings.param["plane"], "stress")
    young = redefined(ShapedSettings.param["young"], 1e10)
    poisson = redefined(ShapedSettings.param["poisson"], 0.2)
    elements = redefined(
        RectangleSettings.param["elements"],
        2,
        (1, 16),
        doc="Number of elements across the ring; along it they are about as long.",
        title="Elements across",
    )
    substructures = redefined(
        ShapedSettings.param["substructures"],
        1,
        doc="Number of pieces (substructures) of each stone.",
        title="Substructures of a stone",
    )

    @property
    def has_live(self) -> bool:
        """Check whether a load acts on the back."""
        return self.is_active("live_load")

    @property
    def n_bodies(self) -> int:
        """Number of voussoirs and abutments."""
        return int(self.voussoirs) + 2

    @cached_property
    def ring(self) -> Ring:
        """Voussoirs and abutments as shapes."""
        return Ring(
            voussoirs=self.voussoirs,
            span=float(np.radians(self.span)),
            radius=self.length,
            thickness=self.thickness * self.length,
            elements=self.elements,
            offset=self.statics.offset * self.length,
        )

    @property
    def n_nodes(self) -> int:
        """Number of nodes of all bodies."""
        across = 2 * self.elements + 1
        return int(across * (self.voussoirs * (2 * self.ring.along + 1) + 2 * across))

    @property
    def n_interfaces(self) -> int:
        """Number of joints."""
        return int(self.voussoirs) + 1

    @property
    def n_jumps(self) -> int:
        """Number of components of all contacts."""
        return int(2 * self.n_interfaces * (2 * self.elements + 1))

    def structure(self) -> Arch:
        """Make the arch; one metre thick."""
        ring = self.ring
        loads = list[Load]()
        if self.fill:
            loads += ring.loads(FILL, self._filled)
        if self.has_live:
            loads += ring.loads(LIVE, self._passing)
        path = self.path("abutment_load")
        settles = self.abutment == "down"
        moved = np.zeros((2, len(path)))
        if settles:
            moved[1] = -path
        else:
            moved[0] = path
        return Arch(
            bodies=ring.bodies(
                self.young,
                self.poisson,
                self.weight(self.unit_weight),
                self.substructures,
            ),
            joints=ring.joints(self.friction),
            held=ring.abutments(moved),
            loads=loads,
            instants=self.times(),
            duration=self.duration,
            state=self.plane,
            friction_law=self.law,
            macro_degree=self.macro_degree,
            settles=settles,
            above=tuple(self._above()),
        )

    @property
    def _filled(self) -> Array:
        """Weight of the fill on the back, (voussoirs, n_nodes, n_instants), N."""
        columns = self.ring.under_fill(self.ring.crown + self.cover)
        return np.multiply.outer(self.fill * columns, self.hold)

    @property
    def _passing(self) -> Array:
        """Load on the back, (voussoirs, n_nodes, n_instants), N."""
        shares = self.ring.under_load(self.path("place_load"))
        return np.asarray(self.path("live_load") * shares)

    def _above(self) -> Iterator[Act]:
        """Arrows of fill and load on the back, at positions in m."""
        ring = self.ring
        if self.fill:
            backs = ring.backs.reshape(-1, 2)
            shown = np.linspace(0, len(backs) - 1, SHOWN).round().astype(np.intp)
            heights = ring.crown + self.cover - backs[shown, 1]
            pressures = np.multiply.outer(self.fill * heights, self.hold)
            yield Act("top fill", "p", backs[shown], DOWN, pressures, "Pa")
        if self.has_live:
            backs = ring.backs.reshape(-1, 2)
            shares = ring.under_load(self.path("place_load")).reshape(len(backs), -1)
            places = np.einsum("nt,na->at", shares, backs)
            force = self.path("live_load")
            yield Act("top load", "F", places[None], DOWN, force, "N")

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterable[ExactCurve]:
        """Smallest thrust, after the abutment has moved outwards until hinges open."""
        least = self._least_thrust
        if least is None or self.has_live or self.abutment != "apart":
            return
        # Statics of rigid voussoirs knows friction by mu N alone.
        if not self.law.is_by_pressure_alone:
            return
        moved = self.path("abutment_load")
        strain = self.unit_weight * self.length / self.young
        is_apart = (self.hold == 1.0) & (moved >= HINGED * strain * self.length)
        if is_apart.any():
            across = np.where(is_apart, moved, moved[is_apart.argmax()])
            thrust = least * float(self.structure().downwards[-1])
            yield ExactCurve("loop", across, np.full_like(across, thrust))

    @property
    def _least_thrust(self) -> float | None:
        """Smallest thrust over the weight; None if limited by friction, or fallen."""
        thrusts = self.statics.thrusts()
        without_slip = replace(self.statics, friction=np.inf).thrusts()
        if thrusts is None or without_slip is None or not self.unit_weight:
            return None
        if not np.isclose(thrusts[0], without_slip[0], rtol=ALIKE, atol=0.0):
            return None
        return thrusts[0]

    @property
    def statics(self) -> VoussoirArch:
        """Statics of the arch as rigid voussoirs, without the load on its back."""
        fill = 0.0
        if self.unit_weight:
            fill = self.fill / self.unit_weight
        return VoussoirArch(
            voussoirs=self.voussoirs,
            thickness=self.thickness,
            span=float(np.radians(self.span)),
            friction=self.friction,
            fill=fill,
            cover=self.cover / self.length,
            centres=self.centres,
        )

    def sentence(self) -> str:
        """Describe the arch in a sentence."""
        kind = "A segment of an arch"
        if self.span == ROUND:
            kind = "A round arch"
        if self.centres:
            kind = "A pointed arch"
        filled = ""
        if self.fill:
            filled = ", filled above,"
        parts = []
        if self.has_live:
            parts.append("a load is on its back")
            if np.ptp(self.path("place_load")):
                parts = ["a load passes over its back"]
        path = self.path("abutment_load")
        if np.any(path) or not parts:
            words = "moved outwards", "moved inwards", "moved apart and together"
            if self.abutment == "down":
                words = "lowered", "raised", "lowered and raised"
            done = shared.acting(path, *words)
            parts.append(f"its right abutment is {done}")
        stones = f"{self.voussoirs} stones that only touch{filled}"
        return (
            f"{kind} of {stones} and {self.touch} each other stands on two abutments; "
            f"{shared.listed(parts)}."
        )
