"""Outcomes of runs: how each ends, its errors, and its violation of all laws."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from solver.latin import Ending, Iterate, Solution
from solver.latin.end.certified import Answer
from solver.latin.end.status_step import states_of
from solver.reference.distance import distance_to
from solver.reference.law_residuals import LawResiduals, RowFields, law_residuals
from solver.reference.solution import Reference
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.study.known_reference import known_reference
from solver.study.scene_run import BROKEN, REFUSED, certified_near, finished_run

LONGEST = 60.0
"""Time limit of a run, of its reference, and of the search for a solution near it, s: a
run that takes longer counts as unsolved, and does not delay the other rows."""
AT_ROUNDING = 1e-8
"""Largest violation of any law that rounding may leave, as a share of the largest
force, or jump."""
APART = 1e-6
"""Distance above which two fields that solve the equations are two solutions."""


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
    other = certified_near(iterate.problem, states_of(iterate), _alarm())
    if other is not None:
        near = _compared(outcome, iterate, other.solution)
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
