"""How times grow with the size of a problem, and who is first at which size and number of instants.

The map is of the time of LATIN, as it comes, over that of the incremental solver.
"""

from __future__ import annotations

import contextlib
import math
import statistics
import time
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.definitions import SettingError, about
from solver.latin import Ending, solve
from solver.latin.cost import run_cost
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError
from solver.scenes import discretise, entry_of
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.exponent import Exponent, exponent_of
from solver.study.speed.error_against_time import (
    INCREMENTAL,
    by_increments,
    by_latin,
    forms_of,
    incremental,
    latin,
    nothing_collected,
)

MEASURED = "LATIN multiscale", "LATIN auto k, nested, Anderson", "LATIN auto k, Anderson"
GOAL = 0.01
"""Error of the friction force to which iterations are counted."""
LONG: dict[str, Any] = {"accuracy": 1e-3, "max_iterations": 300}
"""So that the friction force comes as near as that in all runs that can."""
FACTORS = (0.5, 1.0, 2.0)
"""On the sizes and on the instants of the settings."""
LARGE = (*FACTORS, 4.0, 8.0)
"""On the sizes, where minutes do not matter."""
LONGEST, LONGEST_OF_LARGE = 10.0, 600.0
"""Seconds from which, by estimate, a point is left out."""
REPEATS = 3
SLOW = 1.0
"""Seconds from which one run is enough."""
FORM = "LATIN fast"


@dataclass(frozen=True)
class Growth:
    """A method's times along one setting.

    Attributes
    ----------
    sizes
        Values of the setting.
    seconds
        Of an iteration (its median over the run), or of the whole incremental solution.
    iterations, totals
        Iterations and seconds, set-up included, to 1 % of friction force error; None where 300
        do not suffice, and iterations None for the incremental solver.
    """

    setting: str
    method: str
    sizes: tuple[int, ...]
    seconds: tuple[float, ...]
    iterations: tuple[int | None, ...]
    totals: tuple[float | None, ...]

    @property
    def exponent(self) -> Exponent | None:
        """With which the seconds grow with the size; None below two sizes."""
        return exponent_of(self.sizes, self.seconds)


def growth(settings: Settings) -> list[Growth]:
    """Measure all sizes; those that a scene cannot have are left out."""
    methods = {INCREMENTAL: settings}
    methods |= {name: form for name, form in forms_of(settings).items() if name in MEASURED}
    curves = []
    for setting, numbers in entry_of(settings).sizes.items():
        for method, form in methods.items():
            measure = _incremental_times if method == INCREMENTAL else _latin_times
            rows = []
            for number in numbers:
                with contextlib.suppress(RefusedError):
                    rows.append((number, *measure(form.replace(**{setting: number}))))
            if rows:
                curves.append(Growth(setting, method, *zip(*rows, strict=True)))
    return curves


def _latin_times(form: Settings) -> tuple[float, int | None, float | None]:
    """Times of a form of LATIN; the reference that its errors need is not billed."""
    form = form.replace(**LONG)
    problem = discretise(form)
    distance = distance_to(reference_of(problem), problem)
    with nothing_collected():
        start = time.perf_counter()
        problem = discretise(form)
        spent = time.perf_counter() - start
        records = solve(problem, method_of(form), distance=distance, spent=spent).records
    seconds = [record.seconds for record in records]
    each = float(np.median(np.diff(seconds))) if len(seconds) > 1 else seconds[0]
    near = (record for record in records if record.error_force <= GOAL)
    first = next(near, None)
    return each, *((first.iteration, first.seconds) if first else (None, None))


def _incremental_times(settings: Settings) -> tuple[float, int | None, float | None]:
    """Times of the incremental solver, which has no iterations to count."""
    seconds = statistics.median(by_increments(settings, time.perf_counter) for _ in range(REPEATS))
    return seconds, None, seconds


@dataclass(frozen=True)
class TimesAtSize:
    """Both solvers at one size.

    Attributes
    ----------
    size, instants
        Of the first setting that grows, and of time.
    latin, incremental
        Medians, s; NaN where it was left out.
    message
        Why there is no answer; empty where there is one.
    """

    size: int
    instants: int
    latin: float = math.nan
    incremental: float = math.nan
    message: str = ""

    @property
    def ratio(self) -> float:
        """Time of LATIN over that of the incremental solver; NaN without an answer."""
        return math.nan if self.message else self.latin / self.incremental


@dataclass(frozen=True)
class Crossover:
    """Comparisons at all sizes of a scene.

    Attributes
    ----------
    setting, title
        The first setting that grows, and what it is called.
    others
        Titles of those that grow with it.
    """

    setting: str
    title: str
    others: tuple[str, ...]
    comparisons: tuple[TimesAtSize, ...]

    @property
    def sizes(self) -> list[int]:
        """Sizes, ascending."""
        return sorted({times.size for times in self.comparisons})

    @property
    def instants(self) -> list[int]:
        """Numbers of instants, ascending."""
        return sorted({times.instants for times in self.comparisons})

    @property
    def ratios(self) -> Array:
        """Time of LATIN over that of the incremental solver, (instants, sizes); NaN for none."""
        ratios = {(own.instants, own.size): own.ratio for own in self.comparisons}
        rows = [[ratios.get((at, size), math.nan) for size in self.sizes] for at in self.instants]
        return np.array(rows)

    def message(self, times: TimesAtSize) -> str:
        """What one of the comparisons came to, in a sentence."""
        where = f"{self.title} {times.size}, {times.instants} instants"
        if times.message:
            return f"{where}: {times.message}"
        each = (
            f"LATIN {1e3 * times.latin:.3g} ms, incremental solver {1e3 * times.incremental:.3g} ms"
        )
        return f"{where}: {times.ratio:.2g} ({each})"


def crossover(settings: Settings, *, large: bool = False) -> Crossover:
    """Measure both solvers, in turns, on multiples of the present size and number of instants.

    Parameters
    ----------
    settings
        Of the middle of the map; the method is the fast one.
    large
        Whether to go on to sizes that take minutes.
    """
    names = entry_of(settings).grows
    comparisons: dict[tuple[int, int], TimesAtSize] = {}
    for later, size in product(FACTORS, LARGE if large else FACTORS):
        grown = {name: max(1, round(size * getattr(settings, name))) for name in names}
        instants = round(later * (settings.instants - 1)) + 1
        at = grown[names[0]], instants
        if at not in comparisons:
            longest = LONGEST_OF_LARGE if large else LONGEST
            changes = {**grown, "instants": instants}
            comparisons[at] = _compare(settings, changes, at, longest)
    definitions = settings.definitions()
    title, *others = (about(definitions[name]).title for name in names)
    return Crossover(names[0], title, tuple(others), tuple(comparisons.values()))


def _compare(
    settings: Settings, changes: dict[str, int], at: tuple[int, int], longest: float
) -> TimesAtSize:
    try:
        form = forms_of(settings.replace(**changes))[FORM]
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
    seconds = [(by_latin(form), by_increments(form))]
    while len(seconds) < REPEATS and sum(seconds[0]) < SLOW:
        seconds.append((by_latin(form), by_increments(form)))
    mine, others = map(statistics.median, zip(*seconds, strict=True))
    return TimesAtSize(*at, mine, others, "" if ending is Ending.CONVERGED else f"LATIN: {ending}")
