"""The paper's figures, drawn again: the runs behind them, and what is claimed, tested and shown."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from solver.latin import Iterate, Solution, solve
from solver.reduction.svd import Decomposition, decompositions
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.page import Panel, PlotSection, Section, bullets, write_page

WORDS = tomllib.loads(
    Path(__file__).with_name("paper_figures.toml").read_text(encoding="utf-8")
)
LOAD = (
    "The paper's load path (Fig. 2b) is lost; taken here: one period of a sine of 900 N, "
    "relaxation 0.8, all else as in Table 1."
)
INTRODUCTION = """<p>Computed by Slipfront. The paper prints curves without numbers; each figure
here stands with what the paper says of it, and with the numbers that bear it out or do not.</p>"""
SAYS = {True: "Bears it out.", False: "Speaks against it."}
FILE = "figures.html"
EARLY = 10
"""Iterations after which Fig. 4 looks at the friction force."""
LONG = 800
"""Iterations of Fig. 3: enough to see the rate of convergence at the end of every
error."""
CONVERGED = 1e-18
"""LATIN indicator at which the fields of Figs. 5 to 7 count as converged (error near
1e-6)."""
REDUCED = 100
"""Iterations of the PGD of Fig. 8."""


@dataclass(frozen=True, eq=False)
class PaperRuns:
    """The friction bar of Table 1 under a sine, and its incremental solution.

    Ten substructures with the coarse problem and without, and iterate `EARLY` of both;
    five, converged, and with the PGD at its default settings; the converged fields,
    decomposed in each of the five.
    """

    reference: Reference
    multiscale: Solution
    monoscale: Solution
    early: list[Iterate]
    five: Solution
    five_reduced: Solution
    friction_forces: list[Decomposition]
    displacements: list[Decomposition]


def paper_runs() -> PaperRuns:
    """Solve and decompose all of them."""
    settings = CATALOGUE["bar"].checked(
        {"method": "paper", "load": "sine", "peak": 900.0}
    )
    reference = reference_of(discretise(settings))

    def run(**changes: object) -> Solution:
        changed = settings.replace(**changes)
        problem = discretise(changed)
        return solve(
            problem, method_of(changed), distance=distance_to(reference, problem)
        )

    def ten(iterations: int, multiscale: bool) -> Solution:
        return run(tolerance=1e-30, max_iterations=iterations, multiscale=multiscale)

    five = run(substructures=5, tolerance=CONVERGED, max_iterations=10 * LONG)
    last = five.iterate
    return PaperRuns(
        reference,
        ten(LONG, True),
        ten(LONG, False),
        [ten(EARLY, multiscale).iterate for multiscale in (True, False)],
        five,
        run(substructures=5, linear_stage="pgd", max_iterations=REDUCED),
        decompositions(last.problem, last.boundary_force, is_force=True),
        decompositions(last.problem, last.boundary_displacement, is_force=False),
    )


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
        if all(held):
            return "holds"
        if any(held):
            return "holds in part"
        return "does not hold"


def paper_figure(
    number: int, panels: Sequence[Panel], *findings: Finding, **numbers: float
) -> PaperFigure:
    """A figure with its words, in which numbers are named."""
    texts = {name: text.format(**numbers) for name, text in WORDS[str(number)].items()}
    caption = f"{texts.pop('caption')} {LOAD}"
    return PaperFigure(
        number, panels=panels, findings=findings, caption=caption, **texts
    )


def write_figures(figures: Sequence[PaperFigure], folder: Path) -> None:
    """Write `FILE` into a folder."""
    report: list[Section] = [INTRODUCTION]
    for figure in figures:
        findings = bullets(
            [f"{finding.text} {SAYS[finding.holds]}" for finding in figure.findings]
        )
        claim = f"<b>The paper's claim:</b> {escape(figure.claim)} <b>Here it {figure.verdict}.</b>"
        report += [
            f"<h2>{escape(figure.heading)}</h2>",
            PlotSection(figure.heading, figure.panels),
            f'<p>{claim}</p>\n{findings}\n<p class="caption">{escape(figure.caption)}</p>',
        ]
    write_page(folder / FILE, "The paper's figures, drawn again", report)
