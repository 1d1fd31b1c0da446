"""Settings of the sides of a rectangle: what is given there, how large, and along which path."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.definitions import Parameter, choice, curve, quantity
from solver.discrete.stack import Given, Side
from solver.loads import PRESETS
from solver.scenes.plane import PlaneSettings

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
"""Whether the normal and the tangential displacement are prescribed; a traction is, otherwise."""
AT_REST = ("free", "roller", "clamped")


def _is_given(side: str) -> Callable[..., bool]:
    """Make the test whether anything but rest is given along a side."""
    return lambda settings: getattr(settings, side) not in AT_REST


def _is_prescribed(side: str, component: str, prescribed: bool) -> Callable[..., bool]:
    """Make the test whether that value is given, and is of this kind."""

    def applies(settings: PlaneSettings) -> bool:
        kind = getattr(settings, side)
        return kind not in AT_REST and PRESCRIBED[kind][COMPONENTS.index(component)] == prescribed

    return applies


def _settings_of(side: str, component: str) -> dict[str, Parameter]:
    """Settings of what is given: how large it is, how it varies along the side, and over time."""
    along = "x" if side == "top" else "y"
    towards = "outward" if component == "normal" else f"along {along}"
    axis = along if component == "tangential" else "yx"["xy".index(along)]
    name, group = f"{side}_{component}", side.capitalize()
    title, given = f"{group} {component}", _is_given(side)
    size = {"group": group, "path": f"{name}_load", "places": (f"{side} {axis}",)}
    return {
        f"{name}_traction": quantity(
            0.0,
            (-1e15, 1e15),
            (-2e8, 2e8),
            f"Mean {component} traction on the {side} side, positive {towards}.",
            title=f"{title} traction",
            unit="Pa",
            applies=_is_prescribed(side, component, False),
            **size,
        ),
        f"{name}_displacement": quantity(
            0.0,
            (-1e12, 1e12),
            (-1e-4, 1e-4),
            f"Mean {component} displacement of the {side} side, positive {towards}.",
            title=f"{title} displacement",
            unit="m",
            applies=_is_prescribed(side, component, True),
            **size,
        ),
        f"{name}_slope": quantity(
            0.0,
            (-1e6, 1e6),
            (-1.0, 1.0),
            "How unevenly the value is spread along the side: from the mean times 1 - slope at "
            "its lower or left end to the mean times 1 + slope at the other, and linear between.",
            group=group,
            title=f"{title} slope",
            applies=given,
        ),
        f"{name}_load": curve(
            "hold" if component == "normal" else "delayed",
            PRESETS,
            {"time": "s", "value": "Pa or m"},
            f"{title} value over time: a preset that reaches the mean, or points (s, Pa or m).",
            group=group,
            title=f"{title} path",
            applies=given,
        ),
    }


class SideSettings(PlaneSettings):
    """Settings of a rectangle whose left, right and top side can be held or loaded."""

    def side(self, side: str) -> Side:
        """What is given along a side, for x and y."""
        normal, tangential = (self._given(side, component) for component in COMPONENTS)
        return Side(tangential, normal) if side == "top" else Side(normal, tangential)

    def _given(self, side: str, component: str) -> Given:
        kind = getattr(self, side)
        prescribed = PRESCRIBED[kind][COMPONENTS.index(component)]
        if kind in AT_REST:
            rest = np.zeros(self.n_instants)
            return Given(prescribed, rest, rest)
        sign = -1.0 if side == "left" and component == "normal" else 1.0
        mean = sign * self.path(f"{side}_{component}_load")
        return Given(prescribed, mean, mean * getattr(self, f"{side}_{component}_slope"))


def _define(side: str) -> None:
    SideSettings.param.add_parameter(
        side,
        choice(
            "free",
            PRESCRIBED,
            "What is given. free: nothing. roller: no normal displacement. clamped: no "
            "displacement. displacement: both displacements. traction: both tractions. pushed: "
            "normal displacement, tangential traction. dragged: tangential displacement, normal "
            "traction.",
            group=side.capitalize(),
            title=f"{side.capitalize()} side",
        ),
    )
    for component in COMPONENTS:
        for name, definition in _settings_of(side, component).items():
            SideSettings.param.add_parameter(name, definition)


for _side in LOADED_SIDES:
    _define(_side)
