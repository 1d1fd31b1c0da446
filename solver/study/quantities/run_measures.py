"""Quantities of how a run went: iterations, time, memory, indicators and errors."""

from __future__ import annotations

import math
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Literal

import numpy as np

from solver.checked import dump
from solver.executors import ONE_THREAD
from solver.files import settings_from_toml
from solver.latin import Ending
from solver.settings import Settings
from solver.study.quantities.finished import FinishedRun, finished_run, settle
from solver.study.quantities.quantity import WITHIN, Parameter, Quantity, quantity

ITERATION = Parameter(" at iteration {:g}", (1, 1_000_000))
STATUS = Path("/proc/self/status")
PROGRAM = f"import sys\nfrom {__name__} import growth\nprint(growth(sys.stdin.read()))"
ROOT = Path(__file__).resolve().parents[3]


def _record(
    column: str, title: str, reads: Literal["errors", "indicators"], *, is_share: bool = False
) -> Quantity:
    """Scalar of the records, at an iteration or at the end."""

    def of(run: FinishedRun, at: float | None) -> float:
        records = run.solution.records
        if at is not None:
            records = [entry for entry in records if entry.iteration == at]
        return float(getattr(records[-1], column)) if records else math.nan

    return Quantity(
        column, title, "", of, None, ITERATION, reads=reads, is_share=is_share, is_of_course=True
    )


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
    return Quantity(name, full, unit, of, None, WITHIN, reads="errors", is_of_course=True)


@quantity("Iterations", is_of_course=True)
def iterations(run: FinishedRun) -> float:
    """Number of iterations."""
    return run.iterate.iterations


@quantity("Run time", "s", is_of_course=True)
def seconds(run: FinishedRun) -> float:
    """Time of the whole run, s."""
    records = run.solution.records
    return records[-1].seconds if records else math.nan


@quantity("Whether it converged", is_of_course=True)
def converged(run: FinishedRun) -> float:
    """1 where the run came to its stop rule, 0 where something else ended it."""
    return float(run.solution.status.ending is Ending.CONVERGED)


@quantity("Run time of an iteration", "s", is_of_course=True)
def seconds_per_iteration(run: FinishedRun) -> float:
    """Median time between two iterations, s; that of the only one with its set-up."""
    times = [entry.seconds for entry in run.solution.records]
    return float(np.median(np.diff(times) if len(times) > 1 else times or [math.nan]))


@quantity("Memory at its peak", "B", is_of_course=True)
def memory(run: FinishedRun) -> float:
    """Memory that the run takes, B."""
    return memory_of(run.settings)


def memory_of(settings: Settings) -> float:
    """Memory that a run takes, B; NaN where the operating system tells none (not Linux).

    That is by how much the resident memory of a process of its own grows at most in one run more:
    what Python counts would leave out what sparse factorisations take.
    """
    if not STATUS.exists():
        return math.nan
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        input=dump(settings),
        env=os.environ | ONE_THREAD | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return float(done.stdout)


def growth(text: str) -> int:
    """Memory that a run of settings, in TOML, takes in this process, B."""
    settings = settings_from_toml(text)
    settle()
    before = resident("VmRSS")
    finished_run(settings, errors=False, indicators=False)
    return resident("VmHWM") - before


def resident(name: str) -> int:
    """A line of what the operating system says of this process, B."""
    line = re.search(rf"^{name}:\s+(\d+) kB$", STATUS.read_text(encoding="ascii"), re.MULTILINE)
    if line is None:
        raise LookupError(name)
    return 1024 * int(line[1])


indicator = _record("indicator", "LATIN indicator", "indicators")
behaviour = _record("behaviour", "k-free indicator", "indicators")
estimated_error = _record(
    "estimated_error", "Estimated error of the contact force", "indicators", is_share=True
)
error_displacement = _record(
    "error_displacement", "Error of the displacement", "errors", is_share=True
)
error_force = _record("error_force", "Error of the contact force", "errors", is_share=True)
_FIELDS = ("displacement", "displacement"), ("force", "contact force")
iterations_to_displacement, iterations_to_force = (
    _until("iteration", "Iterations", "", *field) for field in _FIELDS
)
seconds_to_displacement, seconds_to_force = (
    _until("seconds", "Run time", "s", *field) for field in _FIELDS
)
