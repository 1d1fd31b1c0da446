"""Times of all methods from settings to result, beside their errors.

Each method is billed for all its parts: discretisation, factorisation, the coarser
mesh, iterations. One pass without the clock finds the errors, and warms up; then timed
passes run every method once, in turn, and the median of the passes counts. No error is
computed while the clock of a pass runs.

Nothing is kept of earlier solutions, and `timeit` collects no garbage meanwhile, whose
cost grows with all that the process holds. Times that are compared are of one clock:
the processor's, or wall time.
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
from solver.cache import CACHE
from solver.latin import Ending, Solution, judged, solve
from solver.latin.run_cost import run_cost
from solver.reference.assembly import NoReferenceError
from solver.reference.distance import Distance, distance_to
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.settings.values import SettingError

LEVELS = {"10 %": 0.1, "1 %": 0.01, "0.1 %": 1e-3, "1e-6": 1e-6}
"""Errors of the friction force in the table of times, by their titles."""
GOAL = 1e-7
"""Error of the friction force at which an iteration ends."""
MOST_ITERATIONS = 600
PLAIN: dict[str, Any] = {
    "multiscale": True,
    "search_direction": "paper",
    "linear_stage": "full",
    "acceleration": "none",
    "start": "zero",
    "finish": "none",
}
"""Settings common to the forms of LATIN; all others are those of the run."""
FACTORS = (0.5, 1.0, 2.0)
"""Factors on the sizes and on the instants of the settings."""
LARGE = (*FACTORS, 4.0, 8.0)
"""Factors on the sizes where minutes do not matter."""
LONGEST = 10.0
"""Estimated seconds from which a size is left out."""
LONGEST_OF_LARGE = 600.0
"""The same where minutes do not matter."""
REPEATS = 3
"""Number of runs whose median counts."""
SLOW = 1.0
"""Seconds of both solvers from which one run is enough."""
INCREMENTAL = "incremental solver"
FAST = "LATIN fast"


@dataclass(frozen=True, eq=False)
class ErrorCurve:
    """Errors of a method against time.

    Attributes
    ----------
    method
        Name of the method.
    steps
        Iterations done, or Newton steps of the incremental solver, shape (n,).
    seconds
        Time from settings to there, the median of the passes, same shape, s.
    error_displacement, error_force
        Relative L2 distances to the incremental reference, 0 for itself, same shape.
    """

    method: str
    steps: Array
    seconds: Array
    error_displacement: Array
    error_force: Array

    @property
    def is_latin(self) -> bool:
        """Check whether the method is a form of LATIN."""
        return self.method != INCREMENTAL

    @property
    def seconds_per_iteration(self) -> float | None:
        """Median time between iterations, s; None for a method without iterations."""
        if not self.is_latin or len(self.seconds) < 2:
            return None
        return float(np.median(np.diff(self.seconds)))

    def reached(self, level: float) -> tuple[float, float] | None:
        """Time, s, and step at which the error of friction first meets a level.

        None where the method does not reach the level.
        """
        is_reached = self.error_force <= level
        first = is_reached.argmax()
        if is_reached[first]:
            return (float(self.seconds[first]), float(self.steps[first]))
        return None


def error_against_time(settings: Settings, repeats: int) -> list[ErrorCurve]:
    """Run every method `repeats` times, at least once, in turns; a curve for each.

    Raises
    ------
    NoReferenceError
        If the scene has no reference.
    """
    problem = discretise(settings)
    reference = reference_of(problem)
    distance = distance_to(reference, problem)
    forms = forms_of(settings)
    # This pass finds the errors, and warms up.
    errors = {method: _errors(form, distance) for method, form in forms.items()}
    counts = {method: len(values) for method, values in errors.items()}
    times = _times(settings, forms, counts, repeats)
    curves = []
    for method in forms:
        steps = np.arange(1.0, counts[method] + 1.0)
        curves.append(ErrorCurve(method, steps, times[method], *errors[method].T))
    steps = np.array([float(reference.steps)])
    exact = np.zeros(1)
    curves.append(ErrorCurve(INCREMENTAL, steps, times[INCREMENTAL], exact, exact))
    return curves


def _times(
    settings: Settings,
    forms: dict[str, Settings],
    counts: dict[str, int],
    repeats: int,
) -> dict[str, Array]:
    """Median times of all methods by name, shape (n,) each, s.

    Parameters
    ----------
    settings
        Settings of the incremental solver.
    forms, counts
        Settings and numbers of iterations of the forms of LATIN, by name.
    repeats
        Number of passes.
    """
    passes: dict[str, list[list[float]]] = {method: [] for method in forms}
    passes[INCREMENTAL] = []
    for _ in range(repeats):
        for method, form in forms.items():
            # The times come from the run; `seconds_of` only keeps garbage uncollected.
            seconds_of(partial(_append_times, passes[method], form, counts[method]))
        work = partial(incremental, settings)
        passes[INCREMENTAL].append([seconds_of(work, time.perf_counter)])
    return {method: np.median(each, axis=0) for method, each in passes.items()}


def forms_of(settings: Settings) -> dict[str, Settings]:
    """Settings of every form of LATIN that a scene has, by name.

    Forms with an automatic search direction start nested where the scene allows it.
    """
    # A start that the scene does not have is left out of the name, too.
    is_nested = settings.applies("start")
    name = "LATIN auto k"
    auto = {"search_direction": "auto"}
    reduced = {"linear_stage": "pgd", **auto}
    if is_nested:
        name = "LATIN auto k, nested"
        auto["start"] = "nested"
        reduced = {"linear_stage": "pgd"}
    anderson = {**auto, "acceleration": "anderson"}
    forms: dict[str, dict[str, Any]] = {
        "LATIN monoscale": {"multiscale": False},
        "LATIN multiscale": {},
        name: auto,
        f"{name}, Anderson": anderson,
        FAST: {**anderson, "finish": "at-once"},
        "LATIN PGD": reduced,
    }
    return {
        method: settings.replace(**(PLAIN | form)) for method, form in forms.items()
    }


def _errors(settings: Settings, distance: Distance) -> Array:
    """Errors of displacement and friction force of every iterate, shape (n, 2).

    Iterations end once the error of the friction force is below `GOAL`.
    """
    errors: list[tuple[float, float]] = []
    iterates = judged(discretise(settings), method_of(settings))
    for iterate, _ in islice(iterates, MOST_ITERATIONS):
        force = distance.of_friction_force(iterate)
        errors.append((distance.of_displacement(iterate), force))
        if not math.isfinite(force) or (force <= GOAL and iterate.number > 1):
            break
    return np.array(errors)


def _append_times(passes: list[list[float]], settings: Settings, number: int) -> None:
    """Append the times, s, up to every iteration, including discretisation."""
    CACHE.clear()
    start = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - start
    decisions = islice(judged(problem, method_of(settings), None, spent), number)
    passes.append([decision.seconds for _, decision in decisions])


def seconds_of(
    work: Callable[[], object], clock: Callable[[], float] = time.process_time
) -> float:
    """Time of some work, s: processor time unless another clock is given.

    Nothing is kept from what was done before.
    """
    CACHE.clear()
    return timeit(work, timer=clock, number=1)


def latin(settings: Settings) -> Solution:
    """Solve by LATIN as the settings say, without unneeded indicators."""
    return solve(discretise(settings), method_of(settings), watch=False)


def incremental(settings: Settings) -> Reference:
    """Solve by the incremental solver."""
    return reference_of(discretise(settings))


@dataclass(frozen=True)
class TimesAtSize:
    """Times of both solvers at a size of the scene.

    Attributes
    ----------
    size
        Value of the first setting that grows with the scene.
    instants
        Number of instants.
    latin, incremental
        Median times, s.
    message
        Reason why there is no answer; empty where there is one.
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
    """Measure both solvers, in turns, on multiples of the size and number of instants.

    The method is the fast form of LATIN; `large` adds sizes that take minutes.
    """
    factors: tuple[float, ...] = FACTORS
    longest = LONGEST
    if large:
        factors = LARGE
        longest = LONGEST_OF_LARGE
    names = settings.GROWS
    measured: dict[tuple[int, int], TimesAtSize] = {}
    # Rounding may give a size twice, which is measured once.
    for later, factor in product(FACTORS, factors):
        changes = {}
        for name in names:
            changes[name] = max(1, round(factor * getattr(settings, name)))
        instants = round(later * (settings.instants - 1)) + 1
        at = changes[names[0]], instants
        changes["instants"] = instants
        if at not in measured:
            measured[at] = _measured(settings, changes, at, longest)
    return list(measured.values())


