"""Runs of a scene to its stop rule, from nothing or from states of a similar run."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import cache

from solver.discrete.problem import Problem
from solver.latin import Answer, Decision, Solution, record, solve
from solver.latin.end.certified import certified_answer
from solver.latin.end.cost import costs_of
from solver.latin.end.status import certified
from solver.latin.end.status_step import Certificate, status_step
from solver.reference.assembly import Interrupted, NoReferenceError, never
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental_solver
from solver.reference.rules import States
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.study.known_reference import KnownReference, known_reference
from solver.study.quantities.finished import FinishedRun

REFUSED = "refused"
BROKEN = "broken"
"""Endings of a run without a result: refused settings, or a fault of the engine."""
TINY: dict[str, dict[str, object]] = {
    "bar": {"elements": 4, "substructures": 2, "instants": 3},
    "block": {"elements": 4, "elements_up": 2, "substructures": 2, "instants": 3},
}
"""Tiny runs that precede timed ones: importing code is no part of a run's time."""
ALONE = 60
"""Iterations of a usual run, by which the cost of a status step is judged.

A status step from a neighbour may take a third of their time: 4 systems an instant on
50 elements and 13 on 1600. It takes 1 to 3 and 3 to 9 (measured)."""


@cache
def warm_up() -> None:
    """Make tiny runs, once in a process, so that later times include no imports."""
    for scene, tiny in TINY.items():
        finished_run(CATALOGUE[scene].checked(tiny))


def finished_run(
    settings: Settings,
    *,
    errors: bool = True,
    indicators: bool = True,
    cancelled: Callable[[], bool] = never,
    before: States | None = None,
) -> FinishedRun:
    """Run a scene to its stop rule.

    Parameters
    ----------
    settings
        Settings of the scene.
    errors
        Whether to compute the errors of every iteration, where there is a reference.
    indicators
        Whether to compute the indicators of every iteration.
    cancelled
        Asked again and again whether to give up.
    before
        States (stick, slip, open) of a run of similar settings, which the run starts
        from if the solution of these settings is found from there.
    """
    # The time of a run includes its discretisation.
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    if errors:
        known = known_reference(problem, cancelled)
    else:
        known = KnownReference()
    distance = None
    if known.reference is not None:
        distance = distance_to(known.reference, problem)
    # From a neighbour one status step may find the solution, without any iteration.
    if before is not None:
        near = neighbour(problem, settings, before, cancelled, spent)
        if near is not None:
            answer, decision = near
            assert decision.status is not None
            last = record(answer, decision, distance, watch=indicators)
            found = Solution(answer, [last], decision.status)
            return FinishedRun(settings, found, was_warm=True)
    solution = solve(
        problem,
        method_of(settings),
        distance=distance,
        watch=indicators,
        spent=spent,
        cancelled=cancelled,
    )
    return FinishedRun(settings, solution, known_loss=known.lost_from)


def neighbour(
    problem: Problem,
    settings: Settings,
    states: States,
    stop: Callable[[], bool] = never,
    spent: float = 0.0,
) -> tuple[Answer, Decision] | None:
    """Solve by a status step from the states of a run with similar settings.

    The answer counts only if it is certified for the discrete problem, and no other
    solution shows, so that it does not depend on the start. None where it is not found
    soon, or where `stop` returns True before. A run on separated bases never starts
    from another one, since its bases are part of its result.

    Parameters
    ----------
    problem, settings
        Problem to be solved, and the settings that it was made from.
    states
        States as of `states_of`, shape (n_forces, n_instants).
    stop
        Asked again and again whether to give up.
    spent
        Time that the run took before, s.
    """
    began = time.perf_counter()
    # States of another mesh, or of other instants, are no start.
    fits = states.shape == (problem.sum_of_contact.shape[0], problem.n_instants)
    if settings.finish != "at-once" or settings.linear_stage == "pgd" or not fits:
        return None
    costs = costs_of(problem, states)
    if not costs.afford(ALONE) or _may_have_others(problem):
        return None
    certificate = certified_near(problem, states, stop, costs.systems(ALONE))
    if certificate is None or certificate.residual > settings.accuracy:
        return None
    if certificate.solution.ambiguous.any():
        return None
    # The solution has fields of a run, too, with the k of its method.
    k = method_of(settings).direction.of(problem)
    answer = certified_answer(problem, k, certificate)
    status = certified(answer, certificate)
    seconds = spent + time.perf_counter() - began
    return answer, Decision(seconds, certificate.residual, status, certificate)


def certified_near(
    problem: Problem,
    states: States,
    stop: Callable[[], bool],
    most: int | None = None,
) -> Certificate | None:
    """Certified solution by one status step from states; None where it finds none.

    The states are as of `states_of`, shape (n_forces, n_instants). The step is given up
    where `stop` returns True, and after `most` linear systems.
    """
    try:
        solver = incremental_solver(problem, stop)
        _, certificate = status_step(solver, problem, states, most, stop)
    except (NoReferenceError, Interrupted):
        return None
    return certificate


def _may_have_others(problem: Problem) -> bool:
    """Check whether several solutions may exist: friction softens, or bonds break.

    Which of them a run finds depends on its start.
    """
    for law in problem.contacts.laws.values():
        friction = law.tangential
        has_bonds = law.opens and bool(friction.bound.any())
        if friction.softens or has_bonds:
            return True
    return False
