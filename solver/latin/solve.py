"""Driver of the iteration to its end, with a record of every iterate."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from solver.discrete.problem import Problem
from solver.latin.end.certified import Answer
from solver.latin.end.status import CANCELLED, Decision, Ending, Status
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iteration import iterations
from solver.latin.method import Latin
from solver.latin.stages.blocks import one_blas_thread
from solver.latin.stop_rules import StopState
from solver.reference.assembly import never
from solver.reference.distance import Distance


@dataclass(frozen=True)
class Record:
    """Scalars of one iteration.

    Attributes
    ----------
    iteration
        Number of the iteration.
    seconds
        Time that the run took so far, with its set-up and its stop rules, s.
    indicator, behaviour
        LATIN indicator eta (paper, eq. 2), and the k-free indicator.
    estimated_error
        Relative error of the contact force, estimated without a reference; NaN where it
        is not estimated.
    error_displacement, error_force
        Relative L2 distance to the reference over space and time; NaN without one.
    modes
        Number of modes of every substructure; empty for full fields.
    is_answer
        Whether the iterate is an answer beside the iterations, as in `Answer`.
    """

    iteration: int
    seconds: float
    indicator: float
    behaviour: float
    estimated_error: float
    error_displacement: float
    error_force: float
    modes: tuple[int, ...] = ()
    is_answer: bool = False


@dataclass(frozen=True, eq=False)
class Solution:
    """Solution of a run: its last good iterate, its records, and its status."""

    iterate: Iterate
    records: list[Record]
    status: Status

    @property
    def is_certified(self) -> bool:
        """Check whether the iterate is a certified solution of the problem."""
        return isinstance(self.iterate, Answer)


def record(
    iterate: Iterate,
    verdict: Decision,
    distance: Distance | None,
    *,
    watch: bool = True,
) -> Record:
    """Scalars of an iterate; computing those for display alone is not run time.

    Parameters
    ----------
    iterate, verdict
        The iterate, and the decision of the stop rules on it.
    distance
        Distance to a reference, if there is one.
    watch
        Whether indicators and estimate are wanted though no stop rule needed them.
    """
    estimated = verdict.estimated_error
    if watch and math.isnan(estimated) and verdict.certificate is not None:
        estimated = verdict.certificate.distance.of_friction_force(iterate)
    # A stop rule that needed an indicator has left it with the iterate.
    known = vars(iterate)
    indicator = math.nan
    if watch or "indicator" in known:
        indicator = iterate.indicator
    violation = math.nan
    if watch or "violation" in known:
        violation = iterate.violation
    error_displacement = math.nan
    error_force = math.nan
    if distance:
        error_displacement = distance.of_displacement(iterate)
        error_force = distance.of_friction_force(iterate)
    return Record(
        iteration=iterate.number,
        seconds=verdict.seconds,
        indicator=indicator,
        behaviour=violation,
        estimated_error=estimated,
        error_displacement=error_displacement,
        error_force=error_force,
        modes=tuple(basis.n_modes for basis in iterate.bases),
        is_answer=isinstance(iterate, Answer) and iterate.is_beside,
    )


def judged(
    problem: Problem,
    latin: Latin,
    start: Checkpoint | None = None,
    spent: float = 0.0,
    interrupted: Callable[[], bool] = never,
) -> Iterator[tuple[Iterate, Decision]]:
    """Iterate, and judge every iterate by the stop rules.

    The generator continues though a decision says that the run ends. Where a status
    step holds, its certified solution is the last iterate.

    Parameters
    ----------
    problem, latin
        The problem to be solved, and the method.
    start
        State from which the run continues, as for `iterations`.
    spent
        Time that the run took before, to make the problem, s.
    interrupted
        Returns True where a status step is to be given up, so that the iterate before
        it is there at once.

    Yields
    ------
    Iterates, and the decisions on them.
    """
    rules = StopState(latin, spent, interrupted)
    for iterate in iterations(problem, latin, start):
        with one_blas_thread:
            verdict = rules.judge(iterate)
        yield iterate, verdict
        if verdict.finished is not None:
            yield verdict.finished
            return


def solve(
    problem: Problem,
    latin: Latin = Latin(),
    *,
    distance: Distance | None = None,
    start: Checkpoint | None = None,
    watch: bool = True,
    spent: float = 0.0,
    cancelled: Callable[[], bool] = never,
) -> Solution:
    """Drive the iteration until a stop rule ends it.

    Parameters
    ----------
    problem, latin, start, spent
        As for `judged`; by default the method is the fast one, from zero.
    distance
        Distance to a reference, for the errors in the records.
    watch
        Whether the records hold the indicators of every iteration.
    cancelled
        Returns True where the run is to end: called after every iteration, and before
        every linear system of a status step.
    """
    records: list[Record] = []
    last = None
    with one_blas_thread:
        for iterate, verdict in judged(problem, latin, start, spent, cancelled):
            status = verdict.status
            # A diverged iterate is no result: the one before is.
            if status is not None and status.ending is Ending.DIVERGED:
                return Solution(last or iterate, records, status)
            # The last record is that of the result, and is always complete.
            is_complete = watch or verdict.status is not None
            records.append(record(iterate, verdict, distance, watch=is_complete))
            last = iterate
            # A run that ends by itself in the same iteration has its own status.
            if status is None and cancelled():
                status = CANCELLED
            if status is not None:
                return Solution(iterate, records, status)
    raise AssertionError("the iteration has no end of its own")
