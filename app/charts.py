"""Charts that are made once, as HoloViews draws them: What if, reports, pages of the commands."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from html import escape
from typing import Any

import holoviews as hv
import numpy as np
import pandas as pd
import panel as pn
from bokeh.embed import components
from bokeh.palettes import Viridis256
from bokeh.resources import Resources

from app.units import unit_for
from app.views.colors import REFERENCE
from solver.arrays import Array
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
"""Of curves by their hue."""
LEVELS = 8
"""Lines of equal value on a map, about."""
HEIGHT = 350
LABEL = 34
"""Characters of a line beside an axis."""
TOOLS = ["box_zoom", "pan", "wheel_zoom", "reset", "save"]
HOVER: dict[str, Any] = {"tools": ["hover"], "hover_tooltips": "@said"}
STYLE = """<style>
.panels { display: grid; gap: 0 1rem; grid-template-columns:
  repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); }
.key { margin-right: 1rem; white-space: nowrap; }
</style>"""


def render(plots: Sequence[PlotSection]) -> tuple[str, Sequence[str]]:
    """Charts of a page that needs nothing beside it, the entry point of `solver.study.page`.

    Returns
    -------
    What all of them need, and each section (HTML).
    """
    draw = hv.renderer("bokeh").get_plot
    figures = [
        draw(overlay(in_units(chart))).state for plot in plots for chart in plot.charts
    ]
    script, places = components(figures, wrap_script=True)
    waiting = iter(places)
    sections = [
        f'<div role="figure" aria-label="{escape(plot.heading)}">{keys(plot.charts)}'
        f'<div class="panels">{"".join(next(waiting) for _ in plot.charts)}</div></div>'
        for plot in plots
    ]
    return f"{STYLE}\n{library()}\n{script}", sections


def library(*more: str) -> str:
    """Bokeh itself and more of its parts, for a page that loads nothing (HTML)."""
    # Not `Resources.render`, which brings what Panel would have a page load.
    texts = Resources(mode="inline", components=["bokeh", *more]).js_raw
    return "\n".join(f"<script>{text}</script>" for text in texts)


def keys(charts: Sequence[Chart]) -> str:
    """The legend that charts side by side share (HTML)."""
    panels = [chart for chart in charts if isinstance(chart, Panel)]
    curves = {
        curve.label: curve for panel in panels for curve in panel.curves if curve.label
    }
    if curves:
        return "<div>" + " ".join(map(_key, curves.values())) + "</div>"
    return ""


def _key(curve: PanelCurve) -> str:
    dash = curve.line if curve.line in ("dashed", "dotted") else "solid"
    style = f"border-top: 3px {dash} {COLORS[curve.hue]}"
    mark = f'<i style="display: inline-block; width: 1.2rem; vertical-align: middle; {style}"></i>'
    return f'<span class="key">{mark} {escape(curve.label)}</span>'


class LiveChart:
    """A chart that is drawn anew as it fills; `view` has it below its legend."""

    def __init__(self) -> None:
        self._keys = pn.pane.HTML("", margin=(4, 8))
        self._figure = pn.pane.HoloViews(
            None, sizing_mode="stretch_width", margin=(0, 6)
        )
        self.view = pn.Column(self._keys, self._figure, sizing_mode="stretch_width")
        self._drawn: list[Any] = []

    def show(self, chart: Chart) -> None:
        """Show a chart, in the figure of the last one if it has the same axes and curves."""
        axes = chart.x, chart.y, chart.scale if isinstance(chart, Map) else chart.y
        legend = keys([chart])
        data = in_units(chart)
        drawn = [
            legend,
            *((axis.quantity, axis.names, axis.logarithmic) for axis in axes),
        ]
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
    """A chart in the units that one reads; the engine gives it in SI."""
    runs = chart.runs
    if isinstance(chart, Map):
        x_axis, x = _in_unit(chart.x, chart.x_values)
        y_axis, y = _in_unit(chart.y, chart.y_values)
        scale, size = _in_unit(chart.scale, chart.z.ravel())
        more = {"x_values": chart.x_values / x, "y_values": chart.y_values / y}
        more |= {"scale": scale, "z": chart.z / size}
    else:
        drawn = [*chart.curves, *([] if runs is None else [runs])]
        x_axis, x = _in_unit(chart.x, *(each.x for each in drawn))
        y_axis, y = _in_unit(chart.y, *(each.y for each in drawn))
        curves = [
            replace(curve, x=curve.x / x, y=curve.y / y) for curve in chart.curves
        ]
        more = {"curves": tuple(curves)}
    if runs is not None:
        runs = replace(runs, x=runs.x / x, y=runs.y / y)
    return replace(chart, x=x_axis, y=y_axis, runs=runs, **more)


def _in_unit(axis: PanelAxis, *values: Array) -> tuple[PanelAxis, float]:
    """An axis in the unit in which such values are read, and the size of that unit."""
    sizes = np.abs(np.concatenate([[0.0], *values]))
    unit = unit_for(float(sizes[np.isfinite(sizes)].max()), axis.unit)
    limits = axis.limits and (
        axis.limits[0] / unit.factor,
        axis.limits[1] / unit.factor,
    )
    return replace(axis, unit=unit.name, limits=limits), unit.factor


def overlay(chart: Chart) -> hv.Overlay:
    """A chart as HoloViews' elements."""
    title = chart.title
    if isinstance(chart, Map):
        made = _of_map(chart)
        xs = chart.x_values
        ys = chart.y_values
        if chart.scale.unit:
            title += f" ({chart.scale.unit})"
        else:
            title += ""
        x_limits = edges(xs, chart.x)[[0, -1]]
        y_limits = edges(ys, chart.y)[[0, -1]]
    else:
        made = _of_panel(chart)
        xs, ys = (
            np.concatenate([getattr(c, n) for c in chart.curves] or [[]]) for n in "xy"
        )
        x_limits, y_limits = (
            axis.limits or (None, None) for axis in (chart.x, chart.y)
        )
    # Whether axes follow a chart that fills is asked of elements, not of their overlay.
    return hv.Overlay([element.opts(framewise=True) for element in made]).opts(
        # HoloViews takes braces for places that it fills.
        title=title.replace("{", "{{").replace("}", "}}"),
        logx=chart.x.logarithmic,
        logy=chart.y.logarithmic,
        xlim=tuple(x_limits),
        ylim=tuple(y_limits),
        xlabel=textwrap.fill(chart.x.label, 2 * LABEL),
        ylabel=textwrap.fill(chart.y.label, LABEL),
        xticks=_ticks(chart.x, xs),
        yticks=_ticks(chart.y, ys),
        padding=(0.03, 0.1),
        responsive=True,
        height=HEIGHT,
        show_legend=False,
        show_grid=isinstance(chart, Panel),
        default_tools=TOOLS,
        # What scrolls the page must not move what it passes over, until one asks for
        # it.
        active_tools=[],
        # A toolbar that sticks to the axes lies over a title that is as wide as they
        # are.
        backend_opts={"plot.toolbar.logo": None, "plot.toolbar_sticky": False},
    )


