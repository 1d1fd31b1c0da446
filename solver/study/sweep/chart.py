"""The charts of a sweep as plain data: curves over one setting, or a map over two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.study.figure_data import Panel, PanelAxis, PanelCurve
from solver.study.sweep.plan import Plan, Varied
from solver.study.sweep.point import Row

DECADES = 30.0
"""Ratio of the largest to the smallest value from which a chart is logarithmic."""
SAMPLED = 0.5
"""Share of the points up to which runs are few."""
NOT_CONVERGED = "not converged"


@dataclass(frozen=True, eq=False)
class Map:
    """A quantity over two settings.

    Attributes
    ----------
    z
        Values, shape (len(y_values), len(x_values)); NaN where no run has converged.
    is_sampled
        Whether a few runs stand for all, so that the surface between them is meant.
    """

    title: str
    x: PanelAxis
    y: PanelAxis
    x_values: Array
    y_values: Array
    scale: PanelAxis
    z: Array
    is_sampled: bool = False


def charts(plan: Plan, rows: Sequence[Row]) -> list[Panel | Map]:
    """Make a chart of every reading; none where no setting that varies is a number.

    Two numbers make a map; a number and names make a curve for every name.
    """
    numeric = [axis for axis in plan.axes if axis.is_numeric]
    if not numeric:
        return []
    make = _map if len(numeric) == 2 else _panel
    return [make(plan, rows, place) for place in range(len(plan.readings))]


def grid(plan: Plan, rows: Sequence[Row], place: int) -> tuple[Array, Array]:
    """Spread a reading over the points of a plan.

    Returns
    -------
    Values of the runs that have converged, and of those that have not, each of the plan's shape;
    NaN elsewhere, and for what is infinite.
    """
    good, other = np.full(plan.size, np.nan), np.full(plan.size, np.nan)
    for row in rows:
        value = row.values[place]
        (good if row.holds else other)[row.number] = value if np.isfinite(value) else np.nan
    return good.reshape(plan.shape), other.reshape(plan.shape)


def _map(plan: Plan, rows: Sequence[Row], place: int) -> Map:
    along, up = plan.axes
    good = grid(plan, rows, place)[0].T
    return Map(
        plan.readings[place].title,
        _scale_of(plan, along),
        _scale_of(plan, up),
        np.array(along.values, dtype=float),
        np.array(up.values, dtype=float),
        _scale(plan, place, good),
        good,
        _is_sampled(plan, good),
    )


def _is_sampled(plan: Plan, good: Array) -> bool:
    """Tell whether runs are few and enclose the others; those of a stopped sweep do not."""
    known = np.isfinite(good)
    return bool(known.sum() < SAMPLED * plan.size and known[[0, 0, -1, -1], [0, -1, 0, -1]].all())


def _panel(plan: Plan, rows: Sequence[Row], place: int) -> Panel:
    (along,) = (axis for axis in plan.axes if axis.is_numeric)
    names = next((axis for axis in plan.axes if axis is not along), None)
    good, other = grid(plan, rows, place)
    if names is not None and plan.axes[0] is along:
        good, other = good.T, other.T
    x = np.array(along.values, dtype=float)
    if names is None:  # points that were left out are no gaps
        ran = np.isin(np.arange(plan.size), [row.number for row in rows])
        x, good, other = x[ran], good[ran], other[ran]
    curves = []
    for number, (line, missed) in enumerate(
        zip(np.atleast_2d(good), np.atleast_2d(other), strict=True)
    ):
        label = plan.readings[place].title if names is None else str(names.values[number])
        curves.append(PanelCurve(label, x, line, number + 1, "points"))
        if np.isfinite(missed).any():
            curves.append(PanelCurve(NOT_CONVERGED, x, missed, 0, "points"))
    return Panel(
        plan.readings[place].title if names is None else plan.title(names),
        _scale_of(plan, along),
        _scale(plan, place, np.array([good, other])),
        tuple(curves),
    )


def _scale_of(plan: Plan, axis: Varied) -> PanelAxis:
    return PanelAxis(plan.title(axis), plan.unit(axis), axis.logarithmic)


def _scale(plan: Plan, place: int, values: Array) -> PanelAxis:
    """Give the scale of a reading: of decades, where it goes over several."""
    reading = plan.readings[place]
    return PanelAxis(reading.title, reading.quantity.unit, is_wide(values[np.isfinite(values)]))


def is_wide(values: Array) -> bool:
    """Tell whether finite values go over so many decades that a chart of them is logarithmic."""
    return bool(values.size and values.min() > 0.0 and values.max() > DECADES * values.min())
