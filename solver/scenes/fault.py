"""A fault with an inflowing fluid that reduces friction and drives a front of slip.

The strength of the fault is mu (sigma - p), with p the pressure of the fluid, which
spreads along it by diffusion (MATHEMATICS.md, 17).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete import discretise
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.probes import LoopFields, Probe
from solver.discrete.problem import Problem
from solver.discrete.structure import Act, Axes, Description, Hold, Loop
from solver.laws import FrictionLaw
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.fluid_driven_slip import fronts, spread, stress_ahead
from solver.refusal import plain
from solver.scenes.plane import RectangleSettings
from solver.settings.definitions import (
    BODY,
    CONTACT,
    LOAD,
    POSITIVE,
    properties_of,
    redefined,
)
from solver.settings.load_paths import INJECTIONS, instants_of
from solver.settings.profiles import Profile
from solver.settings.scene import Icon
from solver.settings.values import SettingError

PROFILES = {
    "uniform": Profile("1 all along", ((0.0, 1.0), (1.0, 1.0))),
    "rising": Profile(
        "rises evenly from 1 at the well to 2 at the end", ((0.0, 1.0), (1.0, 2.0))
    ),
    "barrier": Profile(
        "1 up to 0.15 times the length, and 5 from 0.16 times the length on",
        ((0.0, 1.0), (0.15, 1.0), (0.16, 5.0), (1.0, 5.0)),
    ),
}
"""Factors over shares of the length."""
FINE = 4000
"""Intervals along the fault on each of which the closed form's strength is linear."""
INFINITE = 0.3
"""Largest length of slip, over the sides of the body, for which the closed form of an
infinite body holds: to 2 % (tests/scenes/test_a_fluid_drives_slip.py)."""
MOST_SPREAD = 300_000_000
"""Largest number of nodes times instants times points of a path: the pressure is a sum
over the points."""
OF_BOTH_SIDES = {
    "tangential_stiffness": 0.5,
    "contact_stiffness": 0.5,
    "strength": 2.0,
    "slip_length": 2.0,
}
"""Settings that are over the slip between both sides of the fault, with the factor on
values of the first format, which were over the slip of one side."""
ROUND = 1e-9
"""Largest error of the strength by rounding, as a share."""


@dataclass(frozen=True, eq=False)
class Fault:
    """A fault as a structure; by symmetry one quarter is modelled.

    The quarter is the body above the fault, to the right of its middle. The part below
    is its image by half a turn, so that the pressure on the fault never changes and its
    strength is known. The part to the left is the other image, which has the same
    displacement along the fault and the opposite one across. The fault slips by twice
    the displacement of the quarter along it: slip, and a law over it, are the fault's
    (`Support.is_image`), while displacements are those of the quarter.

    Attributes
    ----------
    body
        The quarter; the strength of its support is already reduced by the fluid.
    stress
        Shear stress far away, Pa, for drawing.
    fluid
        Pressure of the fluid at the middle, (n_instants,), Pa, for drawing.
    """

    body: Stack
    stress: float
    fluid: Array

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        return ("Slip at the well", "m"), ("Friction force", "N")

    def loop(self, problem: Problem) -> Loop:
        """Friction along the quarter over the slip of the fault at the middle."""
        law = problem.contacts["support"]
        return Loop(
            *self.axes,
            Probe(problem.row_dofs[law.tangent.above[:1]], np.full(1, law.slip_ratio)),
            lambda fields: -fields.contact("support").tangential_force.sum(axis=0),
        )

    def description(self) -> Description:
        """Description for drawing."""
        body = self.body
        return Description(
            bodies=1,
            length=body.length,
            height=body.height,
            instants=body.instants,
            acts=tuple(self._acts()),
            holds=(Hold("image", "bottom"), Hold("rollers", "top")),
        )

    def _acts(self) -> Iterator[Act]:
        """Yield the arrows of loads."""
        along = (1.0, 0.0)
        stress = np.full_like(self.fluid, self.stress)
        yield Act("top x", "τ", np.array([[0.5, 1.0]]), along, stress, "Pa")
        yield Act("left x", "p", np.zeros((1, 2)), along, self.fluid, "Pa")


@discretise.register
def problem_of(fault: Fault) -> Problem:
    """Make the discrete problem of a fault, which is that of its quarter."""
    return discretise(fault.body)


