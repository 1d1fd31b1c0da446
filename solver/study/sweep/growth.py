"""How the readings of a sweep grow with a setting that goes over decades."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from solver.study.exponent import exponent_of
from solver.study.sweep.chart import grid
from solver.study.sweep.plan import Plan
from solver.study.sweep.point import Row


def growth(plan: Plan, rows: Sequence[Row]) -> list[str]:
    """Say in a line for every curve over decades with which power of the setting it grows."""
    numeric = [axis for axis in plan.axes if axis.is_numeric]
    if len(numeric) != 1 or not numeric[0].logarithmic:
        return []
    return list(_lines(plan, rows))


def _lines(plan: Plan, rows: Sequence[Row]) -> Iterator[str]:
    (along,) = (axis for axis in plan.axes if axis.is_numeric)
    names = next((axis for axis in plan.axes if axis is not along), None)
    for place, reading in enumerate(plan.readings):
        good = grid(plan, rows, place)
        if plan.axes[0] is along and names is not None:
            good = good.T
        for number, curve in enumerate(np.atleast_2d(good)):
            law = exponent_of(along.values, curve)
            if law is not None:
                which = f", {names.name}={names.values[number]}" if names else ""
                count = np.isfinite(curve).sum()
                yield f"{reading.name}{which}: {along.name}^({law}), of {count} runs"
