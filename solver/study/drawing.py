"""Figures as PNG files, and as one HTML page that needs nothing beside it.

The only module that needs matplotlib; import it when something is to be drawn.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, NullLocator
from PIL import Image

from solver.study.figure_data import HUES, Line, Panel, PaperFigure

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
SAYS = {True: "Bears it out.", False: "Speaks against it."}
PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Slipfront: {title}</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem;
  color: #222; background: #fff; }}
figure {{ margin: 0 0 3.5rem; }}
img {{ max-width: 100%; height: auto; }}
li b {{ font-weight: 600; }}
.caption {{ opacity: 0.75; font-size: 0.9rem; }}
table {{ border-collapse: collapse; font-size: 0.9rem; }}
th, td {{ padding: 0.2rem 0.8rem 0.2rem 0; text-align: right; border-bottom: 1px solid #8884; }}
th:first-child, td:first-child {{ text-align: left; }}
</style>
{body}
</html>
"""
"""A page of the given title and body, which carries its own style."""
BODY = """<h1>The paper's figures, drawn again</h1>
<p>Computed by Slipfront. The paper prints curves without numbers; each figure here stands with
what the paper says of it, and with the numbers that bear it out or do not.</p>
{figures}"""
FIGURE = """<figure id="figure-{number}">
<h2>Fig. {number}: {title}</h2>
{image}
<figcaption>
<p><b>The paper's claim:</b> {claim} <b>Here it {verdict}.</b></p>
<ul>
{findings}
</ul>
<p class="caption">{caption}</p>
</figcaption>
</figure>
"""


Drawn = tuple[PaperFigure, bytes]
"""A figure, and its PNG."""


def drawn(figure: PaperFigure) -> Drawn:
    """Draw a figure."""
    return figure, png(figure.panels, f"Fig. {figure.number}: {figure.title}")


def write_figures(figures: Sequence[Drawn], folder: Path) -> list[Path]:
    """Write `figure-N.png` for each figure, and `figures.html` with all of them.

    Parameters
    ----------
    figures
        What is drawn.
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
    files = [folder / f"figure-{figure.number}.png" for figure, _ in figures]
    for file, (_, image) in zip(files, figures, strict=True):
        file.write_bytes(image)
    together = folder / "figures.html"
    together.write_text(html(figures), encoding="utf-8")
    return [*files, together]


def png(panels: Sequence[Panel], heading: str) -> bytes:
    """Draw panels side by side under a heading, as a PNG."""
    width = WIDTH * max(len(panels), 1.5)
    sheet = Figure(layout="constrained")
    grid = sheet.subplots(1, len(panels), squeeze=False)
    entries: dict[str, Line2D] = {}
    for axes, panel in zip(grid[0], panels, strict=True):
        entries |= _draw(axes, panel)
    sheet.suptitle(heading, fontsize=11)
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
    drawn, small = io.BytesIO(), io.BytesIO()
    sheet.savefig(drawn, format="png", dpi=RESOLUTION)
    image = Image.open(drawn).convert("RGB")
    image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE).save(small, format="png", optimize=True)
    return small.getvalue()


def html(figures: Sequence[Drawn]) -> str:
    """Write the page, with the images inside it."""
    parts = [
        FIGURE.format(
            number=figure.number,
            title=escape(figure.title),
            image=inline(image, figure.title),
            claim=escape(figure.claim),
            verdict=figure.verdict,
            findings="\n".join(
                f"<li>{escape(found.text)} <b>{SAYS[found.holds]}</b></li>"
                for found in figure.findings
            ),
            caption=escape(figure.caption),
        )
        for figure, image in figures
    ]
    return PAGE.format(title="the paper's figures", body=BODY.format(figures="\n".join(parts)))


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