def edges(values: Array, axis: PanelAxis) -> Array:
    """Where cells about n ascending values end, half way between them on their axis, (n + 1,)."""
    if axis.logarithmic:
        at = np.log(values)
    else:
        at = values
    if len(at) > 1:
        half = np.diff(at) / 2.0
    else:
        half = np.array([0.5])
    ends = np.concatenate([at[:1] - half[:1], at[:-1] + half, at[-1:] + half[-1:]])
    if axis.logarithmic:
        return np.exp(ends)
    return ends


def _ticks(axis: PanelAxis, values: Iterable[float]) -> list[Any] | None:
    """Names of an axis, or its few whole numbers; None for round numbers."""
    if axis.names:
        return list(enumerate(axis.names))
    if axis.whole:
        whole = sorted({int(value) for value in values})
    else:
        whole = []
    return whole if 0 < len(whole) <= 7 else None


def _table(runs: Runs) -> pd.DataFrame:
    """Runs as HoloViews takes them."""
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
    # What has no value stands at the upper edge.
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
    yield dots.opts(**HOVER, **by_column, size=7, hit_dilation=2.0, line_width=1.6)


def _of_curve(panel: Panel, curve: PanelCurve) -> Iterator[hv.Element]:
    if panel.y.logarithmic:
        y = np.where(curve.y > 0.0, curve.y, np.nan)
    else:
        y = curve.y
    is_thin = curve.line == "points"
    looks: dict[str, Any] = {
        "color": COLORS[curve.hue],
        "line_dash": "solid" if is_thin else curve.line,
        "line_width": 1.0 if is_thin else 2.2,
    }
    if panel.runs is None:
        told = [("", curve.label), (panel.x.label, "@x"), (panel.y.label, "@y")]
        looks |= {"tools": ["hover"], "hover_tooltips": told}
    yield hv.Curve((curve.x, y), "x", "y").opts(**looks)
    if is_thin:
        yield hv.Points((curve.x, y), ["x", "y"]).opts(color=COLORS[curve.hue], size=6)