class FaultSettings(RectangleSettings):
    """Settings of the fault; by default the fluid's pressure is constant in time."""

    scene = "fault"
    title = "Fault driven by a fluid"
    source = "R. C. Viesca, J. Fluid Mech. 928, A29, 2021"
    icon = Icon(
        ground="M4 25H44M30 29H18M21 27L18 29L21 31",
        body="M4 8H44V24H4Z",
        load="M18 4H30M27 2L30 4L27 6M4 31V26M1 28L4 25L7 28M6 22H14M11 20L14 22L11 24",
    )
    CHIEF = ("injection_load", "overpressure", "shear_stress")
    SMALL: ClassVar = {"elements": 16, "elements_up": 8, "instants": 13}
    opens = False
    loop_is_over_displacement = False

    overpressure, injection_load = shared.sized_path(
        "injection_load",
        "pressure of the fluid",
        "Pa",
        8e6,
        (0.0, 1e15),
        (0.0, 1e7),
        "Pressure p of the fluid where it is let in, above what was there before.",
        "steady",
        INJECTIONS,
        places=("left x",),
    )
    shear_stress = LOAD.quantity(
        3.6e6,
        (-1e15, 1e15),
        (0.0, 1e7),
        "Shear stress τ far from the fault, from the beginning.",
        title="Shear stress τ",
        unit="Pa",
        places=("top x",),
    )
    duration = redefined(
        RectangleSettings.param["duration"],
        86400.0,
        (3600.0, 2.6e6),
        doc="Length of the time interval. Friction does not feel the rate, but a fluid "
        "needs time: it spreads over sqrt(4 α t).",
    )
    normal_stress = CONTACT.quantity(
        1e7,
        (0.0, 1e15),
        (1e6, 1e8),
        "Pressure σ between both sides of the fault, less that of the fluid there "
        "before.",
        title="Normal stress σ",
        unit="Pa",
    )
    normal_profile = shared.profile("σ", "the fault", PROFILES, bounds=POSITIVE)
    diffusivity = CONTACT.quantity(
        0.1,
        (1e-15, 1e9),
        (1e-3, 10.0),
        "Hydraulic diffusivity α along the fault.",
        title="Diffusivity α",
        unit="m^2/s",
    )
    friction = redefined(RectangleSettings.param["friction"], 0.6)
    friction_profile = shared.profile("μ", "the fault", PROFILES, bounds=POSITIVE)
    tangential_stiffness = redefined(
        RectangleSettings.param["tangential_stiffness"],
        0.0,
        doc="Stiffness of the fault as a joint, in series with friction: shear stress "
        "over the slip between both of its sides. 0: rigid.",
    )
    contact_stiffness = redefined(
        RectangleSettings.param["contact_stiffness"],
        100.0,
        doc="Stiffness of that spring, shear stress over the slip between both sides "
        "of the fault, as a multiple of E / L.",
    )
    strength = redefined(
        RectangleSettings.param["strength"],
        "constant",
        doc="Factor on the largest friction force over the accumulated slip between "
        "both sides of the fault: a preset, or points (m, factor), the first (0, 1), "
        "such as a peak, softening and a residual; the last one stays.",
    )
    slip_length = redefined(
        RectangleSettings.param["slip_length"],
        1e-4,
        doc="Accumulated slip between both sides of the fault at which its friction is "
        "the last.",
    )
    length = shared.size(
        600.0,
        (10.0, 1e4),
        "Length",
        "Length of the body to the right of the well.",
        BODY,
    )
    height = shared.size(
        600.0, (10.0, 1e4), "Height", "Height of the body above the fault.", BODY
    )
    young = shared.young(BODY, 6e10, (1e9, 1e12))
    poisson = redefined(RectangleSettings.param["poisson"], 0.25)

    def changed_meanings(self) -> Mapping[str, str]:
        """Describe settings over slip: the slip of one side in the first format."""
        meanings = {}
        for name, factor in OF_BOTH_SIDES.items():
            value = getattr(self, name)
            if isinstance(value, str) or not self.has(name):
                continue
            unit = properties_of(self.definitions()[name]).unit
            remedy = "give slips twice as large"
            if isinstance(value, float):
                remedy = f"give {plain(factor * value)} {unit}".rstrip()
            meanings[name] = (
                "the file is of a version whose slip was that of one side of the "
                "fault; it is that between both sides now, for the run of then "
                f"{remedy}"
            )
        return meanings

    def fluid(self, place: Array) -> Array:
        """Pressure of the fluid along the fault, shape (n_positions, n_instants), Pa.

        `place` are positions along the fault, (n_places,), m.
        """
        times = self.times()
        if self.instants > 1:
            pressure = self.path("injection_load")
            return spread(place, times, pressure, self.diffusivity)
        # The fluid at a single instant depends on all of the time before.
        history = instants_of(self.duration, 2, self.knots("injection_load"), times)
        pressure = self.path_at("injection_load", history)
        fluid = spread(place, history, pressure, self.diffusivity)
        return fluid[:, np.searchsorted(history, times)]

    def pressing(self, place: Array) -> Array:
        """Normal stress along the fault without the fluid, shape (n_positions,), Pa.

        `place` are positions along the fault, (n_places,), m.
        """
        factors = shared.at_nodes(self, place, "normal_profile")
        return np.asarray(self.normal_stress * factors)

    def largest_friction(self, place: Array) -> Array:
        """Friction bound per area along the fault, shape (n_positions, n_instants), Pa.

        `place` are positions along the fault, (n_places,), m.
        """
        mu = self.friction * shared.at_nodes(self, place, "friction_profile")
        pressing = self.pressing(place)[:, None] - self.fluid(place)
        return np.asarray(mu[:, None] * pressing)

    def check_together(self) -> None:
        """Refuse a fluid that would open the fault, or whose pressure takes minutes."""
        super().check_together()
        n_points = len(self.knots("injection_load"))
        largest = MOST_SPREAD // (self.nodes[0] * self.n_instants)
        if n_points > largest:
            raise SettingError(
                "injection_load",
                f"a path of {n_points} points",
                f"at most {largest} points with {self.n_instants} instants",
                "give fewer points, or fewer elements along",
            )
        pressing = self.pressing(self.places)
        fluid = self.fluid(self.places)
        spare = pressing - fluid.max(axis=1)
        worst = int(spare.argmin())
        if spare[worst] < 0.0:
            raise self.refusal(
                self.size_or_table("injection_load"),
                f"at most the normal stress, {plain(float(pressing[worst]))} Pa",
                "it would open the fault: lower the pressure of the fluid, or press "
                "more",
            )

    @cached_property
    def bodies(self) -> Fault:
        """The quarter of the body; one metre thick.

        The displacement of its top is prescribed, as under the shear stress without
        slip; so there is equilibrium even where the whole fault slips.
        """
        modulus = 0.5 * self.young / (1.0 + self.poisson)
        strength = self.largest_friction(self.places)
        none = np.zeros(self.n_instants)
        level = SideComponent(True, none)
        free = SideComponent(False, none)
        moved = none + self.shear_stress / modulus * self.height
        body = replace(
            self.stack(),
            support=Support(
                np.zeros(len(strength)), self.friction, strength, is_image=True
            ),
            sides={
                "left": Side(free, level),
                "right": Side(free, SideComponent(False, none + self.shear_stress)),
                "top": Side(SideComponent(True, moved), level),
            },
        )
        return Fault(body, self.shear_stress, self.path("injection_load"))

    def sentence(self) -> str:
        """Describe the fault in a sentence."""
        path = self.path("injection_load")
        if not path.any():
            return "A fault is sheared; a quarter of it is seen."
        moves = shared.acting(path, "let in", "sucked out", back="{} and stopped")
        return (
            f"A fluid is {moves} at the left end of a sheared fault, and slip spreads; "
            "a quarter is seen."
        )

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterator[ExactCurve]:
        """Front of slip and friction of an infinite body, while slip only spreads.

        Slip only spreads where the strength falls with time everywhere, and grows with
        the distance from the well.
        """
        stress = self.shear_stress
        if np.any(np.diff(self.path("injection_load")) < 0.0):
            return
        place = np.linspace(0.0, self.length, FINE + 1)
        margin = self.largest_friction(place) - stress
        small = ROUND * float(np.abs(margin).max())
        falls_with_time = np.all(np.diff(margin, axis=1) <= small)
        grows_along = np.all(np.diff(margin, axis=0) >= -small)
        spreads = falls_with_time and grows_along
        if self.law != FrictionLaw() or not spreads or stress <= 0.0:
            return
        front = fronts(place, margin)
        if not front.any() or front.max() > INFINITE * min(self.length, self.height):
            return
        yield ExactCurve("front", front, self.times())
        nodes = problem.contacts["support"].positions
        friction = self._exact_friction(nodes, front, place, margin)
        yield ExactCurve("friction", nodes, -friction)

    def _exact_friction(
        self, nodes: Array, front: Array, place: Array, margin: Array
    ) -> Array:
        """Friction of the closed form at nodes, (n_nodes, n_instants), Pa.

        Parameters
        ----------
        nodes
            Positions of the nodes, (n_nodes,), m.
        front
            Position of the front of slip, (n_instants,), m; 0: nothing slips.
        place
            Positions at which the margin is given, (n_places,), m.
        margin
            Strength less the shear stress far away, (n_places, n_instants), Pa.
        """
        friction = np.full((len(nodes), self.n_instants), self.shear_stress)
        strength = self.largest_friction(nodes)
        for instant in np.flatnonzero(front):
            end = float(front[instant])
            ahead = nodes > front[instant]
            added = stress_ahead(nodes[ahead], place, margin[:, instant], end)
            friction[ahead, instant] += added
            friction[~ahead, instant] = strength[~ahead, instant]
        return friction
