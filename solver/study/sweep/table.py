"""A sweep as a table: a line for every run."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path

from solver.checked import dump
from solver.disk import whole_file
from solver.study.sweep.plan import Plan
from solver.study.sweep.point import Row

OWN = ("ending", "start", "iterations done", "seconds in all", "reason")


def heads(plan: Plan) -> list[str]:
    """Name the columns: what varies, what is asked for, and how the run ended."""
    return [axis.name for axis in plan.axes] + [one.name for one in plan.readings] + [*OWN]


def cells(plan: Plan, row: Row) -> list[object]:
    """Give the entries of a row, in SI units."""
    start = "neighbour's" if row.was_warm else "own"
    own = [row.ending, start, row.iterations, round(row.seconds, 6), row.reason]
    return [*plan.point(row.number).values(), *row.values, *own]


def csv_of(plan: Plan, rows: Sequence[Row]) -> str:
    """Write the rows as CSV, with what is fixed in front, in comments that begin with #."""
    written = io.StringIO()
    for line in head(plan):
        written.write(f"# {line}\n")
    table = csv.writer(written, lineterminator="\n")
    table.writerow(heads(plan))
    table.writerows(cells(plan, row) for row in rows)
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


def head(plan: Plan) -> list[str]:
    """Say what the columns are, and what is fixed."""
    units = [(axis.name, plan.title(axis), plan.unit(axis)) for axis in plan.axes]
    units += [(one.name, one.title, one.quantity.unit) for one in plan.readings]
    varied = {axis.name for axis in plan.axes}
    fixed = [
        line for line in dump(plan.settings).splitlines() if line.partition(" ")[0] not in varied
    ]
    return [
        f"Slipfront, {plan.settings.scene}: {plan.size} runs; SI units",
        *(f"{name}: {title}" + (f" ({unit})" if unit else "") for name, title, unit in units),
        "settings of all runs:",
        *fixed,
    ]
