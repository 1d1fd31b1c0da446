"""Quantities of the course of a run: iterations, time, indicators and errors."""

from __future__ import annotations

import math
from typing import Literal

from solver.latin import Ending
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import WITHIN, Parameter, Quantity, quantity

ITERATION = Parameter(" at iteration {:g}", (1, 1_000_000))


def _record(
    column: str,
    title: str,
    reads: Literal["errors", "indicators"],
    *,
    is_share: bool = False,
) -> Quantity:
    """Quantity of a scalar of the records: at an iteration, or at the end."""

    def of(run: FinishedRun, at: float | None) -> float:
        records = run.solution.records
        if at is not None:
            records = [entry for entry in records if entry.iteration == at]
        if records:
            return float(getattr(records[-1], column))
        return math.nan

    return Quantity(
        column, title, "", of, None, ITERATION, reads=reads, is_share=is_share
    )


def _until(spent: Literal["iterations", "seconds"], field: str, words: str) -> Quantity:
    """Quantity of iterations or seconds until the error of a field meets a level."""

    def of(run: FinishedRun, at: float | None) -> float:
        records = run.solution.records
        errors = [getattr(entry, f"error_{field}") for entry in records]
        if all(math.isnan(error) for error in errors):
            return math.nan
        for entry, error in zip(records, errors, strict=True):
            if error <= (at or 0.0) and not entry.is_answer:
                if spent == "seconds":
                    return float(entry.seconds)
                return float(entry.iteration)
        return math.inf

    if spent == "seconds":
        title = "Run time"
        unit = "s"
    else:
        title = "Iterations"
        unit = ""
    return Quantity(
        name=f"{spent}_to_{field}",
        title=f"{title} to an error of the {words} of",
        unit=unit,
        of=of,
        parameter=WITHIN,
        reads="errors",
    )


@quantity("Iterations", reads="course")
def iterations(run: FinishedRun) -> float:
    """Number of iterations."""
    return run.iterate.iterations


@quantity("Run time", "s", reads="course")
def seconds(run: FinishedRun) -> float:
    """Time of the whole run, s."""
    records = run.solution.records
    if records:
        return records[-1].seconds
    return math.nan


@quantity("Whether it converged", reads="course")
def converged(run: FinishedRun) -> float:
    """1 for a converged run, else 0."""
    return float(run.solution.status.ending is Ending.CONVERGED)


indicator = _record("indicator", "LATIN indicator", "indicators")
behaviour = _record("behaviour", "k-free indicator", "indicators")
estimated_error = _record(
    "estimated_error",
    "Estimated error of the contact force",
    "indicators",
    is_share=True,
)
error_displacement = _record(
    "error_displacement", "Error of the displacement", "errors", is_share=True
)
error_force = _record(
    "error_force", "Error of the contact force", "errors", is_share=True
)
iterations_to_displacement = _until("iterations", "displacement", "displacement")
iterations_to_force = _until("iterations", "force", "contact force")
seconds_to_displacement = _until("seconds", "displacement", "displacement")
seconds_to_force = _until("seconds", "force", "contact force")
