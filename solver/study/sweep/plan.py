"""What a sweep runs, one or two settings over their values, and what comes of a point."""

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
from solver.latin import Ending
from solver.settings.definitions import (
    Parameter,
    SettingError,
    about,
    allowed,
    checked_value,
    parse,
    title_of,
    unknown,
)
from solver.settings.scene import Settings
from solver.study.quantities import reading
from solver.study.quantities.quantity import Quantity

MOST_POINTS = 20_000
"""Runs that one sweep may ask for: more fill no chart, and nobody waits for them."""
STUCK = "stuck"
LOST = "lost"
"""How a run ends whose process was ended: by its time limit, or by something else."""
FORM = "NAME=LOW:HIGH:COUNT, NAME=LOW:HIGH:COUNT:log, or NAME=VALUE,VALUE,..."


@dataclass(frozen=True)
class Varied:
    """A setting and the values that it takes, each once; numbers ascend.

    The unit is in SI, empty for a pure number; `logarithmic` is whether values are
    spread evenly over decades.
    """

    name: str
    title: str
    unit: str
    values: tuple[Any, ...]
    logarithmic: bool

    @property
    def is_numeric(self) -> bool:
        """Whether the values are numbers, which have a place on a scale."""
        return not isinstance(self.values[0], bool | str)

    @property
    def names(self) -> tuple[str, ...]:
        """The values where they are no numbers, none otherwise."""
        words = {True: "on", False: "off"}
        if self.is_numeric:
            return ()
        return tuple(words.get(value, value) for value in self.values)

    @property
    def places(self) -> Array:
        """Where the values stand on an axis: names one after the other."""
        return np.array(
            self.values if self.is_numeric else range(len(self.values)), dtype=float
        )


@dataclass(frozen=True)
class Plan:
    """One or two axes, everything else fixed; points are numbered, the last axis fastest.

    Of a number and names the number is the first axis. `of` are names of what is taken
    of every run, at least one.
    """

    settings: Settings
    axes: tuple[Varied, ...]
    of: tuple[str, ...]

    @property
    def readings(self) -> tuple[Quantity, ...]:
        """What is taken of every run."""
        return tuple(map(reading, self.of))

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
        """Settings that differ from their defaults; a varied method brings the rest."""
        return self.settings.changed()

    def point(self, number: int) -> dict[str, Any]:
        """Values of what varies at a point, by the setting's name."""
        places = np.unravel_index(number, self.shape)
        return {
            axis.name: axis.values[place]
            for axis, place in zip(self.axes, places, strict=True)
        }

    def settings_at(self, number: int) -> Settings:
        """Settings of a point; they are refused where they do not fit together."""
        return self.settings.checked({**self.fixed, **self.point(number)})

    def idle(self) -> list[str]:
        """Names of the settings that vary and do nothing at any point."""
        found = {axis.name for axis in self.axes}
        for number in range(self.size):
            with contextlib.suppress(SettingError):
                settings = self.settings_at(number)
                found -= {name for name in found if settings.applies(name)}
            if not found:
                break
        return sorted(found)


@dataclass(frozen=True)
class Row:
    """What came of one point; it was warm if it started from the run nearest to it.

    Attributes
    ----------
    ending, reason
        `converged` and the other ways in which a run ends, why, and what to try;
        `refused` where its settings do not fit together, `broken` where the engine
        failed, `stuck` and `lost` where its process was ended.
    values
        Of the readings of the plan, in their units: NaN where the run has none,
        infinity for never. Those of a run that has not converged are what it had come
        to, and NaN where some of its instants have no solution.
    seconds
        With its problem, its reference and its readings.
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
        """Whether the run has converged, so that its values are answers."""
        return self.ending == Ending.CONVERGED


def plan_of(settings: Settings, vary: Sequence[str], of: Sequence[str]) -> Plan:
    """Plan of texts as `--vary` (one or two of `FORM`) and `--of` take them, or `SettingError`."""
    if not 1 <= len(vary) <= 2:
        raise SettingError(
            "--vary", list(vary), f"one or two of {FORM}", "vary one or two"
        )
    if not of:
        raise SettingError("--of", list(of), "names of quantities", "name at least one")
    axes = [axis_of(settings, text) for text in vary]
    if len({axis.name for axis in axes}) < len(axes):
        raise SettingError(
            "--vary", list(vary), "two settings", "vary each of them once"
        )
    axes.sort(key=lambda axis: not axis.is_numeric)
    plan = Plan(
        settings, tuple(axes), tuple(dict.fromkeys(reading(name).name for name in of))
    )
    if plan.size > MOST_POINTS:
        few = f"at most {MOST_POINTS} runs"
        raise SettingError(
            "--vary", list(vary), few, f"these are {plan.size}: take fewer values"
        )
    return plan


def axis_of(settings: Settings, text: str) -> Varied:
    """One setting and its values, of a text as `--vary` takes it."""
    name, equals, values = text.partition("=")
    definitions = settings.definitions()
    if not equals or not values:
        raise SettingError("--vary", text, FORM, "name a setting and its values")
    if name not in definitions:
        raise unknown(name, values, settings.scene, definitions)
    if ":" in values:
        found, logarithmic = _range(definitions[name], name, values)
    else:
        found = [parse(value.strip()) for value in values.split(",")]
        logarithmic = False
    for end in (found[-1], found[0]):
        # What was typed is refused before what lies between.
        checked_value(definitions[name], name, end)
    checked = dict.fromkeys(
        checked_value(definitions[name], name, value) for value in found
    )
    ordered = list(checked)
    if isinstance(definitions[name], param.Number):
        ordered.sort()
    title = title_of(definitions[name])
    unit = about(definitions[name]).unit
    return Varied(name, title, unit, tuple(ordered), logarithmic)


def _range(definition: Parameter, name: str, text: str) -> tuple[list[object], bool]:
    """Values spread over a range, and whether over decades."""

    def refuse(remedy: str) -> SettingError:
        return SettingError(
            name, text, f"LOW:HIGH:COUNT or LOW:HIGH:COUNT:log, {within}", remedy
        )

    within = f"within {allowed(definition)}"
    if not isinstance(definition, param.Number):
        raise SettingError(
            name, text, allowed(definition), "list its values, commas between them"
        )
    *numbers, last = text.split(":")
    logarithmic = last == "log"
    try:
        low, high, count = map(float, numbers if logarithmic else [*numbers, last])
    except ValueError:
        raise refuse("write three numbers, colons between them") from None
    if not (math.isfinite(low) and math.isfinite(high)):
        raise refuse("write finite numbers")
    if not 2 <= count <= MOST_POINTS or count != int(count):
        raise refuse(f"the count is a whole number from 2 to {MOST_POINTS}")
    if low == high:
        raise refuse("the two ends differ")
    if logarithmic and min(low, high) <= 0.0:
        raise refuse("decades need ends above zero")
    spread = np.geomspace if logarithmic else np.linspace
    # Through text, so that 0.1:0.6:6 holds 0.3 and not 0.30000000000000004.
    values = [float(f"{value:.12g}") for value in spread(low, high, int(count))]
    is_whole = isinstance(definition, param.Integer)
    return [round(value) if is_whole else value for value in values], logarithmic
