"""Tables that people give for settings that are curves, and what was understood of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from solver.files.columns import TableColumn, quantities_of, unit_doubt
from solver.files.disk import read_bytes
from solver.files.tables import Table, read_table
from solver.scenes import CATALOGUE
from solver.settings.definitions import CurveParameter, SettingError, allowed
from solver.settings.scene import Settings

_SETTINGS = {
    name
    for kind in CATALOGUE.values()
    for name, definition in kind.definitions().items()
    if isinstance(definition, CurveParameter) and "_" in name
}
"""Names of curves that are no common words: a column of another one is not taken."""


def curve_of(
    table: Table, definition: CurveParameter, name: str, units: Sequence[str]
) -> tuple[list[list[float]], str]:
    """Points of a curve in a table, in units as of `Settings.curve_units`, and what was understood.

    Columns that cannot be chosen, other units, what is no number, and an abscissa that
    does not increase are refused.
    """
    columns = columns_for(table, definition, name, units)
    reading = table.read(columns, definition.columns, units)
    falls = np.flatnonzero(np.diff(reading.numbers[0]) <= 0.0)
    if definition.is_path and len(falls):
        line = reading.lines[falls[0] + 1]
        remedy = f"line {line}: {definition.abscissa} must increase from row to row"
        loop = "; of a loop, as force over displacement, give the time of every row"
        raise table.refuse(remedy + (loop if definition.abscissa == "time" else ""))
    return reading.numbers.T.tolist(), reading.message


def columns_for(
    table: Table, definition: CurveParameter, name: str, units: Sequence[str]
) -> Sequence[TableColumn]:
    """Columns of a curve in a table, by its head, or as they stand where that says nothing."""
    columns = table.columns
    if any(c.is_known for c in columns) or _SETTINGS.intersection(
        c.key for c in columns
    ):
        return _chosen(table, definition, name, units)
    if len(columns) != len(units):
        *others, last = definition.columns
        names = f"{', '.join(others)} and {last}"
        raise table.refuse(
            f"it has {len(columns)} columns: name {names} in its first line"
        )
    return columns


def path_doubts(
    table: Table, settings: Settings, name: str, points: Sequence[Sequence[float]]
) -> list[str]:
    """Words where columns without a unit are some thousand times off the scene.

    That is its length, and the path by default, where it is of the same quantity. Times
    are not doubted, as runs last as long as their paths.
    """
    definition: Any = settings.definitions()[name]
    units = settings.curve_units(name)
    if not definition.is_path:
        return []
    sizes = np.abs(points).max(axis=0)
    usual = [0.0, 0.0]
    if definition.abscissa == "position":
        usual[0] = settings.length
    default = type(settings).checked({})
    if default.curve_units(name) == units:
        usual[1] = float(np.abs(default.points(name)).max(axis=0)[1])
    columns = columns_for(table, definition, name, units)
    doubts = [
        unit_doubt(column.name, unit, float(size), one, "the scene")
        for column, unit, size, one in zip(columns, units, sizes, usual, strict=True)
        if column.name and not column.unit
    ]
    return [doubt for doubt in doubts if doubt]


def _chosen(
    table: Table, definition: CurveParameter, name: str, units: Sequence[str]
) -> list[TableColumn]:
    """Columns of a curve that a head names."""
    free = [
        column
        for column in table.columns
        if column.key == name or column.key not in _SETTINGS
    ]
    chosen: list[TableColumn] = []
    remedy = "add that column"
    named = ""
    last = len(units) - 1
    if definition.is_path and definition.abscissa == "time":
        remedy += "; a loop, as force over displacement, is no path over time"
    for place, (title, unit) in enumerate(zip(definition.columns, units, strict=True)):
        kinds: Collection[str] = {title}
        if definition.is_path and place == last:
            kinds = quantities_of(title, unit)
            remedy = f"name one of them {name}"
            named = name
            if len(table.columns) == 2 and free and not free[0].quantities[0]:
                return [*chosen, *free]
        chosen.append(table.choose(free, kinds, unit, named, remedy))
        free.remove(chosen[-1])
    return chosen


def read_tables(
    kind: type[Settings], values: dict[str, object], folder: Path
) -> dict[str, Table]:
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
            values[name], _ = curve_of(table, definition, name, definition.units)
    return tables


def messages(tables: Mapping[str, Table], settings: Settings) -> dict[str, str]:
    """Describe what was understood of tables, by the name of their setting.

    A table of another quantity than the other settings want is refused.
    """
    definitions: Mapping[str, Any] = settings.definitions()
    found = {}
    for name, table in tables.items():
        points, message = curve_of(
            table, definitions[name], name, settings.curve_units(name)
        )
        found[name] = "; ".join([message, *path_doubts(table, settings, name, points)])
    return found


def _read_file(path: Path, definition: CurveParameter, name: str) -> Table:
    can = allowed(definition)
    refuse = partial(SettingError, name, str(path), can)
    no_file = "it is no preset, and no readable CSV file"
    data = read_bytes(path, lambda why: refuse(f"{no_file} ({why})"))
    return read_table(data, str(path), name, can)
