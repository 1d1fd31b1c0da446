"""How the time of an iteration, and the number of them, grow with the size of a problem."""

from __future__ import annotations

import contextlib
import statistics
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.latin import solve
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.refusal import RefusedError
from solver.scenes import discretise, entry_of
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.exponent import Exponent, exponent_of
from solver.study.speed.error_against_time import INCREMENTAL, forms_of
from solver.study.speed.timed import by_increments, nothing_collected

MEASURED = (
    "LATIN multiscale",
    "LATIN auto k, nested, Anderson",
    "LATIN auto k, Anderson",
)
GOAL = 0.01
"""Error of the friction force to which iterations are counted."""
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
    """Measure all sizes; those that a scene cannot have are left out."""
    methods = {INCREMENTAL: settings}
    methods |= {name: form for name, form in forms_of(settings).items() if name in MEASURED}
    curves = []
    for setting, numbers in entry_of(settings).sizes.items():
        for method, form in methods.items():
            measure = _incremental if method == INCREMENTAL else _latin
            sizes = []
            for number in numbers:
                with contextlib.suppress(RefusedError):
                    sizes.append(measure(form.replace(**{setting: number}), number))
            if sizes:
                curves.append(Growth(setting, method, tuple(sizes)))
    return curves


def _latin(form: Settings, number: int) -> Size:
    """Measure a form of LATIN; the reference that its errors need is not billed."""
    form = form.replace(**LONG)
    problem = discretise(form)
    distance = distance_to(reference_of(problem), problem)
    with nothing_collected():
        start = time.perf_counter()
        problem = discretise(form)
        spent = time.perf_counter() - start
        records = solve(problem, method_of(form), distance=distance, spent=spent).records
    seconds = np.array([record.seconds for record in records])
    each = float(np.median(np.diff(seconds))) if len(seconds) > 1 else float(seconds[0])
    for record in records:
        if record.error_force <= GOAL:
            return Size(number, each, record.iteration, record.seconds)
    return Size(number, each, None, None)


def _incremental(settings: Settings, number: int) -> Size:
    """Measure the incremental solver, which has no iterations to count."""
    seconds = statistics.median(by_increments(settings, time.perf_counter) for _ in range(3))
    return Size(number, seconds, None, seconds)
