"""A rectangular body on a rigid rough support: Signorini contact with Coulomb friction."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.drives import Drive, loads_at
from solver.discrete.plane.rigid_stack import loss_of_equilibrium
from solver.discrete.plane.stack import Given, Side, Spring, Stack, Support
from solver.discrete.problem import Problem
from solver.discrete.structure import LoopFields
from solver.reference.closed_forms import ExactCurve
from solver.refusal import plain
from solver.scenes.exact import exact_on_spring, exact_parabola
from solver.scenes.plane import PlaneSettings
from solver.settings.definitions import (
    BODY,
    CONTACT,
    Parameter,
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
COMPONENTS = ("normal", "tangential")
PRESCRIBED: dict[str, tuple[bool, bool]] = {
    "free": (False, False),
    "roller": (True, False),
    "clamped": (True, True),
    "displacement": (True, True),
    "traction": (False, False),
    "pushed": (True, False),
    "dragged": (False, True),
}
"""Whether the normal and the tangential displacement are prescribed; a traction is,
otherwise."""
AT_REST = ("free", "roller", "clamped")
MEANS = (("traction", "Pa", 1e15, 2e8), ("displacement", "m", 1e12, 1e-4))
"""What is given along a side: its unit, its largest size, and where its slider ends."""


def _is_given(
    side: str, component: str, prescribed: bool | None = None
) -> Callable[..., bool]:
    """Make the test whether anything but rest is given along a side, and is of this kind."""

    def applies(settings: PlaneSettings) -> bool:
        kind = getattr(settings, side)
        own = PRESCRIBED[kind][COMPONENTS.index(component)]
        return kind not in AT_REST and prescribed in (None, own)

    return applies


def _settings_of(side: str, component: str) -> dict[str, Parameter]:
    """Settings of what is given: how large it is, how it varies along the side, and over time."""
    along = "x" if side == "top" else "y"
    if component == "normal":
        towards = "outward"
    else:
        towards = f"along {along}"
    if component == "tangential":
        axis = along
    else:
        axis = "yx"["xy".index(along)]
    name = f"{side}_{component}"
    group = SettingGroup(side.capitalize())
    title = f"{group.name} {component}"
    given = _is_given(side, component)
    means = {
        f"{name}_{kind}": group.quantity(
            0.0,
            (-most, most),
            (-end, end),
            f"Mean {component} {kind} of the {side} side, positive {towards}.",
            unit=unit,
            applies=_is_given(side, component, kind == "displacement"),
            path=f"{name}_load",
            places=(f"{side} {axis}",),
        )
        for kind, unit, most, end in MEANS
    }
    return means | {
        f"{name}_slope": group.quantity(
            0.0,
            (-1e6, 1e6),
            (-1.0, 1.0),
            "How unevenly the value is spread along the side: from the mean times 1 - slope at "
            "its lower or left end to the mean times 1 + slope at the other, and linear between.",
            applies=given,
        ),
        f"{name}_load": group.curve(
            "hold" if component == "normal" else "delayed",
            PRESETS,
            {"time": "s", "value": "Pa or m"},
            f"{title} value over time: a preset that reaches the mean, or points (s, Pa or m).",
            title=f"{title} path",
            applies=given,
        ),
    }


class SideSettings(PlaneSettings):
    """Settings of a rectangle whose left, right and top side can be held or loaded."""

    def side(self, side: str) -> Side:
        """What is given along a side, for x and y."""
        normal, tangential = (self._given(side, component) for component in COMPONENTS)
        if side == "top":
            return Side(tangential, normal)
        return Side(normal, tangential)

    def _given(self, side: str, component: str) -> Given:
        kind = getattr(self, side)
        prescribed = PRESCRIBED[kind][COMPONENTS.index(component)]
        if kind in AT_REST:
            rest = np.zeros(self.n_instants)
            return Given(prescribed, rest, rest)
        sign = -1.0 if side == "left" and component == "normal" else 1.0
        mean = sign * self.path(f"{side}_{component}_load")
        return Given(
            prescribed, mean, mean * getattr(self, f"{side}_{component}_slope")
        )


for _side in LOADED_SIDES:
    _kind = SettingGroup(_side.capitalize()).choice(
        "free",
        PRESCRIBED,
        "What is given. free: nothing. roller: no normal displacement. clamped: no displacement. "
        "displacement: both displacements. traction: both tractions. pushed: normal displacement, "
        "tangential traction. dragged: tangential displacement, normal traction.",
        title=f"{_side.capitalize()} side",
    )
    SideSettings.param.add_parameter(_side, _kind)
    for _component in COMPONENTS:
        for _name, _definition in _settings_of(_side, _component).items():
            SideSettings.param.add_parameter(_name, _definition)


def _gap_points(settings: BlockSettings) -> Rows:
    x = np.linspace(0.0, settings.length, POINTS)
    return as_points(x, settings.gap_at(x))


class BlockSettings(SideSettings):
    """Settings of the block; by default it is pressed from above, then sheared to and fro."""

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
        "Opening between the undeformed body and its support: a preset, or points (m, m).",
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
        "Stiffness of a spring that pulls the foot of the right side back as it moves to the left, "
        "for a metre of thickness. 0: none.",
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
        "Height of the body. Shear bends one as high as long: its foot tilts, and a contact on a "
        "parabola rolls.",
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
        """Loads and motions over time that are not zero, both components of the body force too."""
        found = list(super().drives())
        force = self._body_force()
        if force is None:
            return tuple(found)
        for name, values in zip(("body_force_x", "body_force_y"), force, strict=True):
            if np.any(values):
                found.append(Drive(name, about(self.definitions()[name]).unit, values))
        return tuple(found)

    def left_out(self) -> Iterator[str]:
        """Yield what a run does not see of its tables, the gap among them."""
        yield from super().left_out()
        if isinstance(self.gap, str):
            return
        off = off_nodes(self.gap, self.length, self.elements)
        most = UNSEEN * float(np.ptp(np.array(self.gap)[:, 1]))
        if off.max() <= most:
            return
        largest = self.definitions()["elements"].bounds[1]
        sees = (
            str(n)
            for n in range(self.elements + 1, largest + 1)
            if off_nodes(self.gap, self.length, n).max() <= most
        )
        yield (
            f"gap: {np.count_nonzero(off > most)} of {len(self.gap)} points lie between nodes, up "
            f"to {plain(float(f'{off.max():.3g}'))} m off the line through them; what is lower "
            "than both nodes counts at the nearer one, for all of its share; "
            f"{next(sees, f'more than {largest}')} elements would see it"
        )

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
                f"nothing but contact holds it, and {when} {reason}: "
                "lower that load, press more, raise friction where it slides, take a longer or "
                "lower body where it tips, or hold a side",
            )

    def structure(self) -> Stack:
        """Make the block; one metre thick."""
        sides = {side: self.side(side) for side in ("left", "right", "top")}
        is_preset = isinstance(self.gap, str)
        if is_preset:
            gap = self.gap_at(self.places)
        else:
            gap = gap_at(self.gap, self.places)
        return replace(
            self.stack(),
            support=Support(gap, self.friction_at_nodes()),
            sides=sides,
            body_force=self._body_force(),
            spring=Spring(0.0, self.spring) if self.has("spring") else None,
        )

    def sentence(self) -> str:
        """The block in a sentence."""
        support = {"flat": "flat", "parabola": "round"}.get(str(self.gap), "uneven")
        rough = "rough" if self.is_rough else "smooth"
        acts: list[str] = []
        for side in LOADED_SIDES:
            if getattr(self, side) in AT_REST:
                continue
            inward = -self.path(f"{side}_normal_load")
            along = self.path(f"{side}_tangential_load")
            if inward.any():
                own = [shared.acting(inward, "pressed", "pulled")]
            else:
                own = []
            if along.any():
                own += [shared.acting(along, "moved", "moved back")]
            else:
                own += []
            if own:
                acts += [f"{shared.listed(own)} at its {side}"]
            else:
                acts += []
        if self._body_force() is not None:
            acts.append("loaded all through")
        if self.has("spring"):
            acts.append("pulled back by a spring")
        held = [side for side in LOADED_SIDES if getattr(self, side) == "clamped"]
        acts += [f"held at its {side}" for side in held]
        if acts:
            does = shared.listed(acts)
        else:
            does = "left alone"
        if shared.is_steel(self.young):
            block = "A steel block"
        else:
            block = "An elastic block"
        return f"{block} lies on a {support} {rough} support; it is {does}."

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterable[ExactCurve]:
        """Tractions on a parabola, once there are forces for them, or the slide on a spring."""
        body = self.structure()
        if self.gap != "parabola":
            return exact_on_spring(body)
        if solution is None:
            return ()
        return exact_parabola(body, self.radius, problem, solution)

    def gap_at(self, x: Array) -> Array:
        """Gap of a preset at places along the lowest side, m."""
        if self.gap == "flat":
            return np.zeros_like(x)
        return np.asarray((x - 0.5 * self.length) ** 2 / (2.0 * self.radius))

    def _body_force(self) -> Array | None:
        sizes = np.array([self.body_force_x, self.body_force_y])
        if not sizes.any():
            return None
        phases = self.times() / self.duration
        return sizes[:, None] * PRESETS[self.body_load].value(
            phases, self.seed, self.cycles
        )
