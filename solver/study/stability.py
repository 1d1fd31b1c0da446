"""Stability: extreme and random runs, their outcomes and verdicts."""

from __future__ import annotations

import json
import math
import shlex
import time
import tomllib
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from solver.latin import Ending, Iterate, Solution
from solver.latin.end.certified import Answer
from solver.latin.end.status_step import states_of, status_step
from solver.reference.assembly import Interrupted, NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental_solver
from solver.reference.law_residuals import LawResiduals, RowFields, law_residuals
from solver.reference.solution import Reference
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.study.known_reference import known_reference
from solver.study.scene_run import BROKEN, REFUSED, finished_run

CASES = Path(__file__).with_name("stability_cases.toml")
LONGEST = 60.0
"""Time limit of a run, of its reference, and of the search for a solution near it, s: a
run that takes longer counts as unsolved, and does not delay the other rows."""


class Verdict(StrEnum):
    """Verdict on a run."""

    RIGHT = "right"
    UNSOLVED = "unsolved"
    REFUSED = "refused"
    UNCLEAR = "unclear"
    WRONG = "wrong"


class Judge(StrEnum):
    """Source of a verdict on a run."""

    LAWS = "laws"
    REFERENCE = "reference"
    NOTHING = "nothing"


MEANING: dict[str, str] = {
    Verdict.RIGHT: (
        "balance and all laws hold up to rounding, or to the residual that a certified "
        "answer states; or the distance to a reference that obeys them is as small as "
        "it has to be"
    ),
    Verdict.UNSOLVED: "not the right answer, and the run says so, and what to try",
    Verdict.REFUSED: "a problem without a solution, or senseless, is refused in words",
    Verdict.UNCLEAR: (
        "called converged, not certified, and not judged, as the reference finds "
        "several solutions or none, or breaks a law"
    ),
    Verdict.WRONG: (
        "called converged with a larger error, certified and breaks a law by more than "
        "the residual that it states, not finite, or ended in a warning or an exception"
    ),
}
"""Meaning of every verdict."""
JUDGES: dict[str, str] = {
    Judge.LAWS: (
        "the answer obeys balance and all laws up to rounding; or it is certified, and "
        "does so up to the residual that it states, or not: it is what the reference's "
        "own solver finds, so that its distance to the reference says nothing"
    ),
    Judge.REFERENCE: (
        "by the distance to a reference that obeys them: the incremental solver's, or, "
        "of a run that is called converged where several solutions exist, the one that "
        "it came to"
    ),
    Judge.NOTHING: (
        "no judge is needed, or there is none: not solved, refused, broken off, unclear"
    ),
}
"""Meaning of every judge."""
NOT_WRONG = "not wrong"
PASSING = {
    "right": {Verdict.RIGHT},
    "unsolved": {Verdict.RIGHT, Verdict.UNSOLVED},
    "unclear": {Verdict.RIGHT, Verdict.UNSOLVED, Verdict.UNCLEAR},
    "refused": {Verdict.REFUSED},
    NOT_WRONG: set(Verdict) - {Verdict.WRONG},
}
"""Verdicts with which a run passes, by what is expected of it."""
PRECISE = {"accuracy": 1e-6, "tolerance": 1e-20, "max_iterations": 1500}
"""Settings of the stop rules so tight that a run called converged has to be right."""
AT_ROUNDING = 1e-8
"""Largest violation of any law that rounding may leave, as a share of the largest
force, or jump."""
MOST_STATED = 1e-5
"""Largest residual with which an answer may be called certified."""
APART = 1e-6
"""Distance above which two fields that solve the equations are two solutions."""
RIGHT_UP_TO = 1e-6
"""Error of displacement and contact force up to which an answer is right."""
Row = dict[str, Any]
"""Entries of a run by column."""
METHODS: dict[str, dict[str, object]] = {"fast": {}, "paper": {"method": "paper"}}
"""Settings of the methods by which every case is run."""


@dataclass(frozen=True)
class StabilityCase:
    """A run, and the verdicts with which it passes.

    Attributes
    ----------
    title
        Name of the case: the extreme that it has.
    scene, values
        Scene, and the settings that differ from the scene's own.
    expected
        Key of `PASSING`.
    method
        Name of the method.
    error_force, error_displacement
        Relative errors up to which the answer is right.
    """

    title: str
    scene: str
    values: Mapping[str, object]
    expected: str = "right"
    method: str = "fast"
    error_force: float = RIGHT_UP_TO
    error_displacement: float = RIGHT_UP_TO

    @property
    def command(self) -> str:
        """Command that makes the run."""
        words = [f"python -m solver run {self.scene}"]
        for name, value in self.values.items():
            text = value
            if not isinstance(value, str):
                text = json.dumps(value)
            words.append(f"--set {shlex.quote(f'{name}={text}')}")
        return " ".join(words)


