"""A sweep as a CSV file: a line for every run, from which a sweep that was ended goes on."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from solver.checked import dump
from solver.definitions import SettingError
from solver.study.sweep.plan import Plan, Row

BEFORE, AFTER = ("run",), ("ending", "start", "iterations done", "seconds in all", "reason")
OWN, NEIGHBOURS = "own", "neighbour's"


def heads(plan: Plan) -> list[str]:
    """Names of the columns: the run, what varies, what is asked for, and how the run ended."""
    varied = [axis.name for axis in plan.axes]
    return [*BEFORE, *varied, *(one.name for one in plan.readings), *AFTER]


def cells(plan: Plan, row: Row) -> list[object]:
    """Entries of a row, in SI units."""
    ending = [row.ending, NEIGHBOURS if row.was_warm else OWN, row.iterations]
    reason = " ".join(row.reason.split())
    values = [*plan.point(row.number).values(), *row.values]
    return [row.number, *values, *ending, round(row.seconds, 6), reason]


def csv_of(plan: Plan, rows: Sequence[Row]) -> str:
    """Rows as CSV, with what is fixed in front, in comments that begin with #."""
    comments = "".join(f"# {line}\n" for line in head(plan))
    return comments + _written([heads(plan)]) + lines_of(plan, rows)


def lines_of(plan: Plan, rows: Sequence[Row]) -> str:
    """Rows as lines of CSV."""
    return _written([cells(plan, row) for row in rows])


def _written(lines: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(lines)
    return text.getvalue()


def head(plan: Plan) -> list[str]:
    """What the columns are, with all values of what varies, and what is fixed, in SI units."""

    def column(name: str, title: str, unit: str) -> str:
        return f"{name}: {title} ({unit})" if unit else f"{name}: {title}"

    varied = {axis.name for axis in plan.axes}
    return [
        f"Slipfront, {plan.settings.scene}: {plan.size} runs; SI units",
        *(
            f"{column(axis.name, axis.title, axis.unit)}: " + ", ".join(map(str, axis.values))
            for axis in plan.axes
        ),
        *(column(one.name, one.title, one.unit) for one in plan.readings),
        "settings of all runs:",
        *(line for line in dump(plan.settings).splitlines() if line.split(" ")[0] not in varied),
    ]


def rows_in(file: Path, plan: Plan) -> dict[int, Row]:
    """Rows of a plan by their number, as a file holds them; a line without an end is left out.

    Raises
    ------
    SettingError
        If it is the table of another sweep.
    OSError
        If it cannot be read.
    """
    if not file.exists():
        return {}
    text, empty = file.read_text(encoding="utf-8"), csv_of(plan, [])
    if not text.startswith(empty):
        folder = "a folder of the same sweep, or a new one"
        raise SettingError("--out", str(file.parent), folder, "name another")
    whole = text[len(empty) : text.rfind("\n") + 1]
    rows = [_row(plan, line) for line in csv.reader(io.StringIO(whole))]
    return {row.number: row for row in rows}


def _row(plan: Plan, line: Sequence[str]) -> Row:
    number, *rest = line
    *values, ending, start, iterations, seconds, reason = rest[len(plan.axes) :]
    numbers = tuple(map(float, values))
    is_warm = start == NEIGHBOURS
    return Row(int(number), ending, reason, numbers, int(iterations), float(seconds), is_warm)
