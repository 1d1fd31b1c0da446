"""Loads and motions of the sides of a rectangle, as settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
import param

import solver.scenes.shared as shared
from solver.discrete.plane.rectangles.sides import Side, SideComponent
from solver.scenes.plane import RectangleSettings
from solver.settings.definitions import (
    CurveParameter,
    SettingGroup,
)
from solver.settings.load_paths import PRESETS

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
        """Define the relative change of the value from the middle to an end."""
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
        """Define the path over time of the traction or displacement."""
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
        """Heading of the group of the side's settings."""
        return SettingGroup(self.side.capitalize())

    @property
    def _title(self) -> str:
        """Title of the component."""
        return f"{self._group.name} {self.component}"

    @property
    def _axis(self) -> str:
        """Axis of the component: the top side runs along x, the others along y."""
        is_along_x = (self.side == "top") == (self.component == "tangential")
        return "x" if is_along_x else "y"

    def _is_given(self, settings: Any) -> bool:
        """Check whether the side has a load or motion."""
        return getattr(settings, self.side) not in AT_REST

    def _is_prescribed(self, settings: Any) -> bool:
        """Check whether the component is a displacement."""
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

    def side_clauses(self) -> Iterator[str]:
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

    def _given(self, side: str, component: str) -> SideComponent:
        """Prescribed displacement or traction of a side over time."""
        kind = getattr(self, side)
        prescribed: bool = getattr(PRESCRIBED[kind], component)
        if kind in AT_REST:
            rest = np.zeros(self.n_instants)
            return SideComponent(prescribed, rest, rest)
        # On the left side outward is the negative x direction.
        sign = -1.0 if side == "left" and component == "normal" else 1.0
        mean = sign * self.path(f"{side}_{component}_load")
        slope = mean * getattr(self, f"{side}_{component}_slope")
        return SideComponent(prescribed, mean, slope)
