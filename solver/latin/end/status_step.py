"""Status step: from stick, slip and opening of an iterate to the exact solution.

The statuses of an iterate make the problem linear, instant after instant. Statuses that
the linear solution shows to be wrong are corrected where they stand: a Newton method
that begins where LATIN ends. If statuses and solution agree at every instant, all laws
and equilibrium hold. Then the solution is that of the discrete problem up to rounding,
whatever k and the method were, and is called certified (MATHEMATICS.md, 7).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solver.checks import FLAG, check
from solver.discrete.problem import Problem
from solver.latin.iterate import Iterate
from solver.laws import OPEN
from solver.reference.assembly import never
from solver.reference.condensation import BLURRED
from solver.reference.distance import Distance, distance_to
from solver.reference.incremental import Incremental
from solver.reference.rules import HELD, States
from solver.reference.solution import Reference

STILL = 1e-3
"""Share of the largest slip of an interface below which a point counts as stuck, if
`FRONT` does not make it smaller."""
FRONT = 2.0
"""Same share over the square of a point's share of the interface, as slip grows behind
a front. To call a point stuck that slips costs more than the reverse, as corrections
free one at a time: on 800 elements and 101 instants a step takes 480 systems with
`STILL` alone, 180 with this, 190 with 1e-9 (measured)."""
CERTIFIED = 1e-7
"""Largest KKT residual of a certified solution, relative to the contact force. Its
statuses agree with it exactly; on four wires of 320 elements the linear systems leave
1e-8 (measured)."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """Solution of the discrete problem, certified by its residual.

    Attributes
    ----------
    solution
        The solution.
    distance
        Distance of an iterate to the solution.
    residual
        KKT residual relative to the contact force: the largest of all points and
        instants as if it were that of each.
    """

    solution: Reference
    distance: Distance
    residual: float


@dataclass(frozen=True)
class StatusStep:
    """Option to end a run with the certified solution of a status step.

    Attributes
    ----------
    at_once
        Whether the run ends as soon as the step holds. Otherwise the method continues
        by itself until its own force is within the accuracy, or until it gives up; the
        certified solution then is next to the iterates, as the answer.
    """

    at_once: bool = True

    def __post_init__(self) -> None:
        check(self, at_once=FLAG)


def status_step(
    solver: Incremental,
    problem: Problem,
    states: States,
    max_systems: int | None = None,
    stop: Callable[[], bool] = never,
) -> tuple[Reference, Certificate | None]:
    """Correct the states of an iterate to a solution, and certify the solution.

    Parameters
    ----------
    solver
        Incremental solver of the problem.
    problem
        The problem to be solved.
    states
        States to begin with, as of `states_of`, shape (n_forces, n_instants).
    max_systems
        Largest number of linear systems; None sets no limit.
    stop
        Called before each system; returns True where the step is to be given up.

    Returns
    -------
    The solver's result, and its certificate; None if it is no solution.

    Raises
    ------
    Interrupted
        As soon as `stop` returns True.
    NoReferenceError
        If the solver is not worth the size of the problem.
    """
    solution = solver.march(guess=states, max_systems=max_systems, stop=stop)
    if not solution.converged.all():
        return solution, None
    distance = distance_to(solution, problem)
    whole = solution.unbalanced * np.sqrt(len(solution.contact_force))
    residual = whole / distance.force_size
    largest = CERTIFIED
    if solution.unbalanced <= solution.rounding:
        largest = BLURRED
    if not 0.0 <= residual <= largest:
        return solution, None
    return solution, Certificate(solution, distance, float(residual))


def states_of(iterate: Iterate) -> States:
    """States of an iterate, as a guess for the incremental solvers.

    Shape (n_forces, n_instants), stacked as by `Problem.sum_of_contact`: -1, 0, +1 of
    tangential components, 0 of normal components of closed contacts, and `OPEN` of both
    components of open ones.
    """
    problem = iterate.problem
    sizes = problem.contacts.sizes
    status = iterate.status_above(np.minimum(STILL, FRONT / sizes**2))
    return _of_components(problem, status)


def states_of_solution(solution: Reference) -> States:
    """States of a solution, (n_forces, n_instants), as `states_of` of an iterate."""
    return _of_components(solution.problem, solution.status)


def _of_components(problem: Problem, status: States) -> States:
    """States of all components of contact, from the status of the points.

    The status has the shape (n_points, n_instants), the states (n_forces, n_instants).
    """
    contacts = problem.contacts
    states = np.empty((contacts.n_forces, problem.n_instants), dtype=np.int8)
    for law, _, points, forces in contacts.stacks:
        tangential = status[points]
        if law.normal is not None:
            states[forces[0]] = np.where(tangential == OPEN, OPEN, HELD)
        states[forces[-1]] = tangential
    return states
