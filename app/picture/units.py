"""Units that values are read in: chosen by size, or those of mm, N and MPa, or of SI throughout."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

BY_SIZE, MM, SI = "size", "mm", "si"
SYSTEMS = {
    BY_SIZE: "by size: µm, mm, N, kN, MPa",
    MM: "mm, N, MPa",
    SI: "SI: m, N, Pa",
}
"""What one may choose, and how that is called."""
COOKIE = "slipfront-units"
"""By which a browser keeps the choice: the first picture has it already."""
PREFIXES = {"n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
PREFIXED = ("m", "N", "Pa", "J", "N/m", "N/m^3", "N·m", "N·m/m", "rad")
"""Units that take a prefix; all others stand as they are, but for area and time."""
AREA = "m^2"
TIME = "s"
KNOWN = (*PREFIXED, AREA, TIME)
OF_MM = {
    "m": ("mm", 1e-3),
    AREA: ("mm²", 1e-6),
    "Pa": ("MPa", 1e6),
    "N/m": ("N/mm", 1e3),
    "N/m^3": ("N/mm³", 1e9),
    "J": ("mJ", 1e-3),
    "N·m": ("N·mm", 1e-3),
    "N·m/m": ("N·mm/mm", 1.0),
}
NAMED = {AREA: {"mm²": 1e-6, "m²": 1.0}, TIME: {"s": 1.0, "h": 3600.0, "d": 86400.0}}
"""Of units without a prefix."""
LATER = {"GPa": 10.0, "GN/m³": 10.0, "h": 3.0, "d": 3.0}
"""Where a step begins that is not taken from 1 on: a stress of 3000 MPa is told as that. Zero has
the unit in which its slider ends: of a force per volume 1000 MN/m³, and weights are small."""
EXPONENTS = str.maketrans({"^": "", "2": "²", "3": "³"})
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
POWERS = Path(__file__).with_name("powers.js").read_text(encoding="utf-8")
TICKS = f"{POWERS}return powers(Number(tick.toPrecision(6)))"
"""Writes the numbers of an axis: 4·10⁸ and not 4.000e+8."""


class UnitStep(NamedTuple):
    """A unit that a value may be read in.

    Attributes
    ----------
    factor
        Its size in SI.
    least
        Smallest value, in SI, for which it is chosen.
    """

    name: str
    factor: float
    least: float = 0.0


def steps(unit: str, units: str = BY_SIZE) -> list[UnitStep]:
    """Give the units that values of an SI unit are read in, the smallest first."""
    plain = [UnitStep(unit.translate(EXPONENTS), 1.0)]
    if units == MM:
        return [UnitStep(*OF_MM[unit])] if unit in OF_MM else plain
    if units == SI or unit not in KNOWN:
        return plain
    named = NAMED.get(unit) or _prefixed(plain[0].name)
    found = [UnitStep(name, size, size * LATER.get(name, 1.0)) for name, size in named.items()]
    return [found[0]._replace(least=0.0), *found[1:]]


def _prefixed(unit: str) -> dict[str, float]:
    return {prefix + unit: factor for prefix, factor in PREFIXES.items()}


def scale_of(size: float, unit: str, units: str = BY_SIZE) -> tuple[float, str]:
    """Choose a unit for values up to a size; give the factor to divide by, and its name."""
    known = bool(np.isfinite(size) and size > 0.0)
    rounded = float(f"{size:.3g}") if known else 1.0
    found = [one for one in steps(unit, units) if one.least <= rounded * (1.0 + 1e-9)][-1]
    return found.factor, found.name


def titled(title: str, unit: str) -> str:
    """Name a quantity with its unit, if it has one."""
    return f"{title} ({unit})" if unit else title


def of_files(units: str) -> str:
    """Give the units of a file, in which they do not follow the size: a program reads it."""
    return SI if units == BY_SIZE else units


def minus(text: str) -> str:
    """Write a minus as it is printed."""
    return text.replace("-", "−")


def measured(value: float, unit: str, units: str = BY_SIZE, digits: int = 3) -> str:
    """Write a value with its unit."""
    factor, name = scale_of(abs(value), unit, units)
    scaled = float(f"{value / factor:.{digits}g}")
    if units == BY_SIZE and unit and scaled and not 1e-3 <= abs(scaled) < 1e5:
        scaled, name = value, unit
    return f"{rounded(scaled, digits)} {name}".strip()


def rounded(value: float, digits: int = 3) -> str:
    """Write a number, where it is very large or small with a power of ten."""
    near = float(f"{value:.{digits}g}")
    is_far = near != 0.0 and np.isfinite(near) and not 1e-3 <= abs(near) < 1e6
    return power(value, digits) if is_far else f"{near:.7g}"


def power(value: float, digits: int) -> str:
    """Write a number with a power of ten."""
    digit, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{float(digit):g}·10{str(int(exponent)).translate(RAISED)}"
