"""A chart on the page that fills: drawn once, and from then on given what is new."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource, Range1d

from app.charts.layers import Here, layers, limits, span
from app.components.panes import column
from solver.study.chart import Chart, Map

Act = Callable[[], object]
HAND = ThreadPoolExecutor(1, "drawing")
"""Draws, and first imports what draws: at half a second each, all pages would stand still."""
GROWS = ("number", "x", "y", "left", "value")
"""Columns that tell whether a table is another one, or a longer one."""


def drawn(chart: Chart, *rest: Any, **size: Any) -> Future[Any]:
    """Have a chart drawn, as `app.charts.draw` does it."""
    return HAND.submit(_draw, chart, *rest, **size)


def _draw(chart: Chart, *rest: Any, **size: Any) -> Any:
    from app.charts.draw import draw

    return draw(chart, *rest, **size)


class ChartShown(NamedTuple):
    """A chart, that before it, and the place on its axes that is marked."""

    chart: Chart
    before: Chart | None
    here: Here | None


class Filling:
    """The place of one chart, which only the page's own turns touch.

    Parameters
    ----------
    soon
        Has something done in a turn of the page, which alone may touch a figure there; also for a
        thread.
    on_drawn
        Called in such a turn once there is something for `catch_up`.

    Attributes
    ----------
    view
        What stands on the page.
    figure
        What is drawn there; None while there is nothing.
    shown
        What that is of.
    """

    def __init__(self, soon: Callable[[Act], None], on_drawn: Act) -> None:
        self.view = column(role="filling", sizing_mode="stretch_both")
        self.figure: Any = None
        self.shown: ChartShown | None = None
        self._soon, self._on_drawn = soon, on_drawn
        self._form: tuple[Any, ...] = ()
        self._drawing: Future[Any] | None = None
        self._wanted: ChartShown | None = None
        self._is_there = False

    def clear(self) -> None:
        """Show nothing, until there is another chart."""
        self.view[:] = []
        self.figure, self.shown, self._form, self._drawing = None, None, (), None
        self._is_there = False

    def show(self, chart: Chart, before: Chart | None, here: Here | None) -> None:
        """Show a chart: in the figure that there is, or in another where it is of another form."""
        self._wanted = ChartShown(chart, before, here)
        if form(chart) != self._form:
            self._form = form(chart)
            self._drawing = drawn(*self._wanted, height=None)
            self._drawing.add_done_callback(lambda drawing: self._soon(self._on_drawn))
        else:
            self._soon(self._fill)

    def catch_up(self) -> bool:
        """Put the figure in its place once it is drawn; tell if that was done."""
        if self._drawing is None or self._wanted is None or not self._drawing.done():
            return False
        self.figure, self.shown, self._drawing = self._drawing.result(), self._wanted, None
        self._is_there = False
        self.figure.title.visible = False  # the legend has it
        # Made here and not where it is drawn, as its theme is that of the page.
        self.view[:] = [pn.pane.Bokeh(self.figure, sizing_mode="stretch_both")]
        return True

    def go_on(self, figure: str) -> None:
        """Fill a figure that a browser has; of one on its way it would know nothing."""
        if self.figure is not None and self.figure.id == figure:
            self._is_there = True
            self._soon(self._fill)

    def _fill(self) -> None:
        if self._is_there and self._drawing is None and self._wanted is not None:
            self.shown = self._wanted
            fill(self.figure, *self.shown)


def form(chart: Chart) -> tuple[Any, ...]:
    """Give what of a chart does not change while a figure fills."""
    axes = (chart.x, chart.y, chart.scale) if isinstance(chart, Map) else (chart.x, chart.y)
    labels = [] if isinstance(chart, Map) else [(one.label, one.hue) for one in chart.curves]
    return (chart.title, *((one.label, one.logarithmic, one.names) for one in axes), *labels)


def fill(figure: Any, chart: Chart, before: Chart | None, here: Here | None) -> None:
    """Bring a figure up to a chart of the same form; of runs only what is new is sent."""
    # Not `select`, which goes through all models: 20 ms a source.
    sources = {one.data_source.name: one.data_source for one in figure.renderers}
    for layer in layers(chart, before, here):
        source = sources[layer.name]
        # HoloViews has what decides of colours in a column of its own.
        origins = {name: layer.looks["color"] if name == "color" else name for name in source.data}
        _feed(source, {name: layer.columns[origin] for name, origin in origins.items()})
    for axis, ends in zip((figure.x_range, figure.y_range), limits(chart, before), strict=True):
        _move(axis, ends)
    if isinstance(chart, Map):
        (bar,), (low, high) = figure.right, span(chart)
        bar.color_mapper.update(low=low, high=high)


def _feed(source: ColumnDataSource, new: dict[str, Any]) -> None:
    """Give a source its columns, or of runs those that have come since."""
    old, telling = source.data, [name for name in new if name in GROWS]
    count = len(old[telling[0]]) if telling else 0
    if telling and all(np.array_equal(old[name], new[name][:count]) for name in telling):
        if count < len(new[telling[0]]):
            source.stream({name: values[count:] for name, values in new.items()})
    else:
        source.data = new


def _move(axis: Range1d, ends: tuple[float, float]) -> None:
    """Show other values, unless these are shown: what is zoomed stays so."""
    if (axis.reset_start, axis.reset_end) != ends:
        start, end = ends
        axis.update(start=start, end=end, reset_start=start, reset_end=end)
