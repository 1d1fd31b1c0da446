"""Runs for the paper's figures, with claims and findings for each figure."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from solver.latin import Iterate, Solution, solve
from solver.reduction.svd import Decomposition, decompositions
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.page import Panel, PlotSection, write_page

WORDS = tomllib.loads(
    Path(__file__).with_name("paper_figures.toml").read_text(encoding="utf-8")
)
LOAD = (
    "The paper's load path (Fig. 2b) is lost; taken here: one period of a sine of "
    "900 N, relaxation 0.8, all else as in Table 1."
)
SAYS = {True: "Bears it out.", False: "Speaks against it."}
FILE = "figures.html"
EARLY = 10
"""Iterations after which Fig. 4 looks at the friction force."""
LONG = 800
"""Iterations of Fig. 3: enough to see the final rate of convergence of every error."""
CONVERGED = 1e-18
"""LATIN indicator of the converged fields of Figs. 5 to 7 (error near 1e-6)."""
REDUCED = 100
"""Iterations of the PGD of Fig. 8."""


@dataclass(frozen=True, eq=False)
class PaperRuns:
    """Runs of the friction bar of Table 1 under a sine.

    Attributes
    ----------
    reference
        Incremental solution.
    multiscale, monoscale
        Solutions on ten substructures, with the coarse problem and without.
    early
        Iterate `EARLY` of both.
    five, five_reduced
        Solutions on five substructures: converged, and with the PGD at its default
        settings. The records of the first have no errors.
    noise
        Error of the friction force of `five`.
    friction_forces, displacements
        Converged fields, decomposed in each of the five substructures.
    """

    reference: Reference
    multiscale: Solution
    monoscale: Solution
    early: list[Iterate]
    five: Solution
    five_reduced: Solution
    noise: float
    friction_forces: list[Decomposition]
    displacements: list[Decomposition]


def paper_runs() -> PaperRuns:
    """Solve all runs of the figures, and decompose their fields."""
    settings = CATALOGUE["bar"].checked(
        {"method": "paper", "load": "sine", "peak": 900.0}
    )
    reference = reference_of(discretise(settings))

    def run(*, errors: bool = True, **changes: object) -> Solution:
        changed = settings.replace(**changes)
        problem = discretise(changed)
        distance = None
        if errors:
            distance = distance_to(reference, problem)
        # Where no figure shows its way, a run has no more indicators than its stop rule
        # needs.
        return solve(problem, method_of(changed), distance=distance, watch=errors)

    def on_ten(iterations: int, multiscale: bool) -> Solution:
        return run(tolerance=1e-30, max_iterations=iterations, multiscale=multiscale)

    # Of thousands of iterations only the error of the last is shown.
    five = run(
        errors=False,
        substructures=5,
        tolerance=CONVERGED,
        max_iterations=10 * LONG,
    )
    last = five.iterate
    return PaperRuns(
        reference=reference,
        multiscale=on_ten(LONG, True),
        monoscale=on_ten(LONG, False),
        early=[on_ten(EARLY, True).iterate, on_ten(EARLY, False).iterate],
        five=five,
        five_reduced=run(substructures=5, linear_stage="pgd", max_iterations=REDUCED),
        noise=distance_to(reference, last.problem).of_friction_force(last),
        friction_forces=decompositions(
            last.problem, last.boundary_force, is_force=True
        ),
        displacements=decompositions(
            last.problem, last.boundary_displacement, is_force=False
        ),
    )


@dataclass(frozen=True)
class Finding:
    """Measured result on a claim: a sentence with numbers, and whether it holds."""

    text: str
    holds: bool


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """A figure of the paper, drawn again, with the paper's claim and the findings."""

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
    def sentences(self) -> list[str]:
        """Findings, each with its verdict on the claim."""
        return [f"{finding.text} {SAYS[finding.holds]}" for finding in self.findings]

    @property
    def verdict(self) -> str:
        """Verdict on the claim: "holds", "holds in part" or "does not hold"."""
        held = [finding.holds for finding in self.findings]
        if all(held):
            return "holds"
        if any(held):
            return "holds in part"
        return "does not hold"


def paper_figure(
    number: int, panels: Sequence[Panel], *findings: Finding, **numbers: float
) -> PaperFigure:
    """Figure with its title, claim and caption from `WORDS`, which name the numbers."""
    texts = {name: text.format(**numbers) for name, text in WORDS[str(number)].items()}
    return PaperFigure(
        number=number,
        title=texts["title"],
        panels=panels,
        claim=texts["claim"],
        findings=findings,
        caption=f"{texts['caption']} {LOAD}",
    )


def write_figures(figures: Sequence[PaperFigure], folder: Path) -> None:
    """Write the figures as `FILE` into a folder."""
    plots = [PlotSection(figure.heading, figure.panels) for figure in figures]
    title = "The paper's figures, drawn again"
    write_page(folder / FILE, "figures.html", plots, title=title, figures=figures)
