"""A figure of the paper, drawn again, with the claim that it tests and the numbers that decide.

All of them make a page, and PNG files where matplotlib is installed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import chain
from pathlib import Path
from typing import Any

from solver.disk import whole_file
from solver.study.chart import HUES, Line, Panel, PanelAxis
from solver.study.page import PlotSection, Section, bullets, write_page

LOAD = (
    "The paper's load path (Fig. 2b) is lost; taken here: one period of a sine of 900 N, "
    "relaxation 0.8, all else as in Table 1."
)
INTRODUCTION = """<p>Computed by Slipfront. The paper prints curves without numbers; each figure
here stands with what the paper says of it, and with the numbers that bear it out or do not.</p>"""
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
WIDTH, HEIGHT, RESOLUTION = 4.2, 3.6, 110
"""Size of a panel, inches, and dots an inch."""


@dataclass(frozen=True)
class Finding:
    """A measured answer to a claim, or to a part of it.

    Attributes
    ----------
    text
        One sentence with the numbers in it.
    holds
        Whether they bear out the claim.
    values
        Numbers by name.
    """

    text: str
    holds: bool
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """A figure of the paper, drawn again.

    Attributes
    ----------
    number
        Its number in the paper.
    claim
        What the paper says that it shows, in one sentence.
    caption
        What is drawn, and the choices that the paper leaves.
    """

    number: int
    title: str
    panels: tuple[Panel, ...]
    claim: str
    findings: tuple[Finding, ...]
    caption: str

    @property
    def heading(self) -> str:
        """Number and title."""
        return f"Fig. {self.number}: {self.title}"

    @property
    def values(self) -> dict[str, float]:
        """All numbers of the findings, by name."""
        return dict(chain.from_iterable(finding.values.items() for finding in self.findings))

    @property
    def verdict(self) -> str:
        """Whether the claim holds: "holds", "holds in part" or "does not hold"."""
        held = [finding.holds for finding in self.findings]
        return "holds" if all(held) else "holds in part" if any(held) else "does not hold"


def write_figures(figures: Sequence[PaperFigure], folder: Path) -> tuple[list[Path], list[str]]:
    """Write `figures.html`, and `figure-N.png` for each if matplotlib is there.

    Returns
    -------
    The files, and what whoever asked for them is to be told.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    page = folder / "figures.html"
    report = [INTRODUCTION, *chain.from_iterable(map(_sections, figures))]
    note = write_page(page, "The paper's figures, drawn again", report)
    messages = [note] if note else []
    files = []
    try:
        for figure in figures:
            files.append(folder / f"figure-{figure.number}.png")
            _write_png(figure, files[-1])
    except ModuleNotFoundError as missing:
        if (missing.name or "").split(".")[0] != "matplotlib":
            raise
        files.clear()
        messages.append(NO_IMAGES)
    return [*files, page], messages


def _sections(figure: PaperFigure) -> list[Section]:
    """A figure on the page."""
    findings = bullets([f"{finding.text} {SAYS[finding.holds]}" for finding in figure.findings])
    return [
        f"<h2>{escape(figure.heading)}</h2>",
        PlotSection(figure.heading, figure.panels),
        f"<p><b>The paper's claim:</b> {escape(figure.claim)} <b>Here it {figure.verdict}.</b></p>"
        f'\n{findings}\n<p class="caption">{escape(figure.caption)}</p>',
    ]


def _write_png(figure: PaperFigure, file: Path) -> None:
    """Draw the panels of a figure side by side under its heading."""
    from matplotlib.figure import Figure  # an extra

    size = WIDTH * max(len(figure.panels), 1.5), HEIGHT
    sheet = Figure(size, layout="constrained")
    entries: dict[str, Any] = {}
    grid = sheet.subplots(1, len(figure.panels), squeeze=False)[0]
    for axes, panel in zip(grid, figure.panels, strict=True):
        for curve in panel.curves:
            style = {"linewidth": 1.6, **LINES[curve.line], "color": COLORS[curve.hue]}
            (entries[curve.label],) = axes.plot(curve.x, curve.y, **style)
        axes.set(xlabel=panel.x.label, xscale=_scale(panel.x), ylim=panel.y.limits)
        axes.set(ylabel=panel.y.label, yscale=_scale(panel.y))
        axes.set_title(panel.title, fontsize=10)
        axes.grid(color="#DDDDDD", linewidth=0.6)
    sheet.suptitle(figure.heading, fontsize=11)
    keys = entries.values(), entries.keys()
    columns = min(len(entries), 2 * len(figure.panels))
    sheet.legend(*keys, loc="outside lower center", ncols=columns, fontsize=9, frameon=False)
    with whole_file(file, "wb") as open_file:
        sheet.savefig(open_file, format="png", dpi=RESOLUTION, pil_kwargs={"optimize": True})


def _scale(axis: PanelAxis) -> str:
    return "log" if axis.logarithmic else "linear"
