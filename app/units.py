"""Units for readers: each setting, axis and figure keeps its unit."""

from __future__ import annotations

import math
from functools import cache

from solver.files.amounts import Unit, number, unit_for
from solver.scenes import CATALOGUE

OTHER_SIZES = {"Pa": 1e6, "m": 1e-3}
"""Typical values, in SI, of a path whose default points are of another quantity."""
ROUNDING = 1e-7
"""Share of the largest value of its kind below which a value is rounding: frames have
seven digits."""


@cache
def units_of_points(scene: str, name: str, units: tuple[str, ...]) -> tuple[Unit, ...]:
    """The units of a table's columns on the page, by the scene's defaults.

    `units` are the SI units that the path has with the other settings
    (`Settings.curve_units`).
    """
    default = CATALOGUE[scene].checked({})
    columns = zip(*default.points(name), strict=True)
    sizes = [max(map(abs, column)) for column in columns]
    # Sizes of a displacement, say, tell nothing of those of a pressure.
    if default.curve_units(name) != units:
        sizes[1] = OTHER_SIZES.get(units[1], 1.0)
    return tuple(unit_for(size, unit) for size, unit in zip(sizes, units, strict=True))


def settled(value: float, size: float) -> float:
    """A value, or 0 where it is a rounding error of a reference size, both in SI."""
    if abs(value) <= ROUNDING * abs(size):
        return 0.0
    return value


def percent(share: float) -> str:
    """A share in per cent."""
    if not math.isfinite(share):
        return "–"
    return f"{number(100.0 * share, 2 if share < 1.0 else 3)} %"
