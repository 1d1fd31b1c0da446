"""Heads of tables: quantities that a name may mean, and the unit after the name.

A single letter behind a name is a unit only as it is written: `force N`, but not
`channel n`.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cache, cached_property

from solver.files.units import (
    SYMBOLS,
    examples_of,
    is_spelt_as_unit,
    parse_unit,
    size_in,
)
from solver.settings.values import Refuse

WORDS = {
    "time": "time t zeit elapsed sec secs second seconds sekunde sekunden",
    "position": "position x pos ort stelle",
    "force": "force load f fx fy fz p kraft last tension zugkraft loadcell",
    "displacement": (
        "displacement disp displ u ux uy uz weg verschiebung deflection durchbiegung "
        "stroke hub travel extension ext elongation crosshead traverse movement "
        "settlement setzung"
    ),
    "pressure": "pressure load p druck last traction stress spannung",
    "friction force": "friction frictiontraction reibung reibkraft reibungskraft",
    "moment": "moment load last torque",
    "gap": "gap spalt",
    "slip": "slip gleitweg",
    "angle": "angle winkel slope neigung",
    "curvature": "curvature krümmung",
    "factor": "factor faktor",
    "interface": "interface contact joint fuge grenzfläche",
    "layer": "layer leaf lage blatt schicht",
    "share": "share anteil",
    "wires": "wires wire number drähte drahtzahl anzahl",
    "diameter": "diameter d durchmesser",
    "lay angle": "lay angle alpha α winkel schlagwinkel",
    "modulus": "modulus e young modul elastizitätsmodul",
    "body": "body part körper bauteil",
    "ratio": "ratio poisson ν querdehnzahl",
    "weight": "weight gewicht wichte",
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
"""Quantities of a setting by its unit."""
DIRECTIONS = "x", "y", "z"
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
    "winkel",
    "moment",
    "krümmung",
)
_BRACKETS = re.compile(r"(.*?)\s*[\[(](?:in )?([^\[\]()]*)[\])][^\[\]()]*")
_BEHIND = re.compile(r"(.*?)[\s,_/.:;-]+([^\s,_]+)")
_IN_OR_SLASH = re.compile(r"(.*?)(?:\s+in\s+|\s*/\s*)(.+)")


@dataclass(frozen=True)
class TableColumn:
    """A column of a table: index, name, unit, and the line of the head."""

    number: int
    line: int = 0
    name: str = ""
    unit: str = ""

    @property
    def key(self) -> str:
        """Name of the column in the spelling of settings."""
        return re.sub(r"[\s_-]+", "_", self.name.lower())

    @property
    def is_known(self) -> bool:
        """Check whether the column names a quantity, or has a unit."""
        return bool(self.quantities[0] or self.unit)

    @cached_property
    def quantities(self) -> tuple[frozenset[str], bool]:
        """Quantities that the name may mean, and whether the whole name means them."""
        name = self.key.replace("_", " ").rstrip(" .:")
        # A head may be `load cell`, `Axial Force 2` or `Prüfzeit`: the whole name, its
        # last word without a number, and its ending are tried.
        joined = name.replace(" ", "")
        last = name.rstrip("0123456789 ").rpartition(" ")[2]
        words = [name, joined, last]
        # Of a displacement along x the last word is its direction.
        if last in DIRECTIONS:
            words.insert(2, name.partition(" ")[0])
        words += [ending for ending in _ENDINGS if last.endswith(ending)][:1]
        for word in words:
            meant = _meant_by().get(word)
            if meant:
                return meant, word.replace(" ", "") == joined
        return frozenset(), False

    def size(self, unit: str, refuse: Refuse) -> float:
        """Factor from the column's unit to another; refuse other dimensions."""
        if not self.unit:
            return 1.0
        size = size_in(self.unit, unit)
        if size is None:
            raise refuse(
                f"line {self.line} says {self.unit}: give it in {examples_of(unit)}"
            )
        return size

    def with_units(self, line: int, cells: list[str], refuse: Refuse) -> TableColumn:
        """Make the column with its unit from a line of units; refuse a second unit."""
        unit = ""
        if self.number < len(cells):
            unit = cells[self.number].strip("()[]")
        if not unit:
            return self
        if self.unit and parse_unit(unit) != parse_unit(self.unit):
            raise refuse(
                f"line {line} says {unit}, and line {self.line} {self.unit}: give one"
            )
        return replace(self, line=line, unit=unit)

    def message(self, default: str, unit: str) -> str:
        """Text of the column as it was understood, with a default name and unit."""
        name = self.name or default
        if self.unit.strip("-1"):
            return f"{name} in {self.unit}"
        if self.unit or not unit:
            return name
        if self.name:
            return f"{name} in {unit} (no unit given)"
        return f"{name} in {unit}"


@cache
def _meant_by() -> dict[str, frozenset[str]]:
    """Quantities that each word of `WORDS` may mean, by word."""
    meant: dict[str, frozenset[str]] = {}
    for kind, words in WORDS.items():
        for word in [kind, *words.split()]:
            meant[word] = meant.get(word, frozenset()) | {kind}
    return meant


def column_of(number: int, line: int, head: str) -> TableColumn:
    """Make the column of a head, which is split into name and unit."""
    # Brackets are certain, a last word only if it is spelt as a unit; after a slash or
    # "in" an unknown word is taken for one, too, and refused later.
    in_brackets = _BRACKETS.fullmatch(head)
    if in_brackets is not None:
        return TableColumn(number, line, *in_brackets.groups())
    behind = _BEHIND.fullmatch(head)
    if behind and _is_unit_behind(behind[2]):
        name = re.sub(r"\s+in$", "", behind[1])
        return TableColumn(number, line, name, behind[2])
    divided = _IN_OR_SLASH.fullmatch(head)
    if divided is not None:
        return TableColumn(number, line, *divided.groups())
    return TableColumn(number, line, head)


def _is_unit_behind(word: str) -> bool:
    """Check whether the last word of a head is a unit, not the letter of a channel."""
    return is_spelt_as_unit(word) and (len(word) > 1 or word in SYMBOLS)


def quantities_of(title: str, units: str) -> Collection[str]:
    """Quantities that a title names, else those of some units, such as `Pa or m`."""
    named = TableColumn(0, name=title).quantities[0]
    if named:
        return named
    quantities: set[str] = set()
    for unit in units.split(" or "):
        quantities |= KINDS.get(unit, set())
    return quantities


def quantities_of_axis(title: str, unit: str) -> Collection[str]:
    """Quantities of an axis of a loop: those of its unit, and that its title names.

    A title begins with the quantity, as in *Slip at the well*.
    """
    first = title.partition(" ")[0]
    named = TableColumn(0, name=first).quantities[0]
    return KINDS.get(unit, {unit}) | named


def are_units(cells: list[str]) -> bool:
    """Check whether a line is a line of units.

    Symbols of quantities, as t, s and F, are no units. At least half of the cells are
    units, as prose may have an "in".
    """
    # Cells that are "-" or "1" are units that prove nothing.
    words = [cell.strip("()[]") for cell in cells if cell.strip("()[]-1")]
    units = [word for word in words if is_spelt_as_unit(word)]
    others = [word for word in words if word not in units]
    is_named = any(TableColumn(0, name=word).quantities[1] for word in others)
    return bool(units) and 2 * len(units) >= len(words) and not is_named
