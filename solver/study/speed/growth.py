"""How the time of an iteration, and the number of them, grow with the size of a problem."""

from __future__ import annotations

import contextlib
import math
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from solver.definitions import SettingError
from solver.scenes import entry_of
from solver.settings import Settings
from solver.study.exponent import Exponent, exponent_of
from solver.study.quantities.finished import BROKEN, REFUSED
from solver.study.quantities.quantities import reading
from solver.study.speed.error_against_time import INCREMENTAL, forms_of
from solver.study.speed.timed import by_increments, nothing_collected
from solver.study.sweep.plan import Plan, Varied
from solver.study.sweep.point import run_point

MEASURED = (
    "LATIN multiscale",
    "LATIN auto k, nested, Anderson",
    "LATIN auto k, Anderson",
)
READINGS = tuple(
    map(reading, ("seconds_per_iteration", "seconds_to_force@0.01", "iterations_to_force@0.01"))
)
LONG: dict[str, Any] = {"accuracy": 1e-3, "max_iterations": 300}
"""So that the friction force comes as near as that in all runs that can."""


@dataclass(frozen=True)
class Size:
    """One size of one method.

    Attributes
    ----------
    seconds
        Of an iteration (its median over the run), or of the whole incremental solution.
    iterations, total
        Iterations and seconds, set-up included, to 1 % of friction force error; None where 300
        do not suffice, and iterations None for the incremental solver.
    """

    size: int
    seconds: float
    iterations: int | None
    total: float | None


@dataclass(frozen=True)
class Growth:
    """A method's sizes along one setting."""

    setting: str
    method: str
    sizes: tuple[Size, ...]

    @property
    def exponent(self) -> Exponent | None:
        """With which the seconds grow with the size; None below two sizes."""
        return exponent_of([one.size for one in self.sizes], [one.seconds for one in self.sizes])


def growth(settings: Settings) -> list[Growth]:
    """Measure all sizes, those of LATIN by a sweep; sizes that a scene cannot have are left out."""
    sizes_of = entry_of(settings).sizes
    forms = {name: form for name, form in forms_of(settings).items() if name in MEASURED}
    every = [(setting, method) for setting in sizes_of for method in (INCREMENTAL, *forms)]
    found = []
    for setting, method in every:
        if method in forms:
            measured = _swept(forms[method], setting, sizes_of[setting])
        else:
            measured = _solved(settings, setting, sizes_of[setting])
        if sizes := tuple(measured):
            found.append(Growth(setting, method, sizes))
    return found


def _swept(form: Settings, setting: str, sizes: tuple[int, ...]) -> Iterator[Size]:
    """Measure a form of LATIN, one run after the other: others beside them would slow them down."""
    plan = Plan(form.replace(**LONG), (Varied(setting, sizes, logarithmic=True),), READINGS)
    for number, size in enumerate(sizes):
        with nothing_collected():
            row = run_point(plan, number)
        if row.ending not in (REFUSED, BROKEN):
            seconds, total, iterations = row.values
            reached = math.isfinite(iterations)
            yield Size(
                size, seconds, int(iterations) if reached else None, total if reached else None
            )


def _solved(settings: Settings, setting: str, sizes: tuple[int, ...]) -> Iterator[Size]:
    """Measure the incremental solver, which has no iterations to count."""
    for size in sizes:
        with contextlib.suppress(SettingError):
            changed = settings.replace(**{setting: size})
            samples = (by_increments(changed, time.perf_counter) for _ in range(3))
            seconds = statistics.median(samples)
            yield Size(size, seconds, None, seconds)
