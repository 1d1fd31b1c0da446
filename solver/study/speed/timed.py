"""Time of LATIN and of the incremental solver, each from settings to result.

Nothing is kept of what was solved before, and no garbage is collected meanwhile, as with `timeit`:
to collect it bills all that the process holds. On a machine that others use too, seconds of the
processor say what seconds of the clock do not; what is set side by side is of one clock.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from solver.latin import Solution, solve
from solver.reference.choice import reference_of
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings

Clock = Callable[[], float]


@contextmanager
def nothing_collected() -> Iterator[None]:
    """Collect no garbage meanwhile."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def seconds_of(work: Callable[[], object], clock: Clock = time.process_time) -> float:
    """Time of some work, s; of the processor unless another clock is given."""
    with nothing_collected():
        start = clock()
        work()
        return clock() - start


def by_latin(settings: Settings) -> float:
    """Time of LATIN up to its stop rule, s."""
    return seconds_of(lambda: latin(settings))


def by_increments(settings: Settings, clock: Clock = time.process_time) -> float:
    """Time of the incremental solver, s."""
    return seconds_of(lambda: incremental(settings), clock)


def latin(settings: Settings) -> Solution:
    """Solve as the settings say, with nothing beside that the run does not need."""
    return solve(discretise(settings), method_of(settings), watch=False)


def incremental(settings: Settings) -> Reference:
    """Solve by increments."""
    return reference_of(discretise(settings))
