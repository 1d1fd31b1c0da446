"""Which incremental solver a problem calls for."""

from __future__ import annotations

from collections.abc import Callable

from solver.discrete.problem import Problem
from solver.laws import Friction
from solver.reference.contact import incremental_contact
from solver.reference.incremental import Reference, incremental


def reference_of(problem: Problem, stop: Callable[[], bool] | None = None) -> Reference:
    """Solve a problem instant by instant, by the solver that its interfaces call for.

    Parameters
    ----------
    problem
        A structure with at least one interface with friction.
    stop
        Called once per instant; `Interrupted` is raised as soon as it gives True.
    """
    laws = list(problem.rubbing.values())
    alone = len(laws) == 1 and isinstance(laws[0], Friction) and laws[0].below is None
    return incremental(problem, stop) if alone else incremental_contact(problem, stop)
