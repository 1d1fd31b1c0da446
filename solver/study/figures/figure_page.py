"""The paper's figures as a report: each with what the paper says of it, and what is found."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import chain
from pathlib import Path

from solver.disk import write
from solver.study.figures.figure_data import PaperFigure
from solver.study.page import PlotSection, Section, write_page

TITLE = "The paper's figures, drawn again"
WORDS = """<p>Computed by Slipfront. The paper prints curves without numbers; each figure here
stands with what the paper says of it, and with the numbers that bear it out or do not.</p>"""
SAYS = {True: "Bears it out.", False: "Speaks against it."}
NO_IMAGES = "PNG files need matplotlib: pip install 'slipfront[figures]'"


def figure_sections(figure: PaperFigure) -> list[Section]:
    """Write one figure."""
    heading = f"Fig. {figure.number}: {figure.title}"
    findings = "\n".join(
        f"<li>{escape(found.text)} <b>{SAYS[found.holds]}</b></li>" for found in figure.findings
    )
    return [
        f"<h2>{escape(heading)}</h2>",
        PlotSection(heading, figure.panels),
        f"<p><b>The paper's claim:</b> {escape(figure.claim)} <b>Here it {figure.verdict}.</b></p>"
        f'\n<ul>\n{findings}\n</ul>\n<p class="caption">{escape(figure.caption)}</p>',
    ]


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
    note = write_page(together, TITLE, report)
    try:
        from solver.study.figures.drawing import png
    except ModuleNotFoundError as missing:
        if (missing.name or "").split(".")[0] not in ("matplotlib", "PIL"):
            raise
        return [together], [*filter(None, [note]), NO_IMAGES]
    files = []
    for figure in figures:
        files.append(folder / f"figure-{figure.number}.png")
        write(files[-1], png(figure))
    return [*files, together], [*filter(None, [note])]
