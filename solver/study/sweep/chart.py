"""The charts of a sweep as plain data: curves over one setting, or a map over two."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from solver.arrays import Array
from solver.study.page import Chart, Map, Panel, PanelAxis, PanelCurve, Runs
from solver.study.sweep.plan import Plan, Row, Varied

MOST_CURVES = 6
"""Numbers of a second setting that have a curve each; more of them make a map."""
DECADES = 30.0
"""Ratio of the largest to the smallest value from which a chart is logarithmic."""
MARGIN = 0.06
"""Share of an axis that lies beyond the values on either side."""
NEVER, NONE = "never", "none: a run with these settings has no such value"
Text = Callable[[float, str], str]
"""A value and its unit as a text."""


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

    Its values are on a logarithmic scale as is said, or where they go over several decades.
    """
    across, *up = plan.axes
    quantity, runs = plan.readings[place], _runs(plan, rows, place, text)
    z = _measure(plan, place)[0] * grid(plan, rows, place).T
    known = z[np.isfinite(z)] if is_map(plan) else runs.y[np.isfinite(runs.y)]
    if logarithmic is None:
        wide = bool(known.size and 0.0 < DECADES * known.min() < known.max())
    else:
        # Nothing that is zero or less stands on a logarithmic axis.
        wide = logarithmic and bool((known > 0.0).any())
    scale = PanelAxis(quantity.title, _measure(plan, place)[1], wide)
    axes = [PanelAxis(of.title, of.unit, of.logarithmic, names=of.names) for of in plan.axes]
    if is_map(plan):
        z = np.where(z > 0.0, z, np.nan) if wide else z
        return Map(quantity.title, axes[0], axes[1], across.places, up[0].places, scale, z, runs)
    curves = []
    for hue, label in enumerate(_texts(up[0], text) if up else [""], start=1):
        own = np.flatnonzero(runs.hues == hue)
        # Nothing lies between names.
        own = own[np.argsort(runs.x[own])] if across.is_numeric else own[:0]
        y = np.where(runs.holds[own], runs.y[own], np.nan)
        curves.append(PanelCurve(label, runs.x[own], y, hue))
    x_axis = replace(axes[0], limits=_limits(across.places, axes[0]))
    y_axis = replace(scale, limits=_limits(runs.y, scale))
    return Panel(quantity.title, x_axis, y_axis, tuple(curves), runs)


def is_map(plan: Plan) -> bool:
    """Whether a plan makes a map: two numbers, the second one of many values."""
    across, *up = plan.axes
    return across.is_numeric and any(one.is_numeric and len(one.values) > MOST_CURVES for one in up)


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
    low, high = float(known.min()), float(known.max())
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
        point = ", ".join(of_axis[level] for of_axis, level in zip(texts, at, strict=True))
        number = text(value, unit) if math.isfinite(value) else ""
        reason = ": ".join(filter(None, (row.ending, row.reason)))
        if row.holds:
            reason = NEVER if math.isinf(value) else NONE if math.isnan(value) else ""
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
    return (100.0, "%") if quantity.is_share else (1.0, quantity.unit)
