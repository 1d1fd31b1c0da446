"""Panels of a report, which are plain data, as HoloViews draws them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import holoviews as hv
import numpy as np
import panel as pn

from app.views.drawing import GREY
from app.views.legend import Key
from solver.study.figure_data import HUES, Curve, Panel

COLORS = (GREY, *HUES)
DASHES = {"solid": "solid", "dashed": "dashed", "dotted": "dotted", "points": "solid"}
MARKS = {"solid": "line", "dashed": "dashed", "dotted": "dotted", "points": "dot"}
MOST_LABELS = 7
BARE: dict[str, Any] = {"default_tools": [], "tools": []}
"""No tools: a wheel that scrolls the page must not zoom what it passes over."""

hv.extension("bokeh")
# Where there is no graphics card, canvas is faster, and its lines are clean.
hv.renderer("bokeh").webgl = False


def plot(panel: Panel, *, legend: bool = True) -> pn.pane.HoloViews:
    """Put a panel on the page."""
    return pn.pane.HoloViews(
        overlay(panel, legend=legend),
        margin=6,
        linked_axes=False,
        sizing_mode="stretch_width",
        styles={"flex": "1 1 340px"},
    )


def keys(panels: Sequence[Panel]) -> list[Key]:
    """Give one legend for panels whose curves have the same names."""
    found = {curve.label: curve for panel in panels for curve in panel.curves}
    return [Key(_color(curve), MARKS[curve.line], curve.label) for curve in found.values()]


def _color(curve: Curve) -> str:
    return COLORS[curve.hue]


def overlay(panel: Panel, *, legend: bool = True) -> hv.Overlay:
    """Draw one pair of axes, with a legend unless one stands elsewhere."""
    parts: list[Any] = []
    for curve in panel.curves:
        parts += _drawn(panel, curve)
    made = hv.Overlay(parts).opts(
        responsive=True,
        height=360,
        min_width=280,
        title=panel.title,
        logx=panel.x.logarithmic,
        logy=panel.y.logarithmic,
        xlim=panel.x.limits or (None, None),
        ylim=panel.y.limits or (None, None),
        xlabel=panel.x.label,
        ylabel=panel.y.label,
        show_legend=legend,
        legend_position="bottom",
        legend_cols=2,
        toolbar=None,
        **BARE,
        show_grid=True,
        fontsize={"title": 11, "labels": 10, "legend": 9, "xticks": 9, "yticks": 9},
    )
    if panel.x.whole and panel.x.logarithmic:
        made = made.opts(xticks=sorted({int(x) for curve in panel.curves for x in curve.x}))
    elif panel.x.whole:
        last = max(float(curve.x.max()) for curve in panel.curves)
        if last <= MOST_LABELS:
            made = made.opts(xticks=list(range(1, int(last) + 1)))
    return made


def _drawn(panel: Panel, curve: Curve) -> list[Any]:
    dimensions = {"kdims": [panel.x.quantity], "vdims": [panel.y.quantity]}
    color = _color(curve)
    values = np.where(curve.y > 0.0, curve.y, np.nan) if panel.y.logarithmic else curve.y
    line = hv.Curve((curve.x, values), label=curve.label, **dimensions).opts(
        color=color,
        line_dash=DASHES[curve.line],
        line_width=1.0 if curve.line == "points" else 2.2,
        **BARE,
    )
    if curve.line != "points":
        return [line]
    points = hv.Scatter((curve.x, values), label=curve.label, **dimensions)
    return [line, points.opts(color=color, size=6, **BARE)]
