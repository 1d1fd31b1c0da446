"""What a run comes to, measured against the reference and by the equations."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.linalg import eigvalsh

from solver.arrays import Array
from solver.discrete import Problem
from solver.latin import Solution, solve
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.reference.assembly import assembled_stiffness
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.solution import Reference
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.quantities.finished import BROKEN, REFUSED
from solver.study.stability.residual import kkt_residual

AT_ROUNDING = 1e-8
"""Residual of a certified solution, at most, by the equations alone."""
LARGEST = 2000
"""Degrees of freedom up to which condition numbers are found."""


@dataclass(frozen=True)
class Outcome:
    """What a run came to.

    Attributes
    ----------
    ending, advice
        Its status; `REFUSED` or `BROKEN`, and why.
    certified, iterations, seconds, estimated_error
        As the run itself says.
    indicator, behaviour
        At the end.
    error_displacement, error_force
        Relative distance to the reference; absolute (m, N) where reference and load are zero; NaN
        where there is none.
    residual
        Of a certified run by `kkt_residual`; NaN of others.
    floor
        Residual of the reference, below which rounding lets nobody come: layers of 5000 times their
        thickness have one of 3e-7. Measured where that of a certified solution is above rounding.
    doubt
        Why the reference is not the one solution, or empty.
    finite
        Whether all fields are.
    condition_structure, condition_substructure
        Condition numbers of the stiffness with supports but without contact, infinite if that
        alone holds a body, and largest of the substructures' operators K + B' k B; NaN where they
        were not asked, or are too large to tell.
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
    residual: float = math.nan
    floor: float = 0.0
    doubt: str = ""
    finite: bool = True
    condition_structure: float = math.nan
    condition_substructure: float = math.nan


def run(scene: str, values: Mapping[str, object], *, conditions: bool = False) -> Outcome:
    """Run a scene to its stop rule, and measure what comes out; a warning breaks it.

    Parameters
    ----------
    scene, values
        A name of the catalogue, and what differs from its settings.
    conditions
        Whether condition numbers are wanted, which take their time.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            settings = CATALOGUE[scene].settings.checked(values)
            problem, method = discretise(settings), method_of(settings)
            solution = solve(problem, method, watch=False)
            structure = substructures = math.nan
            if conditions:
                structure = condition_of_structure(problem)
                substructures = condition_of_substructures(problem, method.direction.of(problem))
            return _measured(problem, solution, structure, substructures)
        except RefusedError as refusal:
            return Outcome(REFUSED, str(refusal))
        except Exception as trouble:  # whatever it is belongs in the table
            return Outcome(BROKEN, f"{type(trouble).__name__}: {trouble}")


def _measured(
    problem: Problem, solution: Solution, structure: float, substructures: float
) -> Outcome:
    """Compare a solution with the reference, and with the equations if it is certified."""
    iterate, status = solution.iterate, solution.status
    if not all(np.isfinite(one).all() for one in (iterate.displacement, iterate.contact_force)):
        return Outcome(status.ending, status.advice, iterations=iterate.number, finite=False)
    reference, doubt = _reference(problem)
    distance = None if reference is None else distance_to(reference, problem)
    residual = kkt_residual(iterate, problem) if solution.is_certified else math.nan
    floor = kkt_residual(reference, problem) if reference and residual > AT_ROUNDING else 0.0
    last = solution.records[-1] if solution.records else None
    return Outcome(
        status.ending,
        status.advice,
        certified=solution.is_certified,
        iterations=iterate.number,
        seconds=last.seconds if last else iterate.seconds,
        estimated_error=last.estimated_error if last else math.nan,
        indicator=latin_indicator(iterate),
        behaviour=behaviour_indicator(iterate),
        error_displacement=distance.of_displacement(iterate) if distance else math.nan,
        error_force=distance.of_friction_force(iterate) if distance else math.nan,
        residual=residual,
        floor=floor,
        doubt=doubt,
        condition_structure=structure,
        condition_substructure=substructures,
    )


def _reference(problem: Problem) -> tuple[Reference | None, str]:
    """The reference, if there is one, and why it is not the one solution."""
    try:
        reference = reference_of(problem)
    except NoReferenceError as refusal:
        return None, str(refusal)
    lost = np.count_nonzero(~reference.converged)
    if lost:
        return None, f"the reference finds no solution at {lost} of {problem.n_instants} instants"
    if reference.jumps_at is not None:
        return reference, f"it jumps at instant {reference.jumps_at} to another equilibrium"
    several = np.count_nonzero(reference.ambiguous)
    return reference, f"there are several solutions at {several} instants" if several else ""


def condition_of_structure(problem: Problem) -> float:
    """Condition number of the assembled stiffness without its held points."""
    free = np.setdiff1d(np.arange(problem.n_dofs), problem.prescribed[0])
    return _condition(assembled_stiffness(problem)[free][:, free])


def condition_of_substructures(problem: Problem, k: Array) -> float:
    """Largest condition number of K + B' k B over the substructures.

    Parameters
    ----------
    problem, k
        The structure, and the search direction, shape (n_rows,).
    """
    numbers = {}
    for part in problem.substructures:
        key = (id(part.elasticity), k[part.rows].tobytes())
        if key not in numbers:
            springs = np.zeros(len(part.dofs))
            np.add.at(springs, part.elasticity.trace, k[part.rows])
            stiffness = sparse.csr_array(part.elasticity.stiffness)
            numbers[key] = _condition(sparse.csr_array(stiffness + sparse.diags_array(springs)))
    return max(numbers.values())


def _condition(matrix: sparse.csr_array) -> float:
    """Largest over smallest eigenvalue of a symmetric matrix; infinite if that is zero."""
    if matrix.shape[0] > LARGEST:
        return math.nan
    values = eigvalsh(matrix.toarray())
    rounding = len(values) * np.finfo(float).eps * values[-1]
    return float(values[-1] / values[0]) if values[0] > rounding else math.inf
