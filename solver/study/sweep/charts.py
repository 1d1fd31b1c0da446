"""Charts of a sweep as data: curves over one setting, or a map over two."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solver.arrays import Array, Indices
from solver.files.amounts import amount
from solver.study.page import Chart, Map, Panel, PanelAxis, PanelCurve, Runs
from solver.study.quantities.quantity import NEVER
from solver.study.sweep.plan import Plan, Row, Varied

MOST_CURVES = 6
"""Largest number of curves, one for each value of a second setting; more are a map."""
DECADES = 30.0
"""Ratio of the largest to the smallest value from which a chart is logarithmic."""
MARGIN = 0.06
"""Share of the values' range that is added to an axis on either side."""
ROOM = 0.02
"""Share of an axis from zero that is added below zero: there a point is seen whole."""
NONE = "none: a run with these settings has no such value"


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
    return PanelAxis(
        varied.title,
        varied.unit,
        varied.logarithmic,
        names=varied.names,
        # Between 1 and 2 cycles there is none.
        whole=all(type(value) is int for value in varied.values),
    )


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
    """Limits of an axis: of values, (n,), with a margin, or from about zero if near."""
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
        return (-ROOM * (high + margin), high + margin)
    return (low - margin, high + margin)


def _runs(plan: Plan, rows: Sequence[Row], index: int) -> Runs:
    """Points of the runs on the chart of a quantity, with messages."""
    numbers = np.array([row.number for row in rows], dtype=int)
    levels = np.unravel_index(numbers, plan.shape)
    factor, unit = _measure(plan, index)
    values = factor * np.array([row.values[index] for row in rows], dtype=float)
    messages = _messages(plan, rows, np.transpose(levels), values, unit)
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
        x=plan.axes[0].places[levels[0]],
        y=y,
        hues=hues,
        holds=np.array([row.holds for row in rows], dtype=bool) & is_finite,
        said=messages,
    )


def _messages(
    plan: Plan, rows: Sequence[Row], points: Indices, values: Array, unit: str
) -> list[str]:
    """Messages on runs: settings, the value of a quantity, and the ending.

    With the numbers of the values of the settings, shape (n_rows, n_axes), and the
    values of the quantity in its unit, shape (n_rows,).
    """
    texts = [_texts(axis) for axis in plan.axes]
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
