"""Reports of a sweep: charts as data, a page, and the CSV file to resume from."""

from __future__ import annotations

import csv
import io
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from solver.arrays import Array
from solver.files.amounts import amount
from solver.files.saved import dump
from solver.settings.values import SettingError
from solver.study.page import (
    Chart,
    Map,
    Panel,
    PanelAxis,
    PanelCurve,
    PlotSection,
    Runs,
    text_of,
    write_page,
)
from solver.study.quantities.quantity import NEVER, Quantity
from solver.study.sweep.plan import Plan, Row, Varied

MOST_CURVES = 6
"""Largest number of curves, one for each value of a second setting; more are a map."""
DECADES = 30.0
"""Ratio of the largest to the smallest value from which a chart is logarithmic."""
MARGIN = 0.06
"""Share of the values' range that is added to an axis on either side."""
NONE = "none: a run with these settings has no such value"
AFTER = "ending", "start", "iterations done", "seconds in all", "reason"
OWN = "own"
NEIGHBOURS = "neighbour's"


def chart_of(
    plan: Plan,
    rows: Sequence[Row],
    index: int = 0,
    *,
    logarithmic: bool | None = None,
) -> Chart:
    """Chart of a quantity, from all rows so far, in SI.

    Parameters
    ----------
    plan, rows
        The plan, and the rows of the runs so far.
    index
        Index of the reading.
    logarithmic
        Whether the values stand on a logarithmic scale; by default if they go over
        several decades.
    """
    runs = _runs(plan, rows, index)
    if is_map(plan):
        return _map(plan, rows, index, runs, logarithmic)
    return _panel(plan, index, runs, logarithmic)


def _scale(
    plan: Plan, index: int, values: Array, logarithmic: bool | None
) -> PanelAxis:
    """Axis of a quantity with values of any shape, some NaN."""
    known = values[np.isfinite(values)]
    if logarithmic is None:
        wide = bool(known.size and 0.0 < DECADES * known.min() < known.max())
    else:
        # Nothing that is zero or less stands on a logarithmic axis.
        wide = logarithmic and bool((known > 0.0).any())
    _, unit = _measure(plan, index)
    return PanelAxis(plan.quantities[index].title, unit, wide)


def _axis(varied: Varied) -> PanelAxis:
    """Axis of a varied setting."""
    return PanelAxis(varied.title, varied.unit, varied.logarithmic, names=varied.names)


def _map(
    plan: Plan, rows: Sequence[Row], index: int, runs: Runs, logarithmic: bool | None
) -> Map:
    """Map of a quantity over two settings."""
    across, up = plan.axes
    factor, _ = _measure(plan, index)
    z = factor * grid(plan, rows, index).T
    scale = _scale(plan, index, z, logarithmic)
    if scale.logarithmic:
        z = np.where(z > 0.0, z, np.nan)
    return Map(
        title=plan.quantities[index].title,
        x=_axis(across),
        y=_axis(up),
        x_values=across.places,
        y_values=up.places,
        scale=scale,
        z=z,
        runs=runs,
    )


def _panel(plan: Plan, index: int, runs: Runs, logarithmic: bool | None) -> Panel:
    """Curves of a quantity over the first setting, for each value of the second."""
    across, *up = plan.axes
    labels = [""]
    if up:
        labels = _texts(up[0])
    curves = []
    for hue, label in enumerate(labels, start=1):
        members = np.flatnonzero(runs.hues == hue)
        # Nothing lies between names.
        if across.is_numeric:
            members = members[np.argsort(runs.x[members])]
        else:
            members = members[:0]
        y = np.where(runs.holds[members], runs.y[members], np.nan)
        curves.append(PanelCurve(label, runs.x[members], y, hue))
    x_axis = _axis(across)
    y_axis = _scale(plan, index, runs.y, logarithmic)
    return Panel(
        plan.quantities[index].title,
        replace(x_axis, limits=_limits(across.places, x_axis)),
        replace(y_axis, limits=_limits(runs.y, y_axis)),
        tuple(curves),
        runs,
    )


def is_map(plan: Plan) -> bool:
    """Check whether the chart is a map: of two numbers, the second with many values."""
    across, *up = plan.axes
    if not up or not across.is_numeric:
        return False
    return up[0].is_numeric and len(up[0].values) > MOST_CURVES


def grid(plan: Plan, rows: Sequence[Row], index: int) -> Array:
    """Values of a quantity in converged runs, of the plan's shape; NaN elsewhere."""
    # Points without a run yet are NaN, too, so that a chart can grow.
    good = np.full(plan.size, np.nan)
    for row in rows:
        if row.holds and math.isfinite(row.values[index]):
            good[row.number] = row.values[index]
    return good.reshape(plan.shape)


def _limits(values: Array, axis: PanelAxis) -> tuple[float, float]:
    """Limits of an axis: of values, (n,), with a margin, or from zero if near."""
    # What a logarithmic axis cannot show does not widen it.
    known = values[np.isfinite(values) & ((values > 0.0) | (not axis.logarithmic))]
    if not known.size:
        return (0.0, 1.0)
    low = float(known.min())
    high = float(known.max())
    if axis.names:
        return (low - 0.5, high + 0.5)
    if axis.logarithmic:
        factor = max(high / low, 1.0 + MARGIN) ** MARGIN
        return (low / factor, high * factor)
    margin = MARGIN * (high - low) or abs(high) / 2.0 or 1.0
    if 0.0 <= low < margin:
        return (0.0, high + margin)
    return (low - margin, high + margin)


