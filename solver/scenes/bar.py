"""The paper's benchmark: a clamped bar that rubs on a rigid support (paper, section 3, Table 1)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.definitions import SettingError, choice, count, curve, quantity
from solver.loads import PRESETS, instants_of, interpolate, load_path
from solver.settings import Settings

PROFILES = {
    "uniform": ((0.0, 1.0), (1.0, 1.0)),
    "rising": ((0.0, 0.2), (1.0, 1.8)),
    "falling": ((0.0, 1.8), (1.0, 0.2)),
    "gap": ((0.0, 1.0), (0.4, 1.0), (0.401, 0.0), (0.599, 0.0), (0.6, 1.0), (1.0, 1.0)),
}
SECTIONS = ("uniform", "rising", "falling")
"""Of `PROFILES`, those that leave no element without a section."""
FACTORS = 1e-8, 1e8
LARGEST_CONTRAST = 1e8
LARGEST_FIELD = 25_000_000
SLACK = 1e-9
"""Share by which rounding may exceed the largest contrast."""
COARSEST = 6
"""Elements below which a mesh is not coarsened: a front needs a few to be seen at all."""


class BarSettings(Settings):
    """Settings of the friction bar; the defaults are Table 1 under a sine of 900 N."""

    scene = "bar"

    load = curve(
        "sine",
        PRESETS,
        "time",
        "force",
        ("s", "N"),
        "Axial force at the free end over time: a preset, or points (s, N).",
        group="Load",
        title="Load path",
        essential=True,
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
        essential=True,
    )
    seed = shared.seed(lambda settings: settings.load == "random", essential=True)
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
    friction = quantity(
        0.3,
        (0.0, 1e6),
        (0.0, 1.0),
        "Coefficient of friction mu between bar and support.",
        group="Contact",
        title="Friction coefficient μ",
        essential=True,
    )
    pressure = quantity(
        5000.0,
        (0.0, 1e15),
        (0.0, 10_000.0),
        "Pressure p of the bar on its support, per length.",
        group="Contact",
        title="Pressure p",
        unit="N/m",
        essential=True,
    )
    friction_profile = curve(
        "uniform",
        PROFILES,
        "position",
        "factor",
        ("m", ""),
        "Factor on mu along the bar: a preset, or points (m, factor).",
        group="Contact",
        title="μ along the bar",
    )
    pressure_profile = curve(
        "uniform",
        PROFILES,
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
        essential=True,
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
        "Factor on S along the bar, taken at the middle of every element: a preset, or points "
        "(m, factor).",
        group="Bar",
        title="S along the bar",
    )

    def with_change(self, name: str, value: object) -> BarSettings:
        """Change one setting; fewer elements than substructures take these down with them."""
        if name == "elements" and isinstance(value, int) and value < self.substructures:
            return self.replace(elements=value, substructures=max(value, 1))
        return self.replace(**{name: value})

    def check_together(self) -> None:
        """Refuse more substructures than elements, negative factors, and fields beyond memory."""
        if self.substructures > self.elements:
            raise SettingError(
                "substructures",
                self.substructures,
                f"1 to elements ({self.elements})",
                "give fewer substructures or more elements",
            )
        fields = (self.elements + 1) * self.instants
        if fields > LARGEST_FIELD:
            raise SettingError(
                "instants",
                self.instants,
                f"at most {LARGEST_FIELD // (self.elements + 1)} with {self.elements} elements",
                "give fewer instants or fewer elements",
            )
        for name in ("friction_profile", "pressure_profile"):
            table = getattr(self, name)
            if not isinstance(table, str) and min(factor for _, factor in table) < 0.0:
                raise SettingError(
                    name, table, "factors of at least 0", "raise the negative factor"
                )
        self._check_section()

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
                f"factors above 0, from {low:g} to {high:g}",
                "bring the factors into this range",
            )
        if max(factors) > LARGEST_CONTRAST * (1.0 + SLACK) * min(factors):
            raise SettingError(
                "section_profile",
                table,
                f"a largest factor of at most {LARGEST_CONTRAST:g} times the smallest",
                "bring the factors nearer to each other",
            )


@dataclass(frozen=True)
class Bar:
    """A friction bar as plain data; absent parts are None.

    Attributes
    ----------
    length, stiffness
        Length L, m, and axial stiffness ES, N; where that varies, of the uniform bar that the same
        force at both ends stretches by as much.
    elements, substructures
        Numbers of equal linear elements, and of parts that they are dealt to.
    instants, duration
        Instants, shape (n_instants,), and length of the interval, s.
    load
        Axial force at the free end, shape (n_instants,), N.
    bound
        Friction bound mu p at the nodes, shape (n_nodes,), N/m.
    support
        Displacement of the clamped end, shape (n_instants,), m.
    body_force
        Axial force per length, uniform along the bar, shape (n_instants,), N/m.
    section
        Stiffness of every element over `stiffness`, shape (n_elements,), where it varies; the mean
        of the inverse is 1.
    """

    length: float
    stiffness: float
    elements: int
    substructures: int
    instants: Array
    duration: float
    load: Array
    bound: Array
    support: Array | None
    body_force: Array | None
    section: Array | None

    @property
    def nodes(self) -> Array:
        """Positions of the nodes, shape (n_nodes,), m."""
        return np.linspace(0.0, self.length, self.elements + 1)

    def coarser(self) -> Bar | None:
        """Give the same bar uncut on half the elements, or None where a front could not be seen."""
        elements = self.elements // 2
        if elements < COARSEST:
            return None
        nodes = np.linspace(0.0, self.length, elements + 1)
        bound = np.interp(nodes, self.nodes, self.bound)
        section = self._section_between(nodes)
        return replace(self, elements=elements, substructures=1, bound=bound, section=section)

    def _section_between(self, nodes: Array) -> Array | None:
        """Give the stiffness between other nodes, in series what the elements have there."""
        if self.section is None:
            return None
        compliance = np.concatenate([[0.0], np.cumsum(1.0 / self.section)])
        own = np.diff(np.interp(nodes, self.nodes, compliance))
        return np.asarray(np.mean(own) / own)


def bar(settings: BarSettings) -> Bar:
    """Make the friction bar that the settings describe (paper, section 3 and Table 1).

    One instant stands at the end of the interval; more are spread evenly from 0 on, and the bar
    is at rest and free of stress before the first.
    """
    duration = settings.duration
    instants = instants_of(duration, settings.instants)

    def path(curve: str | tuple[tuple[float, float], ...], peak: float) -> Array:
        return load_path(curve, instants, duration, peak, settings.seed)

    nodes = np.linspace(0.0, settings.length, settings.elements + 1)
    mu = settings.friction * _profile(settings.friction_profile, nodes, settings.length)
    pressure = settings.pressure * _profile(settings.pressure_profile, nodes, settings.length)
    mean, section = _section(settings)
    return Bar(
        length=settings.length,
        stiffness=settings.young * settings.section * mean,
        elements=settings.elements,
        substructures=settings.substructures,
        instants=instants,
        duration=duration,
        load=path(settings.load, settings.peak),
        bound=mu * pressure,
        support=path(settings.support_load, settings.support_displacement)
        if settings.support_displacement
        else None,
        body_force=path(settings.body_load, settings.body_force) if settings.body_force else None,
        section=section,
    )


def _section(settings: BarSettings) -> tuple[float, Array | None]:
    """Give the harmonic mean of the section's factors, and every element's over that mean."""
    if settings.section_profile == "uniform":
        return 1.0, None
    ends = np.linspace(0.0, settings.length, settings.elements + 1)
    middles = 0.5 * (ends[:-1] + ends[1:])
    factors = _profile(settings.section_profile, middles, settings.length)
    mean = float(1.0 / np.mean(1.0 / factors))
    return mean, factors / mean


def _profile(profile: str | tuple[tuple[float, float], ...], nodes: Array, length: float) -> Array:
    if isinstance(profile, str):
        return interpolate(PROFILES[profile], nodes / length)
    return interpolate(profile, nodes)