def _of_map(chart: Map) -> Iterator[hv.Element]:
    runs = _table(chart.runs)
    holds = chart.runs.holds
    rows, columns = np.nonzero(np.isfinite(chart.z))
    places = {"x": chart.x_values[columns], "y": chart.y_values[rows]}
    known = pd.DataFrame({**places, "value": chart.z[rows, columns]})
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
    # Not all in the same place, where lines are close.
    places = [
        len(line["x"]) * (1 + number % 3) // 4 for number, line in enumerate(lines)
    ]
    labels = [
        (line["x"][i], line["y"][i], f"{line['z']:.4g}")
        for line, i in zip(lines, places, strict=True)
    ]
    yield hv.Labels(labels, ["x", "y"], "text").opts(
        text_color="#000",
        text_font_size="11px",
        background_fill_color="#fff",
        background_fill_alpha=0.7,
    )
    # Over each run's cell, for its words; hatched where it is no answer.
    hatched = runs.assign(hatch=np.where(holds, " ", "right_diagonal_line"))
    hatch = {"glyph.hatch_pattern": {"field": "hatch"}}
    hatch |= {"glyph.hatch_color": {"value": REFERENCE}}
    hollow = {"fill_alpha": 0.0, "line_alpha": 0.0, "backend_opts": hatch}
    yield _cells(chart, hatched).opts(**hollow, **HOVER)


def _cells(chart: Map, table: pd.DataFrame) -> hv.Rectangles:
    """Cells about runs."""
    columns = np.searchsorted(chart.x_values, table["x"])
    rows = np.searchsorted(chart.y_values, table["y"])
    x = edges(chart.x_values, chart.x)
    y = edges(chart.y_values, chart.y)
    sides = {
        "left": x[columns],
        "bottom": y[rows],
        "right": x[columns + 1],
        "top": y[rows + 1],
    }
    return hv.Rectangles(table.assign(**sides), list(sides), list(table))


def contours(chart: Map) -> list[dict[str, Any]]:
    """Lines of equal and round values "z" through the places "x" and "y"."""
    known = chart.z[np.isfinite(chart.z)]
    if min(chart.z.shape) == 1 or known.max(initial=-np.inf) <= known.min(
        initial=np.inf
    ):
        return []
    levels: Any = LEVELS
    if chart.scale.logarithmic:
        if known.max() < 1e4 * known.min():
            steps = [1.0, 2.0, 5.0]
        else:
            steps = [1.0]
        powers = np.arange(*np.floor(np.log10([known.min(), 10.0 * known.max()])))
        levels = np.outer(10.0**powers, steps).ravel()
    values = hv.QuadMesh((chart.x_values, chart.y_values, chart.z))
    return list(hv.operation.contours(values, levels=levels).data)
