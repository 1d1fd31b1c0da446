"""Which incremental solver a problem calls for."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from solver.discrete.problem import Problem
from solver.reference.condensation import NoReferenceError
from solver.reference.contact import IncrementalContact
from solver.reference.incremental import IncrementalRod, rubs_on_supports
from solver.reference.solution import Reference, States


class Incremental(Protocol):
    """An incremental solver, ready to march through time."""

    def march(
        self,
        guess: States | None = None,
        most: int | None = None,
        stop: Callable[[], bool] | None = None,
    ) -> Reference:
        """Solve instant by instant, as `IncrementalRod.march` and its like say."""


def reference_of(problem: Problem, stop: Callable[[], bool] | None = None) -> Reference:
    """Solve a problem instant by instant, by the solver that its interfaces call for.

    Parameters
    ----------
    problem
        A structure with at least one interface with friction.
    stop
        Called once per instant; `Interrupted` is raised as soon as it returns True.
    """
    start = time.perf_counter()
    solution = incremental_solver(problem).march(stop=stop)
    return replace(solution, seconds=time.perf_counter() - start)


def incremental_solver(problem: Problem) -> Incremental:
    """Prepare the solver that the interfaces of a problem call for.

    Raises
    ------
    NoReferenceError
        If there is none, or the problem goes on from where another ends.
    """
    if any(law.tangential.start is not None for law in problem.rubbing.values()):
        raise NoReferenceError("Incremental solvers begin where nothing has slipped yet.")
    return IncrementalRod(problem) if rubs_on_supports(problem) else IncrementalContact(problem)
