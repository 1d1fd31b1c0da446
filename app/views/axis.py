"""Axes of a figure: units, ends that change seldom, and ticks."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable
from typing import Any

import numpy as np
from bokeh.models import LogScale, NumeralTickFormatter
from bokeh.plotting import figure
from numpy.typing import ArrayLike

from app.frame import Floats
from app.units import Unit, unit_for

LONGEST = 16
"""Letters in a line of the title beside a plot: a small one is no higher."""
FLOOR = 1e-15
"""Smallest value that a logarithmic axis shows."""


class Axis:
    """The x or y axis of a figure, whose unit is chosen once a run, and whose ends change seldom.

    Its title is without that; what it is given is in an SI unit, empty for none.
    """

    def __init__(self, made: figure, side: str, title: str, unit: str = "") -> None:
        self._made = made
        self._side = side
        self._range = getattr(made, f"{side}_range")
        self._is_log = isinstance(getattr(made, f"{side}_scale"), LogScale)
        self._title = title
        self._si = unit
        self._unit = Unit("")
        self._key = None
        self._label()

    def __call__(self, values: ArrayLike) -> Floats:
        """Values in SI as the axis shows them."""
        return np.asarray(values, dtype=np.float32) / np.float32(self._unit.factor)

    def si(self, value: float) -> float:
        """A value on the axis in SI."""
        return float(value) * self._unit.factor

    def rename(self, title: str, unit: str) -> None:
        """Show another quantity."""
        if (title, unit) != (self._title, self._si):
            self._title = title
            self._si = unit
            self._key = None

    def hold(self, key: object, *curves: ArrayLike, margin: float = 0.0) -> None:
        """Show all values of curves in SI, and all that was shown with the same key.

        With another key, as of another run, it chooses the unit anew. The margin is a
        share of the distance, and is left free on either side; a logarithmic axis shows
        whole decades.
        """
        low, high = extent(curves)
        if key != self._key:
            self._key = key
            self._held = (low, high)
            self._unit = unit_for(max(abs(low), abs(high)), self._si)
            self._label()
        low, high = self._held = min(self._held[0], low), max(self._held[1], high)
        if self._is_log:
            low = np.log10(max(low, FLOOR))
            high = np.log10(high)
            self.span(10.0 ** np.floor(low), 10.0 ** np.ceil(high))
        else:
            if high > low:
                room = margin * (high - low)
            else:
                room = self._unit.factor
            self.span(
                (low - room) / self._unit.factor, (high + room) / self._unit.factor
            )

    def span(self, low: float, high: float) -> None:
        """Show what lies between two values on the axis; zooming stays until these change."""
        if (low, high) != (self._range.reset_start, self._range.reset_end):
            self._range.update(start=low, end=high, reset_start=low, reset_end=high)

    def _label(self) -> None:
        text = self._unit.titled(self._title)
        if self._side == "x":
            self._made.title.text = text
        else:
            self._made.yaxis.axis_label = textwrap.fill(text, LONGEST)


def whole(axis: Any) -> None:
    """Have an axis say whole numbers only."""
    axis.ticker.update(min_interval=1, num_minor_ticks=0)
    axis.formatter = NumeralTickFormatter(format="0")


def edges(middles: Floats) -> Floats:
    """Ends of cells of equal size about points."""
    size = float(np.ptp(middles)) / max(len(middles) - 1, 1) or 1.0
    return np.append(middles - 0.5 * size, middles[-1] + 0.5 * size)


def extent(curves: Iterable[ArrayLike]) -> tuple[float, float]:
    """Smallest and largest value of all, as far as they are finite; zeros where there is none."""
    parts = [part for curve in curves if (part := np.asarray(curve)).size]
    ends = [(float(part.min()), float(part.max())) for part in parts]
    lows, highs = zip(
        *[e for e in ends if all(map(math.isfinite, e))] or [(0.0, 0.0)], strict=True
    )
    return min(lows), max(highs)


def rounded_up(size: float, steps: Iterable[float] = (1.0, 2.0, 5.0, 10.0)) -> float:
    """A size rounded up to a step times a power of ten; 1 for none."""
    if size > 0.0:
        power = 10.0 ** math.floor(math.log10(size))
    else:
        power = 1.0
    return next(step * power for step in steps if step * power >= size)
