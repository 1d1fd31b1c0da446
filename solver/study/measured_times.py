"""Times of all methods from settings to result: errors against them, and who is first where.

Each method pays for what it needs: discretisation, factorisation, the coarser mesh,
iterations. One pass without the clock finds the errors, and warms up; then timed passes
run every method once, in turn, and the median of the passes counts. No error is
computed while the clock of a pass runs.

Nothing is kept of what was solved before, and `timeit` collects no garbage meanwhile:
to collect it bills all that the process holds. What is set side by side is of one
clock, the processor's or not.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import islice, product
from timeit import timeit
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.latin import Ending, Solution, judged, solve
from solver.latin.end.cost import run_cost
from solver.reference.assembly import NoReferenceError
from solver.reference.distance import Distance, distance_to
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings.definitions import SettingError
from solver.settings.scene import Settings

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
FACTORS = (0.5, 1.0, 2.0)
"""On the sizes and on the instants of the settings."""
LARGE = (*FACTORS, 4.0, 8.0)
"""On the sizes, where minutes do not matter."""
LONGEST = 10.0
LONGEST_OF_LARGE = 600.0
"""Seconds from which, by estimate, a size is left out."""
REPEATS = 3
SLOW = 1.0
"""Seconds from which one run is enough."""
INCREMENTAL = "incremental solver"
FAST = "LATIN fast"


@dataclass(frozen=True, eq=False)
class ErrorCurve:
    """What a method reaches, and when.

    Steps are iterations done, or Newton steps of the incremental solver; seconds the
    time from settings to there, medians of the passes; errors the relative L2 distances
    to the incremental reference, 0 for itself. All have shape (n,).
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
        """Time from which on the friction force has been so near, and the step it was."""
        near = self.error_force <= level
        first = near.argmax()
        if near[first]:
            return (float(self.seconds[first]), float(self.steps[first]))
        return None


def error_against_time(settings: Settings, repeats: int) -> list[ErrorCurve]:
    """Run every method `repeats` times, at least once, in turns; a curve for each."""
    problem = discretise(settings)
    reference = reference_of(problem)
    distance = distance_to(reference, problem)
    forms = forms_of(settings)
    errors = {method: _errors(form, distance) for method, form in forms.items()}
    times: dict[str, list[list[float]]] = {
        method: [] for method in (*forms, INCREMENTAL)
    }
    for _ in range(repeats):
        for method, form in forms.items():
            work = partial(_append_times, times[method], form, len(errors[method]))
            seconds_of(work)
        times[INCREMENTAL].append(
            [seconds_of(partial(incremental, settings), time.perf_counter)]
        )
    steps = {method: np.arange(1.0, len(own) + 1.0) for method, own in errors.items()}
    errors[INCREMENTAL] = np.zeros((1, 2))
    steps[INCREMENTAL] = np.array([float(reference.steps)])
    return [
        ErrorCurve(method, steps[method], np.median(each, axis=0), *errors[method].T)
        for method, each in times.items()
    ]


def forms_of(settings: Settings) -> dict[str, Settings]:
    """Settings of every form of LATIN that a scene has, by name; nested where it has a start so."""
    is_nested = settings.applies("start")
    auto = {"search_direction": "auto", **({"start": "nested"} if is_nested else {})}
    anderson = {**auto, "acceleration": "anderson"}
    if is_nested:
        name = "LATIN auto k, nested"
    else:
        name = "LATIN auto k"
    forms: dict[str, dict[str, Any]] = {
        "LATIN monoscale": {"multiscale": False},
        "LATIN multiscale": {},
        name: auto,
        f"{name}, Anderson": anderson,
        f"{name}, Anderson, k updated": {**anderson, "k_update": "status"},
        FAST: {**anderson, "finish": "at-once"},
        "LATIN PGD": {"linear_stage": "pgd", **({} if is_nested else auto)},
    }
    return {
        method: settings.replace(**{**PLAIN, **form}) for method, form in forms.items()
    }


