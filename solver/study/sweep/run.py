"""The runs of a sweep: a point in a process, and rows in order of completion."""

from __future__ import annotations

import math
import platform
import time
import uuid
from collections import deque
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)
from dataclasses import replace
from functools import cache, partial
from importlib.metadata import version
from itertools import islice

import numpy as np

from solver.latin import Ending
from solver.latin.end.status_step import states_of
from solver.reference.assembly import never
from solver.reference.rules import States
from solver.refusal import RefusedError
from solver.settings.values import SettingError
from solver.study.quantities.finished import FinishedRun
from solver.study.scene_run import BROKEN, REFUSED, finished_run, warm_up
from solver.study.sweep.plan import LOST, STUCK, Plan, Row

WORKER = "versions of a worker"
TOO_LONG = "It took longer than a run may; allow more with --limit."
KEPT = 500
"""Runs that a process keeps to start others from: a dozen lines of a chart of 41 x 41.

With the default sizes of the scenes each takes 5 to 30 kB."""
_kept: dict[str, deque[tuple[tuple[float, ...], States]]] = {}
"""Points of the runs of this process in the last sweep, and their states."""
AHEAD = 500
"""Runs submitted at once: more than there are workers, and soon submitted."""
PATIENCE = 0.2
"""Seconds between two looks at whether a sweep is still wanted."""


@cache
def versions() -> str:
    """Versions of Python and of the packages that results depend on."""
    packages = [f"{name} {version(name)}" for name in ("slipfront", "numpy", "scipy")]
    return ", ".join([*packages, platform.python_version()])


def run(
    plan: Plan, limit: float, warm: bool, sweep: str, asked_by: str, number: int
) -> Row:
    """Run a point of a plan in this process.

    Parameters
    ----------
    plan, limit, warm
        Plan and options, as of `sweep`.
    sweep
        Name of the sweep, which no other sweep has.
    asked_by
        Versions of the process that asks. Others than those of this process are
        refused, since the result would be that of other code.
    number
        Number of the point.
    """
    if asked_by != versions():
        raise SettingError(WORKER, versions(), asked_by, "install these on all workers")
    if any(reading.reads for reading in plan.quantities):
        warm_up()
    began = time.perf_counter()
    nothing = (math.nan,) * len(plan.of)
    # The status of a run says that it diverges: NumPy need not warn of it.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        try:
            finished = _from_nearest(plan, sweep, number, warm, began + limit)
            row = _row_of(plan, number, finished)
        except RefusedError as refusal:
            row = Row(number, REFUSED, str(refusal), nothing)
        except Exception as trouble:  # any fault of the engine belongs in the table
            row = Row(number, BROKEN, f"{type(trouble).__name__}: {trouble}", nothing)
    return replace(row, seconds=time.perf_counter() - began)


def _row_of(plan: Plan, number: int, finished: FinishedRun) -> Row:
    """Row of a finished run, without its time."""
    values = tuple(reading(finished) for reading in plan.quantities)
    status = finished.solution.status
    ending = str(status.ending)
    reason = status.advice
    if status.ending is Ending.CANCELLED:
        ending = STUCK
        reason = TOO_LONG
    elif status.ending is Ending.CONVERGED:
        reason = ""
    return Row(
        number=number,
        ending=ending,
        reason=reason,
        values=values,
        iterations=finished.iterate.number,
        was_warm=finished.was_warm,
    )


def _from_nearest(
    plan: Plan, sweep: str, number: int, warm: bool, end: float
) -> FinishedRun:
    """Run a point from the states of the nearest run of this process; store states."""
    # States of an earlier sweep are no start for this one.
    if sweep not in _kept:
        _kept.clear()
    kept = _kept.setdefault(sweep, deque(maxlen=KEPT))
    # Distance on the grid, as settings have units of their own.
    point = tuple(np.unravel_index(number, plan.shape) / np.array(plan.shape))
    before = None
    if kept:
        _, before = min(list(kept), key=lambda other: math.dist(point, other[0]))
    reads = {reading.reads for reading in plan.quantities}
    finished = finished_run(
        plan.settings_at(number),
        errors="errors" in reads,
        indicators="indicators" in reads,
        cancelled=lambda: time.perf_counter() > end,
        before=before,
    )
    # States of a run that has not converged would mislead its neighbours.
    if warm and finished.solution.status.ending is Ending.CONVERGED:
        kept.append((point, states_of(finished.iterate)))
    return finished


def longest_wait(limit: float) -> float:
    """Time, s, after which the process of a run that does not end is ended."""
    return 1.5 * limit + 10.0


def sweep(
    plan: Plan,
    executor: Executor,
    *,
    done: Collection[int] = (),
    limit: float = math.inf,
    warm: bool = True,
    cancelled: Callable[[], bool] = never,
) -> Iterator[Row]:
    """Run the points of a plan in an order from neighbour to neighbour.

    Parameters
    ----------
    plan
        Plan of the sweep.
    executor
        Executor of the runs.
    done
        Numbers of points that are left out.
    limit
        Time that a run may take, s.
    warm
        Whether runs start from the nearest one; no run does so where a reading depends
        on the course of a run.
    cancelled
        Asked several times a second whether to end the sweep.

    Yields
    ------
    Rows, one for every point, in any order. Closing the generator ends the sweep: runs
    that have not begun are left out, and runs in processes of this machine are ended.

    Raises
    ------
    SettingError
        Where a worker's results would be those of other code.
    BrokenExecutor
        Where the executor does no more calls; the same sweep can continue in another.
    """
    warm = warm and not any(reading.reads for reading in plan.quantities)
    call = partial(run, plan, limit, warm, uuid.uuid4().hex, versions())
    path = (number for number in snake(plan.shape) if number not in done)
    under_way: dict[Future[Row], int] = {}
    try:
        while not cancelled():
            # Calls are submitted as others end, so that a sweep can end soon.
            for number in islice(path, AHEAD - len(under_way)):
                under_way[executor.submit(call, number)] = number
            if not under_way:
                return
            for future in wait(under_way, PATIENCE, FIRST_COMPLETED).done:
                yield _row(future, under_way.pop(future), len(plan.of))
    finally:
        for future in under_way:
            future.cancel()


def snake(shape: Sequence[int]) -> list[int]:
    """Indices of the points of a grid in an order from neighbour to neighbour."""
    grid = np.arange(math.prod(shape)).reshape(-1, shape[-1])
    grid[1::2] = grid[1::2, ::-1]
    return [int(number) for number in grid.ravel()]


def _row(future: Future[Row], number: int, n_values: int) -> Row:
    """Row of a run, also of a run whose process was ended."""
    try:
        return future.result()
    except (SettingError, BrokenExecutor):
        raise
    except ImportError as trouble:
        raise SettingError(
            WORKER, "others", versions(), f"it cannot run this: {trouble}"
        ) from None
    except CancelledError:
        raise BrokenExecutor("the executor does not answer any more") from None
    except TimeoutError:
        ending = STUCK
        reason = TOO_LONG
    except Exception as trouble:
        why = f"{type(trouble).__name__}: {trouble}"
        ending = LOST
        reason = f"Its process was ended ({why}); the same sweep tries it again."
    return Row(number, ending, reason, (math.nan,) * n_values)
