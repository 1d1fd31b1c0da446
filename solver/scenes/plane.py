"""Settings that scenes in the plane share: of all bodies, and of rectangles."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np
import param

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.inside import Inside
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.rectangles.stack import Stack
from solver.laws import FrictionLaw
from solver.refusal import plain
from solver.settings.definitions import (
    BODY,
    CONTACT,
    DECOMPOSITION,
    METHOD,
    POSITIVE,
    redefined,
)
from solver.settings.load_paths import PRESETS
from solver.settings.scene import Settings

LARGEST_MATRIX = 30_000_000
"""Numbers in one dense matrix of a substructure, from its inside to its outline."""

FLATTEST = 1e4
"""Largest ratio of the sides of an element. The stiffness of an element varies with the
square of the ratio: at a ratio of 3e9 no digit of a substructure's stiffness is left,
at 1e5 none beside a search direction k of a millionth (measured)."""


class PlaneSettings(Settings):
    """Settings of elastic bodies with frictional contact; one metre thick."""

    kind = "plane"
    opens = True

    instants = redefined(Settings.param["instants"], 81)
    friction = shared.friction("mu", largest=10.0)
    friction_profile = shared.profile("μ", "the body", bounds=POSITIVE)
    tangential_stiffness = redefined(
        Settings.param["tangential_stiffness"],
        0.0,
        (1e8, 1e14),
        doc="Stiffness of a spring along the interface, in series with friction, per "
        "area: a joint, a soft layer. 0: rigid.",
        unit="N/m^3",
    )
    normal_stiffness = CONTACT.quantity(
        0.0,
        (0.0, 1e18),
        (1e8, 1e14),
        "Stiffness of a spring across the interface, in series with contact that may "
        "open, per area. 0: rigid.",
        unit="N/m^3",
        applies=lambda settings: settings.is_general and settings.opens,
    )
    cohesion = redefined(
        Settings.param["cohesion"],
        0.0,
        (0.0, 1e7),
        doc="Friction per area without any pressure, beside μ times that. It is gone "
        "for good where contact opens, and was never there where a gap was.",
        unit="Pa",
    )
    friction_cap = redefined(
        Settings.param["friction_cap"],
        0.0,
        (0.0, 1e8),
        doc="Largest friction per area that pressure and cohesion make, before slip. "
        "0: none.",
        unit="Pa",
    )
    plane = BODY.choice(
        "strain",
        ["strain", "stress"],
        "strain: a body that is long across the picture. stress: a thin one.",
    )
    young = shared.young(BODY)
    poisson = BODY.quantity(
        0.3,
        (0.0, 0.4999),
        (0.0, 0.49),
        "Poisson's ratio.",
        title="Poisson's ratio ν",
    )

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`, N/m^3."""
        return float(self.young / self.length)

    @property
    def law(self) -> FrictionLaw:
        """Law of friction without mu, with the stiffness across the interface."""
        stiffness = np.inf
        if self.applies("normal_stiffness") and self.normal_stiffness:
            stiffness = self.normal_stiffness
        return replace(super().law, normal_stiffness=stiffness)

    @property
    def is_rough(self) -> bool:
        """Check whether there is friction at any pair."""
        return bool(self.friction or self.law.cohesion)

    @cached_property
    def hold(self) -> Array:
        """Factor on weights over time, (n_instants,): whole after the first quarter."""
        return PRESETS["hold"].value(self.times() / self.duration, 1)

    @property
    def touch(self) -> str:
        """Words on how bodies touch, before those that they touch."""
        if self.is_rough:
            return "rub on"
        return "slide freely on"

    @property
    def n_interfaces(self) -> int:
        """Number of interfaces: between bodies, or of one body with its support."""
        return max(self.n_bodies - 1, 1)


def poisson_in(settings: Settings, inside: Inside) -> Array | float:
    """Poisson's ratio of every element, (n_elements,), or the common one."""
    structure = settings.structure()
    if isinstance(structure, Bodies):
        # Bodies of a mesh may each have a material of their own.
        of_bodies = np.array([body.poisson for body in structure.bodies])
        return np.asarray(of_bodies[inside.bodies])
    return float(settings.values()["poisson"])


