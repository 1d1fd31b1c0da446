"""Units of columns: their spellings, sizes and dimensions.

Units are SI with prefixes, inches, feet, pounds, kips and kiloponds of force, and psi;
with their products, quotients and powers. A symbol is first taken as it is written
(`mN`, `MN`), else without regard to capitals, or as a word (`SPELLINGS`: `KN`, `Sec`,
`inches`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from fractions import Fraction

Dimensions = tuple[int, ...]
"""Exponents of N, m, s, ° and K."""

INCH = Fraction("0.0254")
KILOPOND = Fraction("9.80665")
POUND = Fraction("0.45359237") * KILOPOND
"""Sizes of an inch, m, of a kilopond and of a pound of force, N, by definition. A pound
of mass is not known, as no table that is read here has masses."""
_POWERS = {
    "n": -9,
    "µ": -6,
    "μ": -6,
    "u": -6,
    "m": -3,
    "c": -2,
    "": 0,
    "da": 1,
    "h": 2,
    "k": 3,
    "M": 6,
    "G": 9,
}
"""Powers of ten by prefixes."""
_WITH_PREFIX: dict[str, tuple[int, Dimensions]] = {
    "N": (1, (1, 0, 0, 0, 0)),
    "m": (1, (0, 1, 0, 0, 0)),
    "s": (1, (0, 0, 1, 0, 0)),
    "Pa": (1, (1, -2, 0, 0, 0)),
    "bar": (100_000, (1, -2, 0, 0, 0)),
    "Nm": (1, (1, 1, 0, 0, 0)),
}
"""Size in SI and dimensions of units that may have a prefix."""


def _prefixed() -> dict[str, tuple[Fraction, Dimensions]]:
    """Size in SI and dimensions of all units of `_WITH_PREFIX` with all prefixes."""
    symbols = {}
    for unit, (size, dimensions) in _WITH_PREFIX.items():
        for prefix, power in _POWERS.items():
            symbols[prefix + unit] = (size * Fraction(10) ** power, dimensions)
    return symbols


SYMBOLS: dict[str, tuple[Fraction, Dimensions]] = _prefixed() | {
    "Nmm": (Fraction(1, 1000), (1, 1, 0, 0, 0)),
    "in": (INCH, (0, 1, 0, 0, 0)),
    "ft": (12 * INCH, (0, 1, 0, 0, 0)),
    "lbf": (POUND, (1, 0, 0, 0, 0)),
    "kip": (1000 * POUND, (1, 0, 0, 0, 0)),
    "kp": (KILOPOND, (1, 0, 0, 0, 0)),
    "psi": (POUND / INCH**2, (1, -2, 0, 0, 0)),
    "ksi": (1000 * POUND / INCH**2, (1, -2, 0, 0, 0)),
    "min": (Fraction(60), (0, 0, 1, 0, 0)),
    "h": (Fraction(3600), (0, 0, 1, 0, 0)),
    "°": (Fraction(1), (0, 0, 0, 1, 0)),
    "deg": (Fraction(1), (0, 0, 0, 1, 0)),
    # In small letters it would be the hundredth of a right angle.
    "Grad": (Fraction(1), (0, 0, 0, 1, 0)),
    "rad": (Fraction(180.0 / math.pi), (0, 0, 0, 1, 0)),
    "K": (Fraction(1), (0, 0, 0, 0, 1)),
    "°C": (Fraction(1), (0, 0, 0, 0, 1)),
    "%": (Fraction(1, 100), (0, 0, 0, 0, 0)),
    "1": (Fraction(1), (0, 0, 0, 0, 0)),
    "-": (Fraction(1), (0, 0, 0, 0, 0)),
}
"""Size in SI and dimensions of all units by their symbols."""
SPELLINGS = {
    "s": "s",
    "sec": "s",
    "secs": "s",
    "second": "s",
    "seconds": "s",
    "sek": "s",
    "sekunde": "s",
    "sekunden": "s",
    "ms": "ms",
    "msec": "ms",
    "millisecond": "ms",
    "milliseconds": "ms",
    "millisekunden": "ms",
    "min": "min",
    "mins": "min",
    "minute": "min",
    "minutes": "min",
    "minuten": "min",
    "h": "h",
    "hr": "h",
    "hrs": "h",
    "hour": "h",
    "hours": "h",
    "std": "h",
    "stunden": "h",
    "m": "m",
    "meter": "m",
    "meters": "m",
    "metre": "m",
    "metres": "m",
    "cm": "cm",
    "centimeter": "cm",
    "centimeters": "cm",
    "centimetre": "cm",
    "centimetres": "cm",
    "mm": "mm",
    "millimeter": "mm",
    "millimeters": "mm",
    "millimetre": "mm",
    "millimetres": "mm",
    "um": "µm",
    "µm": "µm",
    "μm": "µm",
    "micron": "µm",
    "microns": "µm",
    "micrometer": "µm",
    "micrometers": "µm",
    "micrometre": "µm",
    "micrometres": "µm",
    "mikrometer": "µm",
    "in": "in",
    '"': "in",
    "ins": "in",
    "inch": "in",
    "inches": "in",
    "zoll": "in",
    "ft": "ft",
    "foot": "ft",
    "feet": "ft",
    "n": "N",
    "newton": "N",
    "newtons": "N",
    "kn": "kN",
    "kilonewton": "kN",
    "kilonewtons": "kN",
    "dan": "daN",
    "meganewton": "MN",
    "meganewtons": "MN",
    "lb": "lbf",
    "lbs": "lbf",
    "lbf": "lbf",
    "pound": "lbf",
    "pounds": "lbf",
    "kip": "kip",
    "kips": "kip",
    "klbf": "kip",
    "kp": "kp",
    "kgf": "kp",
    "kilopond": "kp",
    "nm": "Nm",
    "knm": "kNm",
    "nmm": "Nmm",
    "pa": "Pa",
    "pascal": "Pa",
    "pascals": "Pa",
    "kpa": "kPa",
    "kilopascal": "kPa",
    "mpa": "MPa",
    "megapascal": "MPa",
    "gpa": "GPa",
    "bar": "bar",
    "mbar": "mbar",
    "psi": "psi",
    "ksi": "ksi",
    "deg": "°",
    "degree": "°",
    "degrees": "°",
    "rad": "rad",
    "radian": "rad",
    "radians": "rad",
    "k": "K",
    "kelvin": "K",
    "°c": "°C",
    "degc": "°C",
    "celsius": "°C",
    "percent": "%",
    "prozent": "%",
}
"""Symbols of units by their other spellings, in small letters."""
_NOT_TAKEN = {
    "kg",
    "hz",
    "v",
    "volt",
    "volts",
    "mv",
}
"""Units that are recognised, and refused, as no quantity that is read has them."""
_SPELT = {symbol.lower() for symbol in SYMBOLS if symbol.strip("1-")}
_SPELT |= SPELLINGS.keys() | _NOT_TAKEN
"""All spellings of units, in small letters."""
DOUBTFUL = 0.8
"""Powers of a thousand from which on numbers without a unit are doubted: 250 times."""
_PREFIXES = {
    -3: "G",
    -2: "M",
    -1: "k",
    1: "m",
    2: "µ",
    3: "n",
}
"""Likely prefixes by the power of a thousand by which numbers are too large."""
_EXAMPLES = {
    "s": "s, ms, min, h",
    "m": "m, mm, µm",
    "N": "N, kN, MN",
    "N/m": "N/m, kN/m, N/mm",
    "Pa": "Pa, kPa, MPa, GPa, bar, N/mm2",
    "°": "°, deg, rad",
    "1/m": "1/m, 1/mm",
    "K": "K, °C",
    "N·m/m": "N·m/m, kN·m/m, N",
    "": "plain numbers or %",
}
"""Units that a message proposes, by the unit of a setting."""


def parse_unit(text: str) -> tuple[float, Dimensions] | None:
    """Size in SI and dimensions of a unit such as `kN/m`; None of another text."""
    size = Fraction(1)
    total = [0, 0, 0, 0, 0]
    for sign, symbol, power in _factors(text):
        # As it is written comes first: in small letters mN and MN would be one.
        known = symbol
        if symbol not in SYMBOLS:
            known = SPELLINGS.get(symbol.lower(), "")
        if not known:
            return None
        exponent = sign * int(power or 1)
        factor, dimensions = SYMBOLS[known]
        size *= factor**exponent
        for axis, dimension in enumerate(dimensions):
            total[axis] += exponent * dimension
    return float(size), tuple(total)


def _factors(text: str) -> Iterable[tuple[int, str, str]]:
    """Yield the factors of a unit: sign of the exponent, symbol, exponent."""
    # Powers are written in many ways, as m², m^2 and m2.
    plain = text.strip().replace("²", "2").replace("³", "3").replace("^", "")
    # A hyphen between letters is a product, as in kN-m.
    plain = re.sub(r"(?<=[^\W\d])-(?=[^\W\d])", "·", plain)
    for operator, factor in re.findall(r"(^|\s*[/·*.]\s*|\s+)([^/·*.\s]+)", plain):
        sign = -1 if "/" in operator else 1
        match = re.fullmatch(r"(\D+?)(-?\d?)", factor)
        if match:
            yield sign, match[1], match[2]
        else:
            yield sign, factor, ""


def is_spelt_as_unit(text: str) -> bool:
    """Check whether a word is a unit in any spelling (kN, KN, inches), or kg."""
    symbols = [symbol for _, symbol, _ in _factors(text)]
    letters = [symbol for symbol in symbols if symbol not in "1-"]
    return bool(letters) and all(symbol.lower() in _SPELT for symbol in letters)


def size_in(text: str, units: str) -> float | None:
    """Factor from a unit to one of `units`, as `Pa or m`; None for other dimensions."""
    given = parse_unit(text)
    for unit in units.split(" or "):
        wanted = parse_unit(unit)
        if given and wanted and given[1] == wanted[1]:
            return given[0] / wanted[0]
    return None


def unit_doubt(name: str, unit: str, size: float, usual: float, of: str) -> str:
    """Message on numbers without a unit, thousand times too large or small; else "".

    Parameters
    ----------
    name
        Name of the column.
    unit
        Unit that the numbers are taken in; plain numbers, of no unit, are not doubted.
    size, usual
        Largest number, and a usual size to compare it with, both positive.
    of
        Words on the usual size.
    """
    if not unit or not (math.isfinite(size * usual) and size * usual > 0.0):
        return ""
    # Prefixes go by thousands, so a forgotten one shows as a power of 1000.
    thousands = math.log10(size / usual) / 3.0
    if abs(thousands) < DOUBTFUL:
        return ""
    remedy = "name its unit in the head"
    prefix = _PREFIXES.get(round(thousands), "")
    if prefix and unit in _WITH_PREFIX:
        likely = f"{prefix}{unit}"
        remedy = f"if it is in {likely}, name that in the head, as in {name} [{likely}]"
    times = f"{float(f'{size / usual:.1g}'):g} times that of {of}"
    return f"{name} has no unit, and taken in {unit} it is {times}: {remedy}"


def examples_of(units: str) -> str:
    """Text of examples of units that a column may have, by the unit of a setting."""
    return " or ".join(_EXAMPLES.get(unit, unit) for unit in units.split(" or "))
