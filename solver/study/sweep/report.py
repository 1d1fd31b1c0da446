"""A sweep as a page: charts, how answers grow, and a line for every run."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from html import escape

import numpy as np
from scipy.special import stdtrit

from solver.arrays import Array
from solver.study.page import PlotSection, Section, bullets, plain_table
from solver.study.sweep.chart import charts, grid
from solver.study.sweep.plan import Plan, Row
from solver.study.sweep.table import cells, head, heads

CONFIDENCE = 0.95
CAPTION = (
    "Hollow points and hatched cells are of runs that have not converged, crosses of runs without "
    "a value."
)
GROWTH = (
    "Powers by least squares of the logarithms, with their margins at 95 % where there are more "
    "than two runs; small sizes, at which other things cost, make them lower."
)


def counts(plan: Plan, rows: Sequence[Row]) -> str:
    """What became of the runs, in a sentence."""
    endings = Counter(row.ending for row in rows)
    message = ", ".join(f"{count} {ending}" for ending, count in endings.most_common())
    return f"{len(rows)} of {plan.size} runs: {message or 'none yet'}."


def growth(plan: Plan, rows: Sequence[Row]) -> list[str]:
    """With which power of a setting over decades each reading grows, a line for every curve."""
    numeric = [axis for axis in plan.axes if axis.is_numeric]
    if len(numeric) != 1 or not numeric[0].logarithmic:
        return []
    (along,), lines = numeric, []
    names = next((axis for axis in plan.axes if axis is not along), None)
    for place, reading in enumerate(plan.readings):
        values = grid(plan, rows, place)
        if plan.axes[0] is along and names is not None:
            values = values.T
        for number, curve in enumerate(np.atleast_2d(values)):
            power, margin, count = exponent_of(along.values, curve)
            if not math.isnan(power):
                which = f", {names.name}={names.values[number]}" if names else ""
                law = f"{power:.2f}" + (f" ± {margin:.2f}" if count > 2 else "")
                lines.append(f"{reading.name}{which}: {along.name}^({law}), of {count} runs")
    return lines


def exponent_of(x: Sequence[float], y: Sequence[float] | Array) -> tuple[float, float, int]:
    """Power with which y grows with x, by least squares of the logarithms.

    Points at which one of them is not a positive number are left out.

    Returns
    -------
    The power, NaN below two points; the margin to both sides of it, with 95 % confidence if points
    scatter at random about a power law, NaN for two points; the number of points.
    """
    points = np.array([x, y], dtype=float).T
    points = points[np.isfinite(points).all(axis=1) & (points > 0.0).all(axis=1)]
    if (count := len(points)) < 2:
        return math.nan, math.nan, count
    x, y = np.log(points).T
    if count == 2:
        return float(np.polyfit(x, y, 1)[0]), math.nan, count
    (slope, _), covariance = np.polyfit(x, y, 1, cov=True)
    quantile = stdtrit(count - 2, 0.5 + 0.5 * CONFIDENCE)
    return float(slope), float(quantile * math.sqrt(covariance[0, 0])), count


def title_of(plan: Plan) -> str:
    """What is asked for, over what."""
    asked, over = (
        [one.title[0].lower() + one.title[1:] for one in several]
        for several in (plan.readings, plan.axes)
    )
    return f"{plan.settings.scene.capitalize()}: {', '.join(asked)} over {' and '.join(over)}"


def sections(plan: Plan, rows: Sequence[Row]) -> list[Section]:
    """Page of some rows, in the order of their points."""
    drawn, laws = charts(plan, rows), growth(plan, rows)
    table = [heads(plan), *([_text(cell) for cell in cells(plan, row)] for row in rows)]
    return [
        f"<p><b>{escape(counts(plan, rows))}</b></p>",
        PlotSection(f"Charts of {len(rows)} runs", drawn),
        *([] if all(row.holds for row in rows) else [f'<p class="caption">{CAPTION}</p>']),
        *([f"<h2>Growth</h2>\n<p>{GROWTH}</p>\n{bullets(laws)}"] if laws else []),
        f"<h2>Every run</h2>\n{plain_table(table)}",
        f"<h2>Settings</h2>\n{bullets(head(plan))}",
    ]


def _text(cell: object) -> str:
    if not isinstance(cell, float):
        return str(cell)
    return "-" if math.isnan(cell) else "never" if math.isinf(cell) else f"{cell:.6g}"
