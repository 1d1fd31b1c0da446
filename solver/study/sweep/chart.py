"""The charts of a sweep as plain data: curves over one setting, or a map over two."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from solver.arrays import Array, Indices
from solver.study.chart import Chart, Map, Panel, PanelAxis, PanelCurve, Runs
from solver.study.sweep.plan import Plan, Varied
from solver.study.sweep.run import Row

MOST_CURVES = 6
"""Numbers of a second setting that have a curve each; more of them make a map."""
DECADES = 30.0
"""Ratio of the largest to the smallest value from which a chart is logarithmic."""
MARGIN = 0.06
"""Share of an axis that lies beyond the values on either side."""
SAMPLED = 0.5
"""Share of the points up to which runs are few."""
Tell = Callable[[float, str], str]
NEVER, NONE = "never", "none: a run with these settings has no such value"


def charts(plan: Plan, rows: Sequence[Row]) -> list[Chart]:
    """Make a chart of every reading of runs to which no others are to come."""
    made = [chart_of(plan, rows, place) for place in range(len(plan.readings))]
    return [_filled(one) if isinstance(one, Map) and _is_sampled(one.z) else one for one in made]


def plainly(value: float, unit: str) -> str:
    """Write a value with its unit."""
    return f"{value:.4g} {unit}".strip().replace("-", "−")


def chart_of(plan: Plan, rows: Sequence[Row], place: int = 0, tell: Tell = plainly) -> Chart:
    """Make the chart of a reading, whatever has come of the plan so far, in SI.

    Words in it have values as `tell` writes them, of a value and its unit.
    """
    return (_map if is_map(plan) else _panel)(plan, rows, place, tell)


def ordered(plan: Plan) -> list[Varied]:
    """Put the axis first that goes across: of a number and names, the number."""
    return sorted(plan.axes, key=lambda axis: not axis.is_numeric)


def is_map(plan: Plan) -> bool:
    """Tell whether a plan makes a map: two numbers, the second one of many values."""
    across, *up = ordered(plan)
    return across.is_numeric and any(one.is_numeric and len(one.values) > MOST_CURVES for one in up)


def plain(value: Any) -> str | float:
    """Write a name, or a switch as one; leave a number."""
    if isinstance(value, bool):
        return "on" if value else "off"
    return "points" if isinstance(value, tuple) else value


def grid(plan: Plan, rows: Sequence[Row], place: int) -> Array:
    """Spread a reading over the points of a plan.

    Returns
    -------
    Values of the runs that have converged, of the plan's shape; NaN elsewhere, and for what is
    infinite.
    """
    good = np.full(plan.size, np.nan)
    for row in rows:
        if row.holds and math.isfinite(row.values[place]):
            good[row.number] = row.values[place]
    return good.reshape(plan.shape)


def is_wide(values: Array) -> bool:
    """Tell whether finite values go over so many decades that a chart of them is logarithmic."""
    return bool(values.size and values.min() > 0.0 and values.max() > DECADES * values.min())


def _map(plan: Plan, rows: Sequence[Row], place: int, tell: Tell) -> Map:
    across, up = ordered(plan)
    x, y = (np.array(axis.values, dtype=float) for axis in (across, up))
    good = factor_of(plan, place) * grid(plan, rows, place)
    good = (good.T if plan.axes[0] is across else good)[np.argsort(y)][:, np.argsort(x)]
    return Map(
        plan.readings[place].title,
        _scale_of(plan, across),
        _scale_of(plan, up),
        np.sort(x),
        np.sort(y),
        _scale(plan, place, good),
        good,
        runs_of(plan, rows, place, tell),
    )


def _is_sampled(good: Array) -> bool:
    """Tell whether runs are few and enclose the others; those of a stopped sweep do not."""
    known = np.isfinite(good)
    return bool(known.sum() < SAMPLED * good.size and known[[0, 0, -1, -1], [0, -1, 0, -1]].all())


def _filled(chart: Map) -> Map:
    """Fill in what lies on the facets between runs."""
    # Here and not above: every page would load it, and none samples.
    from scipy.interpolate import LinearNDInterpolator

    shape, places = chart.z.shape, np.argwhere(np.isfinite(chart.z))
    to, back = (np.log, np.exp) if chart.scale.logarithmic else (np.asarray, np.asarray)
    facets = LinearNDInterpolator(places / shape, to(chart.z[tuple(places.T)]))
    filled = back(facets(np.moveaxis(np.indices(shape), 0, -1) / shape))
    return replace(chart, z=filled, is_sampled=True)


def _panel(plan: Plan, rows: Sequence[Row], place: int, tell: Tell) -> Panel:
    across, *up = ordered(plan)
    runs = runs_of(plan, rows, place, tell)
    curves = []
    for hue, label in enumerate(labels_of(plan, up, tell), start=1):
        own = np.flatnonzero(runs.hues == hue)
        own = own[np.argsort(runs.x[own])]
        if not across.is_numeric:  # nothing lies between names
            own = own[:0]
        x, y = runs.x[own], runs.y[own]
        curves += [
            PanelCurve("", x, y, hue, "faint"),
            PanelCurve(label, x, np.where(runs.holds[own], y, np.nan), hue),
        ]
    x_axis, y_axis = _scale_of(plan, across), _scale(plan, place, runs.y)
    return Panel(
        plan.readings[place].title,
        replace(x_axis, limits=limits_of(_places(across), x_axis, across.is_numeric)),
        replace(y_axis, limits=limits_of(runs.y, y_axis)),
        tuple(curves),
        runs,
    )


def limits_of(values: Array, axis: PanelAxis, is_numeric: bool = True) -> tuple[float, float]:
    """Give what an axis shows: all values with a margin, from zero where that is as near."""
    known = values[np.isfinite(values)]
    if not known.size:
        return (0.0, 1.0)
    low, high = float(known.min()), float(known.max())
    if not is_numeric:
        return (low - 0.5, high + 0.5)
    if axis.logarithmic:
        by = max(high / low, 1.0 + MARGIN) ** MARGIN
        return (low / by, high * by)
    by = MARGIN * (high - low) or abs(high) / 2.0 or 1.0
    return (0.0 if 0.0 <= low < by else low - by, high + by)


def labels_of(plan: Plan, up: Sequence[Varied], tell: Tell) -> list[str]:
    """Name the curves of a chart; a single one needs no name."""
    return [f"{plan.title(axis)} {text}" for axis in up for text in _texts(plan, axis, tell)] or [
        ""
    ]


def runs_of(plan: Plan, rows: Sequence[Row], place: int, tell: Tell) -> Runs:
    """Give where the runs stand on the chart of a reading, and what they came to."""
    across, *up = ordered(plan)
    numbers = np.array([row.number for row in rows], dtype=int)
    where = dict(
        zip((axis.name for axis in plan.axes), np.unravel_index(numbers, plan.shape), strict=True)
    )
    values = factor_of(plan, place) * np.array([row.values[place] for row in rows], dtype=float)
    values[~np.isfinite(values)] = np.nan
    level = where[up[0].name] if up else np.zeros(len(rows), dtype=int)
    on_map = is_map(plan)
    return Runs(
        numbers,
        _places(across)[where[across.name]],
        _places(up[0])[level] if on_map else values,
        values,
        level + 1,
        np.array([row.holds for row in rows], dtype=bool) & np.isfinite(values),
        _said(plan, rows, place, {axis.name: where[axis.name] for axis in (across, *up)}, tell),
    )


def _said(
    plan: Plan, rows: Sequence[Row], place: int, where: dict[str, Indices], tell: Tell
) -> list[str]:
    """Say of every run where it stands, and what it came to or why that is no answer."""
    axes = {axis.name: axis for axis in plan.axes}
    texts = {
        name: [f"{plan.title(axes[name])} {text}" for text in _texts(plan, axes[name], tell)]
        for name in where
    }
    factor, unit = factor_of(plan, place), unit_of(plan, place)
    said = []
    for i, row in enumerate(rows):
        point = ", ".join(texts[name][places[i]] for name, places in where.items())
        value = row.values[place]
        number = tell(factor * value, unit) if math.isfinite(value) else ""
        said.append(f"{point}: {'; '.join(filter(None, (number, _reason(row, value))))}")
    return said


def _reason(row: Row, value: float) -> str:
    """Say why a run is no answer, or nothing."""
    if not row.holds:
        return f"{row.ending}: {row.reason}" if row.reason else row.ending
    return NEVER if math.isinf(value) else NONE if math.isnan(value) else ""


def _texts(plan: Plan, axis: Varied, tell: Tell) -> list[str]:
    """Write the values of a setting, with their unit."""
    values = map(plain, axis.values)
    return [one if isinstance(one, str) else tell(one, plan.unit(axis)) for one in values]


def _places(axis: Varied) -> Array:
    """Give where the values of a setting stand: names one after the other."""
    if axis.is_numeric:
        return np.array(axis.values, dtype=float)
    return np.arange(float(len(axis.values)))


def _scale_of(plan: Plan, axis: Varied) -> PanelAxis:
    names = () if axis.is_numeric else tuple(str(plain(value)) for value in axis.values)
    return PanelAxis(plan.title(axis), plan.unit(axis), axis.logarithmic, names=names)


def _scale(plan: Plan, place: int, values: Array) -> PanelAxis:
    """Give the scale of a reading: of decades, where it goes over several."""
    wide = is_wide(values[np.isfinite(values)])
    return PanelAxis(plan.readings[place].title, unit_of(plan, place), wide)


def factor_of(plan: Plan, place: int) -> float:
    """Give by what a reading is multiplied: shares are told in per cent."""
    return 100.0 if plan.readings[place].quantity.is_share else 1.0


def unit_of(plan: Plan, place: int) -> str:
    """Give the unit in which a reading is told."""
    quantity = plan.readings[place].quantity
    return "%" if quantity.is_share else quantity.unit
