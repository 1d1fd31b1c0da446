"""How the chart of a sweep, the chart before and the present settings belong together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.charts.layers import Here
from app.picture.units import measured, minus
from solver.settings import Settings
from solver.study.chart import Chart
from solver.study.sweep import Plan, Row, Varied
from solver.study.sweep.chart import chart_of, is_map, ordered
from solver.study.sweep.columns import against, columns


def columns_of(plan: Plan, chosen: tuple[str, str]) -> tuple[str, str]:
    """Give the columns that are drawn, across and up: as chosen, or what is asked over what varies.

    A setting of names stands across as it is.
    """
    usual = ordered(plan)[0].name, plan.readings[0].name
    return chosen if all(name in (*columns(plan), usual[0]) for name in chosen) else usual


def is_usual(plan: Plan, x: str, y: str) -> bool:
    """Tell whether a chart of these columns is that of a quantity over what varies."""
    return x == ordered(plan)[0].name and columns(plan)[y].place is not None


def drawn(plan: Plan, rows: Sequence[Row], chosen: tuple[str, str], units: str) -> Chart:
    """Make the chart of two columns, whatever has come of the plan so far, in SI."""

    def tell(value: float, unit: str) -> str:
        return minus(measured(value, unit, units, 4))

    x, y = columns_of(plan, chosen)
    if is_usual(plan, x, y):
        return chart_of(plan, rows, columns(plan)[y].place or 0, tell)
    return against(plan, rows, x, y, tell)


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
