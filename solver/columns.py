"""Columns of tables by their heads: what a name means, and the unit behind it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

from solver.definitions import SettingError
from solver.units import examples_of, is_spelt_as_unit, parse_unit, size_in

Refuse = Callable[[str], SettingError]
WORDS = {
    "time": "time t zeit",
    "position": "position x ort stelle",
    "force": "force load f kraft last tension zugkraft",
    "displacement": "displacement u weg verschiebung deflection durchbiegung",
    "pressure": "pressure load p druck last traction stress spannung",
    "friction force": "friction reibung reibkraft reibungskraft",
    "moment": "moment load last biegemoment",
    "gap": "gap spalt",
    "angle": "angle winkel",
    "curvature": "curvature krümmung",
    "factor": "factor faktor",
    "strain": "strain dehnung",
    "velocity": "velocity speed geschwindigkeit",
    "temperature": "temperature temperatur",
    "frequency": "frequency frequenz",
}
"""Quantities, and what heads call them beside that, in small letters."""
_ENDINGS = "zeit", "kraft", "weg", "verschiebung", "druck", "spannung"
_BRACKETS = re.compile(r"(.*?)\s*[\[(](?:in )?([^\[\]()]*)[\])][^\[\]()]*")
_BEHIND = re.compile(r"(.*?)[\s,_/.:;-]+([^\s,_]+)")
_IN_OR_SLASH = re.compile(r"(.*?)(?:\s+in\s+|\s*/\s*)(.+)")


@dataclass(frozen=True)
class TableColumn:
    """A column by its head.

    Attributes
    ----------
    place
        Number of the column, from 0.
    line
        Number of the line of its unit, or else of its name.
    name, unit
        As they are written; empty where there is none.
    """

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
        """Whether it names a quantity, or has a unit."""
        return bool(self.quantities[0] or self.unit)

    @cached_property
    def quantities(self) -> tuple[frozenset[str], bool]:
        """Quantities that its name may mean, and whether all of it is a word for them."""
        name = self.key.replace("_", " ")
        last = name.rstrip("0123456789 ").rpartition(" ")[2]
        ending = next((word for word in _ENDINGS if last.endswith(word)), "")
        for word in (name, last, ending):
            meant = {kind for kind, words in WORDS.items() if word in [kind, *words.split()]}
            if meant:
                return frozenset(meant), word == name
        return frozenset(), False

    def size(self, unit: str, refuse: Refuse) -> float:
        """Return the size of its unit in another; refuse one that measures something else."""
        size = size_in(self.unit, unit) if self.unit else 1.0
        if size is None:
            raise refuse(f"line {self.line} says {self.unit}: give it in {examples_of(unit)}")
        return size

    def with_units(self, line: int, cells: list[str], refuse: Refuse) -> TableColumn:
        """Return the column with what a line of units says of it."""
        unit = cells[self.place].strip("()[]") if self.place < len(cells) else ""
        if not unit:
            return self
        if self.unit and parse_unit(unit) != parse_unit(self.unit):
            raise refuse(f"line {line} says {unit}, and line {self.line} {self.unit}: give one")
        return replace(self, line=line, unit=unit)

    def message(self, default: str, unit: str) -> str:
        """Describe what was understood of it."""
        name = self.name or default
        if self.unit or not unit:
            return f"{name} in {self.unit}" if self.unit.strip("-1") else name
        return f"{name} in {unit}{' (no unit given)' if self.name else ''}"


def column_of(place: int, line: int, head: str) -> TableColumn:
    """Split a head into name and unit."""
    behind, match = _BEHIND.fullmatch(head), _BRACKETS.fullmatch(head)
    if match is None and behind and is_spelt_as_unit(behind[2]):
        return TableColumn(place, line, re.sub(r"\s+in$", "", behind[1]), behind[2])
    match = match or _IN_OR_SLASH.fullmatch(head)
    return TableColumn(place, line, *(match.groups() if match else (head,)))


def are_units(cells: list[str]) -> bool:
    """Whether a line is one of units; symbols of quantities, as t, s and F, are none."""
    is_named = any(TableColumn(0, name=cell).quantities[1] for cell in cells)
    return not is_named and any(is_spelt_as_unit(cell.strip("()[]")) for cell in cells)
