"""A figure of the paper, drawn again, with the claim that it tests and the numbers that decide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import chain
from pathlib import Path

from solver.study.chart import Panel
from solver.study.page import PlotSection, Section, bullets, write_page

LOAD = (
    "The paper's load path (Fig. 2b) is lost; taken here: one period of a sine of 900 N, "
    "relaxation 0.8, all else as in Table 1."
)
INTRODUCTION = """<p>Computed by Slipfront. The paper prints curves without numbers; each figure
here stands with what the paper says of it, and with the numbers that bear it out or do not.</p>"""
SAYS = {True: "Bears it out.", False: "Speaks against it."}
FILE = "figures.html"


@dataclass(frozen=True)
class Finding:
    """A measured answer to a claim, or to a part of it.

    Attributes
    ----------
    text
        One sentence with the numbers in it.
    holds
        Whether they bear out the claim.
    """

    text: str
    holds: bool


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
    def verdict(self) -> str:
        """Whether the claim holds: "holds", "holds in part" or "does not hold"."""
        held = [finding.holds for finding in self.findings]
        return "holds" if all(held) else "holds in part" if any(held) else "does not hold"


def write_figures(figures: Sequence[PaperFigure], folder: Path) -> str:
    """Write `FILE` into a folder.

    Returns
    -------
    What whoever asked for it is to be told, if anything.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    report = [INTRODUCTION, *chain.from_iterable(map(_sections, figures))]
    return write_page(folder / FILE, "The paper's figures, drawn again", report)


def _sections(figure: PaperFigure) -> list[Section]:
    """A figure on the page."""
    findings = bullets([f"{finding.text} {SAYS[finding.holds]}" for finding in figure.findings])
    return [
        f"<h2>{escape(figure.heading)}</h2>",
        PlotSection(figure.heading, figure.panels),
        f"<p><b>The paper's claim:</b> {escape(figure.claim)} <b>Here it {figure.verdict}.</b></p>"
        f'\n{findings}\n<p class="caption">{escape(figure.caption)}</p>',
    ]
