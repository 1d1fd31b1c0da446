"""Tables of two columns for settings that are curves, read from text and files."""

from __future__ import annotations

import csv
from pathlib import Path

from solver.definitions import Curve, Parameter, SettingError, allowed
from solver.disk import LARGEST, TOO_LARGE, read_text, why


def read_table(text: str, definition: Curve, name: str, source: str) -> list[list[float]]:
    """Read a table of two columns for a curve setting.

    Parameters
    ----------
    text
        CSV whose rows are abscissa, value; empty lines are passed over, and a first row of their
        names, of which the second may be the setting's.
    definition, name, source
        The setting it is for, and where the text comes from, used in messages.

    Raises
    ------
    SettingError
        For a table that is too large, or a row without exactly two numbers.
    """
    if len(text) > LARGEST:
        raise SettingError(name, source, allowed(definition), TOO_LARGE)
    rows: list[list[float]] = []
    lines = text.splitlines()
    try:
        table = list(csv.reader(lines))
    except csv.Error as problem:
        raise SettingError(name, source, allowed(definition), str(problem)) from None
    for number, cells in enumerate(table, start=1):
        names = [cell.strip().lower() for cell in cells]
        is_head = names in [[definition.abscissa, other] for other in (definition.ordinate, name)]
        if not any(names) or (not rows and is_head):
            continue
        try:
            first, second = cells
            rows.append([float(first), float(second)])
        except ValueError:
            remedy = f"line {number} is {lines[number - 1]!r}, not two numbers"
            raise SettingError(name, source, allowed(definition), remedy) from None
    if not rows:
        raise SettingError(name, source, allowed(definition), "it has no points")
    return rows


def _read_file(path: Path, definition: Curve, name: str) -> list[list[float]]:
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
    if not isinstance(definition, Curve) or not isinstance(value, str) or not value:
        return value
    return value if value in definition.presets else _read_file(folder / value, definition, name)
