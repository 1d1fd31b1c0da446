"""What all views share: colours, figures, and the picture that they draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from bokeh.models import (
    BasicTicker,
    ColorBar,
    ColumnDataSource,
    FixedTicker,
    LinearColorMapper,
    Range1d,
)
from bokeh.plotting import figure

from app.recording import Recording
from app.views.legend import Key
from app.worker.reports import Frame
from solver.settings import Settings

BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#8A8A8A"
SKY, VERMILION = "#56B4E9", "#D55E00"
BACKWARD, STICK, FORWARD, OPEN = BLUE, "#D9D9D9", ORANGE, "#4D4D4D"
FACTORS = {"": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9, "k": 1e3, "M": 1e6, "G": 1e9}


@dataclass(frozen=True)
class Picture:
    """What is looked at in one moment.

    Attributes
    ----------
    run, before
        The run at work and the last one worth comparing with.
    past
        Finished runs, oldest first.
    frame
        The fields that are shown, or None before the first.
    instant
        Index of the chosen instant.
    """

    run: Recording
    before: Recording | None
    past: Sequence[Recording]
    frame: Frame | None
    instant: int


class View(Protocol):
    """One plot of the page.

    Attributes
    ----------
    name
        Its name in the choice of views.
    watches
        What its frames must carry beyond the fields, or an empty text.
    keys
        Its legend.
    figure
        The Bokeh figure.
    """

    name: str
    watches: str
    keys: Sequence[Key]
    figure: Any

    def applies(self, settings: Settings) -> bool:
        """Tell whether the view says anything about such a run."""

    def draw(self, picture: Picture) -> None:
        """Bring the figure up to date."""


def make_figure(x_label: str, y_label: str, **options: Any) -> Any:
    """Make a figure of the page's style; `options` go to Bokeh."""
    made = figure(
        height=230,
        min_height=150,
        sizing_mode="stretch_both",
        toolbar_location=None,
        tools=options.pop("tools", ""),
        x_axis_label=x_label,
        y_axis_label=y_label,
        min_border_right=12,
        min_border_top=6,
        **options,
    )
    for axis, kind in ((made.xaxis, "x_axis_type"), (made.yaxis, "y_axis_type")):
        if options.get(kind) == "log":
            # Given once and changed in place: a new ticker would be a new model for the document.
            axis.ticker = FixedTicker(ticks=[])
    made.axis.axis_label_text_font_size = "14px"
    made.axis.major_label_text_font_size = "13px"
    made.axis.axis_label_standoff = 4
    for ticker in (made.xaxis[0].ticker, made.yaxis[0].ticker):
        if isinstance(ticker, BasicTicker):
            # Labels are half of what a browser paints.
            ticker.desired_num_ticks = 4
    made.axis.minor_tick_line_color = None
    made.xgrid.visible = False
    made.outline_line_color = None
    return made


def color_bar(made: Any, mapper: LinearColorMapper, ticker: FixedTicker, title: str) -> None:
    """Put the scale of a colour map at the right of a figure."""
    bar = ColorBar(
        ticker=ticker,
        color_mapper=mapper,
        title=title,
        width=10,
        padding=4,
        title_text_font_size="12px",
        major_label_text_font_size="12px",
    )
    made.add_layout(bar, "right")


def empty(*columns: str) -> ColumnDataSource:
    """Make a data source without rows."""
    return ColumnDataSource({name: [] for name in columns})


def length_of(settings: Settings) -> float:
    """Give the length of a scene, m, which all axes along it show from end to end."""
    return float(settings.values()["length"])


def set_range(axis: Range1d, low: float, high: float) -> None:
    """Move a range, only if it has to: every change is painted."""
    if not high > low:
        low, high = low - 0.5, high + 0.5
    if (axis.start, axis.end) != (low, high):
        axis.update(start=low, end=high)


def mark_decades(axis: Any, scale: Range1d) -> None:
    """Label a logarithmic axis at whole decades only: in a small plot there is room for no more."""
    powers = range(round(np.log10(scale.start)), round(np.log10(scale.end)) + 1)
    ticks = [10.0**power for power in powers][:: max(1, len(powers) // 5)]
    if axis.ticker.ticks != ticks:
        axis.ticker.ticks = ticks


def decimal_scale(size: float, unit: str) -> tuple[float, str]:
    """Choose an SI prefix for values of a size; give the factor to divide by, and the unit."""
    if not (np.isfinite(size) and size > 0.0):
        return 1.0, unit
    fitting = [(factor, prefix) for prefix, factor in FACTORS.items() if size >= 0.5 * factor] or [
        (1e-9, "n")
    ]
    factor, prefix = max(fitting)
    return factor, prefix + unit


def decades(values: Sequence[float], floor: float) -> tuple[float, float]:
    """Give whole decades around the positive values, not below a floor."""
    finite = [value for value in values if np.isfinite(value) and value > 0.0]
    low = max(min(finite, default=1e-1), floor)
    high = max(max(finite, default=1.0), 10.0 * low)
    return 10.0 ** np.floor(np.log10(low)), 10.0 ** np.ceil(np.log10(high))


def round_up(value: float) -> float:
    """Give the next of 1, 2, 5, 10, 20, ... so that a growing axis moves seldom."""
    if value <= 0.0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 2.0, 5.0, 10.0)
    return float(next(step * decade for step in steps if step * decade >= 0.999 * value))


Limits = tuple[float, float]
FILLED = 0.6
"""Share of an axis that values have to fill, or it is drawn in."""
ROOM = 1.1


def held(old: Limits | None, low: float, high: float) -> Limits:
    """Give round limits around values and zero: those there were, as long as they suit.

    A browser spends more on an axis whose labels change than on all that it draws.
    """
    low, high = min(low, 0.0), max(high, 0.0)
    span = high - low
    if not np.isfinite(span):
        return old or (0.0, 1.0)
    if old is not None:
        inside = old[0] <= low and high <= old[1]
        if inside and span >= FILLED * (old[1] - old[0]):
            return old
    if span == 0.0:
        return 0.0, 1.0
    step = round_up(ROOM * span) / 10.0
    return float(np.floor(ROOM * low / step) * step), float(np.ceil(ROOM * high / step) * step)
