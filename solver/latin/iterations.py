"""The LATIN iteration as a generator (paper, Fig. 1; solver/README.md, 2)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

from solver.discrete.problem import Problem
from solver.latin.at_work import AtWork
from solver.latin.clock import Clock
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.method import Latin


def iterations(
    problem: Problem,
    latin: Latin,
    start: Checkpoint | None = None,
    *,
    resumable: bool = True,
) -> Iterator[Iterate]:
    """Iterate between the local and the linear stage, without end.

    Parameters
    ----------
    problem, latin
        What to solve, and the method.
    start
        Where to go on from; without one the method says where to start, and a body that contact
        alone holds where it comes to rest.
    resumable
        Whether iterates shall have checkpoints: what an acceleration remembers is kept for them,
        as much again as it holds itself.

    Yields
    ------
    Snapshots, one per iteration; the clock bills them too, and stands still while the consumer has
    one.
    """
    clock = Clock(start.seconds if start else 0.0)
    method = AtWork(problem, latin, start, clock)
    for number in count(start.number + 1 if start else 1):
        method.choose_direction()
        method.local_stage()
        method.linear_stage()
        clock.stop()
        yield method.snapshot(number, resumable=resumable)
        clock.go_on()