def extreme_cases(
    scenes: Collection[str] = (), *, quick: bool = False
) -> Iterator[StabilityCase]:
    """Extreme cases of some or all scenes by each method, or only the quick ones."""
    for scene, groups in tomllib.loads(CASES.read_text(encoding="utf-8")).items():
        if scene not in (scenes or CATALOGUE):
            continue
        common = groups.pop("common", {})
        for expected, cases in groups.items():
            for title, values in cases.items():
                is_quick = values.pop("quick", False)
                if is_quick or not quick:
                    case = StabilityCase(title, scene, common | values, expected)
                    yield from _by_each_method(case)


def _by_each_method(case: StabilityCase) -> Iterator[StabilityCase]:
    """Yield a case by each method, with strict stop rules unless it has others."""
    for method, settings in METHODS.items():
        values = PRECISE | settings | dict(case.values)
        yield replace(case, values=values, method=method)


@dataclass(frozen=True)
class Outcome:
    """Outcome of a run; unknown numbers are NaN.

    Attributes
    ----------
    ending, advice
        Status of the run with its advice, or `REFUSED` or `BROKEN` with the reason.
    laws, worst_law
        Largest violation of any law by the answer, and the kind of that law.
    residual
        Residual that a certified answer states.
    reference_laws
        Largest violation by the reference; a reference that breaks a law is no judge.
    doubt
        Reason why the reference is not the only solution; empty without one.
    """

    ending: str
    advice: str
    certified: bool = False
    iterations: int = 0
    seconds: float = 0.0
    estimated_error: float = math.nan
    indicator: float = math.nan
    behaviour: float = math.nan
    error_displacement: float = math.nan
    error_force: float = math.nan
    laws: float = math.nan
    worst_law: str = ""
    residual: float = math.nan
    reference_laws: float = math.nan
    doubt: str = ""


