"""The CSV table of a sweep, from which the sweep goes on."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from solver.files.saved import dump
from solver.settings.values import SettingError
from solver.study.quantities.quantity import Quantity
from solver.study.sweep.plan import Plan, Row, Varied

AFTER = "ending", "start", "iterations done", "seconds in all", "reason"
OWN = "own"
NEIGHBOURS = "neighbour's"


def heads(plan: Plan) -> list[str]:
    """Names of the columns: run, settings, quantities, ending."""
    varied = [axis.name for axis in plan.axes]
    return ["run", *varied, *plan.of, *AFTER]


def cells(plan: Plan, row: Row) -> list[object]:
    """Entries of a row, in SI units."""
    start = OWN
    if row.was_warm:
        start = NEIGHBOURS
    return [
        row.number,
        *plan.point(row.number).values(),
        *row.values,
        row.ending,
        start,
        row.iterations,
        round(row.seconds, 6),
        " ".join(row.reason.split()),
    ]


def csv_of(plan: Plan, rows: Sequence[Row]) -> str:
    """Rows as CSV, after comment lines (#) with the fixed settings."""
    comments = "".join(f"# {line}\n" for line in head(plan))
    return f"{comments}{','.join(heads(plan))}\n{lines_of(plan, rows)}"


def lines_of(plan: Plan, rows: Sequence[Row]) -> str:
    """Rows as lines of CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(cells(plan, row) for row in rows)
    return text.getvalue()


def head(plan: Plan) -> list[str]:
    """Lines on the columns, the values of the axes, and the fixed settings, in SI."""
    columns = []
    for axis in plan.axes:
        values = ", ".join(map(str, axis.values))
        columns.append(f"{_column(axis)}: {values}")
    for quantity in plan.quantities:
        columns.append(_column(quantity))
    varied = {axis.name for axis in plan.axes}
    lines = dump(plan.settings).splitlines()
    fixed = [line for line in lines if line.split(" ")[0] not in varied]
    return [
        f"Slipfront, {plan.settings.scene}: {plan.size} runs; SI units",
        *columns,
        "settings of all runs:",
        *fixed,
    ]


def _column(shown: Varied | Quantity) -> str:
    """Name, title and unit of a column."""
    if shown.unit:
        return f"{shown.name}: {shown.title} ({shown.unit})"
    return f"{shown.name}: {shown.title}"


def rows_in(file: Path, plan: Plan) -> dict[int, Row]:
    """Read the rows of a plan from a file, by the number of their point.

    A last line without an end is left out. The table of another sweep is refused.
    """
    if not file.exists():
        return {}
    text = file.read_text(encoding="utf-8")
    empty = csv_of(plan, [])
    if not text.startswith(empty):
        folder = "a folder of the same sweep, or a new one"
        raise SettingError("--out", str(file.parent), folder, "name another")
    # A line without an end was cut off as the sweep was ended.
    whole = text[len(empty) : text.rfind("\n") + 1]
    rows = [_row_of(plan, each) for each in csv.reader(io.StringIO(whole))]
    return {row.number: row for row in rows}


def _row_of(plan: Plan, texts: list[str]) -> Row:
    """Row of a plan from the texts of its cells, in the order of `heads`."""
    number, *rest = texts
    *values, ending, start, iterations, seconds, reason = rest[len(plan.axes) :]
    return Row(
        number=int(number),
        ending=ending,
        reason=reason,
        values=tuple(map(float, values)),
        iterations=int(iterations),
        seconds=float(seconds),
        was_warm=start == NEIGHBOURS,
    )
