"""Settings that a measured loop may be asked for, and the scales on which they are fitted."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import param

from solver.definitions import SettingError, about
from solver.settings import Settings

NOT_FITTED = "Method", "Stop", "Decomposition"
"""Groups of settings that do not change the answer."""
SPANS = 100.0
"""Largest over smallest value from which on a setting is varied in decades."""
FARTHEST = math.log(1e6)
"""How far from its start, in z, a setting may go."""


@dataclass(frozen=True)
class Scale:
    """From z to the values of a setting, and back."""

    start: float
    size: float | None
    """None for a logarithm."""
    low: float
    high: float

    def value(self, z: float) -> float:
        """Value in SI, with as many digits as anybody writes."""
        value = self.start * math.exp(z) if self.size is None else self.start + self.size * z
        return float(f"{min(max(value, self.low), self.high):.12g}")

    def bounds(self) -> tuple[float, float]:
        """Of z."""
        if self.size is None:
            ends = [math.log(v / self.start) if v else -FARTHEST for v in (self.low, self.high)]
        else:
            ends = [(value - self.start) / self.size for value in (self.low, self.high)]
        return max(ends[0], -FARTHEST), min(ends[1], FARTHEST)

    def slope(self, value: float) -> float:
        """Change of the value with z."""
        return value if self.size is None else self.size


def scale_of(settings: Settings, name: str) -> Scale:
    """Scale on which a setting is fitted.

    Raises
    ------
    SettingError
        For a setting that there is not, or is no number, or does nothing to the answer.
    """
    definitions = settings.definitions()

    def refuse(remedy: str) -> SettingError:
        return SettingError("fitted setting", name, ", ".join(fittable(settings)), remedy)

    if name not in definitions:
        raise refuse("there is no such setting: choose one of these")
    definition, value = definitions[name], getattr(settings, name)
    if name not in fittable(settings):
        if not isinstance(definition, param.Number):
            raise refuse("choose another: it is no number")
        if isinstance(definition, param.Integer):
            raise refuse("choose another: it counts, and has no values in between")
        if not settings.applies(name):
            raise refuse("choose another: it does nothing with the other settings as they are")
        raise refuse("choose another: it does not change what a run finds")
    low, high = definition.bounds
    is_logarithmic = about(definition).logarithmic
    if low >= 0.0 and (is_logarithmic or high >= SPANS * low):
        if value > 0.0:
            return Scale(value, None, low, high)
        if is_logarithmic:
            can = f"a value above 0, to begin with, as {definition.softbounds[0]:g}"
            raise SettingError(name, value, can, "set it")
    return Scale(value, abs(value) or float(np.ptp(definition.softbounds)), low, high)


def fittable(settings: Settings) -> list[str]:
    """Settings that a loop may be asked for: numbers that change the answer."""
    return [
        name
        for name, definition in settings.definitions().items()
        if isinstance(definition, param.Number)
        and not isinstance(definition, param.Integer)
        and about(definition).group not in NOT_FITTED
        and name != "duration"
        and settings.applies(name)
    ]
