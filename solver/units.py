"""Units as people write them: SI with prefixes, their products, quotients and powers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from fractions import Fraction

Dimensions = tuple[int, int, int, int]
"""Exponents of N, m, s and °."""

_POWERS = {"n": -9, "µ": -6, "μ": -6, "u": -6, "m": -3, "c": -2, "": 0, "da": 1, "h": 2}
_POWERS |= {"k": 3, "M": 6, "G": 9}
_WITH_PREFIX: dict[str, tuple[int, Dimensions]] = {
    "N": (1, (1, 0, 0, 0)),
    "m": (1, (0, 1, 0, 0)),
    "s": (1, (0, 0, 1, 0)),
    "Pa": (1, (1, -2, 0, 0)),
    "bar": (100_000, (1, -2, 0, 0)),
    "Nm": (1, (1, 1, 0, 0)),
}
_SYMBOLS: dict[str, tuple[Fraction, Dimensions]] = {
    prefix + unit: (size * Fraction(10) ** power, dimensions)
    for unit, (size, dimensions) in _WITH_PREFIX.items()
    for prefix, power in _POWERS.items()
} | {
    "Nmm": (Fraction(1, 1000), (1, 1, 0, 0)),
    "sec": (Fraction(1), (0, 0, 1, 0)),
    "min": (Fraction(60), (0, 0, 1, 0)),
    "h": (Fraction(3600), (0, 0, 1, 0)),
    "°": (Fraction(1), (0, 0, 0, 1)),
    "deg": (Fraction(1), (0, 0, 0, 1)),
    "rad": (Fraction(180.0 / math.pi), (0, 0, 0, 1)),
    "%": (Fraction(1, 100), (0, 0, 0, 0)),
    "1": (Fraction(1), (0, 0, 0, 0)),
    "-": (Fraction(1), (0, 0, 0, 0)),
}
_NOT_TAKEN = {"lbf", "lb", "lbs", "kip", "psi", "ksi", "in", "inch", "ft", "kgf", "kp", "kg", "hz"}
_SPELT = {symbol.lower() for symbol in _SYMBOLS if symbol.strip("1-")} | _NOT_TAKEN
_EXAMPLES = {
    "s": "s, ms, min, h",
    "m": "m, mm, µm",
    "N": "N, kN, MN",
    "N/m": "N/m, kN/m, N/mm",
    "Pa": "Pa, kPa, MPa, GPa, bar, N/mm2",
    "°": "°, deg, rad",
    "1/m": "1/m, 1/mm",
    "N·m/m": "N·m/m, kN·m/m, N",
    "": "plain numbers or %",
}


def parse_unit(text: str) -> tuple[float, Dimensions] | None:
    """Size in SI and dimensions of a unit such as `kN/m`; None of what is none."""
    size, exponents = Fraction(1), [0, 0, 0, 0]
    for sign, symbol, power in _factors(text):
        if symbol not in _SYMBOLS:
            return None
        exponent = sign * int(power or 1)
        size *= _SYMBOLS[symbol][0] ** exponent
        exponents = [
            total + exponent * part
            for total, part in zip(exponents, _SYMBOLS[symbol][1], strict=True)
        ]
    newtons, metres, seconds, degrees = exponents
    return float(size), (newtons, metres, seconds, degrees)


def _factors(text: str) -> Iterable[tuple[int, str, str]]:
    """Sign of the exponent, symbol and exponent of every factor."""
    plain = text.strip().replace("²", "2").replace("³", "3").replace("^", "")
    for operator, factor in re.findall(r"(^|\s*[/·*.]\s*|\s+)([^/·*.\s]+)", plain):
        match = re.fullmatch(r"(\D+?)(-?\d?)", factor)
        symbol, power = match.groups() if match else (factor, "")
        yield -1 if "/" in operator else 1, symbol, power


def is_spelt_as_unit(text: str) -> bool:
    """Whether a word is a unit, one in other letters (KN), or one that is not taken (lbf)."""
    symbols = [symbol for _, symbol, _ in _factors(text)]
    return any(symbol not in "1-" for symbol in symbols) and all(
        symbol in "1-" or symbol.lower() in _SPELT for symbol in symbols
    )


def size_in(text: str, units: str) -> float | None:
    """Size of a unit in that of a setting, such as `Pa or m`; None if it measures another."""
    given = parse_unit(text)
    for unit in units.split(" or "):
        wanted = parse_unit(unit)
        if given and wanted and given[1] == wanted[1]:
            return given[0] / wanted[0]
    return None


def examples_of(units: str) -> str:
    """Units that may stand in place of that of a setting."""
    return " or ".join(_EXAMPLES.get(unit, unit) for unit in units.split(" or "))
