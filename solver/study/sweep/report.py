"""A sweep as a page, and as a CSV file from which one that was ended goes on."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from solver.checked import dump
from solver.definitions import SettingError
from solver.study.page import PlotSection, Section, bullets, html_table, text_of
from solver.study.quantities.quantity import Quantity
from solver.study.sweep.chart import chart_of, grid
from solver.study.sweep.plan import Plan, Row, Varied

AFTER = "ending", "start", "iterations done", "seconds in all", "reason"
OWN, NEIGHBOURS = "own", "neighbour's"
CAPTION = (
    "Hollow points and hatched cells are of runs that have not converged, crosses of runs without "
    "a value."
)
GROWTH = (
    "Powers by least squares of the logarithms; small sizes, at which other things cost, make them "
    "lower."
)


def counts(plan: Plan, rows: Sequence[Row]) -> str:
    """What became of the runs, in a sentence."""
    endings = Counter(row.ending for row in rows)
    message = ", ".join(f"{count} {ending}" for ending, count in endings.most_common())
    return f"{len(rows)} of {plan.size} runs: {message or 'none yet'}."


def growth(plan: Plan, rows: Sequence[Row]) -> list[str]:
    """With which power of a setting over decades each reading grows, a line for every curve."""
    (along, *others), lines = plan.axes, []
    if not along.logarithmic or any(axis.is_numeric for axis in others):
        return []
    which = [f", {axis.name}={value}" for axis in others for value in axis.values] or [""]
    for place, name in enumerate(plan.of):
        curves = grid(plan, rows, place).T.reshape(len(which), -1)
        for words, curve in zip(which, curves, strict=True):
            is_known = curve > 0.0
            if (count := is_known.sum()) > 1:
                size, value = np.log([np.array(along.values)[is_known], curve[is_known]])
                power = np.polyfit(size, value, 1)[0]
                lines.append(f"{name}{words}: {along.name}^{power:.2f}, of {count} runs")
    return lines


def title_of(plan: Plan) -> str:
    """What is asked for, over what."""
    asked, over = (
        [one.title[0].lower() + one.title[1:] for one in several]
        for several in (plan.readings, plan.axes)
    )
    return f"{plan.settings.scene.capitalize()}: {', '.join(asked)} over {' and '.join(over)}"


def sections(plan: Plan, rows: Sequence[Row]) -> list[Section]:
    """Page of some rows, in the order of their points."""
    laws = growth(plan, rows)
    charts = [chart_of(plan, rows, place) for place in range(len(plan.of))]
    table = [heads(plan), *([text_of(cell, 6) for cell in cells(plan, row)] for row in rows)]
    return [
        f"<p><b>{escape(counts(plan, rows))}</b></p>",
        PlotSection(f"Charts of {len(rows)} runs", charts),
        *([] if all(row.holds for row in rows) else [f'<p class="caption">{CAPTION}</p>']),
        *([f"<h2>Growth</h2>\n<p>{GROWTH}</p>\n{bullets(laws)}"] if laws else []),
        f"<h2>Every run</h2>\n{html_table(table)}",
        f"<h2>Settings</h2>\n{bullets(head(plan))}",
    ]


def heads(plan: Plan) -> list[str]:
    """Names of the columns: the run, what varies, what is asked for, and how the run ended."""
    return ["run", *(axis.name for axis in plan.axes), *plan.of, *AFTER]


def cells(plan: Plan, row: Row) -> list[object]:
    """Entries of a row, in SI units."""
    ending = [row.ending, NEIGHBOURS if row.was_warm else OWN, row.iterations]
    reason = " ".join(row.reason.split())
    values = [*plan.point(row.number).values(), *row.values]
    return [row.number, *values, *ending, round(row.seconds, 6), reason]


def csv_of(plan: Plan, rows: Sequence[Row]) -> str:
    """Rows as CSV, with what is fixed in front, in comments that begin with #."""
    comments = "".join(f"# {line}\n" for line in head(plan))
    return f"{comments}{','.join(heads(plan))}\n{lines_of(plan, rows)}"


def lines_of(plan: Plan, rows: Sequence[Row]) -> str:
    """Rows as lines of CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(cells(plan, row) for row in rows)
    return text.getvalue()


def head(plan: Plan) -> list[str]:
    """What the columns are, with all values of what varies, and what is fixed, in SI units."""
    shown: list[Varied | Quantity] = [*plan.axes, *plan.readings]
    columns = [f"{c.name}: {c.title}" + (f" ({c.unit})" if c.unit else "") for c in shown]
    for place, axis in enumerate(plan.axes):
        columns[place] += ": " + ", ".join(map(str, axis.values))
    varied = {axis.name for axis in plan.axes}
    return [
        f"Slipfront, {plan.settings.scene}: {plan.size} runs; SI units",
        *columns,
        "settings of all runs:",
        *(line for line in dump(plan.settings).splitlines() if line.split(" ")[0] not in varied),
    ]


def rows_in(file: Path, plan: Plan) -> dict[int, Row]:
    """Rows of a plan by their number, as a file holds them; a line without an end is left out.

    The table of another sweep is refused.
    """
    if not file.exists():
        return {}
    text, empty = file.read_text(encoding="utf-8"), csv_of(plan, [])
    if not text.startswith(empty):
        folder = "a folder of the same sweep, or a new one"
        raise SettingError("--out", str(file.parent), folder, "name another")
    whole = text[len(empty) : text.rfind("\n") + 1]
    rows = {}
    for number, *rest in csv.reader(io.StringIO(whole)):
        *values, ending, start, iterations, seconds, reason = rest[len(plan.axes) :]
        numbers, is_warm = tuple(map(float, values)), start == NEIGHBOURS
        how = int(iterations), float(seconds), is_warm
        rows[int(number)] = Row(int(number), ending, reason, numbers, *how)
    return rows
