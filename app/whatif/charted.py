"""How the chart of a sweep, the chart before and the present settings belong together."""

from __future__ import annotations

import numpy as np

from app.charts.layers import Here
from solver.settings import Settings
from solver.study.chart import Chart
from solver.study.sweep import Plan, Varied
from solver.study.sweep.chart import is_map, ordered


def stands(plan: Plan, chart: Chart, settings: Settings) -> Here | None:
    """Give where settings stand on a chart: NaN above where there is no run; None off its axes."""
    if settings.scene != plan.settings.scene:
        return None
    across, *up = ordered(plan)
    x, y = _place(across, settings), np.nan
    if is_map(plan):
        y = _place(up[0], settings)
        return None if np.isnan([x, y]).any() else (x, y)
    point = {axis.name: getattr(settings, axis.name) for axis in plan.axes}
    for number, value in zip(chart.runs.numbers, chart.runs.y, strict=True) if chart.runs else ():
        y = value if plan.point(int(number)) == point else y
    return None if np.isnan(x) else (x, y)


def _place(axis: Varied, settings: Settings) -> float:
    """Give where a value stands on an axis; NaN off it."""
    value = getattr(settings, axis.name)
    if axis.is_numeric:
        return float(value) if min(axis.values) <= value <= max(axis.values) else np.nan
    return float(axis.values.index(value)) if value in axis.values else np.nan


def is_of(plan: Plan, settings: Settings) -> bool:
    """Tell whether a plan fixes what settings say."""
    if settings.scene != plan.settings.scene:
        return False
    varied = {axis.name for axis in plan.axes}
    before, after = plan.settings.values(), settings.values()
    return all(before[name] == after[name] for name in before if name not in varied)


def is_comparable(plan: Plan, other: Plan) -> bool:
    """Tell whether the charts of two plans have the same axes."""
    names = [[axis.name for axis in ordered(one)] for one in (plan, other)]
    same = names[0] == names[1] and is_map(plan) == is_map(other)
    return same and plan.readings[0].name == other.readings[0].name
