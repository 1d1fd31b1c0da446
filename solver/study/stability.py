"""Where the method is sound: each case run, measured against the reference, and judged."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice

import numpy as np
from scipy import sparse
from scipy.linalg import eigvals_banded

from solver.discrete import discretise
from solver.discrete.problem import Array, Problem
from solver.latin import Ending, Solution, iterations, solve
from solver.latin.direction import search_direction
from solver.reference.assembly import assembled_stiffness
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes.bar import BarSettings
from solver.study.stability_cases import PRECISE, RIGHT, Case

METHODS: dict[str, dict[str, object]] = {
    "default": {},
    "accelerated": {"search_direction": "auto", "acceleration": "anderson", "start": "nested"},
}
RIGHT_UP_TO = 1e-6
"""Error of displacement and friction force up to which an answer is right."""
WRONG_FROM = 1e-3
"""Error of either from which a field must not be called converged at a tight tolerance."""
SAME_UP_TO = 1e-10
UNITS = {
    "millimetres and newtons": (1e3, 1.0),
    "inches and pounds": (1.0 / 0.0254, 1.0 / 4.4482216152605),
}
"""Units in a metre and in a newton."""


class Verdict(StrEnum):
    """What a run is worth."""

    RIGHT = "right"
    NEAR = "near"
    TOLD = "told"
    FAIL = "fail"


MEANING = {
    Verdict.RIGHT: "both errors are at most 1e-6",
    Verdict.NEAR: "called converged, with an error between 1e-6 and 1e-3",
    Verdict.TOLD: "not the answer, and the status says so, and what to try",
    Verdict.FAIL: "not finite, a warning leaked, or called converged with an error above 1e-3",
}


@dataclass(frozen=True)
class Outcome:
    """What one run of a case came to.

    Attributes
    ----------
    ending, advice
        The status.
    iterations, seconds
        Iterations done, and what they took, set-up included, s.
    indicator, behaviour
        At the end.
    error_displacement, error_force
        True errors, relative; absolute (m, N) where reference and load are zero.
    finite
        Whether all fields are.
    warned
        First warning that leaked, or empty.
    condition_structure, condition_substructure
        Condition numbers of the stiffness with supports, and largest of the substructures'
        operators K + B' k B.
    """

    ending: Ending
    advice: str
    iterations: int
    seconds: float
    indicator: float
    behaviour: float
    error_displacement: float
    error_force: float
    finite: bool
    warned: str
    condition_structure: float
    condition_substructure: float

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
        told = self.case.expected != RIGHT and self.verdict is Verdict.TOLD
        return told or self.verdict is Verdict.RIGHT


def judge(outcome: Outcome) -> Verdict:
    """Judge an outcome by its numbers and its status alone."""
    if not outcome.finite or outcome.warned or not outcome.advice:
        return Verdict.FAIL
    if outcome.error <= RIGHT_UP_TO:
        return Verdict.RIGHT
    if outcome.ending is not Ending.CONVERGED:
        return Verdict.TOLD
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
    settings = BarSettings.checked({**PRECISE, **METHODS[method], **case.changes})
    problem = discretise(settings)
    distance = distance_to(incremental(problem), problem)
    start = time.perf_counter()
    with warnings.catch_warnings(record=True) as leaked:
        warnings.simplefilter("always")
        solution = solve(problem, settings, distance=distance)
    seconds = time.perf_counter() - start
    iterate, last = solution.iterate, solution.records[-1] if solution.records else None
    return Outcome(
        ending=solution.status.ending,
        advice=solution.status.advice,
        iterations=iterate.number,
        seconds=seconds,
        indicator=last.indicator if last else float("nan"),
        behaviour=last.behaviour if last else float("nan"),
        error_displacement=distance.of_displacement(iterate),
        error_force=distance.of_friction_force(iterate),
        finite=_is_finite(solution),
        warned=str(leaked[0].message) if leaked else "",
        condition_structure=condition_of_structure(problem),
        condition_substructure=condition_of_substructures(
            problem, search_direction(problem, settings)
        ),
    )


def condition_of_structure(problem: Problem) -> float:
    """Give the condition number of the assembled stiffness without its held points."""
    free = np.setdiff1d(np.arange(problem.n_dofs), problem.prescribed[0])
    return _condition(assembled_stiffness(problem)[free][:, free])


def condition_of_substructures(problem: Problem, k: Array) -> float:
    """Give the largest condition number of K + B' k B over the substructures.

    Parameters
    ----------
    problem, k
        The structure, and the search direction, shape (n_rows,).
    """
    found = {}
    for part in problem.substructures:
        key = (id(part.elasticity), k[part.rows].tobytes())
        if key not in found:
            springs = np.zeros(len(part.dofs))
            np.add.at(springs, part.elasticity.trace, k[part.rows])
            found[key] = _condition(part.elasticity.stiffness + sparse.diags_array(springs))
    return max(found.values())


def _condition(matrix: sparse.csr_array) -> float:
    """Give largest over smallest eigenvalue of a tridiagonal matrix; infinite if that is zero."""
    size = matrix.shape[0]
    if size == 1:
        return 1.0
    band = np.zeros((2, size))
    band[0], band[1, :-1] = matrix.diagonal(), matrix.diagonal(1)
    first, last = (
        float(eigvals_banded(band, lower=True, select="i", select_range=(place, place))[0])
        for place in (0, size - 1)
    )
    return last / first if first > 0.0 else float("inf")


def invariance(number: int = 40) -> dict[str, float]:
    """Compare iterates of one bar written in several units.

    Returns
    -------
    Largest relative difference of displacement and friction force from those in metres and
    newtons, over some iterations, by units and method.
    """
    size = {"elements": 24, "substructures": 4, "instants": 31}
    found = {}
    for method, options in METHODS.items():
        for units, (length, force) in UNITS.items():
            pair = (
                BarSettings.checked({**size, **options, **bar_in_units(*of)})
                for of in ((1.0, 1.0), (length, force))
            )
            both = (islice(iterations(discretise(chosen), chosen), number) for chosen in pair)
            found[f"{units}, {method}"] = max(
                max(
                    _apart(one.displacement * length, other.displacement),
                    _apart(one.friction_force * force, other.friction_force),
                )
                for one, other in zip(*both, strict=True)
            )
    return found


def bar_in_units(length: float, force: float) -> dict[str, float]:
    """Give the settings of Table 1 that have units, for so many units in a metre and a newton."""
    table = BarSettings.checked({})
    return {
        "length": table.length * length,
        "section": table.section * length**2,
        "young": table.young * force / length**2,
        "pressure": table.pressure * force / length,
        "peak": table.peak * force,
    }


def _apart(one: Array, other: Array) -> float:
    size = float(np.abs(one).max())
    return float(np.abs(one - other).max()) / size if size > 0.0 else float(np.abs(other).max())


def _is_finite(solution: Solution) -> bool:
    iterate = solution.iterate
    return bool(
        np.isfinite(iterate.displacement).all() and np.isfinite(iterate.friction_force).all()
    )
