"""Plan of a sweep over values of one or two settings, and rows of results."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import param

from solver.arrays import Array
from solver.files.typed import typed_value
from solver.latin import Ending
from solver.settings.definitions import Parameter, properties_of, title_of
from solver.settings.scene import Settings
from solver.settings.values import (
    SettingError,
    allowed,
    checked_value,
    unknown_setting,
)
from solver.study.quantities import reading
from solver.study.quantities.quantity import Quantity

MOST_POINTS = 20_000
"""Largest number of runs of a sweep: more fill no chart, and nobody waits for them."""
STUCK = "stuck"
"""Ending of a run whose process was ended by its time limit."""
LOST = "lost"
"""Ending of a run whose process was ended by something else."""
FORM = "NAME=LOW:HIGH:COUNT, NAME=LOW:HIGH:COUNT:log, or NAME=VALUE,VALUE,..."


@dataclass(frozen=True)
class Varied:
    """A varied setting, and its values.

    Attributes
    ----------
    name, title, unit
        Name and title of the setting, and its SI unit, empty for a pure number.
    values
        Values that the setting takes, each once; numbers ascend.
    logarithmic
        Whether values are spread evenly over decades.
    """

    name: str
    title: str
    unit: str
    values: tuple[Any, ...]
    logarithmic: bool

    @property
    def is_numeric(self) -> bool:
        """Check whether the values are numbers."""
        return not isinstance(self.values[0], bool | str)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the values; empty where the values are numbers."""
        if self.is_numeric:
            return ()
        words = {True: "on", False: "off"}
        return tuple(words.get(value, value) for value in self.values)

    @property
    def places(self) -> Array:
        """Positions of the values on an axis, (n_values,): numbers, or 0, 1, ..."""
        if self.is_numeric:
            return np.array(self.values, dtype=float)
        return np.arange(len(self.values), dtype=float)


@dataclass(frozen=True)
class Plan:
    """Plan of a sweep over one or two settings, while all others are fixed.

    Attributes
    ----------
    settings
        Settings of the sweep.
    axes
        Settings that vary; of a number and names the number is first. Points are
        numbered with the last axis fastest.
    of
        Names of the quantities of every run, at least one.
    """

    settings: Settings
    axes: tuple[Varied, ...]
    of: tuple[str, ...]

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Quantities of every run."""
        return tuple(reading(name) for name in self.of)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of every axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    @cached_property
    def fixed(self) -> dict[str, Any]:
        """Fixed settings that differ from the defaults, or from a varied method's."""
        return self.settings.changed()

    def point(self, number: int) -> dict[str, Any]:
        """Values of the varied settings at a point, by name."""
        values = {}
        levels = np.unravel_index(number, self.shape)
        for axis, level in zip(self.axes, levels, strict=True):
            values[axis.name] = axis.values[level]
        return values

    def settings_at(self, number: int) -> Settings:
        """Settings of a point; settings that do not fit together are refused."""
        return self.settings.checked(self.fixed | self.point(number))

    def idle(self) -> list[str]:
        """Names of the varied settings without effect at all points."""
        idle = {axis.name for axis in self.axes}
        # At any point: a setting may apply under some values of the other one alone.
        for number in range(self.size):
            with contextlib.suppress(SettingError):
                settings = self.settings_at(number)
                idle -= {name for name in idle if settings.applies(name)}
            if not idle:
                break
        return sorted(idle)


@dataclass(frozen=True)
class Row:
    """Result of a point of a plan.

    Attributes
    ----------
    number
        Number of the point.
    ending
        Status of the run, such as `converged`; `refused` where its settings do not fit
        together, `broken` where the engine failed, `stuck` and `lost` where its process
        was ended.
    reason
        Reason of that ending, and what to try.
    values
        Values of the quantities, in the order of the plan: NaN where the run has none,
        infinity for never. Those of a run that has not converged are of its last
        iterate, and NaN where some of its instants have no solution.
    iterations
        Number of iterations.
    seconds
        Time of the run with its problem, its reference and its quantities, s.
    was_warm
        Whether the run started from the run nearest to it.
    """

    number: int
    ending: str
    reason: str
    values: tuple[float, ...]
    iterations: int = 0
    seconds: float = 0.0
    was_warm: bool = False

    @property
    def holds(self) -> bool:
        """Check whether the run has converged, so that its values are answers."""
        return self.ending == Ending.CONVERGED


