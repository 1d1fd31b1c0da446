"""LATIN and the incremental solver, each from settings to result, in seconds of the processor.

Nothing is kept of what was solved before, and no garbage is collected meanwhile, as with `timeit`:
to collect it bills all that the process holds. On a machine that others use too, seconds of the
processor say what seconds of the clock do not.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable

from solver.latin import Solution, solve
from solver.reference.choice import reference_of
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings


def by_latin(settings: Settings) -> float:
    """Give the time of LATIN up to its stop rule, s."""
    return _seconds(latins, settings)


def by_increments(settings: Settings) -> float:
    """Give the time of the incremental solver, s."""
    return _seconds(incremental, settings)


def _seconds(solver: Callable[[Settings], object], settings: Settings) -> float:
    was_on = gc.isenabled()
    gc.disable()
    try:
        start = time.process_time()
        solver(settings)
        return time.process_time() - start
    finally:
        if was_on:
            gc.enable()


def latins(settings: Settings) -> Solution:
    """Solve as the settings say, with nothing beside that the run does not need."""
    return solve(discretise(settings), method_of(settings), watch=False)


def incremental(settings: Settings) -> Reference:
    """Solve by increments."""
    return reference_of(discretise(settings))
