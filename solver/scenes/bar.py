"""The paper's benchmark: a clamped bar that rubs on a rigid support (paper, section 3, Table 1)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.definitions import SettingError, choice, count, curve, quantity
from solver.discrete.problem import Problem
from solver.discrete.rods import Rods
from solver.discrete.structure import LoopFields
from solver.loads import PRESETS, interpolate
from solver.profiles import harmonic_means, means, shares_of
from solver.reference.closed_forms import ExactCurve
from solver.refusal import plain
from solver.scenes.base import SceneSettings
from solver.scenes.entry import Emblem, Entry
from solver.scenes.exact import exact_bar
from solver.scenes.words import acting, is_steel

SECTIONS = ("uniform", "rising", "falling")
"""Of `shared.PROFILES`, those that leave no element without a section."""
FACTORS = 1e-8, 1e8
LARGEST_CONTRAST = 1e8
SLACK = 1e-9
"""Share by which rounding may exceed the largest contrast."""


class BarSettings(SceneSettings):
    """Settings of the friction bar; the defaults are Table 1 under a sine of 900 N."""

    scene = "bar"
    LOADS: ClassVar = ("peak",)
    PEAKS: ClassVar = {
        "load": "peak",
        "support_load": "support_displacement",
        "body_load": "body_force",
        "pressure_load": "pressure",
    }
    BEHIND: ClassVar = {
        "right x": "peak",
        "top y": "pressure",
        "left x": "support_displacement",
        "body": "body_force",
    }
    PROFILES: ClassVar = shared.PROFILES

    load = curve(
        "sine",
        PRESETS,
        "time",
        "force",
        ("s", "N"),
        "Axial force at the free end over time: a preset, or points (s, N).",
        group="Load",
        title="Load path",
    )
    peak = quantity(
        900.0,
        (-1e15, 1e15),
        (0.0, 2400.0),
        "Largest force that the preset reaches; 1500 N is where the whole bar of Table 1 slides.",
        group="Load",
        title="Peak load",
        unit="N",
        applies=lambda settings: isinstance(settings.load, str),
    )
    seed = shared.seed(lambda settings: settings.load == "random")
    duration = shared.duration()
    instants = shared.instants(101)
    support_displacement = quantity(
        0.0,
        (-1e12, 1e12),
        (0.0, 1e-3),
        "Largest prescribed displacement of the clamped end; 0 leaves it fixed.",
        group="Load",
        title="Support displacement",
        unit="m",
    )
    support_load = choice(
        "sine",
        PRESETS,
        "Path of the support's displacement over time.",
        group="Load",
        title="Path of the support",
        applies=lambda settings: settings.support_displacement != 0.0,
    )
    body_force = quantity(
        0.0,
        (-1e15, 1e15),
        (0.0, 3000.0),
        "Largest axial force per length inside the bar; 0 leaves it out.",
        group="Load",
        title="Body force",
        unit="N/m",
    )
    body_load = choice(
        "ramp",
        PRESETS,
        "Path of the body force over time.",
        group="Load",
        title="Path of the body force",
        applies=lambda settings: settings.body_force != 0.0,
    )
    friction = shared.friction("mu between bar and support")
    pressure = shared.pressure("the bar on its support", 10_000.0)
    pressure_load = shared.pressure_load()
    friction_profile = shared.friction_profile("the bar")
    pressure_profile = curve(
        "uniform",
        shared.PROFILES,
        "position",
        "factor",
        ("m", ""),
        "Factor on p along the bar: a preset, or points (m, factor).",
        group="Contact",
        title="p along the bar",
    )
    elements = count(
        50,
        (1, 20_000),
        (10, 400),
        "Number of linear elements, equal in length.",
        group="Bar",
        title="Elements",
    )
    length = shared.size(1.0, (0.1, 10.0), "Length L", "Length of the bar.", "Bar")
    young = shared.young("Bar")
    section = shared.section("Area of the cross section.", "Bar")
    section_profile = curve(
        "uniform",
        SECTIONS,
        "position",
        "factor",
        ("m", ""),
        "Factor on S along the bar: a preset, taken at the middle of every element; or points "
        "(m, factor), where an element is as stiff as all that lies in it.",
        group="Bar",
        title="S along the bar",
    )

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return self.elements + 1

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`, N/m^2."""
        mean, _ = self._uneven_section()
        return float(self.young * self.section * mean / self.length**2)

    def check_together(self) -> None:
        """Refuse negative factors too."""
        self._check_section()
        super().check_together()
        shared.refuse_negative(self, "pressure_load", "pressure", " N/m")
        for name in ("friction_profile", "pressure_profile"):
            shared.refuse_negative(self, name, "factor")

    def _check_section(self) -> None:
        """Refuse a section that vanishes, or is too uneven for the digits of a number."""
        table = self.section_profile
        if isinstance(table, str):
            return
        factors = [factor for _, factor in table]
        low, high = FACTORS
        if not low <= min(factors) <= max(factors) <= high:
            raise SettingError(
                "section_profile",
                table,
                f"factors above 0, from {plain(low)} to {plain(high)}",
                "bring the factors into this range",
            )
        if max(factors) > LARGEST_CONTRAST * (1.0 + SLACK) * min(factors):
            raise SettingError(
                "section_profile",
                table,
                f"a largest factor of at most {plain(LARGEST_CONTRAST)} times the smallest",
                "bring the factors nearer to each other",
            )

    def structure(self) -> Rods:
        """Make the friction bar (paper, section 3 and Table 1).

        The bar is at rest and free of stress before the first instant.
        """
        nodes = np.linspace(0.0, self.length, self.elements + 1)
        density = self.friction * self._density(nodes)
        bound = density * self.pressure
        if self.pressure_load != "steady":
            bound = np.outer(density, self.path("pressure_load"))
        mean, section = self._uneven_section()
        return Rods(
            length=self.length,
            stiffness=self.young * self.section * mean,
            elements=self.elements,
            substructures=self.substructures,
            bound=bound,
            load=self.path("load"),
            instants=self.times(),
            duration=self.duration,
            pressure=self.path("pressure_load"),
            support=self.path("support_load") if self.support_displacement else None,
            body_force=self.path("body_load") if self.body_force else None,
            section=section,
            friction_law=self.law,
        )

    def sentence(self) -> str:
        """The bar in a sentence."""
        bound = self.law.without_slip(self.structure().bound)
        table = "rough" if bound.all() else "partly rough" if bound.any() else "smooth"
        ends = f"its right end is {acting(self.path('load'), 'pulled', 'pushed')}"
        if self.support_displacement:
            left = acting(self.path("support_load"), "moved", "moved back")
            ends += f", and its left end is {left}"
        if self.body_force:
            along = acting(self.path("body_load"), "pulled", "pushed")
            ends += f"; all along it is {along}"
        if self.pressure_load != "steady":
            ends += "; what presses it changes"
        held = "" if self.support_displacement else ", held at its left end"
        body = "A steel bar" if is_steel(self.young) else "An elastic bar"
        return f"{body} lies on a {table} table{held}; {ends}."

    def coarser(self) -> Iterator[Rods]:
        """Yield the same bar, uncut, on ever coarser meshes."""
        return shared.ever_coarser(self.structure())

    def exact(self, problem: Problem, solution: LoopFields | None) -> Iterator[ExactCurve]:
        """Friction along the bar and the loop of its end, where closed forms are known."""
        return exact_bar(self.structure(), problem)

    def _uneven_section(self) -> tuple[float, Array | None]:
        """Harmonic mean of the section's factors, and every element's over that mean."""
        if self.section_profile == "uniform":
            return 1.0, None
        ends = np.linspace(0.0, self.length, self.elements + 1)
        table = self.section_profile
        if isinstance(table, str):
            factors = interpolate(self.PROFILES[table], 0.5 * (ends[:-1] + ends[1:]) / self.length)
        else:
            factors = harmonic_means(table, ends)
        mean = float(1.0 / np.mean(1.0 / factors))
        return mean, factors / mean

    def _density(self, nodes: Array) -> Array:
        """Factors on mu and p together: presets at the nodes, tables over their shares."""
        names = "friction_profile", "pressure_profile"
        mu, pressure = tables = [self.points(name) for name in names]
        if all(isinstance(getattr(self, name), str) for name in names):
            return interpolate(mu, nodes) * interpolate(pressure, nodes)
        return means(tables, shares_of(nodes))


BAR = Entry(
    title="Clamped bar on a rough support",
    source="paper, section 3, Table 1",
    emblem=Emblem(
        ground="M5 9V28M5 23H46M12 23l-3 4M19 23l-3 4M26 23l-3 4M33 23l-3 4M40 23l-3 4",
        body="M5 14H36V22H5Z",
        load="M37 18H46M42 14L46 18L42 22",
    ),
    settings=BarSettings,
    kind="rod",
    grows=("elements",),
)
