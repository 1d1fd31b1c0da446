"""Two columns of a sweep's table against each other: what goes with what."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.study.chart import Panel, PanelAxis, PanelCurve
from solver.study.sweep.chart import (
    Tell,
    factor_of,
    is_map,
    is_wide,
    labels_of,
    limits_of,
    ordered,
    plainly,
    runs_of,
    unit_of,
)
from solver.study.sweep.plan import Plan
from solver.study.sweep.point import Row

DONE, TOOK = "iterations done", "seconds in all"
"""Columns that every sweep has."""


@dataclass(frozen=True)
class Column:
    """A column of numbers: its title and unit, and of a quantity its place among what is asked."""

    title: str
    unit: str = ""
    place: int | None = None


def columns(plan: Plan) -> dict[str, Column]:
    """Give the columns of numbers by name: what varies, what is asked for, what runs took."""
    found = {one.name: one for one in plan.axes if one.is_numeric}
    varied = {name: Column(plan.title(one), plan.unit(one)) for name, one in found.items()}
    asked = {
        one.name: Column(one.title, unit_of(plan, place), place)
        for place, one in enumerate(plan.readings)
    }
    return {**varied, **asked, DONE: Column("Iterations done"), TOOK: Column("Run time", "s")}


def against(plan: Plan, rows: Sequence[Row], x: str, y: str, tell: Tell = plainly) -> Panel:
    """Draw a column over another, a point for every run that has both.

    Runs are joined as they follow each other over the first setting, one line for each value of
    the second; those of two settings of many values are not.
    """
    place = columns(plan)[y].place or 0
    across, up = (_values(plan, rows, name) for name in (x, y))
    rows = [row for row, known in zip(rows, np.isfinite(across), strict=True) if known]
    across, up = across[np.isfinite(across)], up[np.isfinite(across)]
    first, *second = ordered(plan)
    runs, is_joined = runs_of(plan, rows, place, tell), first.is_numeric and not is_map(plan)
    holds = np.array([row.holds for row in rows], dtype=bool) & np.isfinite(up)
    hues = np.ones_like(runs.hues) if is_map(plan) else runs.hues
    order, curves = np.argsort(runs.x, kind="stable"), []
    for hue, label in enumerate([""] if is_map(plan) else labels_of(plan, second, tell), start=1):
        own = order[hues[order] == hue] if is_joined else order[:0]
        curves += [
            PanelCurve("", across[own], up[own], hue, "faint"),
            PanelCurve(label, across[own], np.where(holds[own], up[own], np.nan), hue),
        ]
    title = f"{columns(plan)[y].title} over {columns(plan)[x].title}"
    shown = replace(runs, x=across, y=up, values=up, hues=hues, holds=holds)
    return Panel(title, _axis(plan, x, across), _axis(plan, y, up), tuple(curves), shown)


def _values(plan: Plan, rows: Sequence[Row], name: str) -> Array:
    """Give a column, NaN where a run has no value."""
    place = columns(plan)[name].place
    if place is not None:
        values = [factor_of(plan, place) * row.values[place] for row in rows]
    elif name in (DONE, TOOK):
        values = [row.iterations if name == DONE else row.seconds for row in rows]
    else:
        values = [plan.point(row.number)[name] for row in rows]
    found = np.array(values, dtype=float)
    return np.where(np.isfinite(found), found, np.nan)


def _axis(plan: Plan, name: str, values: Array) -> PanelAxis:
    column = columns(plan)[name]
    spread = any(one.name == name and one.logarithmic for one in plan.axes)
    axis = PanelAxis(column.title, column.unit, spread or is_wide(values[np.isfinite(values)]))
    return replace(axis, limits=limits_of(values, axis))