def _runs(plan: Plan, rows: Sequence[Row], index: int) -> Runs:
    """Points of the runs on the chart of a quantity, with messages."""
    numbers = np.array([row.number for row in rows], dtype=int)
    levels = np.unravel_index(numbers, plan.shape)
    factor, _ = _measure(plan, index)
    values = factor * np.array([row.values[index] for row in rows], dtype=float)
    messages = _messages(plan, rows, index, values)
    is_finite = np.isfinite(values)
    values[~is_finite] = np.nan
    y = values
    if is_map(plan):
        y = plan.axes[1].places[levels[1]]
    # Each value of the second setting has a hue, from 1 on.
    hues = np.ones_like(numbers)
    if len(plan.axes) > 1:
        hues = levels[1] + 1
    return Runs(
        numbers=numbers,
        x=plan.axes[0].places[levels[0]],
        y=y,
        hues=hues,
        holds=np.array([row.holds for row in rows], dtype=bool) & is_finite,
        said=messages,
    )


def _messages(plan: Plan, rows: Sequence[Row], index: int, values: Array) -> list[str]:
    """Messages on runs: settings, the value of a quantity, and the ending.

    The values are those of the reading, shape (n_rows,), in its unit.
    """
    _, unit = _measure(plan, index)
    texts = [_texts(axis) for axis in plan.axes]
    numbers = np.array([row.number for row in rows], dtype=int)
    points = np.transpose(np.unravel_index(numbers, plan.shape))
    messages = []
    for row, value, point in zip(rows, values, points, strict=True):
        words = [names[level] for names, level in zip(texts, point, strict=True)]
        number = ""
        if math.isfinite(value):
            number = amount(value, unit)
        outcome = filter(None, (number, _reason(row, value)))
        messages.append(f"{', '.join(words)}: {'; '.join(outcome)}")
    return messages


def _reason(row: Row, value: float) -> str:
    """Reason why a run has no valid value, or ""."""
    if not row.holds:
        return ": ".join(filter(None, (row.ending, row.reason)))
    if math.isinf(value):
        return NEVER
    if math.isnan(value):
        return NONE
    return ""


def _texts(axis: Varied) -> list[str]:
    """Title of a setting with each of its values."""
    values: Sequence[str] = axis.names
    if axis.is_numeric:
        values = [amount(value, axis.unit) for value in axis.values]
    return [f"{axis.title} {value}" for value in values]


def _measure(plan: Plan, index: int) -> tuple[float, str]:
    """Factor and unit of a quantity: shares are in per cent."""
    quantity = plan.quantities[index]
    if quantity.is_share:
        return (100.0, "%")
    return (1.0, quantity.unit)


def counts(plan: Plan, rows: Sequence[Row]) -> str:
    """Sentence on the numbers of runs by ending."""
    endings = Counter(row.ending for row in rows)
    message = ", ".join(f"{count} {ending}" for ending, count in endings.most_common())
    return f"{len(rows)} of {plan.size} runs: {message or 'none yet'}."


def growth(plan: Plan, rows: Sequence[Row]) -> list[str]:
    """Lines on the power of a logarithmic setting with which quantities grow."""
    along, *others = plan.axes
    if not along.logarithmic or any(axis.is_numeric for axis in others):
        return []
    labels = [""]
    if others:
        names = others[0]
        labels = [f", {names.name}={value}" for value in names.values]
    lines = []
    for index, name in enumerate(plan.of):
        curves = grid(plan, rows, index).T.reshape(len(labels), -1)
        for label, curve in zip(labels, curves, strict=True):
            count = int((curve > 0.0).sum())
            if count > 1:
                power = _power(np.array(along.values), curve)
                text = f"{along.name}^{power:.2f}, of {count} runs"
                lines.append(f"{name}{label}: {text}")
    return lines


def _power(sizes: Array, values: Array) -> float:
    """Power of sizes in values, (n,) each, by regression of positive values."""
    is_known = values > 0.0
    # A power law is a straight line in logarithms.
    size, value = np.log([sizes[is_known], values[is_known]])
    return float(np.polyfit(size, value, 1)[0])


def title_of(plan: Plan) -> str:
    """Title of a sweep: its quantities over its settings."""
    asked = ", ".join(_uncapitalised(quantity.title) for quantity in plan.quantities)
    over = " and ".join(_uncapitalised(axis.title) for axis in plan.axes)
    return f"{plan.settings.scene.capitalize()}: {asked} over {over}"


def _uncapitalised(title: str) -> str:
    """Title with a small first letter."""
    return title[0].lower() + title[1:]


def write_sweep(plan: Plan, rows: Sequence[Row], file: Path) -> None:
    """Write the page of a sweep, of rows in the order of their points."""
    charts = [chart_of(plan, rows, index) for index in range(len(plan.of))]
    table = [heads(plan)]
    for row in rows:
        table.append([text_of(cell, 6) for cell in cells(plan, row)])
    write_page(
        file,
        "sweep.html",
        [PlotSection(f"Charts of {len(rows)} runs", charts)],
        title=title_of(plan),
        counts=counts(plan, rows),
        all_hold=all(row.holds for row in rows),
        growth=growth(plan, rows),
        rows=table,
        settings=head(plan),
    )


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