def _measured(
    settings: Settings, changes: dict[str, int], at: tuple[int, int], longest: float
) -> TimesAtSize:
    """Times of both solvers at a size, or the reason why they are missing."""
    try:
        form = forms_of(settings.replace(**changes))[FAST]
    except SettingError:
        return TimesAtSize(*at, message="there is no such size")
    # An estimate decides before anything is run.
    cost = run_cost(discretise(form), method_of(form), with_reference=True)
    if cost.seconds > longest:
        return TimesAtSize(*at, message=f"left out: it would take about {cost}")
    try:
        if not incremental(form).converged.all():
            return TimesAtSize(*at, message="the incremental solver finds no solution")
    except NoReferenceError as refusal:
        return TimesAtSize(*at, message=str(refusal))
    # This run warms up, so that its time does not count.
    ending = latin(form).status.ending
    message = ""
    if ending is not Ending.CONVERGED:
        message = f"LATIN: {ending}"
    of_latin: list[float] = []
    of_incremental: list[float] = []
    is_quick = True
    while not of_latin or (len(of_latin) < REPEATS and is_quick):
        # In turns, as the load of a machine changes within seconds.
        of_latin.append(seconds_of(partial(latin, form)))
        of_incremental.append(seconds_of(partial(incremental, form)))
        is_quick = of_latin[0] + of_incremental[0] < SLOW
    ours = statistics.median(of_latin)
    others = statistics.median(of_incremental)
    return TimesAtSize(*at, ours, others, message)
