"""A strand of helical wires, stretched and bent (MATHEMATICS.md, 6)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.rope.cross_section import (
    CONSTRUCTIONS,
    MOST_LAYERS,
    CrossSection,
    laid,
)
from solver.discrete.rope.rope import Rope, RopeWire
from solver.laws import FrictionLaw
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.bent_strand import BentStrand
from solver.refusal import RefusedError
from solver.settings.definitions import POSITIVE, Rows, TablePreset, redefined
from solver.settings.load_paths import PRESSURES
from solver.settings.scene import Icon, Settings

MOST_WIRES = 1000
"""Largest number of wires of a construction that is a table."""


STRANDS = {
    "mooring": (
        "a spiral strand of 5 mm steel wires, 6, 12, 18, ... a layer on a core wire"
    ),
    "seven-wire": "prestressing strand of 15.7 mm",
    "conductor": (
        "an overhead conductor of 28 mm, 26 aluminium wires on 7 of steel (Drake)"
    ),
}
"""Descriptions of the constructions."""


def _rows(settings: Any) -> Rows:
    """Rows of the table of a construction."""
    rows: Rows = settings.section.rows
    return rows


class RopeSettings(Settings):
    """Settings of the strand; by default 37 wires near a clamp, bent to and fro."""

    scene = "rope"
    title = "Spiral strand, bent"
    source = "closed form: slip spreads from the neutral axis (Papailiou 1997)"
    icon = Icon(
        ground="M5 3V29",
        body="M5 8C18 8 28 9 42 14L40 24C28 19 18 18 5 18ZM11 8L15 18M18 8L22 19M25 "
        "9L29 20M32 11L35 22",
        load="M44 28C46 24 46 20 45 16M41 19L45 15L48 19",
    )
    kind = "helices"
    CHIEF = ("construction", "layers", "bending", "load", "curvature", "tension")
    SMALL: ClassVar = {
        "layers": 1,
        "length": 0.15,
        "tension": 4e4,
        "substructures": 2,
        "elements": 10,
        "instants": 13,
    }
    ALSO_CHIEF = ("friction", "k_scale")
    GROWS = ("layers",)
    loop_is_over_displacement = False

    construction = shared.STRAND.curve(
        "mooring",
        {name: TablePreset(line, _rows) for name, line in STRANDS.items()},
        {"wires": "", "diameter": "m", "lay angle": "°", "modulus": "Pa"},
        "Wires of the strand: a preset, or rows, inside out: wires, their diameter "
        "(m), lay angle (°, negative the other way round) and Young's modulus (Pa); "
        "the first row is the core, 1 wire of 0°.",
        bounds=((1, 500), (1e-6, 1.0), (-75.0, 75.0), (1.0, 1e18)),
    )
    layers = shared.STRAND.count(
        3,
        (1, MOST_LAYERS),
        (1, MOST_LAYERS),
        "Number of layers on the core: 7, 19, 37, 61 or 91 wires.",
        applies=lambda settings: settings.construction == "mooring",
    )
    curvature, load = shared.sized_path(
        "load",
        "curvature",
        "1/m",
        0.1,
        (-1e3, 1e3),
        (0.0, 0.5),
        "Largest curvature that the preset reaches, uniform or at the clamp: 1 over "
        "the radius to which the strand is bent. Sections stay plane, so each wire is "
        "stretched and pressed as it goes round.",
        "cycle",
        title="Peak curvature",
        places=("right y",),
    )
    tension, tension_load = shared.sized_path(
        "tension_load",
        "tension",
        "N",
        250e3,
        (0.0, 1e12),
        (0.0, 1e6),
        "Tension of the strand, by which wires press on what is below them. About a "
        "quarter of what they break at: 250 kN of 37 mooring wires, 70 kN seven-wire, "
        "30 kN conductor. It is bent without untwisting, and what friction adds to a "
        "wire's tension presses no harder.",
        "steady",
        PRESSURES,
        bounds=POSITIVE,
        places=("right x",),
    )
    instants = redefined(Settings.param["instants"], 61)
    bending = shared.STRAND.choice(
        "clamp",
        ["uniform", "clamp"],
        "uniform: the same curvature all along; wires of a layer are then alike, and "
        "one of each stands for all. clamp: the curvature falls away from a clamp, and "
        "every wire is there.",
        title="Where it is bent",
    )
    fall_off = shared.STRAND.quantity(
        0.0,
        (0.0, 1e4),
        (0.0, 1.0),
        "Distance λ from the clamp at which the curvature is exp(-1) of that at the "
        "clamp. 0: sqrt(E I / T), of the bending stiffness while nothing slips and the "
        "largest tension.",
        title="Fall-off λ",
        unit="m",
        applies=lambda settings: settings.bending == "clamp",
    )
    length = shared.STRAND.quantity(
        0.6,
        (1e-3, 1e3),
        (0.1, 5.0),
        "Length of strand from the clamp on; beyond it nothing slips. Some three times "
        "λ.",
        title="Length L",
        unit="m",
        applies=lambda settings: settings.bending == "clamp",
    )
    friction = shared.friction(
        "mu of the wires on what they lie on; those beside each other do not rub"
    )
    friction_factors = shared.friction_factors(
        "between a layer and what it lies on, from the core outwards"
    )
    elements = shared.STRAND.count(
        60,
        (2, 20_000),
        (10, 400),
        "Number of linear elements of a wire: of its length, or of half a turn where "
        "it is bent alike all along.",
        title="Elements per wire",
    )
    substructures = redefined(
        Settings.param["substructures"],
        10,
        doc="Number of pieces (substructures) that a wire is cut into, all alike.",
        title="Substructures per wire",
    )

    @cached_property
    def section(self) -> CrossSection:
        """Cross-section of the strand.

        Raises
        ------
        SettingError
            For rows that are no possible strand, and too many wires.
        """
        if isinstance(self.construction, str):
            return CONSTRUCTIONS[self.construction](self.layers)
        try:
            section = laid(self.construction)
        except RefusedError as refused:
            raise self.refusal(
                "construction", refused.allowed, refused.remedy
            ) from refused
        if section.wires > MOST_WIRES:
            remedy = f"it has {section.wires}: leave some out"
            raise self.refusal("construction", f"at most {MOST_WIRES} wires", remedy)
        return section

    @property
    def is_clamped(self) -> bool:
        """Check whether the curvature decays from a clamp."""
        return bool(self.bending == "clamp")

    @property
    def n_bodies(self) -> int:
        """Number of wires that may slip, without the core."""
        section = self.section
        if self.is_clamped:
            return section.wires - 1
        return len(section.layers)

    @property
    def n_interfaces(self) -> int:
        """Number of interfaces: between layers, and between the first and the core."""
        return len(self.section.layers)

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`, N/m^2."""
        layers = self.section.layers
        longest = max(self._length_of(layer) for layer in range(len(layers)))
        return float(max(layer.stiffness for layer in layers) / longest**2)

    def check_together(self) -> None:
        """Refuse curvature without decay, and tables without a factor per interface."""
        super().check_together()
        shared.factors_of(self)
        needs_tension = self.is_clamped and self.fall_off == 0.0
        if needs_tension and not self.path("tension_load").any():
            raise self.refusal(
                "fall_off",
                "a distance above 0, where there is no tension to tell it",
                "give the fall-off, or a tension",
            )

    def falls_off(self) -> float:
        """Distance over which the curvature decays to exp(-1), m."""
        if self.fall_off:
            return float(self.fall_off)
        tension = self.path("tension_load").max()
        return float(np.sqrt(self.section.stuck_bending / tension))

    @cached_property
    def bodies(self) -> Rope:
        """The strand.

        Under a uniform curvature all wires of a layer are alike, and each passes every
        fibre: half a turn of one wire is enough, from the outermost fibre to the
        innermost, where it does not slip.
        """
        return Rope(
            wires=list(self._wires()),
            substructures=self.substructures,
            tension=self.path("tension_load"),
            curvature=self.path("load"),
            is_clamped=self.is_clamped,
            section=self.section,
            instants=self.times(),
            duration=self.duration,
            friction_law=self.law,
        )

    def _wires(self) -> Iterator[RopeWire]:
        """Yield the wires that may slip, layer by layer."""
        section = self.section
        tension = self.path("tension_load")
        factors = shared.factors_of(self)
        strengths = section.friction_strengths(tension, self.friction, factors)
        if self.tension_load == "steady":
            strengths = strengths[:, 0]
        curvature = self._curvature_at_nodes()
        for layer, layer_data in enumerate(section.layers):
            count = 1
            if self.is_clamped:
                count = layer_data.wires
            for number in range(count):
                yield RopeWire(
                    layer=layer,
                    number=number,
                    layer_data=layer_data,
                    radius=section.radii[layer],
                    start=2.0 * np.pi * number / layer_data.wires,
                    length=self._length_of(layer),
                    strength=strengths[layer],
                    curvature=curvature,
                    tension=section.wire_tension(layer, tension),
                    stands_for=layer_data.wires // count,
                )

    def _curvature_at_nodes(self) -> Array:
        """Curvature of the strand at a wire's nodes, (n_nodes, n_instants), 1/m."""
        share = np.ones(self.elements + 1)
        if self.is_clamped:
            distance = np.linspace(0.0, self.length, len(share))
            share = np.exp(-distance / self.falls_off())
        return np.outer(share, self.path("load"))

    def _length_of(self, layer: int) -> float:
        """Length of the wires of a layer, m: to the clamp, or half a turn."""
        lay = self.section.layers[layer].lay
        if self.is_clamped:
            return float(self.length / np.cos(lay))
        return float(np.pi * self.section.radii[layer] / abs(np.sin(lay)))

    def sentence(self) -> str:
        """Describe the strand in a sentence."""
        bent = shared.acting(
            self.path("load"), "bent up", "bent down", "bent up and down"
        )
        where = "alike all along"
        if self.is_clamped:
            where = "near a clamp"
        tension = ""
        if self.tension_load != "steady":
            tension = "; its tension changes"
        strand = f"A strand of {self.section.wires} wires"
        if np.any(self.path("tension_load")):
            strand = f"{strand}, under tension,"
        return f"{strand} is {bent} {where}{tension}."

    def bent_strand(self) -> BentStrand | None:
        """Closed form of a strand of uniform curvature under constant tension."""
        tension = self.path("tension_load")
        is_known = not self.is_clamped and self.law == FrictionLaw()
        factors = shared.factors_of(self)
        rubs = self.friction and factors.all()
        if not is_known or np.ptp(tension) or not tension[0] or not rubs:
            return None
        return BentStrand(self.section, self.friction, float(tension[0]), factors)

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterator[ExactCurve]:
        """Moment over the curvature, where a closed form is known."""
        strand = self.bent_strand()
        if strand is not None:
            curvature = self.path("load")
            yield ExactCurve("loop", curvature, strand.along(curvature))