def run(scene: str, values: Mapping[str, object]) -> Outcome:
    """Run a scene of the catalogue to its stop rule, and measure its errors.

    The values are settings that differ from the scene's own; a warning breaks the run.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            settings = CATALOGUE[scene].checked(values)
            finished = finished_run(
                settings, errors=False, indicators=False, cancelled=_alarm()
            )
            return _measured(finished.solution)
        except RefusedError as refusal:
            return Outcome(REFUSED, str(refusal))
        except Exception as trouble:  # any fault of the engine belongs in the table
            return Outcome(BROKEN, f"{type(trouble).__name__}: {trouble}")


def _alarm() -> Callable[[], bool]:
    """Function that returns True once `LONGEST` seconds have passed from now on."""
    end = time.perf_counter() + LONGEST
    return lambda: time.perf_counter() > end


def _measured(solution: Solution) -> Outcome:
    """Compare a solution with the laws, and with the reference if there is one."""
    iterate = solution.iterate
    fields = iterate.displacement, iterate.contact_force
    if not all(np.isfinite(field).all() for field in fields):
        return Outcome(BROKEN, "not all fields are finite", iterations=iterate.number)
    rows = RowFields(iterate.boundary_displacement, iterate.boundary_force)
    laws = law_residuals(iterate, iterate.problem, rows)
    seconds = iterate.seconds
    estimated_error = math.nan
    if solution.records:
        seconds = solution.records[-1].seconds
        estimated_error = solution.records[-1].estimated_error
    residual = math.nan
    if isinstance(iterate, Answer):
        residual = iterate.residual
    outcome = Outcome(
        ending=solution.status.ending,
        advice=solution.status.advice,
        certified=solution.is_certified,
        iterations=iterate.number,
        seconds=seconds,
        estimated_error=estimated_error,
        indicator=iterate.indicator,
        behaviour=iterate.violation,
        laws=laws.largest,
        worst_law=laws.worst,
        residual=residual,
    )
    return _beside_reference(outcome, iterate)


def _beside_reference(outcome: Outcome, iterate: Iterate) -> Outcome:
    """Outcome with the errors of an iterate, and with the doubt about the reference."""
    reference, doubt, _ = known_reference(iterate.problem, _alarm())
    if reference is None:
        return replace(outcome, doubt=doubt)
    beside = _compared(outcome, iterate, reference)
    is_settled = beside.reference_laws > AT_ROUNDING or beside.error_force <= APART
    # What a run came to judges its claim; a run that is not converged makes none.
    if is_settled or outcome.ending != Ending.CONVERGED:
        return replace(beside, doubt=doubt or beside.doubt)
    # Friction may leave several solutions, of which an iterate may come to another.
    other = _solution_near(iterate)
    if other is not None:
        near = _compared(outcome, iterate, other)
        obeys = near.reference_laws <= AT_ROUNDING
        if obeys and near.error_force < beside.error_force:
            return replace(near, doubt=doubt)
    return replace(beside, doubt=doubt or beside.doubt)


def _compared(outcome: Outcome, iterate: Iterate, solution: Reference) -> Outcome:
    """Outcome with the errors of an iterate against a solution."""
    distance = distance_to(solution, iterate.problem)
    of_solution = law_residuals(solution, iterate.problem)
    error = distance.of_friction_force(iterate)
    return replace(
        outcome,
        error_displacement=distance.of_displacement(iterate),
        error_force=error,
        reference_laws=of_solution.largest,
        doubt=_doubt(outcome.laws, of_solution, error),
    )


def _solution_near(iterate: Iterate) -> Reference | None:
    """Solution by a status step from the states of an iterate, or None."""
    stop = _alarm()
    try:
        solver = incremental_solver(iterate.problem, stop)
        found, certificate = status_step(
            solver, iterate.problem, states_of(iterate), stop=stop
        )
    except (NoReferenceError, Interrupted):
        return None
    if certificate is None:
        return None
    return found


def _doubt(laws: float, of_reference: LawResiduals, error: float) -> str:
    """Reason why the reference may not be the only solution, or "".

    `laws` is the largest violation of any law by the answer, `error` the distance of
    its contact force from the reference.
    """
    if not of_reference.largest <= AT_ROUNDING:
        worst = of_reference.worst
        return f"the reference breaks a law ({worst}) by {of_reference.largest:.1e}"
    if laws <= AT_ROUNDING and error > APART:
        return "there are several solutions: this one, and the reference"
    return ""


class Judgement(NamedTuple):
    """A verdict, and the judge that found it."""

    verdict: Verdict
    by: Judge


def judge(outcome: Outcome, force: float, displacement: float = math.inf) -> Judgement:
    """Judge an outcome by its numbers and its status.

    Laws come first, and of a certified answer they alone count, up to the residual that
    it states: a body that deforms far, or is stiff beside what holds it, has no digits
    for less. Other answers are right up to the relative errors `force` of the contact
    force and `displacement`.
    """
    # A run without advice leaves its user alone, however it ends.
    if outcome.ending == BROKEN or not outcome.advice:
        return Judgement(Verdict.WRONG, Judge.NOTHING)
    if outcome.ending == REFUSED:
        return Judgement(Verdict.REFUSED, Judge.NOTHING)
    if outcome.laws <= AT_ROUNDING:
        return Judgement(Verdict.RIGHT, Judge.LAWS)
    if outcome.certified:
        verdict = Verdict.WRONG
        if outcome.laws <= outcome.residual <= MOST_STATED:
            verdict = Verdict.RIGHT
        return Judgement(verdict, Judge.LAWS)
    has_reference = outcome.reference_laws <= AT_ROUNDING
    is_force_near = outcome.error_force <= force
    is_near = is_force_near and outcome.error_displacement <= displacement
    if has_reference and is_near:
        return Judgement(Verdict.RIGHT, Judge.REFERENCE)
    if outcome.ending != Ending.CONVERGED:
        return Judgement(Verdict.UNSOLVED, Judge.NOTHING)
    if outcome.doubt:
        return Judgement(Verdict.UNCLEAR, Judge.NOTHING)
    if has_reference:
        by = Judge.REFERENCE
    else:
        by = Judge.NOTHING
    return Judgement(Verdict.WRONG, by)


def row_of(case: StabilityCase, outcome: Outcome) -> Row:
    """Row of a run: its case, its outcome, and the verdict."""
    judgement = judge(outcome, case.error_force, case.error_displacement)
    mark = "FAIL"
    if judgement.verdict in PASSING[case.expected]:
        mark = "pass"
    return vars(case) | {
        # Errors of the run, which replace the largest ones that the case allows.
        **vars(outcome),
        "case": case.title,
        "verdict": str(judgement.verdict),
        "judged_by": str(judgement.by),
        "passed": mark,
        "status": str(outcome.ending),
        "settings": json.dumps(case.values),
        "command": case.command,
    }


def passed(row: Row) -> bool:
    """Check whether the verdict on a run is one of those expected."""
    return bool(row["passed"] == "pass")


def judged_runs(cases: Iterable[StabilityCase]) -> Iterator[Row]:
    """Run cases, and yield the row of each when it is done."""
    for case in cases:
        yield row_of(case, run(case.scene, case.values))
