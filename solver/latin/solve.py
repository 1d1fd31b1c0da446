"""Driving the iteration to an end, with a record of every iterate."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from solver.discrete.problem import Problem
from solver.latin.end.status import CANCELLED, Decision, Ending, Status
from solver.latin.end.stop import StopState
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iteration import iterations
from solver.latin.method import Latin
from solver.latin.stages.blocks import one_blas_thread
from solver.reference.distance import Distance


@dataclass(frozen=True)
class Record:
    """The scalars of one iteration; an error is NaN while no reference is at hand.

    Attributes
    ----------
    seconds
        Time that the run took so far, s: set-up, iterations, and all that its stop
        rules compute.
    indicator, behaviour
        LATIN indicator eta (paper, eq. 2), and the k-free indicator.
    estimated_error
        Of the contact force, relative, without a reference; NaN where it is not
        estimated.
    error_displacement, error_force
        Relative L2 distance to the reference over space and time.
    modes
        Of the separated basis of every substructure; empty without bases.
    is_answer
        As in `Iterate`.
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
    """The last good iterate of a run, its records, and how it ended."""

    iterate: Iterate
    records: list[Record]
    status: Status

    @property
    def is_certified(self) -> bool:
        """Whether a status step ended it with the solution of the discrete problem."""
        return self.iterate.residual is not None


def record(
    iterate: Iterate,
    verdict: Decision,
    distance: Distance | None,
    *,
    watch: bool = True,
) -> Record:
    """The scalars of an iterate; what the rules did not need is off the run's clock.

    `watch` says whether anybody wants indicators and estimate of every iteration, not
    only of that at which a run ends.
    """
    estimated = verdict.estimated_error
    watch = watch or verdict.status is not None
    known = vars(iterate)  # that is, computed for the stop rules
    if watch and math.isnan(estimated) and verdict.certificate is not None:
        estimated = verdict.certificate.distance.of_friction_force(iterate)
    return Record(
        iteration=iterate.number,
        seconds=verdict.seconds,
        indicator=iterate.indicator if watch or "indicator" in known else math.nan,
        behaviour=iterate.behaviour if watch or "behaviour" in known else math.nan,
        estimated_error=estimated,
        error_displacement=distance.of_displacement(iterate) if distance else math.nan,
        error_force=distance.of_friction_force(iterate) if distance else math.nan,
        modes=tuple(basis.n_modes for basis in iterate.bases),
        is_answer=iterate.is_answer,
    )


def judged(
    problem: Problem,
    latin: Latin,
    start: Checkpoint | None = None,
    spent: float = 0.0,
    interrupted: Callable[[], bool] = lambda: False,
) -> Iterator[tuple[Iterate, Decision]]:
    """Iterate, and judge every iterate; where a status step holds, the last one is its solution.

    It goes on though a verdict says that the run ends. The run took `spent` seconds
    before, to make the problem. Where `interrupted` returns True a status step is given
    up, so that the iterate before it is there at once.
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
    cancelled: Callable[[], bool] = lambda: False,
) -> Solution:
    """Drive the iteration until a stop rule ends it.

    Parameters
    ----------
    problem, latin, start, spent
        As for `judged`; the method is the fast one by default, from zero.
    distance
        To a reference, for the errors in the records.
    watch
        Whether the records shall hold the indicators of every iteration.
    cancelled
        Asked after every iteration, and before every linear system of a status step.
    """
    records: list[Record] = []
    last = None
    with one_blas_thread:
        for iterate, verdict in judged(problem, latin, start, spent, cancelled):
            status = verdict.status
            if status is not None and status.ending is Ending.DIVERGED:
                return Solution(last or iterate, records, status)
            records.append(record(iterate, verdict, distance, watch=watch))
            last = iterate
            if status is None and cancelled():
                status = CANCELLED
            if status is not None:
                return Solution(iterate, records, status)
    raise AssertionError("the iteration has no end of its own")
