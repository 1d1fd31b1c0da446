"""The paper's figures as PNG files.

The only module that needs matplotlib; import it when something is to be drawn.
"""

from __future__ import annotations

import io
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from PIL import Image

from solver.study.chart import HUES, Line, Panel, PanelAxis
from solver.study.figures.figure_data import PaperFigure

COLORS = ("#404040", *HUES)
"""Of lines by their hue; the first is neutral."""
LINES: dict[Line, dict[str, Any]] = {
    "solid": {"linestyle": "-"},
    "dashed": {"linestyle": (0, (5, 2))},
    "dotted": {"linestyle": (0, (1, 1.5))},
    "points": {"linestyle": "-", "linewidth": 0.8, "marker": "o", "markersize": 4},
}
WIDTH, HEIGHT, RESOLUTION = 4.2, 3.6, 130
"""Size of a panel, inches, and dots an inch."""
COLOURS = 128
"""Colours of a PNG; lines need few, and the file is a third as large."""
LETTERS = 13
"""Letters of a legend that an inch holds; the mark beside each entry takes eight."""


def png(figure: PaperFigure) -> bytes:
    """Draw the panels of a figure side by side under its heading."""
    width = WIDTH * max(len(figure.panels), 1.5)
    sheet = Figure((width, HEIGHT), layout="constrained")
    grid = sheet.subplots(1, len(figure.panels), squeeze=False)
    entries: dict[str, Line2D] = {}
    for axes, panel in zip(grid[0], figure.panels, strict=True):
        entries |= _draw(axes, panel)
    sheet.suptitle(f"Fig. {figure.number}: {figure.title}", fontsize=11)
    columns = max(1, min(len(entries), int(LETTERS * width / (max(map(len, entries)) + 8))))
    look: dict[str, Any] = {"fontsize": 9, "frameon": False, "handlelength": 2.6}
    keys = entries.values(), entries.keys()
    sheet.legend(*keys, loc="outside lower center", ncols=columns, **look)
    drawn, small = io.BytesIO(), io.BytesIO()
    sheet.savefig(drawn, format="png", dpi=RESOLUTION)
    image = Image.open(drawn).convert("RGB")
    image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE).save(small, format="png", optimize=True)
    return small.getvalue()


def _draw(axes: Axes, panel: Panel) -> dict[str, Line2D]:
    """Draw a panel; give its lines by label."""
    lines = {}
    for curve in panel.curves:
        style = {"linewidth": 1.6, **LINES[curve.line], "color": COLORS[curve.hue]}
        (lines[curve.label],) = axes.plot(curve.x, curve.y, **style)
    axes.set(xlabel=panel.x.label, xscale=_scale(panel.x))
    axes.set(ylabel=panel.y.label, yscale=_scale(panel.y))
    axes.set_title(panel.title, fontsize=10)
    if panel.x.whole:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    if panel.y.limits is not None:
        axes.set_ylim(*panel.y.limits)
    axes.grid(color="#DDDDDD", linewidth=0.6)
    return lines


def _scale(axis: PanelAxis) -> str:
    return "log" if axis.logarithmic else "linear"
