"""Who is first where: time of LATIN over that of the incremental solver, by size and instants."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from solver.arrays import Array
from solver.definitions import SettingError, about
from solver.latin import Ending
from solver.latin.run_cost import run_cost
from solver.reference.condensation import NoReferenceError
from solver.scenes import discretise, entry_of
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.speed.error_against_time import forms_of
from solver.study.speed.timed import by_increments, by_latin, incremental, latins

FACTORS = (0.5, 1.0, 2.0)
"""On the sizes and on the instants of the settings."""
LARGE = (0.5, 1.0, 2.0, 4.0, 8.0)
"""On the sizes, where minutes do not matter."""
LONGEST, LONGEST_OF_LARGE = 10.0, 600.0
"""Seconds from which, by estimate, a point is left out."""
REPEATS = 3
SLOW = 1.0
"""Seconds from which one run is enough."""
FORM = "LATIN fast"


@dataclass(frozen=True)
class Duel:
    """One size.

    Attributes
    ----------
    size, instants
        Of the first setting that grows, and of time.
    latin, incremental
        Medians, s; NaN where it was left out.
    said
        Why there is no answer; nothing where there is one.
    """

    size: int
    instants: int
    latin: float
    incremental: float
    said: str = ""

    @property
    def ratio(self) -> float:
        """Time of LATIN over that of the incremental solver; NaN without an answer."""
        return math.nan if self.said else self.latin / self.incremental


@dataclass(frozen=True)
class Crossover:
    """All sizes of a scene.

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
    duels: tuple[Duel, ...]

    @property
    def sizes(self) -> list[int]:
        """Sizes, ascending."""
        return sorted({one.size for one in self.duels})

    @property
    def instants(self) -> list[int]:
        """Numbers of instants, ascending."""
        return sorted({one.instants for one in self.duels})

    @property
    def ratios(self) -> Array:
        """Time of LATIN over that of the incremental solver, (instants, sizes); NaN for none."""
        found = np.full((len(self.instants), len(self.sizes)), np.nan)
        for one in self.duels:
            found[self.instants.index(one.instants), self.sizes.index(one.size)] = one.ratio
        return found


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
    duels: dict[tuple[int, int], Duel] = {}
    for later, size in product(FACTORS, LARGE if large else FACTORS):
        grown = {name: max(1, round(size * getattr(settings, name))) for name in names}
        instants = round(later * (settings.instants - 1)) + 1
        at = grown[names[0]], instants
        if at not in duels:
            changes = {**grown, "instants": instants}
            duels[at] = _duel(settings, changes, at, LONGEST_OF_LARGE if large else LONGEST)
    definitions = settings.definitions()
    title, *others = (about(definitions[name]).title for name in names)
    return Crossover(names[0], title, tuple(others), tuple(duels.values()))


def _duel(settings: Settings, changes: dict[str, int], at: tuple[int, int], longest: float) -> Duel:
    try:
        form = forms_of(settings.replace(**changes))[FORM]
    except SettingError:
        return Duel(*at, math.nan, math.nan, "there is no such size")
    most = form.max_iterations
    cost = run_cost(discretise(form), method_of(form), most, with_reference=True)
    if cost.seconds > longest:
        return Duel(*at, math.nan, math.nan, f"left out: it would take about {cost}")
    try:
        if not incremental(form).converged.all():
            return Duel(*at, math.nan, math.nan, "the incremental solver finds no solution")
    except NoReferenceError as refusal:
        return Duel(*at, math.nan, math.nan, str(refusal))
    ending = latins(form).status.ending
    seconds = [(by_latin(form), by_increments(form))]
    while len(seconds) < REPEATS and sum(seconds[0]) < SLOW:
        seconds.append((by_latin(form), by_increments(form)))
    latin, other = map(statistics.median, zip(*seconds, strict=True))
    return Duel(*at, latin, other, "" if ending is Ending.CONVERGED else f"LATIN: {ending}")


def equal_at(sizes: Sequence[float], ratios: Sequence[float]) -> float | None:
    """Give the size from which LATIN is ahead, between two of them by powers; None for nowhere.

    Parameters
    ----------
    sizes, ratios
        Ascending, and the time of LATIN over that of the other; NaN where it is not known.
    """
    pairs = zip(sizes, ratios, strict=True)
    known = [(size, ratio) for size, ratio in pairs if math.isfinite(ratio)]
    for (before, above), (after, below) in pairwise(known):
        if above >= 1.0 > below:
            share = math.log(above) / math.log(above / below)
            return float(before * (after / before) ** share)
    return None