def plan_of(settings: Settings, vary: Sequence[str], of: Sequence[str]) -> Plan:
    """Plan from texts, as of the options `--vary` and `--of`.

    Parameters
    ----------
    settings
        Settings of the sweep.
    vary
        One or two texts in one of the forms `FORM`.
    of
        Names of quantities.

    Raises
    ------
    SettingError
        For other texts, one setting twice, and too many points.
    """
    given = list(vary)
    if not 1 <= len(vary) <= 2:
        raise SettingError("--vary", given, f"one or two of {FORM}", "vary one or two")
    if not of:
        raise SettingError("--of", list(of), "names of quantities", "name at least one")
    axes = [axis_of(settings, text) for text in vary]
    if len({axis.name for axis in axes}) < len(axes):
        raise SettingError("--vary", given, "two settings", "vary each of them once")
    # Numbers stand across, names are curves.
    axes.sort(key=lambda axis: not axis.is_numeric)
    # Each quantity once, under its present name.
    names = dict.fromkeys(reading(name).name for name in of)
    plan = Plan(settings, tuple(axes), tuple(names))
    if plan.size > MOST_POINTS:
        few = f"at most {MOST_POINTS} runs"
        remedy = f"these are {plan.size}: take fewer values"
        raise SettingError("--vary", given, few, remedy)
    return plan


def axis_of(settings: Settings, text: str) -> Varied:
    """Varied setting from a text, as of the option `--vary`.

    Raises
    ------
    SettingError
        For a text of another form, an unknown setting, or values that it cannot have.
    """
    before, equals, values = text.partition("=")
    name = before.strip()
    definitions = settings.definitions()
    if not equals or not values:
        raise SettingError("--vary", text, FORM, "name a setting and its values")
    if name not in definitions:
        raise unknown_setting(name, values, settings.scene, definitions)
    definition = definitions[name]
    logarithmic = False
    if ":" in values:
        found, logarithmic = _range(definition, name, values)
    else:
        found = [typed_value(value, name, definition) for value in values.split(",")]
    for end in (found[-1], found[0]):
        # A value that was typed is refused before those that lie between.
        checked_value(definition, name, end)
    checked = [checked_value(definition, name, value) for value in found]
    ordered = list(dict.fromkeys(checked))
    if isinstance(definition, param.Number):
        ordered.sort()
    unit = properties_of(definition).unit
    return Varied(name, title_of(definition), unit, tuple(ordered), logarithmic)


def _range(definition: Parameter, name: str, text: str) -> tuple[list[object], bool]:
    """Values of a range LOW:HIGH:COUNT, and whether they are logarithmic."""
    if not isinstance(definition, param.Number):
        remedy = "list its values, commas between them"
        raise SettingError(name, text, allowed(definition), remedy)
    *numbers, last = text.split(":")
    logarithmic = last == "log"
    if not logarithmic:
        numbers.append(last)
    ends = [typed_value(end, name, definition) for end in numbers[:-1]]
    try:
        low, high = map(float, ends)
        count = float(numbers[-1])
    except ValueError:
        remedy = "write three numbers, colons between them"
        raise _range_error(definition, name, text, remedy) from None
    remedy = _remedy(low, high, count, logarithmic)
    is_counted = isinstance(definition, param.Integer)
    if is_counted and not remedy and (low != int(low) or high != int(high)):
        remedy = "the two ends are whole numbers"
    if remedy:
        raise _range_error(definition, name, text, remedy)
    if logarithmic:
        spread = np.geomspace(low, high, int(count))
    else:
        spread = np.linspace(low, high, int(count))
    # Through text, so that 0.1:0.6:6 holds 0.3 and not 0.30000000000000004.
    values: list[object] = [float(f"{value:.12g}") for value in spread]
    if is_counted:
        values = [round(float(f"{value:.12g}")) for value in spread]
    return values, logarithmic


def _range_error(
    definition: Parameter, name: str, text: str, remedy: str
) -> SettingError:
    """Refusal of a range."""
    within = f"within {allowed(definition)}"
    can = f"LOW:HIGH:COUNT or LOW:HIGH:COUNT:log, {within}"
    return SettingError(name, text, can, remedy)


def _remedy(low: float, high: float, count: float, logarithmic: bool) -> str:
    """Remedy for the numbers of a range, or "" if they are right."""
    if not (math.isfinite(low) and math.isfinite(high)):
        return "write finite numbers"
    if not 2 <= count <= MOST_POINTS or count != int(count):
        return f"the count is a whole number from 2 to {MOST_POINTS}"
    if low == high:
        return "the two ends differ"
    if logarithmic and min(low, high) <= 0.0:
        return "decades need ends above zero"
    return ""
