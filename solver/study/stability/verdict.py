"""Runs that are judged: what each may come to, and its verdict by one rule."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum

from solver.latin import Ending
from solver.study.quantities.finished import BROKEN, REFUSED
from solver.study.stability.outcome import AT_ROUNDING, Outcome, run


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
RIGHT = "right answer"
UNSOLVED = "right answer, or said not to be"
MUST_REFUSE = "refused in words"
UNCLEAR = "right answer, or one that cannot be judged"
NOT_WRONG = "anything but a wrong answer"
PASSING = {
    RIGHT: {Verdict.RIGHT},
    UNSOLVED: {Verdict.RIGHT, Verdict.UNSOLVED},
    MUST_REFUSE: {Verdict.REFUSED},
    UNCLEAR: {Verdict.RIGHT, Verdict.UNSOLVED, Verdict.UNCLEAR},
    NOT_WRONG: set(Verdict) - {Verdict.WRONG},
}
"""Verdicts with which a run passes, by what is expected of it."""


@dataclass(frozen=True)
class Trial:
    """A run that is to be made, and what may come of it.

    Attributes
    ----------
    scene, method
        Of the run, as tables name them.
    group, case
        What is extreme, and how much; or that the run is random, and which one.
    values
        Settings that differ from the scene's own.
    expected
        A key of `PASSING`.
    error_force, error_displacement
        Errors up to which its answer is right.
    """

    scene: str
    method: str
    group: str
    case: str
    values: Mapping[str, object]
    expected: str
    error_force: float
    error_displacement: float = math.inf

    @property
    def command(self) -> str:
        """The command that makes the run."""
        texts = {
            name: value if isinstance(value, str) else json.dumps(value)
            for name, value in self.values.items()
        }
        changes = (f"--set {shlex.quote(f'{name}={text}')}" for name, text in texts.items())
        return " ".join([f"python -m solver run {self.scene}", *changes])


@dataclass(frozen=True)
class JudgedRun:
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
        return self.verdict in PASSING[self.trial.expected]


def judged_runs(trials: Iterable[Trial], *, conditions: bool) -> Iterator[JudgedRun]:
    """Run trials, and yield each as soon as it is done.

    Parameters
    ----------
    trials
        What is to be run.
    conditions
        Whether condition numbers are wanted, which take their time.
    """
    for trial in trials:
        yield JudgedRun(trial, run(trial.scene, trial.values, conditions=conditions))


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
