"""The runs behind the paper's figures."""

from __future__ import annotations

from dataclasses import dataclass

from solver.latin import Iterate, Record, solve
from solver.reduction.svd import Decomposition, decompositions
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

EARLY = 10
"""Iterations after which Fig. 4 looks at the friction force."""
LONG = 800
"""Iterations of Fig. 3: enough to see the rate of convergence at the end of every error."""
CONVERGED = 1e-18
"""LATIN indicator at which the fields of Figs. 5 to 7 count as converged (error near 1e-6)."""
REDUCED = 100
"""Iterations of the PGD of Fig. 8."""


@dataclass(frozen=True, eq=False)
class PaperRun:
    """Records of a run, one per iteration, its iterate number `EARLY`, and the last one."""

    records: list[Record]
    early: Iterate
    last: Iterate


@dataclass(frozen=True, eq=False)
class PaperRuns:
    """The friction bar of Table 1 under a sine, decomposed and solved in several ways.

    Attributes
    ----------
    reference
        The incremental solution; how the bar is decomposed makes no difference to it.
    multiscale, monoscale
        Ten substructures with the coarse problem and without.
    five, five_reduced
        Five substructures, converged, and with the PGD at its default settings.
    friction_forces, displacements
        The converged fields, decomposed in each of five substructures.
    """

    reference: Reference
    multiscale: PaperRun
    monoscale: PaperRun
    five: PaperRun
    five_reduced: PaperRun
    friction_forces: list[Decomposition]
    displacements: list[Decomposition]

    @property
    def versions(self) -> tuple[PaperRun, PaperRun]:
        """Multiscale and monoscale."""
        return self.multiscale, self.monoscale


def paper_runs() -> PaperRuns:
    """Solve and decompose all of them."""
    settings = BarSettings.checked({"method": "paper", "load": "sine", "peak": 900.0})
    reference = reference_of(discretise(settings))

    def run(**changes: object) -> PaperRun:
        changed = settings.replace(**changes)
        problem = discretise(changed)
        distance = distance_to(reference, problem)
        method = method_of(changed.replace(max_iterations=EARLY))
        early = solve(problem, method, distance=distance)
        start = early.iterate.checkpoint
        late = solve(problem, method_of(changed), distance=distance, start=start)
        return PaperRun([*early.records, *late.records], early.iterate, late.iterate)

    ten = {"substructures": 10, "tolerance": 1e-30, "max_iterations": LONG}
    five = run(substructures=5, tolerance=CONVERGED, max_iterations=10 * LONG)
    return PaperRuns(
        reference,
        run(multiscale=True, **ten),
        run(multiscale=False, **ten),
        five,
        run(substructures=5, linear_stage="pgd", max_iterations=REDUCED),
        decompositions(five.last.problem, five.last.boundary_force, is_force=True),
        decompositions(five.last.problem, five.last.boundary_displacement, is_force=False),
    )
