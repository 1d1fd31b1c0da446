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
from solver.study.chart import Map, PanelAxis, Runs
from solver.study.speed.error_against_time import forms_of
from solver.study.speed.timed import by_increments, by_latin, incremental, latin

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
MAP = "Who is first where"
TIMES = "LATIN / incremental solver"


@dataclass(frozen=True)
class Comparison:
    """One size.

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
    comparisons: tuple[Comparison, ...]

    @property
    def sizes(self) -> list[int]:
        """Sizes, ascending."""
        return sorted({one.size for one in self.comparisons})

    @property
    def instants(self) -> list[int]:
        """Numbers of instants, ascending."""
        return sorted({one.instants for one in self.comparisons})

    @property
    def ratios(self) -> Array:
        """Time of LATIN over that of the incremental solver, (instants, sizes); NaN for none."""
        ratios = np.full((len(self.instants), len(self.sizes)), np.nan)
        for one in self.comparisons:
            ratios[self.instants.index(one.instants), self.sizes.index(one.size)] = one.ratio
        return ratios


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
    comparisons: dict[tuple[int, int], Comparison] = {}
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
) -> Comparison:
    try:
        form = forms_of(settings.replace(**changes))[FORM]
    except SettingError:
        return Comparison(*at, message="there is no such size")
    most = form.max_iterations
    cost = run_cost(discretise(form), method_of(form), most, with_reference=True)
    if cost.seconds > longest:
        return Comparison(*at, message=f"left out: it would take about {cost}")
    try:
        if not incremental(form).converged.all():
            return Comparison(*at, message="the incremental solver finds no solution")
    except NoReferenceError as refusal:
        return Comparison(*at, message=str(refusal))
    ending = latin(form).status.ending
    seconds = [(by_latin(form), by_increments(form))]
    while len(seconds) < REPEATS and sum(seconds[0]) < SLOW:
        seconds.append((by_latin(form), by_increments(form)))
    mine, others = map(statistics.median, zip(*seconds, strict=True))
    return Comparison(*at, mine, others, "" if ending is Ending.CONVERGED else f"LATIN: {ending}")


def equal_at(sizes: Sequence[float], ratios: Sequence[float]) -> float | None:
    """Size from which LATIN is ahead, between two of them by powers; None for nowhere.

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


def crossover_map(measured: Crossover) -> Map:
    """Draw the ratio of times over size and instants, with the line where both take as long."""
    comparisons = measured.comparisons
    ratios = np.array([one.ratio for one in comparisons])
    runs = Runs(
        np.arange(len(comparisons)),
        np.array([float(one.size) for one in comparisons]),
        np.array([float(one.instants) for one in comparisons]),
        ratios,
        np.ones(len(comparisons), dtype=int),
        np.isfinite(ratios),
        [_message(measured, one) for one in comparisons],
    )
    return Map(
        f"Time of {TIMES}",
        PanelAxis(measured.title, logarithmic=True, whole=True),
        PanelAxis("Instants", logarithmic=True, whole=True),
        np.array(measured.sizes, dtype=float),
        np.array(measured.instants, dtype=float),
        PanelAxis(TIMES, logarithmic=True),
        measured.ratios,
        runs,
        level=1.0,
    )


def _message(measured: Crossover, one: Comparison) -> str:
    where = f"{measured.title} {one.size}, {one.instants} instants"
    if one.message:
        return f"{where}: {one.message}"
    times = f"LATIN {1e3 * one.latin:.3g} ms, incremental solver {1e3 * one.incremental:.3g} ms"
    return f"{where}: {one.ratio:.2g} ({times})"


def ratio_table(measured: Crossover) -> list[list[str]]:
    """The ratios, a row for each number of instants."""
    head = [TIMES, *(f"{measured.setting} {size}" for size in measured.sizes), "equal at"]
    rows = [head]
    for instants, ratios in zip(measured.instants, measured.ratios, strict=True):
        even = equal_at(measured.sizes, ratios)
        cells = ("-" if np.isnan(ratio) else f"{ratio:.2g}" for ratio in ratios)
        rows.append([f"{instants} instants", *cells, "-" if even is None else f"{even:.2g}"])
    return rows


def notes(measured: Crossover) -> list[str]:
    """What the map shows, and what it leaves out, in sentences."""
    ratios = measured.ratios[np.isfinite(measured.ratios)]
    ahead, everything = int((ratios < 1.0).sum()), ratios.size
    grows = " and ".join([measured.title.lower(), *(other.lower() for other in measured.others)])
    lines = [
        f"LATIN is ahead (below 1) at {ahead} of {everything} sizes. From settings to a certified "
        "or accurate end, in seconds of the processor, medians of up to three runs in turns.",
    ]
    if measured.others:
        lines.append(f"What grows along the axis: {grows}.")
    return [*lines, *(_message(measured, one) for one in measured.comparisons if one.message)]
