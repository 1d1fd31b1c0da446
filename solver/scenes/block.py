"""A rectangular body on a rigid rough support: Signorini contact, Coulomb friction."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
import param

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.drives import Drive, loads_at
from solver.discrete.plane.rigid_stack import loss_of_equilibrium
from solver.discrete.plane.sides import Given, Side, Spring, Support
from solver.discrete.plane.stack import Stack
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.reference.closed_forms import ExactCurve
from solver.refusal import plain
from solver.scenes.exact import exact_on_spring, exact_parabola
from solver.scenes.plane import RectangleSettings
from solver.settings.definitions import (
    BODY,
    CONTACT,
    CurveParameter,
    Rows,
    SettingGroup,
    TablePreset,
    about,
    redefined,
)
from solver.settings.load import POINTS, as_points
from solver.settings.load_paths import PRESETS
from solver.settings.profiles import UNSEEN, gap_at, off_nodes
from solver.settings.scene import Icon

BODY_FORCE = SettingGroup("Body force")
LOADED_SIDES = ("left", "right", "top")


class Prescribed(NamedTuple):
    """Components of the displacement of a side that are prescribed.

    Of the others the traction is given.
    """

    normal: bool
    tangential: bool


PRESCRIBED: dict[str, Prescribed] = {
    "free": Prescribed(normal=False, tangential=False),
    "roller": Prescribed(normal=True, tangential=False),
    "clamped": Prescribed(normal=True, tangential=True),
    "displacement": Prescribed(normal=True, tangential=True),
    "traction": Prescribed(normal=False, tangential=False),
    "pushed": Prescribed(normal=True, tangential=False),
    "dragged": Prescribed(normal=False, tangential=True),
}
"""Prescribed components by the kinds of a side."""
AT_REST = ("free", "roller", "clamped")
"""Kinds of a side of which all that is given is zero."""


def _kind_of(side: str) -> param.Selector[str]:
    """Define the kind of a side: which of its components are prescribed."""
    group = SettingGroup(side.capitalize())
    return group.choice(
        "free",
        PRESCRIBED,
        "What is given. free: nothing. roller: no normal displacement. clamped: no "
        "displacement. displacement: both displacements. traction: both tractions. "
        "pushed: normal displacement, tangential traction. dragged: tangential "
        "displacement, normal traction.",
        title=f"{side.capitalize()} side",
    )


@dataclass(frozen=True)
class SideLoad:
    """Definitions of the settings of one component of the load of a side.

    The component is a traction or a displacement, as the kind of the side says. It has
    a mean along the side, a slope along the side, and a path over time.
    """

    side: str
    component: Literal["normal", "tangential"]

    def traction(self) -> param.Number[float]:
        """Define the mean of a traction."""
        return self._mean(
            "traction",
            "Pa",
            bounds=(-1e15, 1e15),
            slider=(-2e8, 2e8),
            applies=lambda settings: (
                self._is_given(settings) and not self._is_prescribed(settings)
            ),
        )

    def displacement(self) -> param.Number[float]:
        """Define the mean of a displacement."""
        return self._mean(
            "displacement",
            "m",
            bounds=(-1e12, 1e12),
            slider=(-1e-4, 1e-4),
            applies=lambda settings: (
                self._is_given(settings) and self._is_prescribed(settings)
            ),
        )

    def slope(self) -> param.Number[float]:
        """Define the share by which the value changes from the middle to an end."""
        return self._group.quantity(
            0.0,
            (-1e6, 1e6),
            (-1.0, 1.0),
            "How unevenly the value is spread along the side: from the mean times 1 - "
            "slope at its lower or left end to the mean times 1 + slope at the other, "
            "and linear between.",
            applies=self._is_given,
        )

    def path(self) -> CurveParameter:
        """Define the path over time, of a traction as of a displacement."""
        return self._group.curve(
            "hold" if self.component == "normal" else "delayed",
            PRESETS,
            {"time": "s", "value": "Pa or m"},
            f"{self._title} value over time: a preset that reaches the mean, or points "
            "(s, Pa or m).",
            title=f"{self._title} path",
            applies=self._is_given,
        )

    def _mean(
        self,
        quantity: str,
        unit: str,
        *,
        bounds: tuple[float, float],
        slider: tuple[float, float],
        applies: Callable[[Any], bool],
    ) -> param.Number[float]:
        """Define the mean of a quantity along the side."""
        towards = "outward"
        if self.component == "tangential":
            towards = f"along {self._axis}"
        return self._group.quantity(
            0.0,
            bounds,
            slider,
            f"Mean {self.component} {quantity} of the {self.side} side, positive "
            f"{towards}.",
            unit=unit,
            applies=applies,
            path=f"{self.side}_{self.component}_load",
            places=(f"{self.side} {self._axis}",),
        )

    @property
    def _group(self) -> SettingGroup:
        """Heading of the side."""
        return SettingGroup(self.side.capitalize())

    @property
    def _title(self) -> str:
        """Words on the component."""
        return f"{self._group.name} {self.component}"

    @property
    def _axis(self) -> str:
        """Axis of the component: the top side runs along x, the others along y."""
        is_along_x = (self.side == "top") == (self.component == "tangential")
        return "x" if is_along_x else "y"

    def _is_given(self, settings: Any) -> bool:
        """Return whether anything but rest is given along the side."""
        return getattr(settings, self.side) not in AT_REST

    def _is_prescribed(self, settings: Any) -> bool:
        """Return whether the component is a displacement."""
        kind = getattr(settings, self.side)
        return bool(getattr(PRESCRIBED[kind], self.component))


LEFT_NORMAL = SideLoad("left", "normal")
LEFT_TANGENTIAL = SideLoad("left", "tangential")
RIGHT_NORMAL = SideLoad("right", "normal")
RIGHT_TANGENTIAL = SideLoad("right", "tangential")
TOP_NORMAL = SideLoad("top", "normal")
TOP_TANGENTIAL = SideLoad("top", "tangential")


class SideSettings(RectangleSettings):
    """Settings of a rectangle whose left, right and top side can be held or loaded."""

    left = _kind_of("left")
    left_normal_traction = LEFT_NORMAL.traction()
    left_normal_displacement = LEFT_NORMAL.displacement()
    left_normal_slope = LEFT_NORMAL.slope()
    left_normal_load = LEFT_NORMAL.path()
    left_tangential_traction = LEFT_TANGENTIAL.traction()
    left_tangential_displacement = LEFT_TANGENTIAL.displacement()
    left_tangential_slope = LEFT_TANGENTIAL.slope()
    left_tangential_load = LEFT_TANGENTIAL.path()

    right = _kind_of("right")
    right_normal_traction = RIGHT_NORMAL.traction()
    right_normal_displacement = RIGHT_NORMAL.displacement()
    right_normal_slope = RIGHT_NORMAL.slope()
    right_normal_load = RIGHT_NORMAL.path()
    right_tangential_traction = RIGHT_TANGENTIAL.traction()
    right_tangential_displacement = RIGHT_TANGENTIAL.displacement()
    right_tangential_slope = RIGHT_TANGENTIAL.slope()
    right_tangential_load = RIGHT_TANGENTIAL.path()

    top = _kind_of("top")
    top_normal_traction = TOP_NORMAL.traction()
    top_normal_displacement = TOP_NORMAL.displacement()
    top_normal_slope = TOP_NORMAL.slope()
    top_normal_load = TOP_NORMAL.path()
    top_tangential_traction = TOP_TANGENTIAL.traction()
    top_tangential_displacement = TOP_TANGENTIAL.displacement()
    top_tangential_slope = TOP_TANGENTIAL.slope()
    top_tangential_load = TOP_TANGENTIAL.path()

    def side(self, side: str) -> Side:
        """Load of a side: its components along x and y."""
        normal = self._given(side, "normal")
        tangential = self._given(side, "tangential")
        if side == "top":
            return Side(tangential, normal)
        return Side(normal, tangential)

    def _given(self, side: str, component: str) -> Given:
        """Displacement or traction of a side over time."""
        kind = getattr(self, side)
        prescribed: bool = getattr(PRESCRIBED[kind], component)
        if kind in AT_REST:
            rest = np.zeros(self.n_instants)
            return Given(prescribed, rest, rest)
        # On the left side outward is the negative x direction.
        sign = -1.0 if side == "left" and component == "normal" else 1.0
        mean = sign * self.path(f"{side}_{component}_load")
        slope = mean * getattr(self, f"{side}_{component}_slope")
        return Given(prescribed, mean, slope)


def _gap_points(settings: BlockSettings) -> Rows:
    """Table of the gap of a preset: points (position, gap), m."""
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
                unit = about(self.definitions()[name]).unit
                drives.append(Drive(name, unit, values))
        return tuple(drives)

    def left_out(self) -> Iterator[str]:
        """Yield sentences on parts of tables that a run leaves out, as of the gap."""
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
        loss = loss_of_equilibrium(self.structure())
        if loss is not None:
            time, reason = loss
            loads = loads_at(self.drives(), int(np.searchsorted(self.times(), time)))
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

    def structure(self) -> Stack:
        """Make the block; one metre thick."""
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
        clauses = [*self._side_clauses(), *self._other_clauses()]
        done = "left alone"
        if clauses:
            done = shared.listed(clauses)
        return f"{block} lies on a {support} {rough} support; it is {done}."

    def _side_clauses(self) -> Iterator[str]:
        """Yield clauses on the loads and motions of the sides."""
        for side in LOADED_SIDES:
            if getattr(self, side) in AT_REST:
                continue
            actions = []
            inward = -self.path(f"{side}_normal_load")
            if inward.any():
                actions.append(shared.acting(inward, "pressed", "pulled"))
            along = self.path(f"{side}_tangential_load")
            if along.any():
                actions.append(shared.acting(along, "moved", "moved back"))
            if actions:
                yield f"{shared.listed(actions)} at its {side}"

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
        """Tractions on a parabola, by a solution's forces, or the slide on a spring."""
        body = self.structure()
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
