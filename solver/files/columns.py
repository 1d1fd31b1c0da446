"""Heads of tables: what a name means, and the unit behind it, as people write them.

Units are SI with prefixes, inches, feet, pounds, kips and kiloponds of force, and psi;
with their products, quotients and powers. A symbol is first taken as it is written
(`mN`, `MN`), else without regard to capitals, or as a word (`SPELLINGS`: `KN`, `Sec`,
`inches`). A single letter behind a name is a unit only as it is written: `force N`, but
not `channel n`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property

from solver.files.disk import Refuse

WORDS = {
    "time": "time t zeit elapsed sec secs second seconds sekunde sekunden",
    "position": "position x pos ort stelle",
    "force": "force load f fx fy fz p kraft last tension zugkraft loadcell",
    "displacement": (
        "displacement disp displ u ux uy uz weg verschiebung deflection durchbiegung "
        "stroke hub travel extension ext elongation crosshead traverse"
    ),
    "pressure": "pressure load p druck last traction stress spannung",
    "friction force": "friction reibung reibkraft reibungskraft",
    "moment": "moment load last biegemoment",
    "gap": "gap spalt",
    "slip": "slip gleitweg",
    "angle": "angle winkel",
    "curvature": "curvature krümmung",
    "factor": "factor faktor",
    "interface": "interface joint fuge grenzfläche",
    "layer": "layer leaf lage blatt schicht",
    "share": "share anteil",
    "wires": "wires wire number drähte drahtzahl anzahl",
    "diameter": "diameter d durchmesser",
    "lay angle": "lay angle alpha α winkel schlagwinkel",
    "modulus": "modulus e young modul elastizitätsmodul",
    "strain": "strain dehnung",
    "velocity": "velocity speed geschwindigkeit",
    "temperature": "temperature temperatur",
    "frequency": "frequency frequenz",
}
"""Quantities, and what heads call them beside that, in small letters."""
KINDS = {
    "m": {"displacement"},
    "N": {"force", "friction force"},
    "N/m": {"force"},
    "Pa": {"pressure"},
    "N·m": {"moment"},
    "N·m/m": {"moment"},
    "1/m": {"curvature"},
    "rad": {"angle"},
    "°": {"angle"},
    "K": {"temperature"},
    "": {"strain"},
}
"""Quantities by the unit of what they are read for."""
_ENDINGS = (
    "zeit",
    "time",
    "kraft",
    "force",
    "last",
    "load",
    "weg",
    "verschiebung",
    "displacement",
    "disp",
    "position",
    "druck",
    "spannung",
)
_BRACKETS = re.compile(r"(.*?)\s*[\[(](?:in )?([^\[\]()]*)[\])][^\[\]()]*")
_BEHIND = re.compile(r"(.*?)[\s,_/.:;-]+([^\s,_]+)")
_IN_OR_SLASH = re.compile(r"(.*?)(?:\s+in\s+|\s*/\s*)(.+)")

Dimensions = tuple[int, ...]
"""Exponents of N, m, s, ° and K."""

INCH = Fraction("0.0254")
KILOPOND = Fraction("9.80665")
POUND = Fraction("0.45359237") * KILOPOND
"""Of force; as mass it is not taken, as there is none in what is read here. All by
definition."""
_POWERS = {"n": -9, "µ": -6, "μ": -6, "u": -6, "m": -3, "c": -2, "": 0, "da": 1, "h": 2}
_POWERS |= {"k": 3, "M": 6, "G": 9}
_WITH_PREFIX: dict[str, tuple[int, Dimensions]] = {
    "N": (1, (1, 0, 0, 0, 0)),
    "m": (1, (0, 1, 0, 0, 0)),
    "s": (1, (0, 0, 1, 0, 0)),
    "Pa": (1, (1, -2, 0, 0, 0)),
    "bar": (100_000, (1, -2, 0, 0, 0)),
    "Nm": (1, (1, 1, 0, 0, 0)),
}
_SYMBOLS: dict[str, tuple[Fraction, Dimensions]] = {
    prefix + unit: (size * Fraction(10) ** power, dimensions)
    for unit, (size, dimensions) in _WITH_PREFIX.items()
    for prefix, power in _POWERS.items()
} | {
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
    "rad": (Fraction(180.0 / math.pi), (0, 0, 0, 1, 0)),
    "K": (Fraction(1), (0, 0, 0, 0, 1)),
    "°C": (Fraction(1), (0, 0, 0, 0, 1)),
    "%": (Fraction(1, 100), (0, 0, 0, 0, 0)),
    "1": (Fraction(1), (0, 0, 0, 0, 0)),
    "-": (Fraction(1), (0, 0, 0, 0, 0)),
}
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
"""Symbols of units by how they are written otherwise, in small letters."""
_NOT_TAKEN = {"kg", "hz", "v", "volt", "volts", "mv"}
_SPELT = {
    symbol.lower() for symbol in _SYMBOLS if symbol.strip("1-")
} | SPELLINGS.keys()
_SPELT |= _NOT_TAKEN
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
"""By the powers of a thousand by which numbers in that unit are too large."""
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


@dataclass(frozen=True)
class TableColumn:
    """A column by its number, the line of its unit or name, and both as they are written."""

    place: int
    line: int = 0
    name: str = ""
    unit: str = ""

    @property
    def key(self) -> str:
        """Its name as settings are named."""
        return re.sub(r"[\s_-]+", "_", self.name.lower())

    @property
    def is_known(self) -> bool:
        """Return whether it names a quantity, or has a unit."""
        return bool(self.quantities[0] or self.unit)

    @cached_property
    def quantities(self) -> tuple[frozenset[str], bool]:
        """Quantities that its name may mean, and whether all of it is a word for them."""
        name = self.key.replace("_", " ").rstrip(" .:")
        last = name.rstrip("0123456789 ").rpartition(" ")[2]
        ending = next((word for word in _ENDINGS if last.endswith(word)), "")
        for word in (name, name.replace(" ", ""), last, ending):
            if meant := _meant_by().get(word):
                return meant, word.replace(" ", "") == name.replace(" ", "")
        return frozenset(), False

    def size(self, unit: str, refuse: Refuse) -> float:
        """Size of its unit in another; refuse one that measures something else."""
        if self.unit:
            size = size_in(self.unit, unit)
        else:
            size = 1.0
        if size is None:
            raise refuse(
                f"line {self.line} says {self.unit}: give it in {examples_of(unit)}"
            )
        return size

    def with_units(self, line: int, cells: list[str], refuse: Refuse) -> TableColumn:
        """The column with what a line of units says of it."""
        if self.place < len(cells):
            unit = cells[self.place].strip("()[]")
        else:
            unit = ""
        if not unit:
            return self
        if self.unit and parse_unit(unit) != parse_unit(self.unit):
            raise refuse(
                f"line {line} says {unit}, and line {self.line} {self.unit}: give one"
            )
        return replace(self, line=line, unit=unit)

    def message(self, default: str, unit: str) -> str:
        """Describe what was understood of it."""
        name = self.name or default
        if self.unit or not unit:
            if self.unit.strip("-1"):
                return f"{name} in {self.unit}"
            return name
        return f"{name} in {unit}{' (no unit given)' if self.name else ''}"


@cache
def _meant_by() -> dict[str, frozenset[str]]:
    """Quantities that each word of `WORDS` may mean."""
    meant: dict[str, frozenset[str]] = {}
    for kind, words in WORDS.items():
        for word in [kind, *words.split()]:
            meant[word] = meant.get(word, frozenset()) | {kind}
    return meant


def column_of(place: int, line: int, head: str) -> TableColumn:
    """Split a head into name and unit."""
    behind = _BEHIND.fullmatch(head)
    match = _BRACKETS.fullmatch(head)
    if match is None and behind and _is_unit_behind(behind[2]):
        return TableColumn(place, line, re.sub(r"\s+in$", "", behind[1]), behind[2])
    match = match or _IN_OR_SLASH.fullmatch(head)
    return TableColumn(place, line, *(match.groups() if match else (head,)))


def _is_unit_behind(word: str) -> bool:
    """Return whether the last word of a head is its unit; a letter may number a channel instead."""
    return is_spelt_as_unit(word) and (len(word) > 1 or word in _SYMBOLS)


def quantities_of(title: str, units: str) -> Collection[str]:
    """Quantities that a title names, or else those of one of some units, such as `Pa or m`."""
    named = TableColumn(0, name=title).quantities[0]
    return named or set().union(*(KINDS.get(unit, ()) for unit in units.split(" or ")))


def are_units(cells: list[str]) -> bool:
    """Return whether a line is one of units; symbols of quantities, as t, s and F, are none.

    Half of its cells are units at least: in prose there may be an "in", too.
    """
    words = [cell.strip("()[]") for cell in cells if cell.strip("()[]-1")]
    units = [word for word in words if is_spelt_as_unit(word)]
    is_named = any(
        TableColumn(0, name=word).quantities[1] for word in words if word not in units
    )
    return bool(units) and 2 * len(units) >= len(words) and not is_named


def parse_unit(text: str) -> tuple[float, Dimensions] | None:
    """Size in SI and dimensions of a unit such as `kN/m`; None of what is none."""
    size = Fraction(1)
    exponents = [0, 0, 0, 0, 0]
    for sign, symbol, power in _factors(text):
        if symbol in _SYMBOLS:
            known = symbol
        else:
            known = SPELLINGS.get(symbol.lower(), "")
        if not known:
            return None
        exponent = sign * int(power or 1)
        factor, dimensions = _SYMBOLS[known]
        size *= factor**exponent
        exponents = [
            total + exponent * part
            for total, part in zip(exponents, dimensions, strict=True)
        ]
    return float(size), tuple(exponents)


def _factors(text: str) -> Iterable[tuple[int, str, str]]:
    """Sign of the exponent, symbol and exponent of every factor."""
    plain = text.strip().replace("²", "2").replace("³", "3").replace("^", "")
    # A hyphen between letters is a product, as in kN-m.
    plain = re.sub(r"(?<=[^\W\d])-(?=[^\W\d])", "·", plain)
    for operator, factor in re.findall(r"(^|\s*[/·*.]\s*|\s+)([^/·*.\s]+)", plain):
        match = re.fullmatch(r"(\D+?)(-?\d?)", factor)
        if match:
            symbol, power = match.groups()
        else:
            symbol = factor
            power = ""
        yield -1 if "/" in operator else 1, symbol, power


def is_spelt_as_unit(text: str) -> bool:
    """Return whether a word is a unit, as it is written or spelt (KN, inches), or one not taken (kg)."""
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


def unit_doubt(name: str, unit: str, size: float, usual: float, of: str) -> str:
    """Words where numbers without a unit are some thousand times off; empty where they are not.

    `size` is the largest number, taken in that unit, and `usual` one of what it is
    compared with, in the same unit, both positive; `of` says of what. Plain numbers are
    not doubted.
    """
    if not unit or not (math.isfinite(size * usual) and size * usual > 0.0):
        return ""
    thousands = math.log10(size / usual) / 3.0
    if abs(thousands) < DOUBTFUL:
        return ""
    prefix = _PREFIXES.get(round(thousands), "")
    if prefix and unit in _WITH_PREFIX:
        likely = f"{prefix}{unit}"
    else:
        likely = ""
    remedy = "name its unit in the head"
    if likely:
        remedy = f"if it is in {likely}, name that in the head, as in {name} [{likely}]"
    times = f"{float(f'{size / usual:.1g}'):g} times that of {of}"
    return f"{name} has no unit, and taken in {unit} it is {times}: {remedy}"


def examples_of(units: str) -> str:
    """Units that may stand in place of that of a setting."""
    return " or ".join(_EXAMPLES.get(unit, unit) for unit in units.split(" or "))
