"""A rectangular body on a rigid rough support: Signorini contact, Coulomb friction."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.drives import Drive, describe_loads
from solver.discrete.plane.rectangles.rigid_stack import loss_of_equilibrium
from solver.discrete.plane.rectangles.sides import Spring, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.reference.closed_forms import ExactCurve
from solver.refusal import plain
from solver.scenes.exact import exact_on_spring, exact_parabola
from solver.scenes.side_loads import LOADED_SIDES, PRESCRIBED, SideSettings
from solver.settings.definitions import (
    BODY,
    CONTACT,
    Rows,
    SettingGroup,
    TablePreset,
    properties_of,
    redefined,
)
from solver.settings.load import POINTS, as_points
from solver.settings.load_paths import PRESETS
from solver.settings.profiles import UNSEEN, gap_at, off_nodes
from solver.settings.scene import Icon

BODY_FORCE = SettingGroup("Body force")


def _gap_points(settings: BlockSettings) -> Rows:
    """Table of a preset of the gap: points (position, gap), m."""
    x = np.linspace(0.0, settings.length, POINTS)
    return as_points(x, settings.gap_at(x))


class BlockSettings(SideSettings):
    """Settings of the block; by default it is pressed, then sheared to and fro."""

    scene = "block"
    title = "Block pressed and sheared"
    source = "Johnson, Contact Mechanics, 1985, ch. 4 and 7"
    icon = Icon(
        ground="M4 25H44M11 25l-3 4M18 25l-3 4M25 25l-3 4M32 25l-3 4M39 25l-3 4",
        body="M12 11H36V24H12Z",
        load="M24 1V9M20 5L24 9L28 5M32 7H44M40 3L44 7L40 11",
    )
    CHIEF = ("top_tangential_load", "top_tangential_displacement")

    gap = CONTACT.curve(
        "parabola",
        {
            "flat": TablePreset("no opening anywhere", _gap_points),
            "parabola": TablePreset(
                "that of a round body of the radius R, 0 in the middle", _gap_points
            ),
        },
        {"position": "m", "gap": "m"},
        "Opening between the undeformed body and its support: a preset, or points (m, "
        "m).",
    )
    radius = CONTACT.quantity(
        5.0,
        (1e-9, 1e15),
        (0.5, 50.0),
        "Radius R of the parabola; the gap is (x - length / 2)^2 / (2 R).",
        title="Radius R",
        unit="m",
        applies=lambda settings: settings.gap == "parabola",
    )
    spring = CONTACT.quantity(
        0.0,
        (0.0, 1e18),
        (0.0, 1e8),
        "Stiffness of a spring that pulls the foot of the right side back as it moves "
        "to the left, for a metre of thickness. 0: none.",
        title="Spring stiffness",
        unit="N/m",
        applies=lambda settings: not any(PRESCRIBED[settings.right]),
    )
    elements = BODY.count(
        48,
        (1, 5000),
        (8, 192),
        "Number of elements along a body, equal in size.",
        title="Elements along",
    )
    length = shared.size(0.1, (0.01, 1.0), "Length", "Length of the body.", BODY)
    height = shared.size(
        0.05,
        (0.01, 1.0),
        "Height",
        "Height of the body. Shear bends one as high as long: its foot tilts, and a "
        "contact on a parabola rolls.",
        BODY,
    )
    body_force_x = BODY_FORCE.quantity(
        0.0,
        (-1e15, 1e15),
        (-1e9, 1e9),
        "Largest force per volume along x.",
        title="Body force along x",
        unit="N/m^3",
        places=("body",),
    )
    body_force_y = BODY_FORCE.quantity(
        0.0,
        (-1e15, 1e15),
        (-1e9, 1e9),
        "Largest force per volume along y, upward; weight is negative.",
        title="Body force along y",
        unit="N/m^3",
        places=("body",),
    )
    body_load = BODY_FORCE.preset(
        "hold",
        PRESETS,
        "Path of the body force over time: a preset of both components.",
        title="Path of the body force",
        applies=lambda settings: (
            settings.body_force_x != 0.0 or settings.body_force_y != 0.0
        ),
    )
    top = redefined(SideSettings.param["top"], "displacement")
    top_normal_displacement = redefined(
        SideSettings.param["top_normal_displacement"], -4e-5
    )
    top_tangential_displacement = redefined(
        SideSettings.param["top_tangential_displacement"], 2e-5
    )

    def drives(self) -> tuple[Drive, ...]:
        """Non-zero loads and motions over time, with those of the body force."""
        drives = list(super().drives())
        force = self._body_force()
        if force is None:
            return tuple(drives)
        for name, values in zip(("body_force_x", "body_force_y"), force, strict=True):
            if np.any(values):
                unit = properties_of(self.definitions()[name]).unit
                drives.append(Drive(name, unit, values))
        return tuple(drives)

    def left_out(self) -> Iterator[str]:
        """Yield sentences on points of the gap's table that lie between nodes."""
        yield from super().left_out()
        if isinstance(self.gap, str):
            return
        off = off_nodes(self.gap, self.length, self.elements)
        tolerance = UNSEEN * float(np.ptp(np.array(self.gap)[:, 1]))
        if off.max() <= tolerance:
            return
        count = np.count_nonzero(off > tolerance)
        farthest = plain(float(f"{off.max():.3g}"))
        yield (
            f"gap: {count} of {len(self.gap)} points lie between nodes, up "
            f"to {farthest} m off the line through them; what is lower "
            "than both nodes counts at the nearer one, for all of its share; "
            f"{self._enough_elements(tolerance)} elements would see it"
        )

    def _enough_elements(self, tolerance: float) -> str:
        """Smallest number of elements whose nodes follow the table of the gap."""
        largest: int = self.definitions()["elements"].bounds[1]
        for count in range(self.elements + 1, largest + 1):
            if off_nodes(self.gap, self.length, count).max() <= tolerance:
                return str(count)
        return f"more than {largest}"

    def check_together(self) -> None:
        """Refuse loads under which contact alone cannot hold the body."""
        super().check_together()
        loss = loss_of_equilibrium(self.bodies)
        if loss is not None:
            time, reason = loss
            loads = describe_loads(
                self.drives(), int(np.searchsorted(self.times(), time))
            )
            when = f"from {plain(time)} s on"
            if loads:
                when = f"with {loads}, {when},"
            raise self.refusal(
                "top",
                "sides and loads that leave the body in equilibrium",
                f"contact does not hold it, as {when} {reason}: lower that load, "
                "press more, raise friction where it slides, take a longer or lower "
                "body where it tips, or hold a side",
            )

    @cached_property
    def bodies(self) -> Stack:
        """The block; one metre thick."""
        sides = {side: self.side(side) for side in LOADED_SIDES}
        if isinstance(self.gap, str):
            gap = self.gap_at(self.places)
        else:
            gap = gap_at(self.gap, self.places)
        spring = None
        if self.has("spring"):
            spring = Spring(0.0, self.spring)
        return replace(
            self.stack(),
            support=Support(gap, self.friction_at_nodes()),
            sides=sides,
            body_force=self._body_force(),
            spring=spring,
        )

    def sentence(self) -> str:
        """Describe the block in a sentence."""
        block = "An elastic block"
        if shared.is_steel(self.young):
            block = "A steel block"
        support = {"flat": "flat", "parabola": "round"}.get(str(self.gap), "uneven")
        rough = "rough" if self.is_rough else "smooth"
        clauses = [*self.side_clauses(), *self._other_clauses()]
        done = "left alone"
        if clauses:
            done = shared.listed(clauses)
        return f"{block} lies on a {support} {rough} support; it is {done}."

    def _other_clauses(self) -> Iterator[str]:
        """Yield clauses on the body force, the spring and clamped sides."""
        if self._body_force() is not None:
            yield "loaded all through"
        if self.has("spring"):
            yield "pulled back by a spring"
        for side in LOADED_SIDES:
            if getattr(self, side) == "clamped":
                yield f"held at its {side}"

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterable[ExactCurve]:
        """Closed forms: tractions under a parabola, or the slide on a spring."""
        body = self.bodies
        if self.gap != "parabola":
            return exact_on_spring(body)
        if solution is None:
            return ()
        return exact_parabola(body, self.radius, problem, solution)

    def gap_at(self, x: Array) -> Array:
        """Gap of a preset at positions along the lowest side, both (n_nodes,), m."""
        if self.gap == "flat":
            return np.zeros_like(x)
        return np.asarray((x - 0.5 * self.length) ** 2 / (2.0 * self.radius))

    def _body_force(self) -> Array | None:
        """Body force over time, shape (2, n_instants), N/m^3; None without one."""
        sizes = np.array([self.body_force_x, self.body_force_y])
        if not sizes.any():
            return None
        phases = self.times() / self.duration
        return sizes[:, None] * PRESETS[self.body_load].value(
            phases, self.seed, self.cycles
        )
