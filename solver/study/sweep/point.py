"""One run of a sweep, and some of them in a row: what the processes do, wherever they are."""

from __future__ import annotations

import json
import math
import platform
import time
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from solver.files import save_result
from solver.latin import Ending
from solver.refusal import RefusedError
from solver.study.quantities.finished import BROKEN, REFUSED, FinishedRun, finished_run
from solver.study.quantities.memory import settle
from solver.study.sweep.nearest import Nearest
from solver.study.sweep.plan import Plan, plan_from_plain

STUCK, LOST = "stuck", "lost"
"""How a run ends whose process was ended: by its time limit, or by something else."""
BUDGET = 0.25
"""Seconds after which a process says what it has done; the rest of its piece waits for the next."""


@dataclass(frozen=True)
class Row:
    """What came of one point.

    Attributes
    ----------
    number
        Of the point in the plan.
    ending
        `converged` and the other ways in which a run ends; `refused` where its settings do not fit
        together, `broken` where the engine failed, `stuck` and `lost` where its process was ended.
    reason
        Of any ending but convergence, and what to try.
    values
        Of the readings of the plan, in their units: NaN where the run has none, infinity for
        never. Those of a run that has not converged are what it had come to.
    iterations
        How many it did.
    seconds
        That the whole of it took, with its problem, its reference and its readings.
    was_warm
        Whether it started from the run nearest to it.
    """

    number: int
    ending: str
    reason: str
    values: tuple[float, ...]
    iterations: int = 0
    seconds: float = 0.0
    was_warm: bool = False

    @property
    def holds(self) -> bool:
        """Whether the run has converged, so that its values are answers."""
        return self.ending == Ending.CONVERGED


@dataclass(frozen=True)
class Piece:
    """Some points of a plan, for one process.

    Attributes
    ----------
    plan
        As JSON.
    limit
        Seconds that a run may take.
    fields
        Folder for the fields of every run, or None.
    warm
        Whether a run may start from the nearest one that its process has done.
    versions
        Of those who ask, which have to be those of who answers.
    """

    plan: str
    numbers: tuple[int, ...]
    limit: float
    fields: str | None
    warm: bool
    versions: str


def patience(limit: float) -> float:
    """Give the seconds after which a process that has a piece is stuck: no run ends itself."""
    return 1.5 * limit + 10.0


class VersionsDifferError(RuntimeError):
    """Who answers is not of the versions of who asks."""


@cache
def versions() -> str:
    """Name the versions of all that results depend on."""
    found = {name: version(name) for name in ("slipfront", "numpy", "scipy")}
    return ", ".join(f"{name} {one}" for name, one in found.items()) + (
        f", Python {platform.python_version()}"
    )


@cache
def _plan(text: str) -> Plan:
    return plan_from_plain(json.loads(text))


@lru_cache(maxsize=1)
def _nearest(text: str) -> Nearest:
    """Give what this process has done of a plan; what it has done of others is forgotten."""
    return Nearest(_plan(text).shape)


def run_piece(piece: Piece) -> list[Row]:
    """Run points in turn until the time budget is spent, but at least one.

    Returns
    -------
    Rows of the first points of the piece; the others wait for whoever asks again.

    Raises
    ------
    VersionsDifferError
        Where the results would be those of other code.
    """
    if piece.versions != versions():
        raise VersionsDifferError(f"it has {versions()}, and here are {piece.versions}")
    plan, rows = _plan(piece.plan), list[Row]()
    is_of_course = any(one.quantity.is_of_course for one in plan.readings)
    if is_of_course:
        settle()
    nearest = _nearest(piece.plan) if piece.warm and not is_of_course else None
    end = time.perf_counter() + BUDGET
    for number in piece.numbers:
        rows.append(_run(plan, number, piece.limit, piece.fields, nearest))
        if time.perf_counter() > end:
            break
    return rows


def run_point(plan: Plan, number: int, limit: float = math.inf, fields: str | None = None) -> Row:
    """Run one point to its end, whatever that is.

    Parameters
    ----------
    plan, number
        What to run.
    limit
        Seconds after which the run ends as it is.
    fields
        Folder, there already, for the run's fields.
    """
    return _run(plan, number, limit, fields, None)


def _run(plan: Plan, number: int, limit: float, fields: str | None, nearest: Nearest | None) -> Row:
    """Give the row of a point, which starts from the nearest run and is kept for others."""
    began = time.perf_counter()
    reads = {one.quantity.reads for one in plan.readings}
    # A run that diverges is told by its status.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        try:
            run = finished_run(
                plan.settings_at(number),
                errors="errors" in reads,
                indicators="indicators" in reads,
                cancelled=lambda: time.perf_counter() > began + limit,
                before=nearest.to(number) if nearest else None,
            )
            row = _row(plan, number, run, fields)
            if nearest and row.holds:
                nearest.keep(number, run.states)
        except RefusedError as refusal:
            row = nothing(plan, number, REFUSED, str(refusal))
        except Exception as trouble:  # whatever it is belongs in the table
            row = nothing(plan, number, BROKEN, f"{type(trouble).__name__}: {trouble}")
    return replace(row, seconds=time.perf_counter() - began)


def nothing(plan: Plan, number: int, ending: str, reason: str) -> Row:
    """Give the row of a point that has no values."""
    return Row(number, ending, reason, (math.nan,) * len(plan.readings))


def _row(plan: Plan, number: int, run: FinishedRun, fields: str | None) -> Row:
    if fields is not None:
        save_result(Path(fields) / field_file(number), run.settings, run.solution)
    values = tuple(float(reading(run)) for reading in plan.readings)
    return Row(number, *_ending(run), values, run.iterate.number, was_warm=run.was_warm)


def field_file(number: int) -> str:
    """Name the file of a point's fields."""
    return f"run-{number:05d}.npz"


def _ending(run: FinishedRun) -> tuple[str, str]:
    status = run.solution.status
    if status.ending is Ending.CONVERGED:
        return str(status.ending), ""
    if status.ending is Ending.CANCELLED:
        return STUCK, "It took longer than a run may; allow more with --limit."
    return str(status.ending), status.advice
