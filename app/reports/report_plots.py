"""Plots of a report, which are plain data, as HoloViews draws them; it is slow to import."""

from __future__ import annotations

from typing import Any

import holoviews as hv
import numpy as np
from bokeh.plotting import figure

from app.reports.colors import COLORS
from solver.study.figure_data import Panel, PanelCurve

MOST_LABELS = 7
TOOLS = ["box_zoom", "pan", "wheel_zoom", "reset", "save"]

hv.extension("bokeh")
# Where there is no graphics card, canvas is faster, and its lines are clean.
hv.renderer("bokeh").webgl = False
# Plots are drawn on a thread. As in a notebook, each has a document of its own: otherwise it takes
# that of the page which the server is at work on, and changes it there and then.
hv.renderer("bokeh").notebook_context = True


def plot(panel: Panel) -> figure:
    """Draw a panel; it has no legend, which panels side by side share."""
    drawn: figure = hv.renderer("bokeh").get_plot(overlay(panel)).state
    return drawn


def overlay(panel: Panel) -> hv.Overlay:
    """Draw one pair of axes."""
    whole = sorted({int(x) for curve in panel.curves for x in curve.x}) if panel.x.whole else []
    return hv.Overlay([part for curve in panel.curves for part in _drawn(panel, curve)]).opts(
        responsive=True,
        height=340,
        title=panel.title,
        logx=panel.x.logarithmic,
        logy=panel.y.logarithmic,
        xlim=panel.x.limits or (None, None),
        ylim=panel.y.limits or (None, None),
        xlabel=panel.x.label,
        ylabel=panel.y.label,
        xticks=whole if 0 < len(whole) <= MOST_LABELS else None,
        padding=(0.03, 0.1),
        show_legend=False,
        show_grid=True,
        toolbar="above",
        # What scrolls the page must not move what it passes over, until one asks for it.
        active_tools=[],
        # A toolbar that sticks to the axes lies over a title that is as wide as they are.
        backend_opts={"plot.toolbar.logo": None, "plot.toolbar_sticky": False},
    )


def _drawn(panel: Panel, curve: PanelCurve) -> list[Any]:
    x, y = panel.x.quantity, panel.y.quantity
    values = np.where(curve.y > 0.0, curve.y, np.nan) if panel.y.logarithmic else curve.y
    has_points = curve.line == "points"
    line = hv.Curve((curve.x, values), x, y, label=curve.label).opts(
        line_dash="solid" if has_points else curve.line,
        line_width=1.0 if has_points else 2.2,
        tools=["hover"],
        hover_tooltips=[
            ("", curve.label),
            (panel.x.label, f"@{{{x}}}"),
            (panel.y.label, f"@{{{y}}}"),
        ],
    )
    points = [hv.Scatter(line).opts(size=6)] if has_points else []
    return [part.opts(color=COLORS[curve.hue], default_tools=TOOLS) for part in (line, *points)]
