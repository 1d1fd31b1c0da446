"""A band that is pulled over a rough curve: a rope on a drum, a tendon in a duct."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.plane.body import Held, Load
from solver.discrete.plane.makers.band import PULL, TAIL, Band, GuideCurve
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.laws import FrictionLaw
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.belt import Capstan
from solver.scenes.plane import PlaneSettings, RectangleSettings
from solver.settings.definitions import BODY, LOAD, redefined
from solver.settings.load_paths import HELD, PULLS, Preset, lines
from solver.settings.method import MethodSettings
from solver.settings.scene import Icon

STEEPEST = 30.0
"""Largest angle by which the guide may turn over an element, degrees."""
PLACES = 201
"""Points along the guide at which closed forms are drawn."""


PULLING: dict[str, Preset] = {
    "half back": Preset(
        "0 for the first quarter of the interval, rises evenly to the value in the "
        "next half, and falls back to half of it",
        lambda seed: (np.array([0.0, HELD, 0.75, 1.0]), np.array([0.0, 0.0, 1.0, 0.5])),
    ),
    "jack": lines(
        "rises evenly to the value in the first half of the interval, and stays there",
        *(0.0, 1.0, 1.0),
    ),
    **PULLS,
}
"""Paths of a pull over time."""
ANCHORING: dict[str, Preset] = {
    "anchored": lines(
        "0 for the first half of the interval, then rises evenly to the value, which "
        "it has at the end",
        *(0.0, 0.0, 1.0),
    ),
    **PULLS,
}
"""Paths of wedges that draw in over time."""


class BeltSettings(PlaneSettings):
    """Settings of the band; by default a rope on half a turn of a drum."""

    scene = "belt"
    title = "Belt on a drum, tendon in a duct"
    source = "L. Euler, 1769: tension over a drum; EN 1992-1-1, 5.10.5: tendons"
    icon = Icon(
        ground="M14 18A10 10 0 0 1 34 18A10 10 0 0 1 14 18Z",
        body="M10 29V18A14 14 0 0 1 38 18V29H36V18A12 12 0 0 0 12 18V29Z",
        load="M42 20V29M40 27L42 29L44 27",
    )
    CHIEF = ("pull_load", "pull", "displacement", "draw_in", "tail_force", "wrap")
    ALSO_CHIEF = ("friction", "substructures", "multiscale")
    GROWS = ("elements", "substructures")
    # Up to 250 elements a status step ends a search from zero about as soon as a start
    # is found: of 40, 250, 500 and 1000 after 0.09, 0.19, 1.1 and 4.9 s, and from a
    # nested start after 0.23, 0.39, 0.29 and 1.6 s (measured).
    METHODS: ClassVar = {
        **PlaneSettings.METHODS,
        "fast": {**PlaneSettings.METHODS["fast"], "start": "zero"},
    }
    SMALL: ClassVar = {"elements": 20, "instants": 13, "substructures": 4}

    guide = BODY.choice(
        "drum",
        ["drum", "duct"],
        "What the band lies on. drum: a round drum of a radius. duct: a curve of a "
        "length, as that of a tendon in concrete.",
    )
    wrap = BODY.quantity(
        180.0,
        (0.01, 36_000.0),
        (10.0, 1080.0),
        "Angle by which the guide turns, 360° for each turn on a drum.",
        title="Angle of the guide",
        unit="°",
    )
    drum_radius = BODY.quantity(
        0.1,
        (1e-6, 1e4),
        (0.01, 1.0),
        "Radius of the drum.",
        title="Radius R",
        unit="m",
        applies=lambda settings: not settings.is_duct,
    )
    length = BODY.quantity(
        40.0,
        (1e-6, 1e6),
        (5.0, 200.0),
        "Length of the duct.",
        title="Length of the duct",
        unit="m",
        applies=lambda settings: settings.is_duct,
    )
    wobble = BODY.quantity(
        0.0075,
        (0.0, 1e3),
        (0.0, 0.02),
        "Unintended angle of a duct per length, k of EN 1992-1-1: 0.005 to 0.01 rad a "
        "metre. It presses as the curve does, and is drawn as a part of it.",
        title="Unintended angle k",
        unit="rad/m",
        applies=lambda settings: settings.is_duct,
    )
    driven = LOAD.choice(
        "pulled",
        ["pulled", "moved", "jacked"],
        "What drives the last end. pulled: a force. moved: a displacement. jacked: the "
        "displacement that the force of a jack makes under Coulomb's friction, from "
        "which its wedges then draw in.",
        title="The pulled end is",
    )
    pull = LOAD.quantity(
        1400.0,
        (0.0, 1e15),
        (0.0, 5000.0),
        "Largest force at the pulled end, beyond that of the tail. Over a drum it is "
        "what the drum carries.",
        title="Pull above the tail force",
        unit="N",
        applies=lambda settings: settings.driven != "moved",
        path="pull_load",
        places=(PULL,),
    )
    displacement = LOAD.quantity(
        5e-4,
        (-1e6, 1e6),
        (0.0, 5e-3),
        "Largest displacement of the pulled end.",
        unit="m",
        applies=lambda settings: settings.driven == "moved",
        path="pull_load",
        places=(f"{PULL} x", f"{PULL} y"),
    )
    pull_load = LOAD.curve(
        "half back",
        PULLING,
        {"time": "s", "value": "N or m"},
        "Pull or displacement over time: a preset of the largest value, or points (s, "
        "N or m).",
        title="Path of the pull",
    )
    draw_in, draw_in_load = shared.sized_path(
        "draw_in_load",
        "draw-in of the wedges",
        "m",
        0.006,
        (0.0, 1e6),
        (0.0, 0.02),
        "Length by which the wedges of an anchor draw in.",
        "anchored",
        ANCHORING,
        applies=lambda settings: settings.driven == "jacked",
    )
    tail = LOAD.choice(
        "pulled",
        ["pulled", "held", "alike"],
        "The other end. pulled: by a force. held: it does not move. alike: as the "
        "pulled end, as of a tendon that is jacked from both ends.",
        title="The other end is",
    )
    tail_force, tail_load = shared.sized_path(
        "tail_load",
        "tail force",
        "N",
        1000.0,
        (0.0, 1e15),
        (0.0, 2000.0),
        "Force at the other end.",
        "hold",
        PULLS,
        applies=lambda settings: settings.tail == "pulled",
        places=(TAIL,),
    )
    friction_profile = redefined(
        PlaneSettings.param["friction_profile"], "uniform", applies=lambda _: False
    )
    plane = redefined(
        PlaneSettings.param["plane"], "stress", applies=lambda settings: False
    )
    poisson = redefined(
        PlaneSettings.param["poisson"], 0.0, applies=lambda settings: False
    )
    young = redefined(PlaneSettings.param["young"], 5e9)
    section = shared.section("Area of the cross-section.", BODY)
    section = redefined(section, 1e-4, (1e-6, 1e-2))
    instants = redefined(PlaneSettings.param["instants"], 41)
    elements = redefined(
        RectangleSettings.param["elements"],
        40,
        (10, 400),
        doc="Number of elements on the guide, equal in length.",
        title="Elements",
    )
    substructures = redefined(RectangleSettings.param["substructures"], 4)
    start = redefined(
        MethodSettings.param["start"],
        "zero",
        doc="zero: start from nothing, or where the band has slid to. nested: start "
        "from the solution on half the elements, which the incremental solver finds; "
        "the run time includes that. It pays from some 400 elements on.",
    )

    @property
    def is_duct(self) -> bool:
        """Check whether the guide is the duct of a tendon."""
        return bool(self.guide == "duct")

    @property
    def angle(self) -> float:
        """Angle by which the guide turns, unintended ones included, rad."""
        angle = float(np.radians(self.wrap))
        if self.is_duct:
            angle += self.wobble * self.length
        return angle

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`, N/m^2 for a metre of width."""
        return float(self.young * self.section / self.curve.length**2)

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return int(self.elements) + 3

    @cached_property
    def curve(self) -> GuideCurve:
        """The guide: the pulled end of a drum is level, a duct lies evenly."""
        radius = self.drum_radius
        turned = 0.0
        if self.is_duct:
            radius = self.length / self.angle
            turned = -0.5 * self.angle
        span = self.angle * radius / self.elements
        return GuideCurve(self.angle, radius, self.elements, span, turned)

    @property
    def capstan(self) -> Capstan:
        """Closed forms of the band."""
        return Capstan(
            friction=self.friction,
            angle=self.angle,
            length=self.curve.length,
            stiffness=self.young * self.section,
            span=self.curve.span,
        )

    @property
    def tail_tension(self) -> Array | None:
        """Tension of the other end over time, (n_instants,), N; None if it is held.

        Where the other end does as the pulled one, that of a pulled end.
        """
        if self.tail == "pulled":
            return self.path("tail_load")
        if self.tail == "alike":
            return self.path("pull_load")
        return None

    @property
    def tension(self) -> Array:
        """Tension of a pulled end, or of a jack before wedges draw in, (n_instants,).

        In N; of an end that is moved it is unknown.
        """
        pull = self.path("pull_load")
        if self.tail == "pulled":
            return pull + self.path("tail_load")
        return pull

    @property
    def moved(self) -> Array:
        """Displacement of an end that is moved or jacked, shape (n_instants,), m."""
        if self.driven == "moved":
            return self.path("pull_load")
        jacked = self.capstan.displacement(self.tension, self.tail_tension)
        return np.asarray(jacked - self.path("draw_in_load"))

    def check_together(self) -> None:
        """Refuse elements over which the guide turns too far, and lost equilibrium."""
        fewest = int(np.ceil(np.degrees(self.angle) / STEEPEST))
        if self.elements < fewest:
            raise self.refusal(
                "elements",
                f"at least {fewest}, so that the guide turns by at most {STEEPEST:g}° "
                "over each",
                "raise it, or take fewer turns",
            )
        super().check_together()
        self._check_equilibrium()

    def _check_equilibrium(self) -> None:
        """Refuse forces at both ends whose ratio exceeds that of friction."""
        pull = self.tension
        tail = self.tail_tension
        if self.driven == "moved" or tail is None or self.law.cohesion:
            return
        strongest = self.friction * self.law.largest_factor
        ratio = replace(self.capstan, friction=strongest).ratio
        largest = ratio * (1.0 + shared.SLACK)
        if np.all(pull <= largest * tail) and np.all(tail <= largest * pull):
            return
        raise self.refusal(
            self.size_or_table("pull_load"),
            f"tensions of both ends of which none is more than {ratio:.6g} times the "
            "other, at any instant: more no friction carries",
            "lower it, raise wrap, tail_force or friction, or move the end",
        )

    def structure(self) -> Band:
        """Make the band; its width is a metre."""
        return self._band(self.curve, self.substructures)

    def on_mesh_of(self, coarser: Self) -> Band:
        """Make the band on a coarser mesh, with the same spans beyond the guide."""
        guide = replace(self.curve, elements=coarser.elements)
        return self._band(guide, coarser.substructures)

    def _band(self, guide: GuideCurve, substructures: int) -> Band:
        """Make the band on a guide, in a number of substructures."""
        held = list[Held]()
        loads = list[Load]()
        if self.driven == "pulled":
            loads.append(guide.load(PULL, self.tension))
        else:
            held += guide.held(PULL, self.moved)
        if self.tail == "held":
            held += guide.held(TAIL, np.zeros_like(self.times()))
        elif self.tail == "alike" and self.driven != "pulled":
            held += guide.held(TAIL, self.moved)
        else:
            assert self.tail_tension is not None
            loads.append(guide.load(TAIL, self.tail_tension))
        return Band(
            bodies=[guide.body(self.young, self.section, substructures)],
            joints=[guide.contact(self.friction)],
            held=held,
            loads=loads,
            instants=self.times(),
            duration=self.duration,
            friction_law=self.law,
            guide=guide,
        )

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterable[ExactCurve]:
        """Tension, pressure and friction along the guide, and the loop of the end."""
        if self.law != FrictionLaw():
            return
        pull = self.tension
        tail = self.tail_tension
        if self.driven == "pulled":
            yield ExactCurve("loop", self.capstan.displacement(pull, tail), pull)
        elif self.tail == "pulled":
            # How far a band slides that is pulled at the tail, no closed form says.
            if solution is None:
                return
            pull = self.structure().tensions(problem, solution)[-1]
        else:
            alike = self.tail == "alike"
            pull = self.capstan.pulled_by(self.moved, both_ends=alike)
            tail = pull if alike else None
            yield ExactCurve("loop", self.moved, pull)
        yield from self._along(pull, tail)

    def _along(self, pull: Array, tail: Array | None) -> Iterator[ExactCurve]:
        """Curves along the guide under tensions of the ends, (n_instants,), N."""
        places = np.linspace(0.0, self.curve.length, PLACES)
        angles = places / self.curve.radius
        tension = self.capstan.tensions(pull, tail, angles)
        yield ExactCurve("axial force", places, tension)
        yield ExactCurve("pressure", places, tension / self.curve.radius)
        yield ExactCurve("friction", places, -np.gradient(tension, places, axis=0))

    def sentence(self) -> str:
        """Describe the band in a sentence."""
        where = "lies in a duct"
        band = "A tendon"
        if not self.is_duct:
            band = "A rope"
            turns = self.wrap / 360.0
            where = f"lies {turns:.3g} turns round a drum"
            if turns == 1.0:
                where = "lies once round a drum"
        path = self.path("pull_load")
        is_tail_alone = self.is_active("tail_load") and not np.any(path)
        if (self.driven, self.tail) == ("pulled", "pulled") and is_tail_alone:
            return f"{band} {where}; both ends are pulled alike."
        done = shared.acting(
            path, "pulled", "slackened", "pulled to and fro", "{}, and let go"
        )
        if self.driven == "moved":
            done = shared.acting(path, "moved outwards", "moved inwards")
        if self.driven == "jacked":
            done = "pulled by a jack"
            if np.any(self.path("draw_in_load")):
                done = f"{done}, whose wedges draw in"
        other = {
            "pulled": "a force pulls at the other",
            "held": "the other one is held",
            "alike": "so is the other",
        }[self.tail]
        return f"{band} {where}; one end is {done}, and {other}."