def _errors(settings: Settings, distance: Distance) -> Array:
    """Errors of both fields, (n, 2), until the friction force is as near as the goal."""
    errors: list[tuple[float, float]] = []
    for iterate, _ in islice(
        judged(discretise(settings), method_of(settings)), MOST_ITERATIONS
    ):
        force = distance.of_friction_force(iterate)
        errors.append((distance.of_displacement(iterate), force))
        if not math.isfinite(force) or (force <= GOAL and iterate.number > 1):
            break
    return np.array(errors)


def _append_times(passes: list[list[float]], settings: Settings, number: int) -> None:
    """Append times after every iteration, with all that the run needs to end, and discretising."""
    start = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - start
    decisions = islice(judged(problem, method_of(settings), None, spent), number)
    passes.append([decision.seconds for _, decision in decisions])


def seconds_of(
    work: Callable[[], object], clock: Callable[[], float] = time.process_time
) -> float:
    """Time of some work, s; of the processor unless another clock is given."""
    return timeit(work, timer=clock, number=1)


def latin(settings: Settings) -> Solution:
    """Solve as the settings say, with nothing beside that the run does not need."""
    return solve(discretise(settings), method_of(settings), watch=False)


def incremental(settings: Settings) -> Reference:
    """Solve by increments."""
    return reference_of(discretise(settings))


@dataclass(frozen=True)
class TimesAtSize:
    """Medians of both solvers, s, at a size of the first setting that grows with the scene.

    The message says why there is no answer; it is empty where there is one.
    """

    size: int
    instants: int
    latin: float = math.nan
    incremental: float = math.nan
    message: str = ""

    @property
    def ratio(self) -> float:
        """Time of LATIN over that of the incremental solver; NaN without an answer."""
        if self.message:
            return math.nan
        return self.latin / self.incremental


def times_at_sizes(settings: Settings, *, large: bool = False) -> list[TimesAtSize]:
    """Measure both solvers, in turns, on multiples of the present size and number of instants.

    The method is the fast one; large are sizes that take minutes.
    """
    names = settings.GROWS
    if large:
        longest = LONGEST_OF_LARGE
    else:
        longest = LONGEST
    measured: dict[tuple[int, int], TimesAtSize] = {}
    for later, size in product(FACTORS, LARGE if large else FACTORS):
        grown = {name: max(1, round(size * getattr(settings, name))) for name in names}
        instants = round(later * (settings.instants - 1)) + 1
        at = grown[names[0]], instants
        if at not in measured:
            measured[at] = _measured(
                settings, {**grown, "instants": instants}, at, longest
            )
    return list(measured.values())


def _measured(
    settings: Settings, changes: dict[str, int], at: tuple[int, int], longest: float
) -> TimesAtSize:
    """Both solvers at one size, unless that takes too long, or one of them has no answer."""
    try:
        form = forms_of(settings.replace(**changes))[FAST]
    except SettingError:
        return TimesAtSize(*at, message="there is no such size")
    most = form.max_iterations
    cost = run_cost(discretise(form), method_of(form), most, with_reference=True)
    if cost.seconds > longest:
        return TimesAtSize(*at, message=f"left out: it would take about {cost}")
    try:
        if not incremental(form).converged.all():
            return TimesAtSize(*at, message="the incremental solver finds no solution")
    except NoReferenceError as refusal:
        return TimesAtSize(*at, message=str(refusal))
    ending = latin(form).status.ending
    seconds: list[tuple[float, ...]] = []
    while not seconds or (len(seconds) < REPEATS and sum(seconds[0]) < SLOW):
        seconds.append(
            tuple(seconds_of(partial(solve, form)) for solve in (latin, incremental))
        )
    mine, others = map(statistics.median, zip(*seconds, strict=True))
    return TimesAtSize(
        *at, mine, others, "" if ending is Ending.CONVERGED else f"LATIN: {ending}"
    )
