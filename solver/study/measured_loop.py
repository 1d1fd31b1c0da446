"""A measured loop, force over displacement, as tables have it, with or without times."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from solver.arrays import Array
from solver.columns import KINDS, TableColumn
from solver.definitions import SettingError
from solver.discrete.structure import Loop
from solver.study.comparison import FEWEST, MOST
from solver.tables import Table, read_table

CAN = "CSV whose head names displacement and force of every row, and their time if it is known"
Axes = tuple[tuple[str, str], tuple[str, str]]
"""Titles and units of a loop's displacement and force."""


@dataclass(frozen=True, eq=False)
class MeasuredLoop:
    """A measured loop, in SI.

    Attributes
    ----------
    displacement, force
        Of every row, shape (n_rows,).
    times
        Same shape, s; None where rows are matched along the path.
    units
        Of both, as the loop of its scene has them.
    source
        Name of the file.
    message
        What was understood of it.
    """

    displacement: Array
    force: Array
    times: Array | None
    units: tuple[str, str]
    source: str
    message: str

    def csv(self) -> str:
        """Table of it, as `read_loop` takes it."""
        columns = {f"displacement [{self.units[0]}]": self.displacement}
        columns[f"force [{self.units[1]}]"] = self.force
        if self.times is not None:
            columns = {"time [s]": self.times, **columns}
        return table_of(columns)


def table_of(columns: dict[str, Array]) -> str:
    """Columns of numbers by their heads as CSV."""
    rows = (
        ",".join(f"{value:.10g}" for value in row) for row in zip(*columns.values(), strict=True)
    )
    return "\n".join([",".join(columns), *rows, ""])


def axes_of(loop: Loop) -> Axes:
    """Titles and units of a loop."""
    return loop.across, loop.up


def is_a_loop(data: bytes | str, source: str) -> bool:
    """Whether a table is a measured loop, and not results over places."""
    table = read_table(data, partial(SettingError, "--with", source, CAN))
    return not any(column.quantities[0] & {"position"} for column in table.columns)


def read_loop(data: bytes | str, source: str, axes: Axes) -> MeasuredLoop:
    """Read a measured loop.

    Parameters
    ----------
    data
        A table as `solver.tables` takes it, a file's bytes or its text.
    source
        Name of the file.
    axes
        Titles and units of the loop that it is compared with.

    Raises
    ------
    SettingError
        For a table without these columns, too large or too small, or with what is no finite number.
    """
    table = read_table(data, partial(SettingError, "the measured loop", source, CAN))
    return loop_in(table, columns_of(table, axes), source, axes)


def columns_of(table: Table, axes: Axes) -> tuple[TableColumn | None, TableColumn, TableColumn]:
    """Columns of time, where there is one, displacement and force that the head names.

    Raises
    ------
    SettingError
        If it names no displacement or no force, or several.
    """
    columns = table.columns
    if not any(column.is_known for column in columns):
        raise table.refuse("name its columns in the first line, as in displacement,force")
    time = table.find(columns, {"time"}, "s")
    rest = [column for column in columns if column is not time]
    both = []
    for title, unit in axes:
        remedy = f"name that of {title}, {unit}"
        both.append(table.choose(rest, KINDS[unit], unit, remedy=remedy))
        rest.remove(both[-1])
    return time, both[0], both[1]


def loop_in(
    table: Table,
    columns: tuple[TableColumn | None, TableColumn, TableColumn],
    source: str,
    axes: Axes,
) -> MeasuredLoop:
    """The loop in the columns of time, displacement and force of a table.

    Raises
    ------
    SettingError
        For another unit, what is no finite number, too many or too few rows, or values that are
        all the same.
    """
    time, across, up = columns
    used, units = [across, up], [axes[0][1], axes[1][1]]
    if len(table.rows) > MOST:
        raise table.refuse(f"it has {len(table.rows)} rows, and may have {MOST}: leave some out")
    if time is not None:
        used, units = [time, *used], ["s", *units]
    names = ["time", axes[0][0], axes[1][0]][-len(used) :]
    numbers, message = table.read(used, names, units)
    *times, displacement, force = numbers
    if len(force) < FEWEST:
        raise table.refuse(f"it has {len(force)} rows: give at least {FEWEST}")
    for values, (title, _) in zip((displacement, force), axes, strict=True):
        if np.ptp(values) == 0.0:
            raise table.refuse(f"{title} has the same value in all rows")
    if time is None:
        message += "; matched along the path, as no time is given"
    both = axes[0][1], axes[1][1]
    return MeasuredLoop(displacement, force, times[0] if times else None, both, source, message)
