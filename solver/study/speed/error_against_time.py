"""Errors of all methods against the time that they take, from settings to result.

Each method pays for what it needs: discretisation, factorisation, the coarser mesh, iterations. One
pass without the clock finds the errors, and warms up; then timed passes run every method once, in
turn, and the median of the passes counts. No error is computed while the clock of a pass runs.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.executors import machine
from solver.latin import judged
from solver.reference.choice import reference_of
from solver.reference.distance import Distance, distance_to
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.speed.timed import by_increments, nothing_collected

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
INCREMENTAL = "incremental solver"


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
    def kind(self) -> str:
        """Whose it is: "latin" or "incremental"."""
        return "incremental" if self.method == INCREMENTAL else "latin"

    @property
    def seconds_per_iteration(self) -> float | None:
        """Median time between two iterations; None for a method that has none."""
        if self.kind != "latin" or len(self.seconds) < 2:
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


@dataclass(frozen=True, eq=False)
class _Entry:
    """A method's errors and steps, and how to time it again."""

    method: str
    steps: list[float]
    errors: list[tuple[float, float]]
    timed: Callable[[], list[float]]


def error_against_time(settings: Settings, repeats: int) -> Study:
    """Run every method `repeats` times, in turns.

    Parameters
    ----------
    settings
        Checked settings of a scene.
    repeats
        Timed passes, at least 1.
    """
    problem = discretise(settings)
    reference = reference_of(problem)
    distance = distance_to(reference, problem)
    entries = [_latin_entry(method, form, distance) for method, form in forms_of(settings).items()]
    steps = [float(reference.steps)]
    entries.append(
        _Entry(
            INCREMENTAL, steps, [(0.0, 0.0)], lambda: [by_increments(settings, time.perf_counter)]
        )
    )
    samples: list[list[list[float]]] = [[] for _ in entries]
    for _ in range(repeats):
        for entry, times in zip(entries, samples, strict=True):
            with nothing_collected():
                times.append(entry.timed())
    curves = [_curve(entry, times) for entry, times in zip(entries, samples, strict=True)]
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
        "LATIN fast": {**anderson, "finish": "at-once"},
        "LATIN PGD": {"linear_stage": "pgd", **({} if is_nested else auto)},
    }
    return {method: settings.replace(**{**PLAIN, **form}) for method, form in forms.items()}


def _latin_entry(method: str, settings: Settings, distance: Distance) -> _Entry:
    """Find the errors of a form of LATIN, until its friction force is as near as the goal."""
    errors: list[tuple[float, float]] = []
    for iterate, _ in islice(judged(discretise(settings), method_of(settings)), MOST_ITERATIONS):
        errors.append((distance.of_displacement(iterate), distance.of_friction_force(iterate)))
        force = errors[-1][1]
        if not math.isfinite(force) or (force <= GOAL and iterate.number > 1):
            break
    steps = [float(number) for number in range(1, len(errors) + 1)]
    return _Entry(method, steps, errors, lambda: _by_iterations(settings, len(steps)))


def _by_iterations(settings: Settings, number: int) -> list[float]:
    """Time after every iteration, with all that the run needs to end, and discretising."""
    start = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - start
    return [
        verdict.seconds
        for _, verdict in islice(judged(problem, method_of(settings), None, spent), number)
    ]


def _curve(entry: _Entry, times: list[list[float]]) -> ErrorCurve:
    displacement, force = np.array(entry.errors).T
    return ErrorCurve(
        method=entry.method,
        steps=np.array(entry.steps),
        seconds=np.median(np.array(times), axis=0),
        error_displacement=displacement,
        error_force=force,
    )
