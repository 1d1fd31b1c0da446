"""A figure of the paper, drawn again, with the claim that it tests and the numbers that decide."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from solver.study.page import Panel, PlotSection, Section, bullets, write_page

WORDS = tomllib.loads(Path(__file__).with_name("figures.toml").read_text(encoding="utf-8"))
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
    """A measured answer to a claim: a sentence with its numbers, and whether they bear it out."""

    text: str
    holds: bool


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """A figure of the paper, by its number there, drawn again, with what the paper says of it."""

    number: int
    title: str
    panels: Sequence[Panel]
    claim: str
    findings: Sequence[Finding]
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


def paper_figure(
    number: int, panels: Sequence[Panel], *findings: Finding, **numbers: float
) -> PaperFigure:
    """A figure with its words, in which numbers are named."""
    texts = {name: text.format(**numbers) for name, text in WORDS[str(number)].items()}
    caption = f"{texts.pop('caption')} {LOAD}"
    return PaperFigure(number, panels=panels, findings=findings, caption=caption, **texts)


def write_figures(figures: Sequence[PaperFigure], folder: Path) -> None:
    """Write `FILE` into a folder."""
    report: list[Section] = [INTRODUCTION]
    for figure in figures:
        findings = bullets([f"{finding.text} {SAYS[finding.holds]}" for finding in figure.findings])
        claim = f"<b>The paper's claim:</b> {escape(figure.claim)} <b>Here it {figure.verdict}.</b>"
        report += [
            f"<h2>{escape(figure.heading)}</h2>",
            PlotSection(figure.heading, figure.panels),
            f'<p>{claim}</p>\n{findings}\n<p class="caption">{escape(figure.caption)}</p>',
        ]
    write_page(folder / FILE, "The paper's figures, drawn again", report)
