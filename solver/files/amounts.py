"""Amounts for readers: numbers in a unit of suitable size."""

from __future__ import annotations

import math
from dataclasses import dataclass

import param

from solver.settings.definitions import Parameter, properties_of

PREFIXES = {"n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
PREFIXED = ("m", "N", "Pa", "J", "N/m", "N/m^2", "N/m^3", "N·m", "N·m/m", "rad")
"""Units that take a prefix."""
TIMES = {"s": 1.0, "h": 3600.0, "d": 86400.0}
AREAS = {"mm²": 1e-6, "m²": 1.0}
LATER = {"GPa": 10.0, "GN/m²": 10.0, "GN/m³": 10.0, "h": 3.0, "d": 3.0}
"""Least value in a unit with which the unit is taken, where it is not 1: a stress of
3000 MPa is not read in GPa."""
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
        """A title followed by the unit."""
        if self.name:
            return f"{title}, {self.name}"
        return title


def sizes_of(unit: str) -> dict[str, float]:
    """Multiples of an SI unit and their sizes in it, smallest first."""
    name = unit.replace("^2", "²").replace("^3", "³")
    if unit == "s":
        return TIMES
    if unit == "m^2":
        return AREAS
    if unit in PREFIXED:
        return {prefix + name: size for prefix, size in PREFIXES.items()}
    return {name: 1.0}


def unit_for(size: float, unit: str) -> Unit:
    """The unit of suitable size for values up to a size in SI."""
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
    """The unit of a setting for readers, by its default value or range."""
    unit = properties_of(definition).unit
    if not isinstance(definition, param.Number):
        return Unit(unit)
    ends = [abs(end) for end in definition.softbounds or () if end is not None]
    size = abs(definition.default) or max(ends)
    return unit_for(size, unit)


def number(value: float, digits: int = 3) -> str:
    """Text of a number, with a minus sign, and a power of ten where needed."""
    near = float(f"{value:.{digits}g}")
    if near != 0.0 and math.isfinite(near) and not 1e-3 <= abs(near) < 1e6:
        digit, exponent = f"{value:.{digits - 1}e}".split("e")
        text = f"{float(digit):g}·10{str(int(exponent)).translate(RAISED)}"
    else:
        text = f"{near:.7g}"
    return text.replace("-", "−")


def amount(value: float, unit: str) -> str:
    """Text of a value in SI in a unit of suitable size."""
    return unit_for(abs(value), unit)(value, 4)
