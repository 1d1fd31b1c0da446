"""The runs behind the paper's figures, each made once, when first asked for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from solver.discrete.problem import Problem
from solver.latin import Iterate, Record, solve
from solver.reduction.svd import Decomposition, InterfaceField, decompositions
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
    """A run by its records and two of its iterates.

    Attributes
    ----------
    records
        One per iteration.
    early, last
        The iterate number `EARLY`, and the one at the end.
    """

    records: list[Record]
    early: Iterate
    last: Iterate


class PaperRuns:
    """The friction bar of Table 1 under the default load, decomposed and solved in several ways."""

    settings = BarSettings.checked({"method": "paper", "load": "sine", "peak": 900.0})

    @cached_property
    def reference(self) -> Reference:
        """The incremental solution; how the bar is decomposed makes no difference to it."""
        return reference_of(discretise(self.settings))

    @cached_property
    def multiscale(self) -> PaperRun:
        """Ten substructures with the coarse problem."""
        return self._run(substructures=10, multiscale=True, tolerance=1e-30, max_iterations=LONG)

    @cached_property
    def monoscale(self) -> PaperRun:
        """Ten substructures without it."""
        return self._run(substructures=10, multiscale=False, tolerance=1e-30, max_iterations=LONG)

    @cached_property
    def five(self) -> PaperRun:
        """Five substructures, converged."""
        return self._run(substructures=5, tolerance=CONVERGED, max_iterations=10 * LONG)

    @cached_property
    def five_reduced(self) -> PaperRun:
        """Five substructures with the PGD in the linear stage, at its default settings."""
        return self._run(substructures=5, linear_stage="pgd", max_iterations=REDUCED)

    @cached_property
    def friction_forces(self) -> list[Decomposition]:
        """The converged friction force, decomposed in each of five substructures."""
        return decompositions(self.five.last, InterfaceField.FRICTION_FORCE)

    @cached_property
    def displacements(self) -> list[Decomposition]:
        """The converged displacement, decomposed in each of five substructures."""
        return decompositions(self.five.last, InterfaceField.DISPLACEMENT)

    def _run(self, **changes: object) -> PaperRun:
        settings = self.settings.replace(**changes)
        problem: Problem = discretise(settings)
        distance = distance_to(self.reference, problem)
        early = solve(problem, method_of(settings.replace(max_iterations=EARLY)), distance=distance)
        checkpoint = early.iterate.checkpoint
        late = solve(problem, method_of(settings), distance=distance, start=checkpoint)
        return PaperRun([*early.records, *late.records], early.iterate, late.iterate)