class RectangleSettings(PlaneSettings):
    """Settings of elastic rectangles with frictional contact; one metre thick."""

    across = "height"
    PARTS: ClassVar = {"substructures": "elements", "substructures_up": "elements_up"}
    MESH = ("elements", "elements_up")
    SMALL: ClassVar = {"elements": 16, "elements_up": 6, "instants": 13}
    GROWS = (*MESH, *PARTS)

    elements = BODY.count(
        48,
        (2, 5000),
        (8, 192),
        "Number of elements along a body, equal in size.",
        title="Elements along",
    )
    elements_up = BODY.count(
        24,
        (1, 5000),
        (2, 96),
        "Number of elements over the height of a body.",
    )
    substructures: param.Integer[int] = redefined(
        Settings.param["substructures"],
        4,
        title="Substructures along",
    )
    substructures_up = DECOMPOSITION.count(
        2,
        (1, 5000),
        (1, 16),
        "Number of pieces (substructures) over the height of a body.",
    )
    macro_degree = DECOMPOSITION.count(
        1,
        (0, 10),
        (0, 4),
        "What the coarse problem balances on each side of a substructure. 0: "
        "resultants; 1: also moments and linear extension. Sides more than three times "
        "as long as the substructure is deep get more by themselves.",
        applies=lambda settings: settings.multiscale and settings.is_divided,
    )
    start = METHOD.choice(
        "zero",
        ["zero"],
        "Where the iteration starts: from zero.",
        applies=lambda settings: False,
    )

    @property
    def places(self) -> Array:
        """Positions of the nodes along a body, (n_nodes,), m."""
        return np.linspace(0.0, self.length, self.nodes[0])

    def friction_at_nodes(self) -> float | Array:
        """Coefficient mu at the nodes along a body, (n_nodes,), or a uniform one."""
        if self.friction_profile == "uniform" or not self.applies("friction_profile"):
            return self.friction
        factors = shared.at_nodes(self, self.places, "friction_profile")
        return np.asarray(self.friction * factors)

    @property
    def nodes(self) -> tuple[int, int]:
        """Number of nodes of one body, along and up."""
        return self.elements + 1, self.elements_up + 1

    @property
    def n_nodes(self) -> int:
        """Number of nodes of all bodies."""
        return self.n_bodies * math.prod(self.nodes)

    @property
    def is_divided(self) -> bool:
        """Check whether there is more than one substructure."""
        return super().is_divided or self.substructures_up > 1

    def stack(self) -> Stack:
        """Make the bodies, free on all sides and without any load."""
        return Stack(
            length=self.length,
            height=getattr(self, self.across),
            elements=(self.elements, self.elements_up),
            substructures=(self.substructures, self.substructures_up),
            macro_degree=self.macro_degree,
            young=self.young,
            poisson=self.poisson,
            state=self.plane,
            friction=self.friction_at_nodes(),
            friction_law=self.law,
            instants=self.times(),
            duration=self.duration,
        )

    def check_together(self) -> None:
        """Refuse elements too flat for double precision, and large matrices."""
        height: float = getattr(self, self.across)
        ratio = self.length * self.elements_up / (height * self.elements)
        if not 1.0 / FLATTEST <= ratio <= FLATTEST:
            raise self.refusal(
                self.across,
                f"elements of which no side is more than {plain(FLATTEST)} times the "
                "other",
                f"they are {ratio:.3g} times as long as high: change sizes or numbers "
                "of elements",
            )

        super().check_together()
        columns = -(-self.elements // self.substructures)
        rows = -(-self.elements_up // self.substructures_up)
        if 8 * columns * rows * (columns + rows) > LARGEST_MATRIX:
            raise self.refusal(
                "substructures",
                f"parts smaller than {columns} by {rows} elements",
                "give more substructures along or up, or fewer elements",
            )


class ShapedSettings(PlaneSettings):
    """Settings of bodies of any shape that touch at joints; one metre thick."""

    has_joints = True

    friction_profile = redefined(
        PlaneSettings.param["friction_profile"], "uniform", applies=lambda _: False
    )
    instants = redefined(PlaneSettings.param["instants"], 41)
    substructures = redefined(
        RectangleSettings.param["substructures"],
        1,
        doc="Number of pieces (substructures) of each body.",
        title="Substructures of a body",
    )
    macro_degree = redefined(RectangleSettings.param["macro_degree"], 1)
    start = redefined(RectangleSettings.param["start"], "zero")

    def weight(self, density: float) -> Array:
        """Force per volume by a weight per volume, (2, n_instants), N/m^3."""
        return np.outer([0.0, -density], self.hold)
