"""What came of a sweep: charts as plain data, a page, and a CSV file from which it goes on."""

from __future__ import annotations

import csv
import io
import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np

from solver.arrays import Array
from solver.files.saved import dump
from solver.settings.definitions import SettingError
from solver.study.page import (
    Chart,
    Map,
    Panel,
    PanelAxis,
    PanelCurve,
    PlotSection,
    Runs,
    Section,
    bullets,
    html_table,
    text_of,
)
from solver.study.quantities.quantity import Quantity
from solver.study.sweep.plan import Plan, Row, Varied

MOST_CURVES = 6
"""Numbers of a second setting that have a curve each; more of them make a map."""
DECADES = 30.0
"""Ratio of the largest to the smallest value from which a chart is logarithmic."""
MARGIN = 0.06
"""Share of an axis that lies beyond the values on either side."""
NEVER = "never"
NONE = "none: a run with these settings has no such value"
Text = Callable[[float, str], str]
"""A value and its unit as a text."""
AFTER = "ending", "start", "iterations done", "seconds in all", "reason"
OWN = "own"
NEIGHBOURS = "neighbour's"
CAPTION = (
    "Hollow points and hatched cells are of runs that have not converged, crosses of runs without "
    "a value."
)
GROWTH = (
    "Powers by least squares of the logarithms; small sizes, at which other things cost, make them "
    "lower."
)


def plainly(value: float, unit: str) -> str:
    """Text of a value with its unit."""
    return f"{value:.4g} {unit}".strip().replace("-", "−")


def chart_of(
    plan: Plan,
    rows: Sequence[Row],
    place: int = 0,
    text: Text = plainly,
    *,
    logarithmic: bool | None = None,
) -> Chart:
    """Chart of the reading at a place, whatever has come of the plan so far, in SI.

    Its values are on a logarithmic scale as is said, or where they go over several
    decades.
    """
    across, *up = plan.axes
    quantity = plan.readings[place]
    runs = _runs(plan, rows, place, text)
    z = _measure(plan, place)[0] * grid(plan, rows, place).T
    if is_map(plan):
        known = z[np.isfinite(z)]
    else:
        known = runs.y[np.isfinite(runs.y)]
    if logarithmic is None:
        wide = bool(known.size and 0.0 < DECADES * known.min() < known.max())
    else:
        # Nothing that is zero or less stands on a logarithmic axis.
        wide = logarithmic and bool((known > 0.0).any())
    scale = PanelAxis(quantity.title, _measure(plan, place)[1], wide)
    axes = [
        PanelAxis(of.title, of.unit, of.logarithmic, names=of.names) for of in plan.axes
    ]
    if is_map(plan):
        if wide:
            z = np.where(z > 0.0, z, np.nan)
        else:
            z = z
        return Map(
            quantity.title,
            axes[0],
            axes[1],
            across.places,
            up[0].places,
            scale,
            z,
            runs,
        )
    curves = []
    for hue, label in enumerate(_texts(up[0], text) if up else [""], start=1):
        own = np.flatnonzero(runs.hues == hue)
        # Nothing lies between names.
        if across.is_numeric:
            own = own[np.argsort(runs.x[own])]
        else:
            own = own[:0]
        y = np.where(runs.holds[own], runs.y[own], np.nan)
        curves.append(PanelCurve(label, runs.x[own], y, hue))
    x_axis = replace(axes[0], limits=_limits(across.places, axes[0]))
    y_axis = replace(scale, limits=_limits(runs.y, scale))
    return Panel(quantity.title, x_axis, y_axis, tuple(curves), runs)


def is_map(plan: Plan) -> bool:
    """Whether a plan makes a map: two numbers, the second one of many values."""
    across, *up = plan.axes
    return across.is_numeric and any(
        one.is_numeric and len(one.values) > MOST_CURVES for one in up
    )


def grid(plan: Plan, rows: Sequence[Row], place: int) -> Array:
    """Finite values of a reading of runs that have converged, of the plan's shape; else NaN."""
    good = np.full(plan.size, np.nan)
    for row in rows:
        if row.holds and math.isfinite(row.values[place]):
            good[row.number] = row.values[place]
    return good.reshape(plan.shape)


def _limits(values: Array, axis: PanelAxis) -> tuple[float, float]:
    """Ends of an axis: all values with a margin, from zero where that is as near."""
    known = values[np.isfinite(values) & ((values > 0.0) | (not axis.logarithmic))]
    if not known.size:
        return (0.0, 1.0)
    low = float(known.min())
    high = float(known.max())
    if axis.names:
        return (low - 0.5, high + 0.5)
    if axis.logarithmic:
        by = max(high / low, 1.0 + MARGIN) ** MARGIN
        return (low / by, high * by)
    by = MARGIN * (high - low) or abs(high) / 2.0 or 1.0
    return (0.0 if 0.0 <= low < by else low - by, high + by)


