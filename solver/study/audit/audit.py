"""Runs that are audited: what each has to come to, and its verdict by one rule."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum

from solver.latin import Ending
from solver.study.audit.outcome import AT_ROUNDING, Outcome, run
from solver.study.quantities.finished import BROKEN, REFUSED


class Verdict(StrEnum):
    """What a run is worth."""

    RIGHT = "right"
    UNSOLVED = "unsolved"
    REFUSED = "refused"
    UNCLEAR = "unclear"
    WRONG = "wrong"


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
SOUND = frozenset(Verdict) - {Verdict.WRONG}


@dataclass(frozen=True)
class Trial:
    """A run that is to be made, and what may come of it.

    Attributes
    ----------
    scene, method
        Of the run, as its tables name them.
    title
        What tells it from others.
    values
        Settings that differ from the scene's own.
    error_force, error_displacement
        Errors up to which its answer is right.
    passing
        Verdicts that it may have.
    conditions
        Whether its condition numbers are wanted.
    labels
        What stands in its table besides.
    again
        Commands that repeat it.
    """

    scene: str
    method: str
    title: str
    values: Mapping[str, object]
    error_force: float
    error_displacement: float
    passing: frozenset[Verdict]
    conditions: bool
    labels: Mapping[str, object]
    again: tuple[str, ...] = ()


@dataclass(frozen=True)
class Audited:
    """A trial, what it came to, and what that is worth."""

    trial: Trial
    outcome: Outcome

    @property
    def verdict(self) -> Verdict:
        """What it is worth."""
        return judge(self.outcome, self.trial.error_force, self.trial.error_displacement)

    @property
    def passed(self) -> bool:
        """Whether it came to what it has to."""
        return self.verdict in self.trial.passing


def audit(trials: Iterable[Trial]) -> Iterator[Audited]:
    """Run trials, and yield each as soon as it is done."""
    for trial in trials:
        yield Audited(trial, run(trial.scene, trial.values, conditions=trial.conditions))


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
