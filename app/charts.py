"""Charts by HoloViews: of What if, of reports, and of pages of commands."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import holoviews as hv
import numpy as np
import pandas as pd
import panel as pn
from bokeh.embed import components
from bokeh.models import (
    BasicTicker,
    BasicTickFormatter,
    FixedTicker,
    LogTicker,
    LogTickFormatter,
    NoOverlap,
    Ticker,
    TickFormatter,
)
from bokeh.palettes import Viridis256
from bokeh.resources import Resources

from app.templates import html
from app.views.axis import edges
from app.views.colors import REFERENCE
from solver.arrays import Array
from solver.files.amounts import unit_for
from solver.study.page import (
    HUES,
    Chart,
    Map,
    Panel,
    PanelAxis,
    PanelCurve,
    PlotSection,
    Runs,
)

hv.extension("bokeh")

COLORS = (REFERENCE, *HUES)
"""Colours of curves by their hue."""
LEVELS = 8
"""Number of contour lines on a map, about."""
HEIGHT = 350
"""Height of a chart, px."""
LONGEST = 150.0
"""Ratio of the ends of the longest logarithmic axis with ticks at 1, 2, 5, 10, ..."""
LABEL = 34
"""Characters of a line beside an axis."""
SIZES = {"title": "1.05em", "labels": "1em", "ticks": "0.925em"}
"""Type sizes: to Bokeh an em is 13 px, with and without the theme of the page."""
UNPRINTED = "@media print { :host { display: none !important; } }"
"""Style sheet of what has no meaning on paper."""
TOOLS = ["box_zoom", "pan", "wheel_zoom", "reset", "save"]
SAID = '<div style="max-width: min(320px, 40vw); white-space: normal">@said</div>'
"""What is said of a run where one points: why it failed takes several lines."""
HOVER: dict[str, Any] = {"tools": ["hover"], "hover_tooltips": SAID}


def render(plots: Sequence[PlotSection]) -> tuple[str, Sequence[str]]:
    """Draw charts for a page that loads nothing: entry point of `solver.study.page`.

    Returns
    -------
    Styles and scripts of all charts, and each section (HTML).
    """
    draw = hv.renderer("bokeh").get_plot
    figures = []
    for plot in plots:
        for chart in plot.charts:
            figures.append(draw(overlay(in_units(chart))).state)
    script, panels = components(figures, wrap_script=True)
    sections = []
    first = 0
    for plot in plots:
        last = first + len(plot.charts)
        section = html(
            "charts.html",
            heading=plot.heading,
            keys=keys(plot.charts),
            panels=panels[first:last],
        )
        sections.append(section)
        first = last
    head = html("charts_head.html", library=library(), script=script)
    return head, sections


def library(*more: str) -> str:
    """Scripts of Bokeh and others as HTML, for a page that loads nothing."""
    # Not `Resources.render`: in it Panel has a page load scripts from the network.
    texts = Resources(mode="inline", components=["bokeh", *more]).js_raw
    return html("library.html", scripts=texts)


def keys(charts: Sequence[Chart]) -> str:
    """Common legend of charts side by side as HTML; "" without labels."""
    curves: dict[str, dict[str, str]] = {}
    for chart in charts:
        if isinstance(chart, Panel):
            for curve in chart.curves:
                if curve.label:
                    curves[curve.label] = _key(curve)
    return html("keys.html", curves=curves.values())


def _key(curve: PanelCurve) -> dict[str, str]:
    """Label of a curve in the legend, and dash and colour of its line."""
    dash = curve.line if curve.line in ("dashed", "dotted") else "solid"
    return {"label": curve.label, "dash": dash, "color": COLORS[curve.hue]}


class LiveChart:
    """A chart that is updated as its runs end; `view` has legend and chart."""

    def __init__(self) -> None:
        self._keys = pn.pane.HTML("", margin=(4, 8))
        self._figure = pn.pane.HoloViews(
            None, sizing_mode="stretch_width", margin=(0, 6)
        )
        self.view = pn.Column(self._keys, self._figure, sizing_mode="stretch_width")
        self._drawn: list[Any] = []

    def show(self, chart: Chart) -> None:
        """Show a chart, in the same figure if axes and curves are unchanged."""
        axes = [chart.x, chart.y]
        if isinstance(chart, Map):
            axes.append(chart.scale)
        legend = keys([chart])
        data = in_units(chart)
        drawn: list[Any] = [legend]
        for axis in axes:
            drawn.append((axis.quantity, axis.names, axis.logarithmic))
        if drawn == self._drawn:
            self._pipe.send(data)
            return
        self._drawn = drawn
        self._keys.object = legend
        self._pipe = hv.streams.Pipe(data=data)
        self._figure.object = hv.DynamicMap(
            lambda data: overlay(data), streams=[self._pipe]
        )


def in_units(chart: Chart) -> Chart:
    """A chart in units for readers; charts of the engine are in SI."""
    if isinstance(chart, Map):
        return _map_in_units(chart)
    return _panel_in_units(chart)


def _map_in_units(chart: Map) -> Map:
    x_axis, x = _in_unit(chart.x, chart.x_values)
    y_axis, y = _in_unit(chart.y, chart.y_values)
    scale, size = _in_unit(chart.scale, chart.z.ravel())
    return replace(
        chart,
        x=x_axis,
        y=y_axis,
        runs=_divided(chart.runs, x, y),
        x_values=chart.x_values / x,
        y_values=chart.y_values / y,
        scale=scale,
        z=chart.z / size,
    )


def _panel_in_units(chart: Panel) -> Panel:
    drawn: list[PanelCurve | Runs] = [*chart.curves]
    if chart.runs is not None:
        drawn.append(chart.runs)
    xs = [each.x for each in drawn]
    ys = [each.y for each in drawn]
    x_axis, x = _in_unit(chart.x, *xs)
    y_axis, y = _in_unit(chart.y, *ys)
    curves = [replace(curve, x=curve.x / x, y=curve.y / y) for curve in chart.curves]
    runs = _divided(chart.runs, x, y)
    return replace(chart, x=x_axis, y=y_axis, runs=runs, curves=tuple(curves))


def _divided(runs: Runs | None, x: float, y: float) -> Runs | None:
    """Runs, if there are any, over the sizes of two units."""
    if runs is None:
        return None
    return replace(runs, x=runs.x / x, y=runs.y / y)


def _in_unit(axis: PanelAxis, *values: Array) -> tuple[PanelAxis, float]:
    """An axis in a unit for values in SI, (n,) each, and the size of the unit."""
    sizes = np.abs(np.concatenate([[0.0], *values]))
    if len(sizes) == 1 and axis.limits is not None:
        # Before the first run it has the unit that it keeps.
        sizes = np.abs(axis.limits)
    unit = unit_for(float(sizes[np.isfinite(sizes)].max()), axis.unit)
    limits = None
    if axis.limits is not None:
        low, high = axis.limits
        limits = (low / unit.factor, high / unit.factor)
    return replace(axis, unit=unit.name, limits=limits), unit.factor


def overlay(chart: Chart) -> hv.Overlay:
    """A chart as elements of HoloViews."""
    title = chart.title
    x_limits: Sequence[float | None]
    y_limits: Sequence[float | None]
    if isinstance(chart, Map):
        elements = _of_map(chart)
        xs = chart.x_values
        ys = chart.y_values
        if chart.scale.unit:
            title += f" ({chart.scale.unit})"
        x_limits = cell_edges(xs, chart.x)[[0, -1]]
        y_limits = cell_edges(ys, chart.y)[[0, -1]]
    else:
        elements = _of_panel(chart)
        # An empty array is joined, too, as there may be no curves.
        none = [np.empty(0)]
        xs = np.concatenate(none + [curve.x for curve in chart.curves])
        ys = np.concatenate(none + [curve.y for curve in chart.curves])
        x_limits = chart.x.limits or (None, None)
        y_limits = chart.y.limits or (None, None)
    ticks = {"x": _ticks(chart.x, xs), "y": _ticks(chart.y, ys)}
    formatters = {
        f"{name}axis.formatter": _formatter(axis, ticks[name])
        for name, axis in (("x", chart.x), ("y", chart.y))
    }
    # Whether axes follow a chart that fills is asked of elements, not of their overlay.
    return hv.Overlay([element.opts(framewise=True) for element in elements]).opts(
        # HoloViews takes braces for places that it fills.
        title=title.replace("{", "{{").replace("}", "}}"),
        logx=chart.x.logarithmic,
        logy=chart.y.logarithmic,
        xlim=tuple(x_limits),
        ylim=tuple(y_limits),
        xlabel=textwrap.fill(chart.x.label, 2 * LABEL),
        ylabel=textwrap.fill(chart.y.label, LABEL),
        xticks=ticks["x"],
        yticks=ticks["y"],
        # Of a chart that fills the theme would enlarge them.
        fontsize=SIZES,
        padding=(0.03, 0.1),
        responsive=True,
        height=HEIGHT,
        show_legend=False,
        show_grid=isinstance(chart, Panel),
        default_tools=TOOLS,
        # A wheel that scrolls the page must not zoom the charts that it passes.
        active_tools=[],
        # A toolbar that sticks to the axes would lie over a title of their width.
        backend_opts={
            "plot.toolbar.logo": None,
            "plot.toolbar.stylesheets": [UNPRINTED],
            "plot.toolbar_sticky": False,
            "xaxis.major_label_policy": NoOverlap(),
            **formatters,
        },
    )


def cell_edges(values: Array, axis: PanelAxis) -> Array:
    """Edges of cells around n ascending values, halfway between, shape (n + 1,).

    On a logarithmic axis a cell ends half way between logarithms.
    """
    if axis.logarithmic:
        return np.exp(edges(np.log(values)))
    return edges(values)


def _ticks(axis: PanelAxis, values: Iterable[float]) -> list[Any] | Ticker:
    """Ticks of an axis: names, few whole numbers, or those of a short logarithmic axis.

    Else what finds round numbers. It is never left out: a chart that fills would keep
    the ticks that it began with.
    """
    if axis.names:
        return list(enumerate(axis.names))
    if axis.logarithmic:
        return _logarithmic_ticks(axis, values)
    if not axis.whole:
        return BasicTicker()
    numbers = sorted({int(value) for value in values})
    if 0 < len(numbers) <= 7:
        return numbers
    return BasicTicker()


def _logarithmic_ticks(axis: PanelAxis, values: Iterable[float]) -> Ticker:
    """Ticks at 1, 2, 5, 10, ... of a logarithmic axis.

    Bokeh's own are few, or lie on one another. They are right for more than two
    decades; between two of these ticks those of a linear axis are.
    """
    known = np.array([value for value in values if value > 0.0])
    # Of a chart that fills the curves do not go as far as its axis yet.
    low, high = axis.limits or (known.min(initial=np.inf), known.max(initial=0.0))
    if not 0.0 < low <= high <= LONGEST * low:
        return LogTicker(num_minor_ticks=10)
    first = math.floor(math.log10(low))
    powers = 10.0 ** np.arange(first, first + 4)
    ticks = np.outer(powers, [1.0, 2.0, 5.0]).ravel()
    inside = ticks[(ticks > 0.999 * low) & (ticks < 1.001 * high)]
    if len(inside) < 2:
        return BasicTicker()
    return FixedTicker(ticks=inside.tolist())


def _formatter(axis: PanelAxis, ticks: list[Any] | Ticker) -> TickFormatter:
    """Formatter of the numbers at the ticks of an axis: plain, or powers of ten.

    A text for each tick would stay in the browser as the ticks of a chart change.
    """
    if axis.logarithmic and isinstance(ticks, LogTicker):
        return LogTickFormatter()
    return BasicTickFormatter()


def _table(runs: Runs) -> pd.DataFrame:
    """Runs as a table for HoloViews: x, y, and the words of each."""
    return pd.DataFrame(
        {"x": runs.x, "y": runs.y, "said": np.array(runs.said, dtype=object)}
    )


def _of_panel(panel: Panel) -> Iterator[hv.Element]:
    for curve in panel.curves:
        yield from _of_curve(panel, curve)
    if panel.runs is None:
        return
    runs = _table(panel.runs)
    known = np.isfinite(panel.runs.y)
    low, high = panel.y.limits or (0.0, 1.0)
    # Runs without a value stand at the upper edge.
    if panel.y.logarithmic:
        top = high * (low / high) ** 0.03
    else:
        top = high - 0.03 * (high - low)
    looks = {
        "color": np.array(COLORS)[panel.runs.hues],
        "fill_alpha": panel.runs.holds * 1.0,
        "marker": np.where(known, "circle", "x"),
    }
    table = runs.assign(y=runs["y"].where(known, top), **looks)
    by_column = {name: name for name in looks}
    dots = hv.Points(table, ["x", "y"], ["said", *looks])
    look = {"size": 7, "hit_dilation": 2.0, "line_width": 1.6, "hooks": [_unhovered]}
    yield dots.opts(**HOVER, **by_column, **look)


def _unhovered(plot: Any, _element: hv.Element) -> None:
    """Have points look as ever while one points at one of them.

    With another look for that one Bokeh would give the others the markers of their
    neighbours.
    """
    plot.handles["glyph_renderer"].hover_glyph = None


def _of_curve(panel: Panel, curve: PanelCurve) -> Iterator[hv.Element]:
    y = curve.y
    if panel.y.logarithmic:
        y = np.where(curve.y > 0.0, curve.y, np.nan)
    has_points = curve.line == "points"
    looks: dict[str, Any] = {"color": COLORS[curve.hue]}
    if has_points:
        looks |= {"line_dash": "solid", "line_width": 1.0}
    else:
        looks |= {"line_dash": curve.line, "line_width": 2.2}
    if panel.runs is None:
        tips = [("", curve.label), (panel.x.label, "@x"), (panel.y.label, "@y")]
        looks |= {"tools": ["hover"], "hover_tooltips": tips}
    yield hv.Curve((curve.x, y), "x", "y").opts(**looks)
    if has_points:
        yield hv.Points((curve.x, y), ["x", "y"]).opts(color=COLORS[curve.hue], size=6)


def _of_map(chart: Map) -> Iterator[hv.Element]:
    """Coloured cells, contour lines with labels, and cells with words on runs."""
    rows, columns = np.nonzero(np.isfinite(chart.z))
    known = pd.DataFrame(
        {
            "x": chart.x_values[columns],
            "y": chart.y_values[rows],
            "value": chart.z[rows, columns],
        }
    )
    yield _cells(chart, known).opts(
        color="value",
        cmap=Viridis256,
        logz=chart.scale.logarithmic,
        line_alpha=0.0,
        colorbar=True,
        clabel=" ",
    )
    lines = contours(chart)
    yield hv.Contours(lines, ["x", "y"], "z").opts(
        color="#000", alpha=0.75, line_width=1.2
    )
    labels = []
    for place, line in enumerate(lines):
        # At one of three positions along the line: lines may be close.
        index = len(line["x"]) * (1 + place % 3) // 4
        labels.append((line["x"][index], line["y"][index], f"{line['z']:.4g}"))
    yield hv.Labels(labels, ["x", "y"], "text").opts(
        text_color="#000",
        text_font_size="11px",
        background_fill_color="#fff",
        background_fill_alpha=0.7,
    )
    # Over each run's cell, for its words; hatched where the run gave no answer.
    pattern = np.where(chart.runs.holds, " ", "right_diagonal_line")
    hatched = _table(chart.runs).assign(hatch=pattern)
    hatch = {
        "glyph.hatch_pattern": {"field": "hatch"},
        "glyph.hatch_color": {"value": REFERENCE},
    }
    hollow = {"fill_alpha": 0.0, "line_alpha": 0.0, "backend_opts": hatch}
    yield _cells(chart, hatched).opts(**hollow, **HOVER)


def _cells(chart: Map, table: pd.DataFrame) -> hv.Rectangles:
    """Cells of a map about the rows of a table with columns x and y."""
    columns = np.searchsorted(chart.x_values, table["x"])
    rows = np.searchsorted(chart.y_values, table["y"])
    x = cell_edges(chart.x_values, chart.x)
    y = cell_edges(chart.y_values, chart.y)
    sides = {
        "left": x[columns],
        "bottom": y[rows],
        "right": x[columns + 1],
        "top": y[rows + 1],
    }
    return hv.Rectangles(table.assign(**sides), list(sides), list(table))


def contours(chart: Map) -> list[dict[str, Any]]:
    """Contour lines of a map at round values, each with "x" and "y", (n,), and "z"."""
    known = chart.z[np.isfinite(chart.z)]
    low = known.min(initial=np.inf)
    high = known.max(initial=-np.inf)
    if min(chart.z.shape) == 1 or high <= low:
        return []
    levels: Any = LEVELS
    if chart.scale.logarithmic:
        steps = [1.0]
        if high < 1e4 * low:
            steps = [1.0, 2.0, 5.0]
        first, last = np.floor(np.log10([low, 10.0 * high]))
        powers = np.arange(first, last)
        levels = np.outer(10.0**powers, steps).ravel()
    values = hv.QuadMesh((chart.x_values, chart.y_values, chart.z))
    lines = hv.operation.contours(values, levels=levels).data
    # Where many runs have the lowest value, as 0, its line would be anywhere.
    rounding = 1e-6 * (high - low)
    return [line for line in lines if low + rounding < line["z"] < high - rounding]
