"""The paper's figures as a report: each with what the paper says of it, and what is found."""

from __future__ import annotations

from html import escape

from solver.study.figure_data import PaperFigure
from solver.study.page import PlotSection, Section

TITLE = "The paper's figures, drawn again"
WORDS = """<p>Computed by Slipfront. The paper prints curves without numbers; each figure here
stands with what the paper says of it, and with the numbers that bear it out or do not.</p>"""
SAYS = {True: "Bears it out.", False: "Speaks against it."}


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
