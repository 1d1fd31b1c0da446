"""A block on a slope that rises and falls, with a spring uphill (MATHEMATICS.md, 9).

The block is drawn as it lies on the slope: x runs uphill, and its weight turns instead.
The spring pulls at the foot of the uphill side once it has slid down by the slack.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.discrete.plane.rectangles.rigid_stack import loss_of_equilibrium
from solver.discrete.plane.rectangles.sides import Spring, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.laws import FrictionLaw
from solver.laws.play import play
from solver.reference.closed_forms import ExactCurve
from solver.refusal import plain
from solver.scenes.plane import RectangleSettings
from solver.settings.definitions import BODY, CONTACT, LOAD, redefined
from solver.settings.load_paths import PULLS
from solver.settings.scene import Icon

SOFTEST = 0.5
"""Largest deformation of the block, by its weight's strain over its longer side, as a
share of the stretch of the spring, for which the force is that of a rigid block: to
some 2 % of the largest, at eight times as much to 20 % (measured)."""


class InclineSettings(RectangleSettings):
    """Settings of the block on a slope; by default the spring pulls it back."""

    scene = "incline"
    title = "Block on an inclined plane"
    source = "closed form: Coulomb, Théorie des machines simples, 1785"
    icon = Icon(
        ground="M3 29L45 10V29Z",
        body="M15 22L28 16L25 8L12 14Z",
        load="M27 12L30 13L30 8L35 11L35 6L40 9L46 6M20 15V26M17 23L20 26L23 23",
    )
    CHIEF = ("slope_load", "slope")
    SMALL: ClassVar = {"elements": 12, "elements_up": 6, "instants": 13}
    loop_is_over_displacement = False

    slope, slope_load = shared.sized_path(
        "slope_load",
        "slope",
        "°",
        40.0,
        (0.0, 89.0),
        (0.0, 60.0),
        "Largest angle of the slope. Up to tan θ = μ the block sticks; unless tan(θ/2) "
        "> μ, the spring cannot pull it back.",
        "triangle",
        PULLS,
        title="Slope θ",
    )
    weight = LOAD.quantity(
        1000.0,
        (0.0, 1e15),
        (0.0, 5000.0),
        "Weight W of the block, for a metre of thickness.",
        title="Weight W",
        unit="N",
        places=("body",),
    )
    slack = CONTACT.quantity(
        2e-4,
        (0.0, 1e6),
        (0.0, 1e-3),
        "How far the block may slide before the spring pulls.",
        unit="m",
    )
    spring = CONTACT.quantity(
        2e6,
        (1e-6, 1e18),
        (1e5, 1e8),
        "Stiffness of the spring, for a metre of thickness.",
        title="Spring stiffness",
        unit="N/m",
    )
    length = shared.size(
        0.1, (0.01, 1.0), "Length b", "Length of the block's base.", BODY
    )
    height = shared.size(
        0.05,
        (0.01, 1.0),
        "Height h",
        "Height of the block; it tips where tan θ > b/h.",
        BODY,
    )
    young = shared.young(BODY, 1e7, (1e6, 1e12))
    elements = redefined(RectangleSettings.param["elements"], 24)
    elements_up = redefined(RectangleSettings.param["elements_up"], 12)

    def check_together(self) -> None:
        """Refuse slopes on which nothing holds the block."""
        super().check_together()
        loss = loss_of_equilibrium(self.bodies)
        if loss is None:
            return
        instant, reason = loss
        angle = float(np.interp(instant, self.times(), self.path("slope_load")))
        raise self.refusal(
            self.size_or_table("slope_load"),
            "slopes on which the block stays in equilibrium",
            f"at {angle:.4g}°, from {plain(instant)} s on, {reason}: "
            "lower the slope, or take a longer base or a lower block",
        )

    @cached_property
    def bodies(self) -> Stack:
        """The block on its slope; one metre thick."""
        angle = np.radians(self.path("slope_load"))
        density = self.weight / (self.length * self.height)
        body_force = None
        if density:
            body_force = -density * np.stack([np.sin(angle), np.cos(angle)])
        return replace(
            self.stack(),
            support=Support(np.zeros(self.nodes[0]), self.friction_at_nodes()),
            body_force=body_force,
            spring=Spring(self.slack, self.spring),
            tilt=angle,
        )

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterator[ExactCurve]:
        """Force of the spring over the angle: weight along the slope less friction.

        Of a block that the spring hardly feels the deformation of: as the slope falls,
        a block that sticks and springs back loads it.
        """
        mu = self.friction_at_nodes()
        if not self.weight or self.law != FrictionLaw() or np.ptp(mu):
            return
        angle = np.radians(self.path("slope_load"))
        down = self.weight * np.sin(angle)
        friction = np.max(mu) * self.weight * np.cos(angle)
        # As down is not negative, a force that begins at zero never falls below it.
        (force,) = play(down[None], friction[None])
        strain = self.weight / (self.length * self.young)
        deformed = strain * max(self.length, self.height)
        # A block that never slides does not come to the spring.
        allowed = self.slack
        if force.any():
            allowed = SOFTEST * float(force.max()) / self.spring
        if deformed > allowed:
            return
        yield ExactCurve("loop", np.degrees(angle), force)

    def sentence(self) -> str:
        """Describe the block on its slope in a sentence."""
        path = self.path("slope_load")
        moves = "stays level"
        if np.any(path):
            turns = "rises and falls"
            moves = shared.acting(path, "rises", "falls", both=turns, back=turns)
        rough = "rough" if self.is_rough else "smooth"
        return (
            f"A block lies on a {rough} slope that {moves}; a spring catches it when "
            "it slides down."
        )
