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
from scipy.linalg import eigvals_banded, eigvalsh

from solver.arrays import Array
from solver.definitions import SettingError
from solver.discrete.problem import Problem
from solver.latin import Ending, Solution, iterations, solve
from solver.latin.direction import search_direction
from solver.reference.assembly import assembled_stiffness
from solver.reference.choice import reference_of
from solver.reference.condensation import NotHeldError
from solver.reference.distance import Distance, distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.study.stability_cases import PRECISE, REFUSED, RIGHT, TOLD, UNCLEAR, Case, cases
from solver.study.stability_plane import plane_cases
from solver.study.stability_strand import strand_cases

METHODS: dict[str, dict[str, object]] = {"fast": {}, "paper": {"method": "paper"}}
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
    UNCLEAR = "unclear"
    FAIL = "fail"


MEANING = {
    Verdict.RIGHT: "both errors are at most 1e-6",
    Verdict.NEAR: "called converged, with an error between 1e-6 and 1e-3",
    Verdict.TOLD: "not the answer, and the status or the refusal says so, and what to try",
    Verdict.UNCLEAR: "the reference knows several solutions or none, so that no error is judged",
    Verdict.FAIL: "not finite, a warning leaked, or called converged with an error above 1e-3",
}


ALLOWED = {
    RIGHT: {Verdict.RIGHT},
    TOLD: {Verdict.RIGHT, Verdict.TOLD},
    UNCLEAR: {Verdict.RIGHT, Verdict.TOLD, Verdict.UNCLEAR},
}
"""What may come of a case, by what is expected of it."""
LARGEST_DENSE = 2000
"""Degrees of freedom up to which condition numbers of other than tridiagonal matrices are found."""


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
        return Verdict.TOLD
    if outcome.doubt:
        return Verdict.UNCLEAR
    if outcome.error <= RIGHT_UP_TO:
        return Verdict.RIGHT
    if outcome.ending != Ending.CONVERGED:
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
        error_displacement=distance.of_displacement(iterate) if distance else float("nan"),
        error_force=distance.of_friction_force(iterate) if distance else float("nan"),
        finite=_is_finite(solution),
        warned=str(leaked[0].message) if leaked else "",
        doubt=doubt,
        condition_structure=condition_of_structure(problem),
        condition_substructure=condition_of_substructures(
            problem, search_direction(problem, settings)
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
            stiffness = sparse.csr_array(part.elasticity.stiffness)
            found[key] = _condition(sparse.csr_array(stiffness + sparse.diags_array(springs)))
    return max(found.values())


def _condition(matrix: sparse.csr_array) -> float:
    """Give largest over smallest eigenvalue of a symmetric matrix; infinite if that is zero."""
    size = matrix.shape[0]
    if size == 1:
        return 1.0
    rows, columns = sparse.coo_array(matrix).coords
    if np.abs(rows - columns).max() > 1:
        return _condition_of_dense(matrix)
    band = np.zeros((2, size))
    band[0], band[1, :-1] = matrix.diagonal(), matrix.diagonal(1)
    first, last = (
        float(eigvals_banded(band, lower=True, select="i", select_range=(place, place))[0])
        for place in (0, size - 1)
    )
    return last / first if first > 0.0 else float("inf")


def _condition_of_dense(matrix: sparse.csr_array) -> float:
    if matrix.shape[0] > LARGEST_DENSE:
        return float("nan")
    found = eigvalsh(matrix.toarray())
    rounding = len(found) * np.finfo(float).eps * found[-1]
    return float(found[-1] / found[0]) if found[0] > rounding else float("inf")


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
        np.isfinite(iterate.displacement).all() and np.isfinite(iterate.contact_force).all()
    )
