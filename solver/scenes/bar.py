"""The paper's benchmark: a bar on a rigid rough support (paper, section 3, Table 1)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import param

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.discrete.substructure import tributary
from solver.reference.closed_forms import ExactCurve
from solver.refusal import plain
from solver.scenes.exact import exact_bar
from solver.settings.definitions import (
    ANY,
    LOAD,
    POSITIVE,
    CurveParameter,
    SettingGroup,
)
from solver.settings.load_paths import interpolate
from solver.settings.profiles import Profile, harmonic_means, means
from solver.settings.scene import Icon, Settings

SECTIONS = {name: shared.PROFILES[name] for name in ("uniform", "rising", "falling")}
"""Presets of the section: without a gap, as every element needs a section."""
SETTLEMENTS = {
    "linear": Profile(
        "rises evenly from 0 at the left end to 1 at the right end",
        ((0.0, 0.0), (1.0, 1.0)),
    ),
    **shared.PROFILES,
}
"""Presets of the settlement: the first one is zero at the left end."""
LARGEST_CONTRAST = 1e8
"""Largest ratio of two factors on the section, and the largest factor itself."""
DONE = {
    "body_load": ("all along it is {}", "pulled", "pushed"),
    "temperature_load": ("it is {}", "heated", "cooled"),
    "settlement_load": ("what it lies on is {}", "moved", "moved back"),
}
"""Words on loads along the bar by the setting of their path: a clause, and words for a
positive and a negative load."""
BAR = SettingGroup("Bar")
ENDS = SettingGroup("Ends")
KINDS = ("held", "spring", "pulled", "free")
"""Kinds of an end."""
HOLDING = ("held", "spring")
"""Kinds of an end that keep the bar in equilibrium under any load."""
PATHS = {
    "left": {"force": "left_load", "displacement": "support_load"},
    "right": {"force": "load", "displacement": "right_load"},
}
"""Settings of the paths of both ends by what is given there."""


def _is_end(side: str, *kinds: str) -> Callable[[Any], bool]:
    """Condition on settings: whether an end is of some kinds."""
    return lambda settings: getattr(settings, f"{side}_end") in kinds


def _end(side: str, default: str) -> param.Selector[str]:
    """Define the kind of an end."""
    return ENDS.choice(
        default,
        KINDS,
        f"What is at the {side} end. held: it stands still, or is moved. spring: a "
        "spring holds it to what stands still, or is moved. pulled: by a force. free: "
        "nothing.",
    )


def _spring(side: str) -> param.Number[float]:
    """Define the spring of an end."""
    return ENDS.quantity(
        1e6,
        (1e-9, 1e18),
        (1e3, 1e9),
        f"Stiffness of the spring at the {side} end.",
        title=f"Spring at the {side} end",
        unit="N/m",
        applies=_is_end(side, "spring"),
    )


def _moved_end(
    side: str, path: str, preset: str
) -> tuple[param.Number[float], CurveParameter]:
    """Define the displacement of the support of an end, and its path."""
    return shared.sized_path(
        path,
        f"displacement of the {side} end",
        "m",
        0.0,
        (-1e12, 1e12),
        (0.0, 1e-3),
        f"Largest displacement of what holds the {side} end; 0 leaves it where it is.",
        preset,
        applies=_is_end(side, *HOLDING),
        group=ENDS,
        places=(f"{side} x",),
    )


def _end_of(settings: Any, side: str) -> End:
    """Make an end of the structure."""
    kind = getattr(settings, f"{side}_end")
    paths = PATHS[side]
    if kind == "free":
        return End()
    if kind == "pulled":
        return End(force=settings.path(paths["force"]))
    stiffness = np.inf
    if kind == "spring":
        stiffness = getattr(settings, f"{side}_spring")
    return End(displacement=settings.path(paths["displacement"]), spring=stiffness)


def _ends_in_words(rods: Rods) -> tuple[str, str]:
    """Text on ends at rest, and text on ends that are pulled or moved."""
    at_rest: dict[str, list[str]] = {}
    moved = []
    for side, end in rods.ends.items():
        name = f"its {side} end"
        if end.force is not None:
            outward = end.force if side == "right" else -end.force
            moved.append(f"{name} is {shared.acting(outward, 'pulled', 'pushed')}")
        elif end.displacement is not None and end.displacement.any():
            subject = name
            if end.is_on_spring:
                subject = f"the spring at {name}"
            action = shared.acting(end.displacement, "moved", "moved back")
            moved.append(f"{subject} is {action}")
        else:
            at_rest.setdefault(_rest_of(end), []).append(name)
    clauses = []
    for word, names in at_rest.items():
        if len(names) == 2:
            where = "both ends"
        else:
            where = names[0]
        clauses.append(f"{word} at {where}")
    rest = ""
    if clauses:
        rest = shared.listed(clauses)
    return rest, ", and ".join(moved)


def _rest_of(end: End) -> str:
    """Text on an end at rest."""
    if end.is_on_spring:
        return "on a spring"
    if end.is_prescribed:
        return "held"
    return "free"


class BarSettings(Settings):
    """Settings of the friction bar; the defaults are Table 1 under a sine of 900 N."""

    scene = "bar"
    title = "Bar on a rough support"
    source = "paper, section 3, Table 1"
    icon = Icon(
        ground="M5 9V28M5 23H46M12 23l-3 4M19 23l-3 4M26 23l-3 4M33 23l-3 4M40 23l-3 4",
        body="M5 14H36V22H5Z",
        load="M37 18H46M42 14L46 18L42 22",
    )
    kind = "rod"
    CHIEF = ("load", "peak", "right_displacement")
    SMALL: ClassVar = {"elements": 20, "instants": 21, "substructures": 4}
    GROWS = ("elements",)

    peak, load = shared.sized_path(
        "load",
        "force at the right end",
        "N",
        900.0,
        (-1e15, 1e15),
        (0.0, 2400.0),
        "Largest force that the preset reaches; 1500 N is where the whole bar of Table "
        "1 slides.",
        "sine",
        applies=_is_end("right", "pulled"),
        title="Peak load",
        places=("right x",),
    )
    right_end = _end("right", "pulled")
    right_displacement, right_load = _moved_end("right", "right_load", "ramp")
    right_spring = _spring("right")
    left_end = _end("left", "held")
    support_displacement, support_load = _moved_end("left", "support_load", "sine")
    left_spring = _spring("left")
    left_force, left_load = shared.sized_path(
        "left_load",
        "force at the left end",
        "N",
        0.0,
        (-1e15, 1e15),
        (0.0, 2400.0),
        "Largest axial force at the left end, positive to the right.",
        "sine",
        applies=_is_end("left", "pulled"),
        group=ENDS,
        places=("left x",),
    )
    body_force, body_load = shared.sized_path(
        "body_load",
        "body force",
        "N/m",
        0.0,
        (-1e15, 1e15),
        (0.0, 3000.0),
        "Largest axial force per length inside the bar; 0 leaves it out.",
        "ramp",
        places=("body",),
    )
    temperature, temperature_load = shared.sized_path(
        "temperature_load",
        "temperature",
        "K",
        0.0,
        (-1e9, 1e9),
        (0.0, 60.0),
        "Largest change of the temperature of the bar; 0 leaves it out.",
        "ramp",
        title="Heating",
    )
    temperature_profile = shared.profile(
        "the temperature",
        "the bar",
        group=LOAD,
        applies=lambda settings: settings.is_active("temperature_load"),
    )
    expansion = LOAD.quantity(
        1.2e-5,
        (1e-12, 1.0),
        (1e-6, 1e-4),
        "Strain of the bar without any force, per kelvin.",
        title="Thermal expansion",
        unit="1/K",
        applies=lambda settings: settings.is_active("temperature_load"),
    )
    settlement, settlement_load = shared.sized_path(
        "settlement_load",
        "settlement",
        "m",
        0.0,
        (-1e12, 1e12),
        (0.0, 1e-3),
        "Largest displacement of the support along the bar, as of soil that settles or "
        "a slab that shrinks; 0 leaves it where it is. The ends are not on it.",
        "ramp",
        places=("bottom x",),
    )
    settlement_profile = shared.profile(
        "the settlement",
        "the bar",
        SETTLEMENTS,
        "a preset, or points (m, factor).",
        group=LOAD,
        applies=lambda settings: settings.is_active("settlement_load"),
    )
    friction = shared.friction("mu between bar and support")
    pressure, pressure_load = shared.pressure("the bar on its support", 10_000.0)
    friction_profile = shared.profile("μ", "the bar", bounds=POSITIVE)
    pressure_profile = shared.profile("p", "the bar", bounds=POSITIVE)
    elements = BAR.count(
        50,
        (1, 20_000),
        (10, 400),
        "Number of linear elements, equal in length.",
    )
    length = shared.size(1.0, (0.1, 10.0), "Length L", "Length of the bar.", BAR)
    young = shared.young(BAR)
    section = shared.section("Area of the cross section.", BAR)
    section_profile = shared.profile(
        "S",
        "the bar",
        SECTIONS,
        "a preset, taken at the middle of every element; or points (m, factor), where "
        "an element is as stiff as all that lies in it.",
        bounds=(ANY, (1.0 / LARGEST_CONTRAST, LARGEST_CONTRAST)),
        group=BAR,
    )

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`, N/m^2."""
        mean, _ = self._uneven_section()
        return float(self.young * self.section * mean / self.length**2)

    def check_together(self) -> None:
        """Refuse unlike sections, too soft or stiff springs, and lost equilibrium."""
        table = self.section_profile
        factors = [1.0]
        if not isinstance(table, str):
            factors = [factor for _, factor in table]
        if max(factors) > LARGEST_CONTRAST * (1.0 + shared.SLACK) * min(factors):
            raise self.refusal(
                "section_profile",
                f"a largest factor of at most {plain(LARGEST_CONTRAST)} times the "
                "smallest",
                "bring the factors nearer to each other",
            )
        super().check_together()
        stiffness = self.young * self.section / self.length
        for side in PATHS:
            remedy = "let the end be free, or held"
            self.check_digits(f"{side}_spring", stiffness, remedy)
        self._check_equilibrium()

    @cached_property
    def bodies(self) -> Rods:
        """The friction bar (paper, section 3 and Table 1).

        The bar is at rest and free of stress before the first instant.
        """
        nodes = np.linspace(0.0, self.length, self.elements + 1)
        factors = shared.at_nodes(self, nodes, "friction_profile", "pressure_profile")
        mean, section = self._uneven_section()
        return Rods(
            length=self.length,
            stiffness=self.young * self.section * mean,
            elements=self.elements,
            substructures=self.substructures,
            strength=shared.strength(self, factors),
            left=_end_of(self, "left"),
            right=_end_of(self, "right"),
            instants=self.times(),
            duration=self.duration,
            pressure=self.path("pressure_load"),
            body_force=self.path("body_load") if self.is_active("body_load") else None,
            strain=self._strain(nodes),
            settlement=self._settlement(nodes),
            section=section,
            friction_law=self.law,
        )

    def _strain(self, nodes: Array) -> Array | None:
        """Strain of elements by heating, (n_elements, n_instants); None without it.

        `nodes` are their positions, (n_nodes,), m.
        """
        if not self.is_active("temperature_load"):
            return None
        along = means([self.points("temperature_profile")], nodes)
        return np.outer(self.expansion * along, self.path("temperature_load"))

    def _settlement(self, nodes: Array) -> Array | None:
        """Displacement of the support at nodes, (n_nodes, n_instants), m; None at rest.

        `nodes` are their positions, (n_nodes,), m.
        """
        if not self.is_active("settlement_load"):
            return None
        along = interpolate(self.points("settlement_profile"), nodes)
        return np.outer(along, self.path("settlement_load"))

    def sentence(self) -> str:
        """Describe the bar in a sentence."""
        rods = self.bodies
        strength = self.law.bound_before_slip(rods.strength)
        table = "smooth"
        if strength.all():
            table = "rough"
        elif strength.any():
            table = "partly rough"
        body = "An elastic bar"
        if shared.is_steel(self.young):
            body = "A steel bar"
        head = f"{body} lies on a {table} table"
        rest, moved = _ends_in_words(rods)
        if rest:
            head = f"{head}, {rest}"
        clauses = [head]
        if moved:
            clauses.append(moved)
        for path, (clause, forward, backward) in DONE.items():
            if self.is_active(path):
                action = shared.acting(self.path(path), forward, backward)
                clauses.append(clause.format(action))
        if self.pressure_load != "steady":
            clauses.append("what presses it changes")
        return f"{'; '.join(clauses)}."

    @property
    def loop_is_over_displacement(self) -> bool:
        """Check whether an end is pulled or moved."""
        acting = {name for name in self.paths if self.is_active(name)}
        driven = [*PATHS["left"].values(), *PATHS["right"].values()]
        return bool(acting.intersection(driven))

    def _check_equilibrium(self) -> None:
        """Refuse forces beyond friction if friction alone holds the bar."""
        if {self.left_end, self.right_end} & set(HOLDING):
            return
        rods = self.bodies
        strength = self.law.bound_before_slip(rods.strengths) * self.law.largest_factor
        shares = tributary(self.elements) * (self.length / self.elements)
        largest = np.broadcast_to(shares @ strength, (self.n_instants,))
        forces = [end.force for end in rods.ends.values() if end.force is not None]
        if rods.body_force is not None:
            forces.append(self.length * rods.body_force)
        total = np.abs(sum(forces, np.zeros(self.n_instants)))
        worst = int(np.argmax(total - largest))
        force = float(total[worst])
        capacity = float(largest[worst])
        if force >= (1.0 - shared.SLACK) * capacity:
            raise self.refusal(
                "left_end",
                f"held, or spring, where forces reach {plain(force)} N "
                f"and friction carries less than {plain(capacity)} N",
                "hold an end, lower the forces, or raise friction or pressure",
            )

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterator[ExactCurve]:
        """Friction along the bar and the loop of its end, by closed forms."""
        return exact_bar(self.bodies, problem)

    def _uneven_section(self) -> tuple[float, Array | None]:
        """Harmonic mean of the section's factors, and every element's factor over it.

        The latter has shape (n_elements,); it is None if the section is uniform.
        """
        if self.section_profile == "uniform":
            return 1.0, None
        ends = np.linspace(0.0, self.length, self.elements + 1)
        table = self.section_profile
        if isinstance(table, str):
            middles = 0.5 * (ends[:-1] + ends[1:]) / self.length
            factors = interpolate(SECTIONS[table].points, middles)
        else:
            factors = harmonic_means(table, ends)
        mean = float(1.0 / np.mean(1.0 / factors))
        return mean, factors / mean
