"""LATIN and the incremental solver, each from settings to result, in seconds of the processor.

Nothing is kept of what was solved before. On a machine that others use too, seconds of the
processor say what seconds of the clock do not.
"""

from __future__ import annotations

import gc
import time

from solver.latin import Solution, solve
from solver.reference.choice import reference_of
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings


def by_latin(settings: Settings) -> float:
    """Give the time of LATIN up to its stop rule, s."""
    gc.collect()
    start = time.process_time()
    latins(settings)
    return time.process_time() - start


def by_increments(settings: Settings) -> float:
    """Give the time of the incremental solver, s."""
    gc.collect()
    start = time.process_time()
    incremental(settings)
    return time.process_time() - start


def latins(settings: Settings) -> Solution:
    """Solve as the settings say, with nothing beside that the run does not need."""
    return solve(discretise(settings), method_of(settings), watch=False)


def incremental(settings: Settings) -> Reference:
    """Solve by increments."""
    return reference_of(discretise(settings))
