"""A sweep as a table: a line for every run."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Sequence
from pathlib import Path

from solver.checked import dump
from solver.disk import whole_file
from solver.study.sweep.plan import Plan
from solver.study.sweep.point import Row

Turn = Callable[[str], tuple[float, str]]
OWN = ("ending", "start", "iterations done", "seconds in all", "reason")


def in_si(unit: str) -> tuple[float, str]:
    """Give what values are divided by, and their unit."""
    return 1.0, unit


def heads(plan: Plan, turn: Turn = in_si) -> list[str]:
    """Name the columns: what varies, what is asked for, and how the run ended; but for SI units."""
    named = [(name, unit, turn(unit)[1]) for name, _, unit in _told(plan)]
    return [name if own == unit else f"{name} ({own})" for name, unit, own in named] + [*OWN]


def _told(plan: Plan) -> list[tuple[str, str, str]]:
    """Give name, title and unit of what varies and of what is asked for."""
    varied = [(axis.name, plan.title(axis), plan.unit(axis)) for axis in plan.axes]
    return varied + [(one.name, one.title, one.quantity.unit) for one in plan.readings]


def cells(plan: Plan, row: Row, turn: Turn = in_si) -> list[object]:
    """Give the entries of a row."""
    start = "neighbour's" if row.was_warm else "own"
    own = [row.ending, start, row.iterations, round(row.seconds, 6), row.reason]
    values = [*plan.point(row.number).values(), *row.values]
    factors = [turn(unit)[0] for _, _, unit in _told(plan)]
    turned = (
        float(f"{one / factor:.15g}") if isinstance(one, float) and factor != 1.0 else one
        for one, factor in zip(values, factors, strict=True)
    )
    return [*turned, *own]


def csv_of(plan: Plan, rows: Sequence[Row], turn: Turn = in_si, system: str = "SI units") -> str:
    """Write the rows as CSV, with what is fixed in front, in comments that begin with #.

    `turn` gives for an SI unit what values are divided by, and their unit; all of these together
    are called the `system`.
    """
    written = io.StringIO()
    for line in head(plan, turn, system):
        written.write(f"# {line}\n")
    table = csv.writer(written, lineterminator="\n")
    table.writerow(heads(plan, turn))
    table.writerows(cells(plan, row, turn) for row in rows)
    return written.getvalue()


def write_parquet(plan: Plan, rows: Sequence[Row], file: Path) -> bool:
    """Write the rows as Parquet, with the plan as JSON beside them; tell whether that can be done.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ModuleNotFoundError:
        return False
    columns = zip(*(cells(plan, row) for row in rows), strict=True)
    table = pyarrow.table(dict(zip(heads(plan), map(list, columns), strict=False)))
    table = table.replace_schema_metadata({"slipfront": json.dumps(plan.plain())})
    with whole_file(file, "wb") as out:
        pyarrow.parquet.write_table(table, out)
    return True


def head(plan: Plan, turn: Turn = in_si, system: str = "SI units") -> list[str]:
    """Say what the columns are, and what is fixed, in SI units."""
    units = [(name, title, turn(unit)[1]) for name, title, unit in _told(plan)]
    varied = {axis.name for axis in plan.axes}
    fixed = [
        line for line in dump(plan.settings).splitlines() if line.partition(" ")[0] not in varied
    ]
    return [
        f"Slipfront, {plan.settings.scene}: {plan.size} runs; {system}",
        *(f"{name}: {title}" + (f" ({unit})" if unit else "") for name, title, unit in units),
        "settings of all runs:",
        *fixed,
    ]
