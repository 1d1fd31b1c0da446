"""Tables as spreadsheets write them, and those of two columns for settings that are curves."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from pathlib import Path

from solver.definitions import CurveParameter, Parameter, SettingError, allowed
from solver.disk import LARGEST, TOO_LARGE, read_text, why

Row = tuple[int, list[str]]
"""Number of a line, and its cells, whose decimals have points."""
Refuse = Callable[[str], SettingError]
UNIT = re.compile(r"\s*(?:[\[(]([^\])]*)[\])]|/\s*(\S+))\s*$")
PREFIXES = {"": 1.0, "n": 1e-9, "µ": 1e-6, "μ": 1e-6, "u": 1e-6, "m": 1e-3}
PREFIXES |= {"k": 1e3, "M": 1e6, "G": 1e9}
NO_UNIT = "", "-", "1"


def read_table(text: str, definition: CurveParameter, name: str, source: str) -> list[list[float]]:
    """Read a table of two columns for a curve setting, as spreadsheets write it.

    Parameters
    ----------
    text
        CSV whose rows are abscissa, value. Between them stands a comma, or a semicolon or a tab,
        beside which decimals may have commas. Empty lines are passed over, and rows of words in
        front. A unit there, in brackets, behind a slash or in a row of units, may have a prefix.
    definition, name, source
        The setting it is for, and where the text comes from, used in messages.

    Raises
    ------
    SettingError
        For a table that is too large, a row without exactly two numbers, another unit, or columns
        the other way round.
    """

    def refuse(remedy: str) -> SettingError:
        return SettingError(name, source, allowed(definition), remedy)

    heads, rows = split_table(text, refuse)
    for line, cells in heads:
        if [name_of(cell) for cell in cells[1:]] == [definition.abscissa]:
            raise refuse(f"line {line} has {definition.abscissa} second: it comes first")
    first, second = factors(heads, definition.units, refuse)
    found = []
    for line, cells in rows:
        try:
            before, after = map(float, cells)
        except ValueError:
            remedy = f"line {line} is {text.splitlines()[line - 1]!r}, not two numbers"
            raise refuse(remedy) from None
        found.append([before * first, after * second])
    if not found:
        raise refuse("it has no points")
    return found


def heads_of(text: str) -> set[str]:
    """Give the words above a table, without their units, as settings are named."""
    try:
        heads, _ = _split(text)
    except csv.Error:
        return set()
    return {name_of(cell).replace(" ", "_") for _, cells in heads for cell in cells}


def split_table(text: str, refuse: Refuse) -> tuple[list[Row], list[Row]]:
    """Give the rows of words in front of the first number, and those from there on.

    Raises
    ------
    SettingError
        As `refuse` makes it, for a table that is too large, or none.
    """
    if len(text) > LARGEST:
        raise refuse(TOO_LARGE)
    try:
        return _split(text)
    except csv.Error as problem:
        raise refuse(str(problem)) from None


def _split(text: str) -> tuple[list[Row], list[Row]]:
    """Give the rows of words in front of the first number, and those from there on."""
    lines = text.splitlines()
    separator = next((sign for sign in "\t;" if sign in text), ",")
    table = enumerate(csv.reader(lines, delimiter=separator), start=1)
    rows = [(line, [cell.strip() for cell in cells]) for line, cells in table]
    rows = [(line, cells) for line, cells in rows if any(cells)]
    ends = (place for place, (_, cells) in enumerate(rows) if any(map(_is_number, cells)))
    end = next(ends, len(rows))
    heads, numbers = rows[:end], rows[end:]
    if separator != "," and not any("." in cell for _, cells in numbers for cell in cells):
        numbers = [(line, [cell.replace(",", ".") for cell in cells]) for line, cells in numbers]
    return heads, numbers


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def name_of(cell: str) -> str:
    """Give what a cell calls its column, without its unit, in small letters."""
    return UNIT.sub("", cell).strip().lower()


def factors(heads: list[Row], units: Sequence[str], refuse: Refuse) -> list[float]:
    """Give what turns the numbers of columns into SI, by the units in front of them.

    Raises
    ------
    SettingError
        As `refuse` makes it, for another unit than those of the columns.
    """
    found = [1.0] * len(units)
    for place, (line, cells) in enumerate(heads):
        bare = [_factor(cell, unit) for cell, unit in zip(cells, units, strict=False)]
        is_row_of_units = place > 0 and any(
            cell and factor for cell, factor in zip(cells, bare, strict=False)
        )
        for column, (cell, unit) in enumerate(zip(cells, units, strict=False)):
            written = UNIT.search(cell)
            said = cell if is_row_of_units else (written[1] or written[2] or "") if written else ""
            factor = _factor(said, unit)
            if factor is None:
                raise refuse(f"line {line} says {said}: give it in {unit or 'plain numbers'}")
            found[column] *= factor
    return found


def _factor(said: str, unit: str) -> float | None:
    """Give the size of a unit in that of a setting, which may be one of several."""
    if said in NO_UNIT:
        return 1.0
    sizes = (
        PREFIXES.get(said.removesuffix(one))
        for one in unit.split(" or ")
        if one and said.endswith(one)
    )
    return next((size for size in sizes if size is not None), None)


def _read_file(path: Path, definition: CurveParameter, name: str) -> list[list[float]]:
    try:
        text = read_text(path)
    except (OSError, ValueError) as problem:  # no text, or no path at all
        remedy = f"it is no preset, and no readable CSV file ({why(problem)})"
        raise SettingError(name, str(path), allowed(definition), remedy) from None
    return read_table(text, definition, name, str(path))


def resolve(definition: Parameter, name: str, value: object, folder: Path) -> object:
    """Replace the name of a CSV file, sought in a folder, by its points.

    Reading files is for fronts whose user owns the machine, so nothing else does it.
    """
    if not isinstance(definition, CurveParameter) or not isinstance(value, str) or not value:
        return value
    return value if value in definition.presets else _read_file(folder / value, definition, name)
