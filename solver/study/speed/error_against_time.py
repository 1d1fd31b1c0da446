"""Errors of all methods against the time that they take, from settings to result.

Each method pays for what it needs: discretisation, factorisation, the coarser mesh, iterations. One
pass without the clock finds the errors, and warms up; then timed passes run every method once, in
turn, and the median of the passes counts. No error is computed while the clock of a pass runs.

Nothing is kept of what was solved before, and `timeit` collects no garbage meanwhile: to collect it
bills all that the process holds. On a machine that others use too, seconds of the
processor say what seconds of the clock do not; what is set side by side is of one clock.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import islice
from timeit import timeit
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.executors import machine
from solver.latin import Solution, judged, solve
from solver.reference.distance import Distance, distance_to
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings

LEVELS = {"10 %": 0.1, "1 %": 0.01, "0.1 %": 1e-3, "1e-6": 1e-6}
"""Errors of the friction force whose times make the table."""
GOAL = 1e-7
"""Error of the friction force at which an iteration ends."""
MOST_ITERATIONS = 600
PLAIN: dict[str, Any] = {
    "multiscale": True,
    "search_direction": "paper",
    "linear_stage": "full",
    "acceleration": "none",
    "start": "zero",
    "k_update": "none",
    "finish": "none",
}
"""Settings that the forms of LATIN start from; all others are those of the run."""
INCREMENTAL, FAST = "incremental solver", "LATIN fast"
Clock = Callable[[], float]


@dataclass(frozen=True, eq=False)
class ErrorCurve:
    """What a method reaches, and when.

    Attributes
    ----------
    method
        What it is called.
    steps
        Iterations done, or Newton steps of the incremental solver, shape (n,).
    seconds
        Time from settings to result, medians of the passes, shape (n,).
    error_displacement, error_force
        Relative L2 distances to the incremental reference, shape (n,); 0 by definition for itself.
    """

    method: str
    steps: Array
    seconds: Array
    error_displacement: Array
    error_force: Array

    @property
    def is_latin(self) -> bool:
        """Whether it is a form of LATIN."""
        return self.method != INCREMENTAL

    @property
    def seconds_per_iteration(self) -> float | None:
        """Median time between two iterations; None for a method that has none."""
        if not self.is_latin or len(self.seconds) < 2:
            return None
        return float(np.median(np.diff(self.seconds)))

    def reached(self, level: float) -> tuple[float, float] | None:
        """Least time at which the friction force is so near, and the step it was."""
        near = np.flatnonzero(self.error_force <= level)
        if not len(near):
            return None
        first = near[self.seconds[near].argmin()]
        return float(self.seconds[first]), float(self.steps[first])


@dataclass(frozen=True, eq=False)
class Study:
    """Curves of all methods on one scene, and under which conditions they were measured.

    Attributes
    ----------
    settings
        The scene; the forms of LATIN change what `forms_of` says.
    repeats
        Timed passes.
    machine
        Processors, BLAS threads, versions.
    curves
        One per method that ran.
    """

    settings: Settings
    repeats: int
    machine: str
    curves: tuple[ErrorCurve, ...]


def error_against_time(settings: Settings, repeats: int) -> Study:
    """Run every method `repeats` times, at least once, in turns."""
    problem = discretise(settings)
    reference = reference_of(problem)
    distance = distance_to(reference, problem)
    forms = forms_of(settings)
    errors = {method: _errors(form, distance) for method, form in forms.items()}
    steps = {method: np.arange(1.0, len(own) + 1.0) for method, own in errors.items()}
    errors[INCREMENTAL], steps[INCREMENTAL] = np.zeros((1, 2)), np.array([float(reference.steps)])
    samples: dict[str, list[list[float]]] = {method: [] for method in errors}

    def iterate(method: str) -> None:
        samples[method].append(_by_iterations(forms[method], len(errors[method])))

    for _ in range(repeats):
        for method in forms:
            seconds_of(partial(iterate, method))
        seconds = seconds_of(partial(incremental, settings), time.perf_counter)
        samples[INCREMENTAL].append([seconds])
    curves = (
        ErrorCurve(method, steps[method], np.median(times, axis=0), *errors[method].T)
        for method, times in samples.items()
    )
    return Study(settings, repeats, machine(), tuple(curves))


def forms_of(settings: Settings) -> dict[str, Settings]:
    """Settings of every form of LATIN that a scene has, by name; nested where it has a start so."""
    is_nested = settings.applies("start")
    auto = {"search_direction": "auto", **({"start": "nested"} if is_nested else {})}
    anderson = {**auto, "acceleration": "anderson"}
    name = "LATIN auto k, nested" if is_nested else "LATIN auto k"
    forms: dict[str, dict[str, Any]] = {
        "LATIN monoscale": {"multiscale": False},
        "LATIN multiscale": {},
        name: auto,
        f"{name}, Anderson": anderson,
        f"{name}, Anderson, k updated": {**anderson, "k_update": "status"},
        FAST: {**anderson, "finish": "at-once"},
        "LATIN PGD": {"linear_stage": "pgd", **({} if is_nested else auto)},
    }
    return {method: settings.replace(**{**PLAIN, **form}) for method, form in forms.items()}


def _errors(settings: Settings, distance: Distance) -> Array:
    """Errors of both fields, (n, 2), until the friction force is as near as the goal."""
    errors: list[tuple[float, float]] = []
    for iterate, _ in islice(judged(discretise(settings), method_of(settings)), MOST_ITERATIONS):
        force = distance.of_friction_force(iterate)
        errors.append((distance.of_displacement(iterate), force))
        if not math.isfinite(force) or (force <= GOAL and iterate.number > 1):
            break
    return np.array(errors)


def _by_iterations(settings: Settings, number: int) -> list[float]:
    """Time after every iteration, with all that the run needs to end, and discretising."""
    start = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - start
    decisions = islice(judged(problem, method_of(settings), None, spent), number)
    return [decision.seconds for _, decision in decisions]


def seconds_of(work: Callable[[], object], clock: Clock = time.process_time) -> float:
    """Time of some work, s; of the processor unless another clock is given."""
    return timeit(work, timer=clock, number=1)


def latin(settings: Settings) -> Solution:
    """Solve as the settings say, with nothing beside that the run does not need."""
    return solve(discretise(settings), method_of(settings), watch=False)


def incremental(settings: Settings) -> Reference:
    """Solve by increments."""
    return reference_of(discretise(settings))