def _runs(plan: Plan, rows: Sequence[Row], place: int, text: Text) -> Runs:
    """Where the runs stand on the chart of a reading, and what they came to."""
    axes = plan.axes
    numbers = np.array([row.number for row in rows], dtype=int)
    levels = np.unravel_index(numbers, plan.shape)
    factor, unit = _measure(plan, place)
    values = factor * np.array([row.values[place] for row in rows], dtype=float)
    texts = [_texts(axis, text) for axis in axes]
    messages = []
    for row, value, at in zip(rows, values, zip(*levels, strict=True), strict=True):
        point = ", ".join(
            of_axis[level] for of_axis, level in zip(texts, at, strict=True)
        )
        if math.isfinite(value):
            number = text(value, unit)
        else:
            number = ""
        reason = ": ".join(filter(None, (row.ending, row.reason)))
        if row.holds:
            if math.isinf(value):
                reason = NEVER
            elif math.isnan(value):
                reason = NONE
            else:
                reason = ""
        messages.append(f"{point}: {'; '.join(filter(None, (number, reason)))}")
    values[~np.isfinite(values)] = np.nan
    return Runs(
        numbers,
        axes[0].places[levels[0]],
        axes[1].places[levels[1]] if is_map(plan) else values,
        levels[1] + 1 if len(axes) > 1 else np.ones_like(numbers),
        np.array([row.holds for row in rows], dtype=bool) & np.isfinite(values),
        messages,
    )


def _texts(axis: Varied, text: Text) -> list[str]:
    """Title of a setting with each of its values."""
    values = axis.names or [text(value, axis.unit) for value in axis.values]
    return [f"{axis.title} {value}" for value in values]


def _measure(plan: Plan, place: int) -> tuple[float, str]:
    """Factor and unit of a reading: shares are in per cent."""
    quantity = plan.readings[place]
    if quantity.is_share:
        return (100.0, "%")
    return (1.0, quantity.unit)


def counts(plan: Plan, rows: Sequence[Row]) -> str:
    """What became of the runs, in a sentence."""
    endings = Counter(row.ending for row in rows)
    message = ", ".join(f"{count} {ending}" for ending, count in endings.most_common())
    return f"{len(rows)} of {plan.size} runs: {message or 'none yet'}."


def growth(plan: Plan, rows: Sequence[Row]) -> list[str]:
    """With which power of a setting over decades each reading grows, a line for every curve."""
    (along, *others) = plan.axes
    lines = []
    if not along.logarithmic or any(axis.is_numeric for axis in others):
        return []
    which = [f", {axis.name}={value}" for axis in others for value in axis.values] or [
        ""
    ]
    for place, name in enumerate(plan.of):
        curves = grid(plan, rows, place).T.reshape(len(which), -1)
        for words, curve in zip(which, curves, strict=True):
            is_known = curve > 0.0
            if (count := is_known.sum()) > 1:
                size, value = np.log(
                    [np.array(along.values)[is_known], curve[is_known]]
                )
                power = np.polyfit(size, value, 1)[0]
                lines.append(
                    f"{name}{words}: {along.name}^{power:.2f}, of {count} runs"
                )
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
    table = [
        heads(plan),
        *([text_of(cell, 6) for cell in cells(plan, row)] for row in rows),
    ]
    return [
        f"<p><b>{escape(counts(plan, rows))}</b></p>",
        PlotSection(f"Charts of {len(rows)} runs", charts),
        *(
            []
            if all(row.holds for row in rows)
            else [f'<p class="caption">{CAPTION}</p>']
        ),
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
    columns = [
        f"{c.name}: {c.title}" + (f" ({c.unit})" if c.unit else "") for c in shown
    ]
    for place, axis in enumerate(plan.axes):
        columns[place] += ": " + ", ".join(map(str, axis.values))
    varied = {axis.name for axis in plan.axes}
    return [
        f"Slipfront, {plan.settings.scene}: {plan.size} runs; SI units",
        *columns,
        "settings of all runs:",
        *(
            line
            for line in dump(plan.settings).splitlines()
            if line.split(" ")[0] not in varied
        ),
    ]


def rows_in(file: Path, plan: Plan) -> dict[int, Row]:
    """Rows of a plan by their number, as a file holds them; a line without an end is left out.

    The table of another sweep is refused.
    """
    if not file.exists():
        return {}
    text = file.read_text(encoding="utf-8")
    empty = csv_of(plan, [])
    if not text.startswith(empty):
        folder = "a folder of the same sweep, or a new one"
        raise SettingError("--out", str(file.parent), folder, "name another")
    whole = text[len(empty) : text.rfind("\n") + 1]
    rows = {}
    for number, *rest in csv.reader(io.StringIO(whole)):
        *values, ending, start, iterations, seconds, reason = rest[len(plan.axes) :]
        numbers = tuple(map(float, values))
        is_warm = start == NEIGHBOURS
        how = int(iterations), float(seconds), is_warm
        rows[int(number)] = Row(int(number), ending, reason, numbers, *how)
    return rows
