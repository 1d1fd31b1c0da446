"""Tables that people give for settings that are curves, and what was understood of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from solver.columns import TableColumn, examples_of
from solver.definitions import CurveParameter, SettingError, allowed
from solver.disk import read_bytes, why
from solver.scenes import CATALOGUE
from solver.settings import Settings
from solver.tables import Table, read_table

_BY_UNIT = {"Pa": "pressure", "m": "displacement", "N·m/m": "moment", "N/m": "force"}
"""Quantities of settings whose ordinate is called value."""
_SETTINGS = {
    name
    for entry in CATALOGUE.values()
    for name, definition in entry.settings.definitions().items()
    if isinstance(definition, CurveParameter) and "_" in name
}
"""Names of curves that are no common words: a column of another one is not taken."""


@dataclass(frozen=True)
class GivenCurve:
    """A curve out of a table.

    Attributes
    ----------
    points
        Abscissa and ordinate, or rows of a table, in the units of the setting.
    message
        What was understood.
    """

    points: list[list[float]]
    message: str


def curve_of(
    table: Table,
    definition: CurveParameter,
    name: str,
    units: Sequence[str],
) -> GivenCurve:
    """Choose the columns of a curve, and read its points.

    Parameters
    ----------
    table
        As `solver.tables.read_table` gives it.
    definition, name
        The setting.
    units
        Its units, as the other settings have them (`Settings.curve_units`).

    Raises
    ------
    SettingError
        If its columns cannot be chosen, for another unit, what is no number, or an abscissa that
        does not increase.
    """
    columns = _chosen(table, definition, name, units)
    sizes = [column.size(unit, table.refuse) for column, unit in zip(columns, units, strict=True)]
    numbers = table.numbers(columns)
    falls = np.flatnonzero(np.diff(numbers[0]) <= 0.0)
    if definition.is_path and len(falls):
        line = table.rows[falls[0] + 1][0]
        remedy = f"line {line}: {definition.abscissa} must increase from row to row"
        loop = "; of a loop, as force over displacement, give the time of every row"
        raise table.refuse(remedy + (loop if definition.abscissa == "time" else ""))
    each = "points" if definition.is_path else "rows"
    message = table.message(columns, definition.columns, units, numbers, each)
    return GivenCurve((numbers.T * sizes).tolist(), message)


def _chosen(
    table: Table,
    definition: CurveParameter,
    name: str,
    units: Sequence[str],
) -> Sequence[TableColumn]:
    """Choose the columns of abscissa and ordinate, or of a table."""
    columns = table.columns
    if not any(c.is_known for c in columns) and not _SETTINGS.intersection(c.key for c in columns):
        *others, last = definition.columns
        if len(columns) != len(others) + 1:
            names = f"{', '.join(others)} and {last}"
            raise table.refuse(f"it has {len(columns)} columns: name {names} in its first line")
        return columns
    likely = [column for column in columns if column.key == name or column.key not in _SETTINGS]
    if not definition.is_path:
        return _each(table, definition.columns, units)
    kinds: Collection[str] = TableColumn(0, name=definition.ordinate).quantities[0]
    kinds = kinds or {_BY_UNIT[unit] for unit in units[1].split(" or ")}
    names = ", ".join(repr(column.name) for column in columns)
    first = table.find(likely, {definition.abscissa}, units[0])
    if first is None:
        loop = ": a loop, as force over displacement, is no path over time"
        raise table.refuse(
            f"its head names no {definition.abscissa} (it has {names})"
            f"{loop if definition.abscissa == 'time' else ''}; add that column"
        )
    rest = [column for column in likely if column is not first]
    second = table.find(rest, kinds, units[1], name)
    if second is None and len(columns) == 2 and rest:
        second = None if rest[0].quantities[0] else rest[0]
    if second is None:
        wanted = f"{' or '.join(sorted(kinds))} in {examples_of(units[1])}"
        remedy = f"its head names no {wanted} (it has {names}): name one of them {name}"
        raise table.refuse(remedy)
    return first, second


def _each(table: Table, names: Sequence[str], units: Sequence[str]) -> Sequence[TableColumn]:
    """Choose a column of every name."""
    chosen = []
    for name, unit in zip(names, units, strict=True):
        rest = [column for column in table.columns if column not in chosen]
        column = table.find(rest, {name}, unit)
        if column is None:
            has = ", ".join(repr(column.name) for column in table.columns)
            raise table.refuse(f"its head names no {name} (it has {has}): add that column")
        chosen.append(column)
    return chosen


def read_tables(kind: type[Settings], values: dict[str, object], folder: Path) -> dict[str, Table]:
    """Tables in the CSV files that curves name, whose points replace the names in the values.

    Reading files is for fronts whose user owns the machine, so nothing else does it.
    """
    tables = {}
    for name, definition in kind.definitions().items():
        value = values.get(name)
        if not isinstance(definition, CurveParameter) or not isinstance(value, str):
            continue
        if value not in ("", *definition.presets):
            table = tables[name] = _read_file(folder / value, definition, name)
            values[name] = curve_of(table, definition, name, definition.units).points
    return tables


def messages(tables: Mapping[str, Table], settings: Settings) -> dict[str, str]:
    """Describe what was understood of tables, by the name of their setting.

    Raises
    ------
    SettingError
        Where the other settings want another quantity than a table has.
    """
    definitions: Mapping[str, Any] = settings.definitions()
    return {
        name: curve_of(table, definitions[name], name, settings.curve_units(name)).message
        for name, table in tables.items()
    }


def _read_file(path: Path, definition: CurveParameter, name: str) -> Table:
    def refuse(remedy: str) -> SettingError:
        return SettingError(name, str(path), allowed(definition), remedy)

    try:
        data = read_bytes(path)
    except (OSError, ValueError) as problem:  # no path at all is a ValueError
        raise refuse(f"it is no preset, and no readable CSV file ({why(problem)})") from None
    return read_table(data, refuse)
