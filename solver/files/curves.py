"""Tables for settings that are curves, and messages on how tables were understood."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from solver.files.columns import TableColumn, quantities_of
from solver.files.disk import read_bytes
from solver.files.tables import Table, read_table
from solver.files.units import unit_doubt
from solver.scenes import CATALOGUE
from solver.settings.definitions import CurveParameter
from solver.settings.scene import Settings
from solver.settings.values import SettingError, allowed


def _names_of_curves() -> set[str]:
    """Names of the curves of all scenes, without common words."""
    names = set()
    for kind in CATALOGUE.values():
        for name, definition in kind.definitions().items():
            if isinstance(definition, CurveParameter) and "_" in name:
                names.add(name)
    return names


_SETTINGS = _names_of_curves()
"""Names of curves that are no common words: no other curve takes such a column."""


def curve_of(
    table: Table, definition: CurveParameter, name: str, units: Sequence[str]
) -> tuple[list[list[float]], str]:
    """Points of a curve in a table, in units of `Settings.curve_units`, and a message.

    Columns that cannot be chosen, units of another dimension, cells without a number,
    and an abscissa that does not increase are refused.
    """
    columns = columns_for(table, definition, name, units)
    reading = table.read(columns, definition.columns, units)
    # Here the line of the file is known; later checks know the points alone.
    falls = np.flatnonzero(np.diff(reading.numbers[0]) <= 0.0)
    if definition.is_path and len(falls):
        line = reading.lines[falls[0] + 1]
        remedy = f"line {line}: {definition.abscissa} must increase from row to row"
        if definition.abscissa == "time":
            remedy += (
                "; of a loop, as force over displacement, give the time of every row"
            )
        raise table.refuse(remedy)
    return reading.numbers.T.tolist(), reading.message


def columns_for(
    table: Table, definition: CurveParameter, name: str, units: Sequence[str]
) -> Sequence[TableColumn]:
    """Columns of a curve in a table: by the head, else in order.

    Raises
    ------
    SettingError
        If the head names no columns, and the table has others than the curve.
    """
    columns = table.columns
    names_quantities = any(column.is_known for column in columns)
    names_settings = any(column.key in _SETTINGS for column in columns)
    if names_quantities or names_settings:
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
    """Messages on columns without a unit that seem thousand times too large or small.

    Positions are compared with the length of the scene, values with the path by
    default, where it is of the same quantity. Times are not doubted, as runs last as
    long as their paths.
    """
    definition: Any = settings.definitions()[name]
    units = settings.curve_units(name)
    if not definition.is_path:
        return []
    # Zero is a size with which nothing is compared.
    usual = [0.0, 0.0]
    if definition.abscissa == "position":
        usual[0] = settings.length
    default = type(settings).checked({})
    if default.curve_units(name) == units:
        usual[1] = float(np.abs(default.points(name)).max(axis=0)[1])
    sizes = np.abs(points).max(axis=0)
    doubts = []
    for number, column in enumerate(columns_for(table, definition, name, units)):
        if not column.name or column.unit:
            continue
        doubt = unit_doubt(
            column.name, units[number], float(sizes[number]), usual[number], "the scene"
        )
        if doubt:
            doubts.append(doubt)
    return doubts


def _chosen(
    table: Table, definition: CurveParameter, name: str, units: Sequence[str]
) -> list[TableColumn]:
    """Columns of a curve that a head names."""
    # A column named after another setting is not taken, whatever quantity it names.
    others = _SETTINGS - {name}
    free = [column for column in table.columns if column.key not in others]
    chosen: list[TableColumn] = []
    remedy = "add that column"
    key = ""
    last = len(units) - 1
    if definition.is_path and definition.abscissa == "time":
        # Measured loops, force over displacement, are what people most often bring
        # here.
        remedy += "; a loop, as force over displacement, is no path over time"
    for number, (title, unit) in enumerate(zip(definition.columns, units, strict=True)):
        kinds: Collection[str] = {title}
        if definition.is_path and number == last:
            # Of two columns the second is the value if its name says nothing.
            if len(table.columns) == 2 and free and not free[0].quantities[0]:
                return [*chosen, *free]
            kinds = quantities_of(title, unit)
            remedy = f"name one of them {name}"
            key = name
        chosen.append(table.choose(free, kinds, unit, key, remedy))
        free.remove(chosen[-1])
    return chosen


def read_tables(
    kind: type[Settings], values: dict[str, object], folder: Path
) -> dict[str, Table]:
    """Read the CSV files named by curves; points replace the names in the values.

    Only fronts whose user owns the machine call this: elsewhere no file may be read.
    """
    tables = {}
    for name, definition in kind.definitions().items():
        value = values.get(name)
        if not isinstance(definition, CurveParameter) or not isinstance(value, str):
            continue
        # Points in the units by default: other settings, which may change these, are
        # not checked yet.
        if value not in ("", *definition.presets):
            table = tables[name] = _read_file(folder / value, definition, name)
            values[name], _ = curve_of(table, definition, name, definition.units)
    return tables


def messages(tables: Mapping[str, Table], settings: Settings) -> dict[str, str]:
    """Messages on how tables were understood, by the name of their setting.

    A table of another quantity than the other settings ask for is refused.
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
    """Table in a CSV file that is given for a curve."""
    can = allowed(definition)
    refuse = partial(SettingError, name, str(path), can)
    no_file = "it is no preset, and no readable CSV file"
    data = read_bytes(path, lambda why: refuse(f"{no_file} ({why})"))
    return read_table(data, str(path), name, can)
