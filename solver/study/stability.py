"""Where the method is sound: each case run, measured against the reference, and judged."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from solver.definitions import SettingError
from solver.discrete.problem import Problem
from solver.latin import Ending, solve
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.latin.iterate import Iterate
from solver.reference.choice import reference_of
from solver.reference.condensation import NotHeldError
from solver.reference.distance import Distance, distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.conditioning import condition_of_structure, condition_of_substructures
from solver.study.stability_cases import PRECISE, REFUSED, RIGHT, UNCLEAR, UNSOLVED, Case, cases
from solver.study.stability_plane import plane_cases
from solver.study.stability_strand import strand_cases

METHODS: dict[str, dict[str, object]] = {"fast": {}, "paper": {"method": "paper"}}
RIGHT_UP_TO = 1e-6
"""Error of displacement and friction force up to which an answer is right."""
WRONG_FROM = 1e-3
"""Error of either from which a field must not be called converged at a tight tolerance."""
SAME_UP_TO = 1e-10


class Verdict(StrEnum):
    """What a run is worth."""

    RIGHT = "right"
    NEAR = "near"
    UNSOLVED = "unsolved"
    UNCLEAR = "unclear"
    FAIL = "fail"


MEANING: dict[str, str] = {
    Verdict.RIGHT: "both errors are at most 1e-6",
    Verdict.NEAR: "called converged, with an error between 1e-6 and 1e-3",
    Verdict.UNSOLVED: "not the right answer, and the run says so, and what to try",
    Verdict.UNCLEAR: "not judged, as the reference finds several solutions or none",
    Verdict.FAIL: "not finite, a stray warning, or called converged with an error above 1e-3",
}


ALLOWED = {
    RIGHT: {Verdict.RIGHT},
    UNSOLVED: {Verdict.RIGHT, Verdict.UNSOLVED},
    UNCLEAR: {Verdict.RIGHT, Verdict.UNSOLVED, Verdict.UNCLEAR},
}
"""What may come of a case, by what is expected of it."""


def cases_of(scene: str | None = None, *, quick: bool = False) -> list[Case]:
    """Give the cases of one scene, or of all, and with `quick` only the few for a short check."""
    return [
        case
        for case in (*cases(), *strand_cases(), *plane_cases())
        if scene in (None, case.scene) and (case.quick or not quick)
    ]


@dataclass(frozen=True)
class Outcome:
    """What one run of a case came to.

    Attributes
    ----------
    ending, advice
        The status; or `REFUSED`, and the refusal.
    iterations, seconds
        Iterations done, and what they took, set-up included, s.
    indicator, behaviour
        At the end.
    error_displacement, error_force
        True errors, relative; absolute (m, N) where reference and load are zero; NaN where they
        are not known.
    finite
        Whether all fields are.
    warned
        First warning that leaked, or empty.
    doubt
        Why the reference is not the one solution, or empty.
    condition_structure, condition_substructure
        Condition numbers of the stiffness with supports but without contact, infinite if that
        alone holds a body, and largest of the substructures' operators K + B' k B; NaN where they
        are too large to tell.
    """

    ending: str
    advice: str
    iterations: int = 0
    seconds: float = 0.0
    indicator: float = float("nan")
    behaviour: float = float("nan")
    error_displacement: float = float("nan")
    error_force: float = float("nan")
    finite: bool = True
    warned: str = ""
    doubt: str = ""
    condition_structure: float = float("nan")
    condition_substructure: float = float("nan")

    @property
    def error(self) -> float:
        """The larger error; infinite where one is no number."""
        larger = float(np.max([self.error_displacement, self.error_force]))
        return larger if np.isfinite(larger) else float("inf")


@dataclass(frozen=True)
class Row:
    """One case by one method, judged."""

    case: Case
    method: str
    outcome: Outcome
    verdict: Verdict

    @property
    def as_expected(self) -> bool:
        """Whether the answer is right, or where that is allowed, known to be not."""
        if self.outcome.ending == REFUSED or self.case.expected == REFUSED:
            return self.outcome.ending == self.case.expected == REFUSED
        return self.verdict in ALLOWED[self.case.expected]


def judge(outcome: Outcome) -> Verdict:
    """Judge an outcome by its numbers and its status alone."""
    if not outcome.finite or outcome.warned or not outcome.advice:
        return Verdict.FAIL
    if outcome.ending == REFUSED:
        return Verdict.UNSOLVED
    if outcome.doubt:
        return Verdict.UNCLEAR
    if outcome.error <= RIGHT_UP_TO:
        return Verdict.RIGHT
    if outcome.ending != Ending.CONVERGED:
        return Verdict.UNSOLVED
    return Verdict.NEAR if outcome.error <= WRONG_FROM else Verdict.FAIL


def stability(
    matrix: Iterable[Case], report: Callable[[Row], None] = lambda row: None
) -> list[Row]:
    """Run cases by both methods; `report` is told of each row when it is done."""
    rows = []
    for case in matrix:
        for method in METHODS:
            outcome = run_case(case, method)
            rows.append(Row(case, method, outcome, judge(outcome)))
            report(rows[-1])
    return rows


def run_case(case: Case, method: str) -> Outcome:
    """Run a case to its stop rule, and measure it."""
    options = METHODS[method]
    try:
        settings = CATALOGUE[case.scene].settings.checked({**PRECISE, **options, **case.changes})
    except SettingError as refusal:
        return Outcome(REFUSED, str(refusal))
    problem = discretise(settings)
    distance, doubt = _reference(problem)
    start = time.perf_counter()
    with warnings.catch_warnings(record=True) as leaked:
        warnings.simplefilter("always")
        solution = solve(problem, method_of(settings), watch=False)
    seconds = time.perf_counter() - start
    iterate = solution.iterate
    finite = _is_finite(iterate)
    return Outcome(
        ending=solution.status.ending,
        advice=solution.status.advice,
        iterations=iterate.number,
        seconds=seconds,
        indicator=latin_indicator(iterate) if finite else float("nan"),
        behaviour=behaviour_indicator(iterate) if finite else float("nan"),
        error_displacement=distance.of_displacement(iterate) if distance else float("nan"),
        error_force=distance.of_friction_force(iterate) if distance else float("nan"),
        finite=finite,
        warned=str(leaked[0].message) if leaked else "",
        doubt=doubt,
        condition_structure=condition_of_structure(problem),
        condition_substructure=condition_of_substructures(
            problem, method_of(settings).direction.of(problem)
        ),
    )


def _reference(problem: Problem) -> tuple[Distance | None, str]:
    """Give the distance to the one solution, or why there is none or more than one."""
    try:
        found = reference_of(problem)
    except NotHeldError as refusal:
        return None, str(refusal)
    lost, several = (~found.converged).sum(), found.ambiguous.sum()
    doubt = []
    if lost:
        doubt.append(f"the reference finds no solution at {lost} of {problem.n_instants} instants")
    if several:
        doubt.append(f"it is one of several at {several} of {problem.n_instants} instants")
    return (None if doubt else distance_to(found, problem)), "; ".join(doubt)


def _is_finite(iterate: Iterate) -> bool:
    return bool(
        np.isfinite(iterate.displacement).all() and np.isfinite(iterate.contact_force).all()
    )
