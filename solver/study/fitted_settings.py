"""Settings that may be fitted, and their scales z."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import param

from solver.arrays import Array
from solver.settings.definitions import is_logarithmic, properties_of
from solver.settings.scene import Settings
from solver.settings.values import SettingError

NOT_FITTED = "Method", "Stop", "Decomposition"
"""Groups of settings that do not change the solution."""
FARTHEST = math.log(1e6)
"""Largest distance in z of a setting from its start."""


def fittable(settings: Settings) -> list[str]:
    """Names of the settings that may be fitted: numbers that change the solution."""
    return [name for name in settings.definitions() if not _why_not(settings, name)]


def _why_not(settings: Settings, name: str) -> str:
    """Reason why a setting cannot be fitted, or ""."""
    definition = settings.definitions().get(name)
    if definition is None:
        return "there is no such setting"
    if not isinstance(definition, param.Number):
        return "it is no number"
    if isinstance(definition, param.Integer):
        return "it counts, and has no values in between"
    if not settings.applies(name):
        return "it does nothing with the other settings as they are"
    if properties_of(definition).group in NOT_FITTED or name == "duration":
        return "it does not change what a run finds"
    return ""


def _scale_of(settings: Settings, name: str) -> tuple[float, float, float, float]:
    """Start and size of the scale of a fitted setting, and its bounds, in SI.

    The size is 0 of a logarithmic scale. A setting that is no number, or does not
    change the solution, is refused.
    """
    if reason := _why_not(settings, name):
        can = ", ".join(fittable(settings))
        raise SettingError("fitted setting", name, can, f"choose another: {reason}")
    definition = settings.definitions()[name]
    value = getattr(settings, name)
    low, high = definition.bounds
    # Positive quantities, as stiffnesses, span decades, and their errors are factors.
    if low >= 0.0 and value > 0.0:
        return value, 0.0, low, high
    if is_logarithmic(definition):
        can = f"a value above 0, to begin with, as {definition.softbounds[0]:g}"
        raise SettingError(name, value, can, "set it")
    return value, abs(value) or float(np.ptp(definition.softbounds)), low, high


class FittedScales:
    """Scales z of fitted settings: 0 at their values in the first run.

    Parameters
    ----------
    settings
        Settings of the first run.
    names
        Names of the p settings that are fitted.

    Attributes
    ----------
    in_decades
        Whether the scale of a setting is logarithmic, shape (p,).
    bounds
        Smallest and largest z of the settings, shape (2, p).
    """

    def __init__(self, settings: Settings, names: Sequence[str]) -> None:
        self.names = tuple(names)
        scales = np.array([_scale_of(settings, name) for name in names])
        self._start, self._size, *self._ends = scales.T
        self.in_decades = self._size == 0.0
        ends = [self._on_scale(end) for end in self._ends]
        self.bounds = np.clip(ends, -FARTHEST, FARTHEST)

    def _on_scale(self, values: Array) -> Array:
        """Scaled settings z, shape (p,), from values in SI."""
        # Both scales are computed for all settings; one of them is not used.
        with np.errstate(divide="ignore", invalid="ignore"):
            in_logarithm = np.log(values / self._start)
            in_size = (values - self._start) / self._size
        return np.asarray(np.where(self.in_decades, in_logarithm, in_size))

    def values(self, z: Array) -> Array:
        """Values of the settings at z, shape (p,), in SI."""
        with np.errstate(over="ignore"):
            in_logarithm = self._start * np.exp(z)
            in_size = self._start + self._size * z
        values = np.where(self.in_decades, in_logarithm, in_size)
        return np.asarray(np.clip(values, *self._ends))

    def changes(self, z: Array) -> dict[str, float]:
        """Values of the settings at z, (p,), by name, in SI, rounded to 12 digits."""
        # A difference in the last bits would be another run, and another place.
        values = [float(f"{value:.12g}") for value in self.values(z)]
        return dict(zip(self.names, values, strict=True))

    def holds(self, z: Array) -> bool:
        """Check whether z, (p,), lies within the bounds of all settings."""
        low, high = self.bounds
        return bool(((low <= z) & (z <= high)).all())
