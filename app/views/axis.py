"""Axes of a figure: units, stable limits, and ticks."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from bokeh.models import LogScale, NumeralTickFormatter
from bokeh.plotting import figure
from numpy.typing import ArrayLike

from app.frame import Floats
from solver.arrays import Array, Indices
from solver.files.amounts import Unit, unit_for

LONGEST = 16
"""Letters in a line of the title beside a plot: a small plot is no higher."""
PERCENT = Unit("%", 0.01)
FLOOR = 1e-15
"""Smallest value that a logarithmic axis shows."""
FARTHEST = 2.0
"""Largest value of an iterate in sight over the largest of what is known."""
MOST_CELLS = 401
"""Largest number of cells of an image along a side, where points are not even."""
EVEN = 1e-6
"""Difference of the gaps between points, over their range, up to which they are even:
positions have seven digits."""


class Axis:
    """The x or y axis of a figure: a unit for each run, and stable limits.

    `title` is without the unit; `unit` is the SI unit of all values that are passed to
    the axis, empty for numbers, "%" for shares.
    """

    def __init__(self, plot: figure, side: str, title: str, unit: str = "") -> None:
        self._figure = plot
        self._side = side
        self._range = getattr(plot, f"{side}_range")
        self._is_log = isinstance(getattr(plot, f"{side}_scale"), LogScale)
        self._title = title
        self._si = unit
        self._unit = Unit("")
        self._key: object = None
        self._label()

    def __call__(self, values: ArrayLike) -> Floats:
        """Values in the unit of the axis, of values in SI of any shape."""
        return np.asarray(values, dtype=np.float32) / np.float32(self._unit.factor)

    def si(self, value: float) -> float:
        """A value in SI, of a value in the unit of the axis."""
        return float(value) * self._unit.factor

    def rename(self, title: str, unit: str) -> None:
        """Show another quantity."""
        if (title, unit) != (self._title, self._si):
            self._title = title
            self._si = unit
            self._key = None

    def hold(
        self,
        key: object,
        *curves: ArrayLike,
        iterate: Sequence[ArrayLike] = (),
        margin: float = 0.0,
    ) -> None:
        """Extend the limits to curves in SI; limits are reset for another key.

        Curves of an iterate, which may be far off, extend them to `FARTHEST` times the
        largest of the others: they must not press these flat.

        With another key, as of another run, the axis chooses its unit again. The margin
        is a share of the distance between the limits, and is left free on either side;
        a logarithmic axis shows whole decades.
        """
        low, high = extent(curves)
        if iterate:
            largest = FARTHEST * max(abs(low), abs(high))
            ends = np.array(extent(iterate))
            if largest > 0.0:
                ends = ends.clip(-largest, largest)
            low, high = extent([ends, [low, high]])
        if key == self._key:
            held_low, held_high = self._held
            low = min(held_low, low)
            high = max(held_high, high)
        else:
            self._key = key
            self._unit = PERCENT
            if self._si != PERCENT.name:
                self._unit = unit_for(max(abs(low), abs(high)), self._si)
            self._label()
        self._held = (low, high)
        if self._is_log:
            first = np.floor(np.log10(max(low, FLOOR)))
            last = np.ceil(np.log10(high))
            self.span(10.0**first, 10.0**last)
            return
        factor = self._unit.factor
        # A single value has one unit of room on either side.
        free = factor
        if high > low:
            free = margin * (high - low)
        self.span((low - free) / factor, (high + free) / factor)

    def span(self, low: float, high: float) -> None:
        """Set the limits of the axis in its unit; a zoom stays until these change."""
        if (low, high) != (self._range.reset_start, self._range.reset_end):
            self._range.update(start=low, end=high, reset_start=low, reset_end=high)

    def _label(self) -> None:
        text = self._unit.titled(self._title)
        if self._side == "x":
            # Below the plot stands the title of the figure: it is nearer than a label.
            self._figure.title.text = text
        else:
            self._figure.yaxis.axis_label = textwrap.fill(text, LONGEST)


def whole(axis: Any) -> None:
    """Set the ticks of an axis to whole numbers only."""
    axis.ticker.update(min_interval=1, num_minor_ticks=0)
    axis.formatter = NumeralTickFormatter(format="0")


def edges(middles: Array) -> Array:
    """Edges of cells around n ascending points, midway between them, (n + 1,)."""
    gaps = np.diff(middles)
    if len(gaps) == 0:
        gaps = np.ones(1)
    return np.concatenate(
        [
            middles[:1] - 0.5 * gaps[0],
            0.5 * (middles[1:] + middles[:-1]),
            middles[-1:] + 0.5 * gaps[-1],
        ]
    )


def even_cells(middles: Array) -> tuple[Array, Indices]:
    """Equal cells from the first to the last of n ascending points.

    An image has cells of equal size, while points may lie anywhere: they are as large
    as the smallest gap between two points, as far as `MOST_CELLS` allow.

    Returns
    -------
    Edges of all cells, shape (n_cells + 1,), and the index of the point nearest to the
    middle of each, shape (n_cells,).
    """
    gaps = np.diff(middles)
    span = float(np.ptp(middles))
    count = len(middles)
    if count > 2 and np.ptp(gaps) > EVEN * span:
        # Two points at a break have the same position.
        smallest = float(gaps[gaps > EVEN * span].min())
        count = math.ceil(min(span / smallest, MOST_CELLS - 1.0)) + 1
    places = np.linspace(middles[0], middles[-1], count)
    return edges(places), np.searchsorted(edges(middles)[1:-1], places)


def extent(curves: Iterable[ArrayLike]) -> tuple[float, float]:
    """Smallest and largest value of curves that are entirely finite; else zeros."""
    lows = []
    highs = []
    for curve in curves:
        values = np.asarray(curve)
        if not values.size:
            continue
        low = float(values.min())
        high = float(values.max())
        if math.isfinite(low) and math.isfinite(high):
            lows.append(low)
            highs.append(high)
    return min(lows, default=0.0), max(highs, default=0.0)


def rounded_up(size: float, steps: Iterable[float] = (1.0, 2.0, 5.0, 10.0)) -> float:
    """A size rounded up to a step times a power of ten; 1 for zero."""
    power = 1.0
    if size > 0.0:
        power = 10.0 ** math.floor(math.log10(size))
    return next(step * power for step in steps if step * power >= size)
