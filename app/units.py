"""Units that values are read in: each setting, axis and figure keeps its unit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import param

from solver.files.numerals import leading_number
from solver.files.units import size_in
from solver.scenes import CATALOGUE
from solver.settings.definitions import Parameter, about

PREFIXES = {"µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
PREFIXED = ("m", "N", "Pa", "J", "N/m", "N/m^2", "N/m^3", "N·m", "N·m/m", "rad")
"""Units that take a prefix."""
TIMES = {"s": 1.0, "h": 3600.0, "d": 86400.0}
LATER = {"GPa": 10.0, "GN/m²": 10.0, "GN/m³": 10.0, "h": 3.0, "d": 3.0}
"""Least value in a unit with which the unit is taken, where it is not 1: a stress of
3000 MPa is not read in GPa."""
OTHER_SIZES = {"Pa": 1e6, "m": 1e-3}
"""Typical values, in SI, of a path whose default points are of another quantity."""
ROUNDING = 1e-7
"""Share of the largest value of its kind below which a value is rounding: frames have
seven digits."""
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Unit:
    """A unit and its size in SI."""

    name: str
    factor: float = 1.0

    def __call__(self, value: float, digits: int = 3) -> str:
        """A value in SI with this unit."""
        gap = "" if self.name == "°" else " "
        return f"{number(value / self.factor, digits)}{gap}{self.name}".strip()

    def titled(self, title: str) -> str:
        """A title with the unit behind it."""
        if self.name:
            return f"{title}, {self.name}"
        return title


def sizes_of(unit: str) -> dict[str, float]:
    """Multiples of an SI unit and their sizes in it, smallest first."""
    name = unit.replace("^2", "²").replace("^3", "³")
    if unit == "s":
        return TIMES
    if unit in PREFIXED:
        return {prefix + name: size for prefix, size in PREFIXES.items()}
    return {name: 1.0}


def unit_for(size: float, unit: str) -> Unit:
    """The unit in which values up to a size in SI are read."""
    if math.isfinite(size) and size > 0.0:
        # As it is read: 0.9999 is 1.
        size = float(f"{size:.3g}") * (1.0 + 1e-9)
    else:
        size = 1.0
    units = sizes_of(unit).items()
    chosen, factor = next(iter(units))
    for name, unit_size in units:
        if unit_size * LATER.get(name, 1.0) <= size:
            chosen = name
            factor = unit_size
    return Unit(chosen, factor)


def unit_of(definition: Parameter) -> Unit:
    """The unit of a setting, by its default value or else its range."""
    unit = about(definition).unit
    if not isinstance(definition, param.Number):
        return Unit(unit)
    size = abs(definition.default) or max(map(abs, definition.softbounds))
    return unit_for(size, unit)


@cache
def units_of_points(scene: str, name: str, units: tuple[str, ...]) -> tuple[Unit, ...]:
    """The units in which the columns of a table are read, by the scene's defaults.

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


def typed(text: str, unit: Unit, si: str) -> float:
    """Value in SI of a typed number, in a unit or in the unit that is typed behind it.

    Raises
    ------
    ValueError
        If the text is no number, or its unit is of another quantity; it says what to
        write instead.
    """
    value, behind = leading_number(text)
    if not math.isfinite(value):
        raise ValueError("write a number")
    sizes = {**sizes_of(si), "": unit.factor, unit.name: unit.factor}
    size = sizes.get(behind) or size_in(behind, si)
    if size is None:
        raise ValueError(f"write a number in {unit.name or 'no unit'}")
    return float(f"{value * size:.15g}")


def settled(value: float, size: float) -> float:
    """A value, or 0 where it is rounding beside a size of its kind, both in SI."""
    if abs(value) <= ROUNDING * abs(size):
        return 0.0
    return value


def number(value: float, digits: int = 3) -> str:
    """A number with a printed minus, and with a power of ten where it needs one."""
    near = float(f"{value:.{digits}g}")
    if near != 0.0 and math.isfinite(near) and not 1e-3 <= abs(near) < 1e6:
        digit, exponent = f"{value:.{digits - 1}e}".split("e")
        text = f"{float(digit):g}·10{str(int(exponent)).translate(RAISED)}"
    else:
        text = f"{near:.7g}"
    return text.replace("-", "−")


def percent(share: float) -> str:
    """A share in per cent."""
    if not math.isfinite(share):
        return "–"
    return f"{number(100.0 * share, 2 if share < 1.0 else 3)} %"
