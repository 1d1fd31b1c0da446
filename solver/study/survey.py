"""Random runs of all scenes, each judged: what is called converged has to be right."""

from __future__ import annotations

import json
import math
import shlex
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from solver.discrete import Problem
from solver.latin import Ending, Solution, solve
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.solution import Reference
from solver.refusal import RefusedError
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.survey_draw import draw, is_foolish
from solver.study.survey_residual import kkt_residual

ALLOWED = 2.0
"""Times the accuracy that the contact force of a run that is called converged may be wrong by."""
AT_ROUNDING = 1e-8
"""Residual of a certified solution, at most, by the equations alone."""
REFUSED = "refused"
BROKEN = "broken"


class Verdict(StrEnum):
    """What a run is worth."""

    RIGHT = "right"
    UNSOLVED = "unsolved"
    UNCLEAR = "unclear"
    WRONG = "wrong"


MEANING: dict[str, str] = {
    Verdict.RIGHT: "called converged, and the contact force within twice the accuracy; or "
    "certified, and the equations hold up to rounding where there are several solutions",
    Verdict.UNSOLVED: "not converged, or refused, and the run says so",
    Verdict.UNCLEAR: "called converged, not certified, and not judged, as the reference finds "
    "several solutions or none",
    Verdict.WRONG: "called converged with a larger error, certified without solving the equations, "
    "not finite, or ended in an exception",
}


@dataclass(frozen=True)
class Outcome:
    """What one run of a survey came to.

    Attributes
    ----------
    ending, advice
        Its status; `REFUSED` or `BROKEN`, and why.
    certified, iterations, seconds, estimated_error
        As the run itself says.
    residual
        Of a certified run by `kkt_residual`; NaN of others.
    error_displacement, error_force
        Relative distance to the reference; NaN where there is none.
    doubt
        Why the reference is not the one solution, or empty.
    finite
        Whether all fields are.
    floor
        Residual of the reference, below which rounding lets nobody come: layers of 5000 times their
        thickness have one of 3e-7. Measured where that of a certified solution is above rounding.
    """

    ending: str
    advice: str
    certified: bool = False
    iterations: int = 0
    seconds: float = 0.0
    estimated_error: float = math.nan
    residual: float = math.nan
    error_displacement: float = math.nan
    error_force: float = math.nan
    doubt: str = ""
    finite: bool = True
    floor: float = 0.0


@dataclass(frozen=True)
class Row:
    """One run of a survey, judged.

    Attributes
    ----------
    settings
        With which it ran.
    seed, number
        By which they can be drawn again.
    """

    settings: Settings
    seed: int
    number: int
    outcome: Outcome
    verdict: Verdict

    @property
    def scene(self) -> str:
        """Name of the scene."""
        return self.settings.scene

    @property
    def method(self) -> str:
        """Name of the method; with bases, or with options of its own, that is said."""
        settings = self.settings
        if settings.is_reduced:
            return "pgd"
        own = set(settings.changed()) & {*settings.METHODS["fast"], "k_update"}
        return f"{settings.values()['method']}{', mixed' if own - {'tolerance'} else ''}"

    @property
    def is_foolish(self) -> bool:
        """Whether k is far from what suits."""
        return is_foolish(self.settings)

    @property
    def may_finish(self) -> bool:
        """Whether a status step may end it."""
        return self.settings.finish == "status" and not self.settings.is_reduced

    @property
    def changed(self) -> dict[str, Any]:
        """Settings that differ from their defaults, the method among them."""
        return self.settings.changed()

    @property
    def command(self) -> str:
        """Give the command line that repeats the run."""
        plain = {
            name: value if isinstance(value, str) else json.dumps(value)
            for name, value in self.changed.items()
        }
        changes = (f"--set {shlex.quote(f'{name}={value}')}" for name, value in plain.items())
        return " ".join([f"python -m solver run {self.scene}", *changes])


