"""The paper's figures as a page, and as PNG files where matplotlib is installed."""

from __future__ import annotations

import io
from collections.abc import Sequence
from html import escape
from itertools import chain
from pathlib import Path
from typing import Any

from solver.disk import write
from solver.study.chart import HUES, Line, Panel, PanelAxis
from solver.study.figures.convergence import figure_3, figure_4
from solver.study.figures.figure import PaperFigure
from solver.study.figures.modes import figure_5, figure_6, figure_7, figure_8
from solver.study.figures.paper_runs import PaperRuns
from solver.study.page import PlotSection, Section, write_page

TITLE = "The paper's figures, drawn again"
WORDS = """<p>Computed by Slipfront. The paper prints curves without numbers; each figure here
stands with what the paper says of it, and with the numbers that bear it out or do not.</p>"""
SAYS = {True: "Bears it out.", False: "Speaks against it."}
NO_IMAGES = "PNG files need matplotlib: pip install 'slipfront[figures]'"
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


def paper_figures(runs: PaperRuns | None = None) -> list[PaperFigure]:
    """Make Figs. 3 to 8 from one set of runs, each done when it is first asked for."""
    runs = runs or PaperRuns()
    return [make(runs) for make in (figure_3, figure_4, figure_5, figure_6, figure_7, figure_8)]


def write_figures(figures: Sequence[PaperFigure], folder: Path) -> tuple[list[Path], list[str]]:
    """Write `figures.html` with all figures, and `figure-N.png` for each if matplotlib is there.

    Parameters
    ----------
    figures
        What to draw.
    folder
        An existing folder; files of these names are replaced.

    Returns
    -------
    The files, and what whoever asked for them is to be told.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    together = folder / "figures.html"
    report = [WORDS, *chain.from_iterable(map(figure_sections, figures))]
    messages = [message for message in [write_page(together, TITLE, report)] if message]
    files = []
    try:
        for figure in figures:
            image = png(figure)
            files.append(folder / f"figure-{figure.number}.png")
            write(files[-1], image)
    except ModuleNotFoundError as missing:
        if (missing.name or "").split(".")[0] not in ("matplotlib", "PIL"):
            raise
        messages.append(NO_IMAGES)
    return [*files, together], messages


def figure_sections(figure: PaperFigure) -> list[Section]:
    """One figure on the page."""
    findings = "\n".join(
        f"<li>{escape(found.text)} <b>{SAYS[found.holds]}</b></li>" for found in figure.findings
    )
    return [
        f"<h2>{escape(figure.heading)}</h2>",
        PlotSection(figure.heading, figure.panels),
        f"<p><b>The paper's claim:</b> {escape(figure.claim)} <b>Here it {figure.verdict}.</b></p>"
        f'\n<ul>\n{findings}\n</ul>\n<p class="caption">{escape(figure.caption)}</p>',
    ]


def png(figure: PaperFigure) -> bytes:
    """Draw the panels of a figure side by side under its heading."""
    from matplotlib.figure import Figure  # an extra
    from PIL import Image

    width = WIDTH * max(len(figure.panels), 1.5)
    sheet = Figure((width, HEIGHT), layout="constrained")
    grid = sheet.subplots(1, len(figure.panels), squeeze=False)
    entries: dict[str, Any] = {}
    for axes, panel in zip(grid[0], figure.panels, strict=True):
        entries |= _draw(axes, panel)
    sheet.suptitle(figure.heading, fontsize=11)
    columns = max(1, min(len(entries), int(LETTERS * width / (max(map(len, entries)) + 8))))
    look: dict[str, Any] = {"fontsize": 9, "frameon": False, "handlelength": 2.6}
    keys = entries.values(), entries.keys()
    sheet.legend(*keys, loc="outside lower center", ncols=columns, **look)
    drawn, small = io.BytesIO(), io.BytesIO()
    sheet.savefig(drawn, format="png", dpi=RESOLUTION)
    image = Image.open(drawn).convert("RGB")
    image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE).save(small, format="png", optimize=True)
    return small.getvalue()


def _draw(axes: Any, panel: Panel) -> dict[str, Any]:
    """Draw a panel; its lines by label."""
    from matplotlib.ticker import MaxNLocator

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
