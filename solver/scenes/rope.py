"""A strand of helical wires, stretched and bent (solver/README.md, 6)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.discrete.problem import Problem
from solver.discrete.rope.cross_section import (
    CONSTRUCTIONS,
    MOST_LAYERS,
    CrossSection,
    laid,
)
from solver.discrete.rope.rope import Rope, RopeWire
from solver.discrete.structure import LoopFields
from solver.laws import FrictionLaw
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.bent_strand import BentStrand
from solver.refusal import RefusedError
from solver.settings.definitions import POSITIVE, Rows, TablePreset, redefined
from solver.settings.load_paths import PRESSURES
from solver.settings.scene import Icon, Settings

MOST_WIRES = 1000
"""Of a construction of one's own."""


STRANDS = {
    "mooring": "a spiral strand of 5 mm steel wires, 6, 12, 18, ... a layer on a core wire",
    "seven-wire": "prestressing strand of 15.7 mm",
    "conductor": "an overhead conductor of 28 mm, 26 aluminium wires on 7 of steel (Drake)",
}
"""A line on each of the constructions."""


def _rows(settings: Any) -> Rows:
    rows: Rows = settings.section.rows
    return rows


class RopeSettings(Settings):
    """Settings of the strand; by default 37 wires near a clamp, bent up, down and up again."""

    scene = "rope"
    title = "Spiral strand, bent"
    source = "closed form: slip spreads from the neutral axis (Papailiou 1997)"
    icon = Icon(
        ground="M5 3V29",
        body="M5 8C18 8 28 9 42 14L40 24C28 19 18 18 5 18ZM11 8L15 18M18 8L22 19M25 9L29 20"
        "M32 11L35 22",
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
    jumps = 0

    construction = shared.STRAND.curve(
        "mooring",
        {name: TablePreset(line, _rows) for name, line in STRANDS.items()},
        {"wires": "", "diameter": "m", "lay angle": "°", "modulus": "Pa"},
        "Wires of the strand: a preset, or rows, inside out: wires, their diameter (m), lay angle "
        "(°, negative the other way round) and Young's modulus (Pa); the first row is the core, 1 "
        "wire of 0°.",
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
        "Largest curvature that the preset reaches, uniform or at the clamp: 1 over the radius to "
        "which the strand is bent. Sections stay plane, so each wire is stretched and pressed as "
        "it goes round.",
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
        "Tension of the strand, by which wires press on what is below them. About a quarter of "
        "what they break at: 250 kN of 37 mooring wires, 70 kN seven-wire, 30 kN conductor. It is "
        "bent without untwisting, and what friction adds to a wire's tension presses no harder.",
        "steady",
        PRESSURES,
        bounds=POSITIVE,
        places=("right x",),
    )
    instants = redefined(Settings.param["instants"], 61)
    bending = shared.STRAND.choice(
        "clamp",
        ["uniform", "clamp"],
        "uniform: the same curvature all along; wires of a layer are then alike, and one of each "
        "stands for all. clamp: the curvature falls away from a clamp, and every wire is there.",
        title="Where it is bent",
    )
    fall_off = shared.STRAND.quantity(
        0.0,
        (0.0, 1e4),
        (0.0, 1.0),
        "Distance λ from the clamp at which the curvature is exp(-1) of that at the clamp. 0: "
        "sqrt(E I / T), of the bending stiffness while nothing slips and the largest tension.",
        title="Fall-off λ",
        unit="m",
        applies=lambda settings: settings.bending == "clamp",
    )
    length = shared.STRAND.quantity(
        0.6,
        (1e-3, 1e3),
        (0.1, 5.0),
        "Length of strand from the clamp on; beyond it nothing slips. Some three times λ.",
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
        "Number of linear elements of a wire: of its length, or of half a turn where it is bent "
        "alike all along.",
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
        """The strand's cross-section."""
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
        """Whether the curvature falls away from a clamp."""
        return bool(self.bending == "clamp")

    @property
    def n_bodies(self) -> int:
        """Number of wires whose slip is sought; the core does not slip."""
        section = self.section
        if self.is_clamped:
            return section.wires - 1
        return len(section.layers)

    @property
    def n_interfaces(self) -> int:
        """Number of interfaces between layers, and of the first with the core."""
        return len(self.section.layers)

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`, N/m^2."""
        layers = self.section.layers
        longest = max(self._length_of(layer) for layer in range(len(layers)))
        return float(max(layer.stiffness for layer in layers) / longest**2)

    def check_together(self) -> None:
        """Refuse a curvature that no fall-off is known of."""
        super().check_together()
        shared.factors_of(self)
        if (
            self.is_clamped
            and self.fall_off == 0.0
            and not self.path("tension_load").any()
        ):
            raise self.refusal(
                "fall_off",
                "a distance above 0, where there is no tension to tell it",
                "give the fall-off, or a tension",
            )

    def falls_off(self) -> float:
        """Distance over which the curvature falls to exp(-1), m."""
        if self.fall_off:
            return float(self.fall_off)
        return float(
            np.sqrt(self.section.stuck_bending / self.path("tension_load").max())
        )

    def structure(self) -> Rope:
        """Make the strand.

        Wires of a layer pass every fibre, one after the other: under a uniform
        curvature half a turn of one of them, from the outermost fibre to the innermost,
        which do not slip, is all there is.
        """
        curvature = self.path("load")
        tension = self.path("tension_load")
        bounds = self.section.friction_bounds(
            tension, self.friction, shared.factors_of(self)
        )
        if self.tension_load == "steady":
            bounds = bounds[:, 0]
        share = np.ones(self.elements + 1)
        if self.is_clamped:
            share = np.exp(
                -np.linspace(0.0, self.length, len(share)) / self.falls_off()
            )
        along = np.outer(share, curvature)
        wires = [
            RopeWire(
                layer=layer,
                number=number,
                made=own,
                radius=self.section.radii[layer],
                start=2.0 * np.pi * number / own.wires,
                length=self._length_of(layer),
                bound=bounds[layer],
                curvature=along,
                tension=self.section.wire_tension(layer, tension),
                stands_for=1 if self.is_clamped else own.wires,
            )
            for layer, own in enumerate(self.section.layers)
            for number in range(own.wires if self.is_clamped else 1)
        ]
        return Rope(
            wires=wires,
            substructures=self.substructures,
            tension=tension,
            curvature=curvature,
            is_clamped=self.is_clamped,
            section=self.section,
            instants=self.times(),
            duration=self.duration,
            friction_law=self.law,
        )

    def _length_of(self, layer: int) -> float:
        """Length of its wires that is seen, m: down to the clamp, or half round the strand."""
        lay = self.section.layers[layer].lay
        if self.is_clamped:
            return float(self.length / np.cos(lay))
        return float(np.pi * self.section.radii[layer] / abs(np.sin(lay)))

    def sentence(self) -> str:
        """The strand in a sentence."""
        bent = shared.acting(
            self.path("load"), "bent up", "bent down", "bent up and down"
        )
        if self.is_clamped:
            where = "near a clamp"
        else:
            where = "alike all along"
        if self.tension_load == "steady":
            tension = ""
        else:
            tension = "; its tension changes"
        wires = self.section.wires
        return f"A strand of {wires} wires, under tension, is {bent} {where}{tension}."

    def bent_strand(self) -> BentStrand | None:
        """Closed form of a strand that is bent alike all along, under a tension that stays."""
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
