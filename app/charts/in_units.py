"""Charts in the units that one reads; the engine gives them in SI."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from app.charts.layers import Here
from app.picture.units import scale_of
from solver.arrays import Array
from solver.study.chart import Chart, Map, Panel, PanelAxis, Runs

Scale = tuple[float, str]


class ChartUnits(NamedTuple):
    """What values across, up and of a map are divided by, each with its unit."""

    x: Scale
    y: Scale
    z: Scale


def scales_of(chart: Chart, units: str) -> ChartUnits:
    """Choose units that suit a chart."""
    if isinstance(chart, Map):
        z = _scale(chart.scale, chart.z, units)
        return ChartUnits(
            _scale(chart.x, chart.x_values, units), _scale(chart.y, chart.y_values, units), z
        )
    x, y = (np.concatenate([getattr(one, name) for one in chart.curves]) for name in "xy")
    if chart.runs:
        x, y = np.append(x, chart.runs.x), np.append(y, chart.runs.y)
    up = _scale(chart.y, y, units)
    return ChartUnits(_scale(chart.x, np.append(x, chart.x.limits or ()), units), up, up)


def _scale(axis: PanelAxis, values: Array, units: str) -> Scale:
    known = np.abs(values[np.isfinite(values)])
    return scale_of(float(known.max(initial=0.0)), axis.unit, units)


def in_units(chart: Chart, scales: ChartUnits) -> Chart:
    """Turn a chart into these units."""
    (across, _), (up, _), (by, _) = scales
    x, y = _axis(chart.x, scales.x), _axis(chart.y, scales.y)
    if isinstance(chart, Map):
        return replace(
            chart,
            x=x,
            y=y,
            scale=_axis(chart.scale, scales.z),
            x_values=chart.x_values / across,
            y_values=chart.y_values / up,
            z=chart.z / by,
            level=None if chart.level is None else chart.level / by,
            runs=_runs(chart.runs, scales),
        )
    curves = tuple(replace(one, x=one.x / across, y=one.y / up) for one in chart.curves)
    return Panel(chart.title, x, y, curves, _runs(chart.runs, scales) if chart.runs else None)


def placed(here: Here | None, scales: ChartUnits) -> Here | None:
    """Give where a place on the axes lies in these units."""
    return here and (here[0] / scales.x[0], here[1] / scales.y[0])


def _axis(axis: PanelAxis, scale: Scale) -> PanelAxis:
    factor, unit = scale
    ends = axis.limits
    limits = (ends[0] / factor, ends[1] / factor) if ends else None
    return replace(axis, unit=unit, limits=limits)


def _runs(runs: Runs, scales: ChartUnits) -> Runs:
    (across, _), (up, _), (by, _) = scales
    return replace(runs, x=runs.x / across, y=runs.y / up, values=runs.values / by)
