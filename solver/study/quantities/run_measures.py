"""Quantities of how a run went: iterations, time, memory, indicators and errors."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np

from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.memory import memory_of
from solver.study.quantities.quantity import WITHIN, Parameter, Quantity, quantity

ITERATION = Parameter(" at iteration {:g}", (1, 1_000_000), whole=True)


def _recorded(column: str) -> Callable[[FinishedRun, float | None], float]:
    def of(run: FinishedRun, at: float | None) -> float:
        records = run.solution.records
        if at is not None:
            records = [entry for entry in records if entry.iteration == at]
        return float(getattr(records[-1], column)) if records else math.nan

    return of


def _record(
    column: str, title: str, reads: Literal["errors", "indicators"], *, is_share: bool = True
) -> Quantity:
    """Scalar of the records, at an iteration or at the end."""
    return Quantity(column, title, "", _recorded(column), ITERATION, reads, is_share, True)


def _until(column: str, title: str, unit: str, field: str, words: str) -> Quantity:
    """What a run spends until an error is as small as it is asked to be."""

    def of(run: FinishedRun, at: float | None) -> float:
        errors = [(entry, getattr(entry, f"error_{field}")) for entry in run.solution.records]
        if all(math.isnan(error) for _, error in errors):
            return math.nan
        for entry, error in errors:
            if error <= (at or 0.0) and not entry.is_answer:
                return float(getattr(entry, column))
        return math.inf

    name = f"{'iterations' if column == 'iteration' else column}_to_{field}"
    full = f"{title} to an error of the {words} of"
    return Quantity(name, full, unit, of, WITHIN, "errors", is_of_course=True)


@quantity("Iterations", is_of_course=True)
def iterations(run: FinishedRun) -> float:
    """Number of iterations."""
    return run.iterate.iterations


@quantity("Run time", "s", is_of_course=True)
def seconds(run: FinishedRun) -> float:
    """Time of the whole run, s."""
    return _recorded("seconds")(run, None)


@quantity("Run time of an iteration", "s", is_of_course=True)
def seconds_per_iteration(run: FinishedRun) -> float:
    """Median time between two iterations, s; that of the only one with its set-up."""
    times = [entry.seconds for entry in run.solution.records]
    return float(np.median(np.diff(times) if len(times) > 1 else times or [math.nan]))


@quantity("Memory at its peak", "B", is_of_course=True)
def memory(run: FinishedRun) -> float:
    """Memory that the run takes, B, which takes another run; NaN where none is told."""
    return memory_of(run.settings)


indicator = _record("indicator", "LATIN indicator", "indicators", is_share=False)
behaviour = _record("behaviour", "k-free indicator", "indicators", is_share=False)
estimated_error = _record("estimated_error", "Estimated error of the contact force", "indicators")
error_displacement = _record("error_displacement", "Error of the displacement", "errors")
error_force = _record("error_force", "Error of the contact force", "errors")
_FIELDS = ("displacement", "displacement"), ("force", "contact force")
iterations_to_displacement, iterations_to_force = (
    _until("iteration", "Iterations", "", *field) for field in _FIELDS
)
seconds_to_displacement, seconds_to_force = (
    _until("seconds", "Run time", "s", *field) for field in _FIELDS
)
