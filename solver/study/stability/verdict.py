"""Runs that are judged by one rule."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from solver.latin import Ending
from solver.study.quantities.finished import BROKEN, REFUSED
from solver.study.stability.case import PASSING, Case, Verdict
from solver.study.stability.outcome import AT_ROUNDING, Outcome, run

MEANING: dict[str, str] = {
    Verdict.RIGHT: "the errors are as small as they have to be; or certified, and the equations "
    "hold up to rounding where there are several solutions",
    Verdict.UNSOLVED: "not the right answer, and the run says so, and what to try",
    Verdict.REFUSED: "a problem without a solution, or senseless, is refused in words",
    Verdict.UNCLEAR: "called converged, not certified, and not judged, as the reference finds "
    "several solutions or none",
    Verdict.WRONG: "called converged with a larger error, certified without solving the equations, "
    "not finite, or ended in a warning or an exception",
}


@dataclass(frozen=True)
class JudgedRun:
    """A case, what it came to, and what that is worth."""

    case: Case
    outcome: Outcome

    @property
    def verdict(self) -> Verdict:
        """What it is worth."""
        return judge(self.outcome, self.case.error_force, self.case.error_displacement)

    @property
    def passed(self) -> bool:
        """Whether it came to what it has to."""
        return self.verdict in PASSING[self.case.expected]


def judged_runs(cases: Iterable[Case], *, conditions: bool) -> Iterator[JudgedRun]:
    """Run cases, and yield each as soon as it is done.

    Parameters
    ----------
    cases
        What is to be run.
    conditions
        Whether condition numbers are wanted, which take their time.
    """
    for case in cases:
        yield JudgedRun(case, run(case.scene, case.values, conditions=conditions))


def judge(outcome: Outcome, force: float, displacement: float = math.inf) -> Verdict:
    """Judge an outcome by its numbers and its status alone.

    Parameters
    ----------
    outcome
        Of a run.
    force, displacement
        Errors of contact force and displacement up to which the answer is right.
    """
    if outcome.ending == BROKEN or not outcome.finite or not outcome.advice:
        return Verdict.WRONG
    if outcome.ending == REFUSED:
        return Verdict.REFUSED
    if outcome.certified and not outcome.residual <= max(AT_ROUNDING, 2.0 * outcome.floor):
        return Verdict.WRONG
    if outcome.error_force <= force and outcome.error_displacement <= displacement:
        return Verdict.RIGHT
    if outcome.ending != Ending.CONVERGED:
        return Verdict.UNSOLVED
    if outcome.doubt:
        # One solution of several is right.
        return Verdict.RIGHT if outcome.certified else Verdict.UNCLEAR
    return Verdict.WRONG
