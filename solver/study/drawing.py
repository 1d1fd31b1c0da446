"""Plots as PNG files, and inside of one HTML page that needs nothing beside it.

The only module that needs matplotlib; import it when something is to be drawn.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from html import escape
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, NullLocator
from matplotlib.tri import Triangulation
from PIL import Image

from solver.arrays import Array
from solver.disk import write
from solver.study.figure_data import HUES, Line, Panel, PaperFigure
from solver.study.figure_page import TITLE, WORDS, figure_sections
from solver.study.page import PlotSection, Section, page
from solver.study.sweep.chart import Map

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
ROWS, ROW = 3, 0.2
"""Rows of a legend that the height leaves room for, and what each further one adds, inches."""
LEVELS = 7
"""Lines of equal value on a map."""
CONTOURS: dict[str, Any] = {"colors": "w", "linewidths": 0.8}


def write_figures(figures: Sequence[PaperFigure], folder: Path) -> list[Path]:
    """Write `figure-N.png` for each figure, and `figures.html` with all of them.

    Parameters
    ----------
    figures
        What to draw.
    folder
        An existing folder; files of these names are replaced.

    Returns
    -------
    The files, in the order written.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    together = folder / "figures.html"
    report = [WORDS, *chain.from_iterable(map(figure_sections, figures))]
    files = [folder / f"figure-{figure.number}.png" for figure in figures]
    for file, image in zip(files, write_page(together, TITLE, report), strict=True):
        write(file, image)
    return [*files, together]


def write_page(file: Path, title: str, report: Sequence[Section]) -> list[bytes]:
    """Write a report with its plots inside it, and give these as PNG files.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    images = {plot: png(plot) for plot in report if isinstance(plot, PlotSection)}
    parts = [one if isinstance(one, str) else inline(images[one], one.heading) for one in report]
    write(file, page(title, parts))
    return list(images.values())


def png(plot: PlotSection) -> bytes:
    """Draw panels side by side under their heading, as a PNG."""
    panels = plot.panels
    width = WIDTH * max(len(panels), 1.5)
    sheet = Figure(layout="constrained")
    grid = sheet.subplots(1, len(panels), squeeze=False)
    entries: dict[str, Line2D] = {}
    for axes, panel in zip(grid[0], panels, strict=True):
        entries |= _draw(axes, panel)
    sheet.suptitle(plot.heading, fontsize=11)
    columns = max(1, min(len(entries), int(LETTERS * width / (max(map(len, entries)) + 8))))
    more = max(-(-len(entries) // columns) - ROWS, 0)
    sheet.set_size_inches(width, HEIGHT + ROW * more)
    sheet.legend(
        entries.values(),
        entries.keys(),
        loc="outside lower center",
        ncols=columns,
        fontsize=9,
        frameon=False,
        handlelength=2.6,
    )
    return _small(sheet)


def _small(sheet: Figure) -> bytes:
    """Give a figure as a PNG of few colours."""
    drawn, small = io.BytesIO(), io.BytesIO()
    sheet.savefig(drawn, format="png", dpi=RESOLUTION)
    image = Image.open(drawn).convert("RGB")
    image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE).save(small, format="png", optimize=True)
    return small.getvalue()


def chart_png(chart: Panel | Map) -> bytes:
    """Draw a chart of a sweep, as a PNG."""
    return png(PlotSection("", [chart])) if isinstance(chart, Panel) else map_png(chart)


def map_png(chart: Map) -> bytes:
    """Draw a map: a colour for every run, and lines of equal value between them, as a PNG."""
    sheet = Figure(figsize=(1.6 * WIDTH, 1.3 * HEIGHT), layout="constrained")
    axes = sheet.subplots()
    norm = LogNorm() if chart.scale.logarithmic else Normalize()
    if np.isfinite(chart.z).any():
        draw = _surface if chart.is_sampled else _cells
        sheet.colorbar(draw(axes, chart, norm), label=chart.scale.label)
    axes.set(xlabel=chart.x.label, xscale=chart.x.scale, ylabel=chart.y.label, yscale=chart.y.scale)
    axes.set_title(chart.title, fontsize=10)
    return _small(sheet)


def _cells(axes: Axes, chart: Map, norm: Normalize) -> ScalarMappable:
    """Draw a cell for every run."""
    x, y, z = chart.x_values, chart.y_values, np.ma.masked_invalid(chart.z)
    if min(z.shape) > 1 and z.min() < z.max():
        levels = _levels(chart, z.min(), z.max())
        axes.clabel(axes.contour(x, y, z, levels, **CONTOURS), fontsize=8, fmt="%.3g")
    return axes.pcolormesh(x, y, z, norm=norm, cmap="cividis", shading="nearest")


def _surface(axes: Axes, chart: Map, norm: Normalize) -> ScalarMappable:
    """Draw the facets between the runs, and a dot for each of these."""
    rows, columns = np.nonzero(np.isfinite(chart.z))
    x, y, z = chart.x_values[columns], chart.y_values[rows], chart.z[rows, columns]
    facets = Triangulation(columns / chart.z.shape[1], rows / chart.z.shape[0]).triangles
    net = Triangulation(x, y, facets)
    axes.plot(x, y, ".", color="w", markersize=3)
    if z.min() < z.max():
        lines = axes.tricontour(net, z, _levels(chart, z.min(), z.max()), **CONTOURS)
        axes.clabel(lines, fontsize=8, fmt="%.3g")
    return axes.tripcolor(net, z, norm=norm, cmap="cividis", shading="gouraud")


def _levels(chart: Map, low: float, high: float) -> Array:
    spread = np.geomspace if chart.scale.logarithmic else np.linspace
    return np.asarray(spread(low, high, LEVELS + 2)[1:-1])


def inline(image: bytes, words: str) -> str:
    """Write a PNG into a page, with words for those who cannot see it."""
    data = base64.b64encode(image).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" alt="{escape(words)}">'


def _draw(axes: Axes, panel: Panel) -> dict[str, Line2D]:
    """Draw a panel; give its lines by label."""
    lines = {}
    for curve in panel.curves:
        style = {"linewidth": 1.6, **LINES[curve.line], "color": COLORS[curve.hue]}
        (lines[curve.label],) = axes.plot(curve.x, curve.y, **style)
    axes.set(xlabel=panel.x.label, xscale=panel.x.scale, ylabel=panel.y.label, yscale=panel.y.scale)
    axes.set_title(panel.title, fontsize=10)
    if panel.x.whole and panel.x.logarithmic:
        ticks = sorted({int(x) for curve in panel.curves for x in curve.x})
        axes.set_xticks(ticks, [str(tick) for tick in ticks])
        axes.xaxis.set_minor_locator(NullLocator())
    elif panel.x.whole:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    if panel.y.limits is not None:
        axes.set_ylim(*panel.y.limits)
    axes.grid(color="#DDDDDD", linewidth=0.6)
    return lines
