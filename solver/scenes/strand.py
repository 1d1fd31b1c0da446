"""Parallel elastic wires with friction, one of them broken (MATHEMATICS.md, 6)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.pulled_bar import broken_wire
from solver.refusal import plain
from solver.settings.definitions import LOAD, POSITIVE, redefined
from solver.settings.load_paths import PULLS
from solver.settings.scene import Icon, Settings


class StrandSettings(Settings):
    """Settings of the strand; by default the middle one of three wires is broken.

    The broken wire then regains its force over 0.2 m on either side of the break.
    """

    scene = "strand"
    title = "Parallel wires, one broken"
    source = "closed form: force regained over T / (mu p)"
    icon = Icon(
        ground="M5 3V29",
        body="M5 6H37V11H5ZM5 14H18V19H5ZM23 14H37V19H23ZM5 22H37V27H5Z",
        load="M38 16H47M43 12L47 16L43 20",
    )
    kind = "wires"
    CHIEF = ("load", "peak")
    SMALL: ClassVar = {"elements": 10, "instants": 11}
    GROWS = ("wires",)
    PARTS: ClassVar = {"substructures": "elements", "broken": "wires"}

    peak, load = shared.sized_path(
        "load",
        "tension",
        "N",
        600.0,
        (0.0, 1e15),
        (0.0, 1500.0),
        "Largest tension of a wire that the preset reaches.",
        "cycle",
        PULLS,
        bounds=POSITIVE,
        title="Peak tension",
        places=("right x",),
    )
    grip = LOAD.choice(
        "force",
        ["force", "displacement"],
        "What is given at the right end. force: the same force for every wire. "
        "displacement: the same displacement for all, that which an unbroken wire "
        "needs for this force.",
    )
    friction = shared.friction("mu between neighbouring wires")
    friction_factors = shared.friction_factors("between two wires, from the first on")
    pressure, pressure_load = shared.pressure(
        "neighbouring wires on each other", 20_000.0
    )
    wires = shared.STRAND.count(
        3,
        (2, 200),
        (2, 20),
        "Number of wires side by side; each rubs on the one before it and the one "
        "after it.",
    )
    broken = shared.STRAND.count(
        2,
        (0, 200),
        (0, 20),
        "Which wire is broken, counted from 1; 0: none.",
        title="Broken wire",
    )
    break_position = shared.STRAND.quantity(
        0.5,
        (0.0, 1.0),
        (0.0, 1.0),
        "Where the wire is broken, as a share of the length; at the nearest node "
        "between the ends.",
        title="Position of the break",
        applies=lambda settings: settings.broken > 0,
    )
    elements = shared.STRAND.count(
        60,
        (2, 20_000),
        (10, 400),
        "Number of linear elements of a wire, equal in length.",
        title="Elements per wire",
    )
    substructures = redefined(
        Settings.param["substructures"],
        6,
        doc="Number of pieces (substructures) that a wire is cut into, at least two "
        "where one is broken: all wires are cut at the break, and alike.",
        title="Substructures per wire",
    )
    length = shared.size(
        1.0, (0.1, 10.0), "Length L", "Length of the wires.", shared.STRAND
    )
    young = shared.young(shared.STRAND)
    section = shared.section("Area of the cross section of a wire.", shared.STRAND)

    @property
    def n_bodies(self) -> int:
        """Number of wires."""
        return int(self.wires)

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`, N/m^2."""
        return float(self.young * self.section / self.length**2)

    def check_together(self) -> None:
        """Refuse tables without a factor per interface, and unbalanced tensions."""
        super().check_together()
        shared.factors_of(self)
        self._check_equilibrium(self.path("load"))

    @cached_property
    def bodies(self) -> Rods:
        """The strand.

        The wires are at rest and free of stress before the first instant.
        """
        stiffness = self.young * self.section
        load = self.path("load")
        right = End(load)
        if self.grip == "displacement":
            right = End(displacement=load * self.length / stiffness)
        broken = None
        if self.broken:
            broken = self.broken, self._break_node()
        return Rods(
            length=self.length,
            stiffness=stiffness,
            elements=self.elements,
            substructures=self.substructures,
            strength=shared.strength(self, np.ones(self.elements + 1)),
            left=End(displacement=np.zeros_like(load)),
            right=right,
            instants=self.times(),
            duration=self.duration,
            pressure=self.path("pressure_load"),
            wires=self.wires,
            factors=shared.factors_of(self),
            broken=broken,
            friction_law=self.law,
        )

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterator[ExactCurve]:
        """Forces of the broken wire and of its neighbours, by a closed form."""
        strand = self.bodies
        exact = broken_wire(strand)
        if exact is not None:
            for force in (exact.force, exact.neighbour_force):
                yield ExactCurve("axial force", strand.nodes, force)

    def sentence(self) -> str:
        """Describe the strand in a sentence."""
        kind = "steel" if shared.is_steel(self.young) else "elastic"
        wires = f"{self.wires} {kind} wires"
        if self.broken:
            wires = f"{wires}, number {self.broken} broken,"
        pulled = shared.acting(self.path("load"), "pulled", "pushed")
        if self.grip == "displacement":
            pulled = f"{pulled} by one grip"
        if self.pressure_load != "steady":
            pulled = f"{pulled}; what presses them together changes"
        touch = "rub on"
        if not np.any(self.law.bound_before_slip(self.bodies.strength)):
            touch = "slide freely on"
        return f"{wires} {touch} each other; their right ends are {pulled}."

    def _break_node(self) -> int:
        """Index of the node at which the wire is broken, inside the wire."""
        node = round(self.break_position * self.elements)
        return min(max(node, 1), self.elements - 1)

    def _check_equilibrium(self, tension: Array) -> None:
        """Refuse tensions, (n_instants,), N, that pull the broken wire's end out."""
        if self.grip != "force" or not self.broken:
            return
        share = 1.0 - self._break_node() / self.elements
        factors = shared.factors_of(self)
        beside = factors[max(self.broken - 2, 0) : self.broken].tolist()
        pressed = self.friction * self.path("pressure_load")
        strength = np.sum(
            [self.law.bound_before_slip(factor * pressed) for factor in beside], axis=0
        )
        # Friction alone holds the wire beyond its break.
        friction = share * self.length * strength * self.law.largest_factor
        worst = int(np.argmax(tension - friction))
        largest = float(tension[worst])
        capacity = float(friction[worst])
        if largest > capacity or largest == capacity > 0.0:
            raise self.refusal(
                self.size_or_table("load"),
                f"tensions below {plain(capacity)} N, all that friction can hold of "
                "the broken wire beyond its break",
                "pull less, raise friction or pressure, move the break to the left, or "
                "take the grip of given displacement",
            )
