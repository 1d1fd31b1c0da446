"""Who is first at which size and number of instants: LATIN, or the incremental solver."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass
from functools import partial
from itertools import product

from solver.definitions import SettingError
from solver.latin import Ending
from solver.latin.cost import run_cost
from solver.reference.condensation import NoReferenceError
from solver.scenes import discretise, entry_of
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.speed.error_against_time import (
    FAST,
    forms_of,
    incremental,
    latin,
    seconds_of,
)

FACTORS = (0.5, 1.0, 2.0)
"""On the sizes and on the instants of the settings."""
LARGE = (*FACTORS, 4.0, 8.0)
"""On the sizes, where minutes do not matter."""
LONGEST, LONGEST_OF_LARGE = 10.0, 600.0
"""Seconds from which, by estimate, a size is left out."""
REPEATS = 3
SLOW = 1.0
"""Seconds from which one run is enough."""


@dataclass(frozen=True)
class TimesAtSize:
    """Both solvers at one size.

    Attributes
    ----------
    size, instants
        Of the first setting that grows with the scene, and of time.
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


def times_at_sizes(settings: Settings, *, large: bool = False) -> list[TimesAtSize]:
    """Measure both solvers, in turns, on multiples of the present size and number of instants.

    Parameters
    ----------
    settings
        Of the middle of the table; the method is the fast one.
    large
        Whether to go on to sizes that take minutes.
    """
    names = entry_of(settings).grows
    longest = LONGEST_OF_LARGE if large else LONGEST
    measured: dict[tuple[int, int], TimesAtSize] = {}
    for later, size in product(FACTORS, LARGE if large else FACTORS):
        grown = {name: max(1, round(size * getattr(settings, name))) for name in names}
        instants = round(later * (settings.instants - 1)) + 1
        at = grown[names[0]], instants
        if at not in measured:
            measured[at] = _measured(settings, {**grown, "instants": instants}, at, longest)
    return list(measured.values())


def _measured(
    settings: Settings, changes: dict[str, int], at: tuple[int, int], longest: float
) -> TimesAtSize:
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
        seconds.append(tuple(seconds_of(partial(solve, form)) for solve in (latin, incremental)))
    mine, others = map(statistics.median, zip(*seconds, strict=True))
    return TimesAtSize(*at, mine, others, "" if ending is Ending.CONVERGED else f"LATIN: {ending}")
