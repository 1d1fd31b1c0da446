"""A run that has ended, with what its quantities are taken from."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop
from solver.latin import Decision, Iterate, Solution, record, solve
from solver.latin.certified import finished
from solver.latin.cost import costs_of
from solver.latin.status import certified
from solver.latin.status_step import states_of, status_step
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental_solver, reference_of
from solver.reference.rules import States
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.quantities.cycles import slips_of

REFUSED, BROKEN = "refused", "broken"
"""How a run ends that never was one: by refused settings, by a fault of the engine."""
TINY: dict[str, dict[str, object]] = {
    "bar": {"elements": 4, "substructures": 2, "instants": 3},
    "block": {"elements": 4, "elements_up": 2, "substructures": 2, "instants": 3},
}
"""Runs that go before others: to bring in code is no part of a run's memory, nor of its time."""
ALONE = 60
"""Iterations that take as long as a run of its own, with all beside them. A status step from a
neighbour may take a third of that, which is 4 systems an instant on 50 elements and 13 on 1600; it
takes 1 to 3 and 3 to 9 (measured)."""


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """A run from its settings to its end.

    Attributes
    ----------
    was_warm
        Whether it started from another run.
    made_loop
        Its loop, where that is at hand: in the plane it takes a while to make one.
    """

    settings: Settings
    solution: Solution
    was_warm: bool = False
    made_loop: Loop | None = None

    @property
    def iterate(self) -> Iterate:
        """Its last good iterate."""
        return self.solution.iterate

    @property
    def problem(self) -> Problem:
        """What it solves."""
        return self.iterate.problem

    @cached_property
    def loop(self) -> Loop:
        """Loop that the scene shows."""
        return self.made_loop or self.settings.structure().loop(self.problem)

    @property
    def states(self) -> States:
        """What sticks, slips and is open, from which a run of like settings may start."""
        return states_of(self.iterate)

    @cached_property
    def _along_loop(self) -> tuple[Array, Array]:
        return self.loop.along(self.iterate)

    @property
    def displacement(self) -> Array:
        """Displacement of the loop that the scene shows, m, or what it goes over; (n_instants,)."""
        return self._along_loop[0]

    @property
    def force(self) -> Array:
        """Force of that loop, shape (n_instants,), N."""
        return self._along_loop[1]

    @cached_property
    def dissipated(self) -> Array:
        """Energy that friction takes between each instant and the one before, (n_instants,), J."""
        works = (work.sum(axis=0) for _, _, work in slips_of(self.iterate))
        return np.asarray(sum(works, np.zeros(self.problem.n_instants)))


@cache
def settle() -> None:
    """Make tiny runs, once in a process, after which a run brings in no code any more."""
    for scene, tiny in TINY.items():
        finished_run(CATALOGUE[scene].checked(tiny))


def finished_run(
    settings: Settings,
    *,
    errors: bool = True,
    indicators: bool = True,
    cancelled: Callable[[], bool] = lambda: False,
    before: States | None = None,
) -> FinishedRun:
    """Run a scene to its stop rule, unless it is cancelled.

    Errors, where there is a reference, and indicators of every iteration take their time. `before`
    is what stuck, slipped and opened in a run of like settings, to start from where that holds.
    """
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    distance = None
    if errors:
        try:
            reference = reference_of(problem)
        except NoReferenceError:
            reference = None
        if reference is not None and reference.converged.all():
            distance = distance_to(reference, problem)
    if before is not None and (near := neighbour(problem, settings, before)) is not None:
        return FinishedRun(settings, near, was_warm=True)
    solution = solve(
        problem,
        method_of(settings),
        distance=distance,
        watch=indicators,
        spent=spent,
        cancelled=cancelled,
    )
    return FinishedRun(settings, solution)


def neighbour(problem: Problem, settings: Settings, states: States) -> Solution | None:
    """Try a status step from what stuck, slipped and opened in a run of like settings.

    It counts only if it finds the one solution of the discrete problem, which does not depend on
    the start. Iterations of the method in between better no states that are as near as these
    (solver/study/README.md, 7). A run on separated bases is its own, as it is asked for these too.
    None where it is not found soon.
    """
    began = time.perf_counter()
    fits = states.shape == (problem.sum_of_contact.shape[0], problem.n_instants)
    if settings.finish != "at-once" or settings.linear_stage == "pgd" or not fits:
        return None
    costs = costs_of(problem, states)
    if not costs.afford(ALONE):
        return None
    try:
        solver, most = incremental_solver(problem), costs.systems(ALONE)
        _, certificate = status_step(solver, problem, states, most)
    except NoReferenceError:
        return None
    if certificate is None or certificate.residual > settings.accuracy:
        return None
    k = method_of(settings).direction.of(problem)
    finish = finished(problem, k, certificate)
    status, residual = certified(finish, certificate), certificate.residual
    seconds = time.perf_counter() - began
    decision = Decision(seconds, residual, certificate=certificate)
    return Solution(finish, [record(finish, decision, None, watch=False)], status)
