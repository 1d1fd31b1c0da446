"""The status step: from the stick, slip and opening of an iterate to the solution itself.

Statuses that an iterate shows make the problem linear, instant after instant. Those
that the linear solution itself shows to be wrong are mended where they stand, a Newton
method that begins where LATIN ends. If statuses and solution agree at every instant,
all laws and equilibrium hold: then it is the solution of the discrete problem up to
rounding, whatever k and the method were, and it is called certified (solver/README.md,
7). LATIN finds the fronts, the step finishes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solver.checks import FLAG, check
from solver.discrete.problem import Problem
from solver.latin.indicators import contact_status
from solver.latin.iterate import Iterate
from solver.laws import OPEN
from solver.reference.condensation import BLURRED
from solver.reference.distance import Distance, distance_to
from solver.reference.incremental import Incremental
from solver.reference.rules import States
from solver.reference.solution import Reference

STILL = 1e-3
"""Share of the largest slip of an interface below which a point counts as stuck, at
most."""
FRONT = 2.0
"""The same over the square of a point's share of the length, as slip grows behind a
front. To call a point stuck that slips is the dearer mistake, as mending frees one at a
time: on 800 elements and 101 instants a step takes 480 systems with `STILL` alone, 180
with this, 190 with 1e-9 (measured)."""
CERTIFIED = 1e-7
"""KKT residual of a certified solution at most, relative to the contact force. Its
statuses agree with it exactly; on four wires of 320 elements the linear systems leave
1e-8 (measured)."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """A solution of the discrete problem, proven by its own residual, and the distance to it.

    The KKT residual is relative to the contact force: the largest of all points and
    instants as if it were that of each.
    """

    solution: Reference
    distance: Distance
    residual: float


@dataclass(frozen=True)
class StatusStep:
    """Ends a run with the certified solution, once a status step from an iterate holds.

    That is as soon as it holds, if `at_once`. Otherwise the method goes on by itself
    until its own force is within the accuracy, or until it gives up; what is certified
    is then put beside its iterates, as the answer, and is none of them.
    """

    at_once: bool = True

    def __post_init__(self) -> None:
        check(self, at_once=FLAG)


def status_step(
    solver: Incremental,
    problem: Problem,
    states: States,
    most: int,
    stop: Callable[[], bool] | None = None,
) -> tuple[Reference, Certificate | None]:
    """What the solver makes of states, mended, and its certificate if it is a solution.

    It begins with `states`, as `states_of` returns those of an iterate, may solve
    `most` linear systems, and asks `stop` before each of them.

    Raises
    ------
    Interrupted
        As soon as `stop` returns True.
    NoReferenceError
        If the solver is not worth the size of the problem.
    """
    solution = solver.march(guess=states, most=most, stop=stop)
    if not solution.converged.all():
        return solution, None
    distance = distance_to(solution, problem)
    residual = (
        solution.unbalanced * np.sqrt(len(solution.contact_force)) / distance.force_size
    )
    most_residual = BLURRED if solution.unbalanced <= solution.rounding else CERTIFIED
    if not 0.0 <= residual <= most_residual:
        return solution, None
    return solution, Certificate(solution, distance, float(residual))


def states_of(iterate: Iterate) -> States:
    """States of an iterate, as the incremental solvers take them for a guess.

    Stacked as `Problem.sum_of_contact` says, shape (n_forces, n_instants): -1, 0, +1 of
    tangential components; of normal ones 0 where they are closed; `OPEN` of both where
    they are not.
    """
    problem = iterate.problem
    sizes = np.array([len(law.positions) for law in problem.rubbing.values()])
    status = contact_status(iterate, np.minimum(STILL, FRONT / sizes**2))
    states: list[States] = []
    for name, law in problem.rubbing.items():
        own = status[problem.contact_points[name]]
        if law.normal is not None:
            states.append(np.where(own == OPEN, OPEN, 0).astype(np.int8))
        states.append(own)
    return np.concatenate(states)