def survey(scenes: Sequence[str], numbers: Sequence[int], seed: int) -> Iterator[Row]:
    """Run random settings of scenes in turn.

    Parameters
    ----------
    scenes
        Names of the catalogue.
    numbers
        Of the rows to run; row n is of scene n modulo their number.
    seed
        Of the draws.

    Yields
    ------
    Every row as soon as it is done.
    """
    for number in numbers:
        yield run_row(scenes[number % len(scenes)], seed, number)


def run_row(scene: str, seed: int, number: int) -> Row:
    """Draw one row, run it, and judge it."""
    settings = draw(scene, seed, number)
    outcome = run(settings)
    return Row(settings, seed, number, outcome, judge(outcome, settings.accuracy))


def judge(outcome: Outcome, accuracy: float) -> Verdict:
    """Judge an outcome by its numbers and its status alone."""
    if outcome.ending == BROKEN or not outcome.finite:
        return Verdict.WRONG
    if outcome.ending != Ending.CONVERGED:
        return Verdict.UNSOLVED
    if outcome.certified and not outcome.residual <= max(AT_ROUNDING, 2.0 * outcome.floor):
        return Verdict.WRONG
    if outcome.error_force <= ALLOWED * accuracy or outcome.certified:
        # One solution of several is right; where there is but one, the equations tell as well.
        return Verdict.RIGHT
    return Verdict.UNCLEAR if outcome.doubt else Verdict.WRONG


def run(settings: Settings) -> Outcome:
    """Run settings to their stop rule, and measure what comes out."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            problem = discretise(settings)
            solution = solve(problem, method_of(settings), watch=False)
            return _measured(problem, solution)
        except RefusedError as refusal:
            return Outcome(REFUSED, str(refusal))
        except Exception as trouble:  # whatever it is belongs in the table
            return Outcome(BROKEN, f"{type(trouble).__name__}: {trouble}")


def _measured(problem: Problem, solution: Solution) -> Outcome:
    """Compare a solution with the reference, and with the equations if it is certified."""
    iterate, status = solution.iterate, solution.status
    finite = all(
        np.isfinite(field).all() for field in (iterate.displacement, iterate.contact_force)
    )
    reference, doubt = _reference(problem)
    errors = math.nan, math.nan
    if reference is not None and finite:
        distance = distance_to(reference, problem)
        errors = distance.of_displacement(iterate), distance.of_friction_force(iterate)
    certified = solution.is_certified
    residual = kkt_residual(iterate, problem) if certified else math.nan
    floor = kkt_residual(reference, problem) if reference and residual > AT_ROUNDING else 0.0
    last = solution.records[-1] if solution.records else None
    return Outcome(
        str(status.ending),
        status.advice,
        certified,
        iterate.number,
        last.seconds if last else iterate.seconds,
        last.estimated_error if last else math.nan,
        residual,
        *errors,
        doubt,
        finite or status.ending is Ending.DIVERGED,
        floor,
    )


def _reference(problem: Problem) -> tuple[Reference | None, str]:
    """Give the reference, if there is one, and why it is not the one solution."""
    try:
        reference = reference_of(problem)
    except NoReferenceError as refusal:
        return None, str(refusal)
    lost = np.count_nonzero(~reference.converged)
    if lost:
        return None, f"the reference finds no solution at {lost} of {problem.n_instants} instants"
    several = np.count_nonzero(reference.ambiguous)
    return reference, f"there are several solutions at {several} instants" if several else ""


def is_sound(row: Row) -> bool:
    """Tell whether a row could converge: it has a solution, and its k is not foolish."""
    found = row.outcome
    return not row.is_foolish and found.ending != REFUSED and not found.doubt


def groups(rows: Sequence[Row]) -> Iterator[tuple[str, str, list[Row]]]:
    """Give the rows by scene and method, sorted."""
    names = sorted({(row.scene, row.method) for row in rows})
    for scene, method in names:
        yield scene, method, [r for r in rows if (r.scene, r.method) == (scene, method)]
