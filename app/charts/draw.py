"""Charts as HoloViews draws them on Bokeh; it is slow to import."""

from __future__ import annotations

from typing import Any, TypeGuard

import holoviews as hv
from bokeh.models import CustomJSTickFormatter
from bokeh.plotting import figure

from app.charts.layers import Here, Layer, layers, limits
from app.picture.units import TICKS
from solver.arrays import Array
from solver.study.chart import Chart, Map, Panel, PanelAxis

MOST_LABELS = 7
LONG, ACROSS = 34, 60
"""Letters up to which a label fits beside an axis, and below; of a longer one the unit does."""
TOOLS = ["box_zoom", "pan", "wheel_zoom", "reset", "save"]
SIDES = ["left", "bottom", "right", "top"]
PLACES: dict[str, list[str]] = {
    "Curve": ["x", "y"],
    "Points": ["x", "y"],
    "Labels": ["x", "y"],
    "Rectangles": SIDES,
}
"""Columns that say where a mark is."""

hv.extension("bokeh")
# Where there is no graphics card, canvas is faster, and its lines are clean.
hv.renderer("bokeh").webgl = False
# Plots are drawn on a thread. As in a notebook, each has a document of its own: otherwise it takes
# that of the page which the server is at work on, and changes it there and then.
hv.renderer("bokeh").notebook_context = True


def draw(
    chart: Chart,
    before: Chart | None = None,
    here: Here | None = None,
    *,
    height: int | None = 340,
) -> figure:
    """Draw a chart; it has no legend, which those side by side share.

    Parameters
    ----------
    chart, before, here
        As for `layers`.
    height
        Pixels; None for as much as there is room for.
    """
    made = hv.Overlay([_drawn(layer) for layer in layers(chart, before, here)])
    size = {"responsive": True, **({"height": height} if height else {})}
    drawn: figure = hv.renderer("bokeh").get_plot(made.opts(**size, **_axes(chart, before))).state
    return drawn


def _drawn(layer: Layer) -> Any:
    columns = layer.columns
    if layer.mark == "Contours":
        rows = zip(columns["xs"], columns["ys"], columns["hue"], strict=True)
        paths = [{"x": x, "y": y, "hue": hue} for x, y, hue in rows]
        made = hv.Contours(paths, ["x", "y"], "hue")
    else:
        places = PLACES[layer.mark]
        rest = [name for name in columns if name not in places]
        kinds = (places[:1], places[1:]) if layer.mark == "Curve" else (places, rest)
        made = getattr(hv, layer.mark)(columns, *kinds)
    return made.opts(
        **layer.looks,
        default_tools=TOOLS,
        hooks=[lambda plot, _: plot.handles["source"].update(name=layer.name)],
    )


def _axes(chart: Chart, before: Chart | None) -> dict[str, Any]:
    across, up = limits(chart, before)
    linear = {"x": not chart.x.logarithmic, "y": not chart.y.logarithmic}
    formatters = {
        f"{name}formatter": CustomJSTickFormatter(code=TICKS) for name, one in linear.items() if one
    }
    return {
        **formatters,
        "title": chart.title,
        "logx": chart.x.logarithmic,
        "logy": chart.y.logarithmic,
        "xlim": across,
        "ylim": up,
        "xlabel": _label(chart.x, ACROSS),
        "ylabel": _label(chart.y),
        "xticks": _ticks(chart),
        "yticks": _steps(chart.y_values) if _has_steps(chart) else None,
        "padding": (0.03, 0.1),
        "show_legend": False,
        "show_grid": isinstance(chart, Panel),
        "toolbar": "above",
        # What scrolls the page must not move what it passes over, until one asks for it.
        "active_tools": [],
        # A toolbar that sticks to the axes lies over a title that is as wide as they are.
        "backend_opts": {"plot.toolbar.logo": None, "plot.toolbar_sticky": False},
    }


def _label(axis: PanelAxis, most: int = LONG) -> str:
    return axis.label if len(axis.label) <= most else axis.unit


def _has_steps(chart: Chart) -> TypeGuard[Map]:
    """Tell whether a chart is a map of a few values, each of which has its tick."""
    return isinstance(chart, Map) and chart.level is not None


def _steps(values: Array) -> list[tuple[float, str]]:
    return [(float(value), f"{value:g}") for value in values]


def _ticks(chart: Chart) -> list[Any] | None:
    """Give the names of an axis, or its few whole numbers."""
    if chart.x.names:
        return list(enumerate(chart.x.names))
    if isinstance(chart, Map):
        return _steps(chart.x_values) if _has_steps(chart) else None
    if not chart.x.whole:
        return None
    whole = sorted({int(x) for curve in chart.curves for x in curve.x})
    return whole if 0 < len(whole) <= MOST_LABELS else None
