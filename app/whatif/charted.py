"""What a chart of runs shows, as plain data: its axes, and the value and the state of each run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from app.views.colors import VIRIDIS
from solver.settings import Settings
from solver.study.figure_data import HUES
from solver.study.sweep import Plan, Row, Varied
from solver.study.sweep.chart import DECADES

MOST_CURVES = 6
"""Values of a second setting that have a curve each; more of them make a map."""
WAITING, HOLDS = "waiting", ""
NEVER, NONE = "never", "none: a run with these settings has no such value"


def described(plan: Plan) -> dict[str, Any]:
    """Say what a chart of the first quantity of a plan is.

    Returns
    -------
    `axes`, that across first, each with its `step` in the numbers of points; the `quantity`; and
    whether it is a `map`.
    """
    across, *up = _ordered(plan)
    wide = [axis for axis in up if axis.is_numeric and len(axis.values) > MOST_CURVES]
    reading = plan.readings[0]
    unit = "%" if reading.quantity.is_share else reading.quantity.unit
    return {
        "key": plan.digest,
        "axes": [_described(plan, axis) for axis in (across, *up)],
        "quantity": {"title": reading.title, "unit": unit},
        "map": bool(wide) and across.is_numeric,
        "decades": DECADES,
        "hues": list(HUES),
        "scale": list(VIRIDIS),
    }


def drawn(plan: Plan, rows: Sequence[Row]) -> dict[str, list[Any]]:
    """Give what has come of each point of a plan.

    Returns
    -------
    By number of the point the `values`, None where there is no finite one, and the `states`, which
    are places in `words`: waiting, answered, or why it is no answer.
    """
    share = plan.readings[0].quantity.is_share
    values: list[float | None] = [None] * plan.size
    states = [0] * plan.size
    words = [WAITING, HOLDS]
    for row in rows:
        value = row.values[0]
        if math.isfinite(value):
            values[row.number] = float(f"{100.0 * value if share else value:.6g}")
        word = said(row)
        if word not in words:
            words.append(word)
        states[row.number] = words.index(word)
    return {"values": values, "states": states, "words": words}


def said(row: Row) -> str:
    """Say why a run is no answer, or nothing."""
    if not row.holds:
        return f"{row.ending}: {row.reason}" if row.reason else row.ending
    value = row.values[0]
    return NEVER if math.isinf(value) else NONE if math.isnan(value) else HOLDS


def stands(plan: Plan, settings: Settings) -> list[Any]:
    """Give where settings stand on the axes of a chart, that across first; empty off the plan."""
    if settings.scene != plan.settings.scene:
        return []
    return [_plain(getattr(settings, axis.name)) for axis in _ordered(plan)]


def is_of(plan: Plan, settings: Settings) -> bool:
    """Tell whether a plan fixes what settings say."""
    if settings.scene != plan.settings.scene:
        return False
    varied = {axis.name for axis in plan.axes}
    before, after = plan.settings.values(), settings.values()
    return all(before[name] == after[name] for name in before if name not in varied)


def is_comparable(plan: Plan, other: Plan) -> bool:
    """Tell whether the charts of two plans have the same axes."""
    names = [[axis.name for axis in _ordered(one)] for one in (plan, other)]
    kinds = [described(one)["map"] for one in (plan, other)]
    same = names[0] == names[1] and kinds[0] == kinds[1]
    return same and plan.readings[0].name == other.readings[0].name


def _ordered(plan: Plan) -> list[Varied]:
    """Put the axis first that goes across: of a number and names, the number."""
    return sorted(plan.axes, key=lambda axis: not axis.is_numeric)


def _described(plan: Plan, axis: Varied) -> dict[str, Any]:
    place = plan.axes.index(axis)
    return {
        "name": axis.name,
        "title": plan.title(axis),
        "unit": plan.unit(axis),
        "values": [_plain(value) for value in axis.values],
        "log": axis.logarithmic,
        "numeric": axis.is_numeric,
        "step": math.prod(plan.shape[place + 1 :]),
    }


def _plain(value: Any) -> Any:
    """Write a name, or a switch as one; leave a number."""
    if isinstance(value, bool):
        return "on" if value else "off"
    return "points" if isinstance(value, tuple) else value
