"""Mesh study: a quantity on three meshes or numbers of instants, and its limit.

Richardson's extrapolation, with the margin that Roache gives it (J. Fluids Eng. 116,
405, 1994). Runs end with the exact solution on their mesh, so that they differ by the
mesh alone, or by the time step alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.quantities.quantity import Quantity
from solver.study.scene_run import finished_run

SAFETY = 1.25
"""Roache's factor on what is still missing, for three meshes."""
LEAST_ORDER = 0.5
"""Smallest order that is believed: with a smaller one no limit is in sight."""
LARGEST_ORDER = 2.1
"""Largest order that is believed: linear elements give no quantity a larger one."""
UNSURE = 3.0
"""Factor on the largest difference, where no limit is in sight.

Where the order is too large the factor is `SAFETY` (both: Eca and Hoekstra, J. Comput.
Phys. 262, 104, 2014)."""
AN_ELEMENT = "an element's size"
TIME_STEP = "a time step"
"""Size that is halved, in words."""
EQUAL = 1e-6
"""Relative difference up to which values count as equal."""


@dataclass(frozen=True)
class Refinement:
    """A quantity on three meshes, each of half the size of the one before.

    Attributes
    ----------
    values
        Values of the quantity, the one on the coarsest mesh first.
    own
        Index of the mesh whose error is asked for.
    """

    values: tuple[float, float, float]
    own: int

    @property
    def has_values(self) -> bool:
        """Check whether the quantity has a value on all three meshes."""
        return all(math.isfinite(value) for value in self.values)

    @property
    def steps(self) -> tuple[float, float]:
        """Differences from mesh to mesh; zero between values that are equal."""
        coarse, middle, fine = self.values
        size = max(abs(value) for value in self.values)
        first = middle - coarse
        second = fine - middle
        # A quantity that no mesh changes has neither order nor error; where only one of
        # both steps changes it, the rounding in the other one makes no order.
        if abs(first) <= EQUAL * size:
            first = 0.0
        if abs(second) <= EQUAL * size:
            second = 0.0
        return first, second

    @property
    def order(self) -> float | None:
        """Order of convergence: power of the size in the error; None without any."""
        first, second = self.steps
        if first * second > 0.0:
            return math.log2(first / second)
        return None

    @property
    def limit(self) -> float:
        """Limit of the quantity by extrapolation; without order the finest value."""
        order = self.order
        fine = self.values[-1]
        if order is None or not LEAST_ORDER <= order <= LARGEST_ORDER:
            return fine
        return fine + self.steps[1] / math.expm1(order * math.log(2.0))

    @property
    def margin(self) -> float:
        """Margin of the limit, to either side."""
        order = self.order
        largest = max(abs(step) for step in self.steps)
        if order is None or order < LEAST_ORDER:
            return UNSURE * largest
        if order > LARGEST_ORDER:
            return SAFETY * largest
        return SAFETY * abs(self.limit - self.values[-1])

    @property
    def deviation(self) -> float:
        """Largest error of the run's value, as a share of the limit."""
        if not any(self.steps):
            return 0.0
        error = abs(self.values[self.own] - self.limit) + self.margin
        if self.limit:
            return error / abs(self.limit)
        if error:
            return math.inf
        return 0.0


def three_of(settings: Settings, names: Sequence[str]) -> tuple[list[Settings], int]:
    """Settings with three sizes, each twice as fine as the one before.

    The second result is the index of the given settings among them: the middle, or the
    first where the sizes cannot be halved. Sizes that a scene does not take are
    refused.

    Parameters
    ----------
    settings
        Settings of the scene.
    names
        Names of the settings of the mesh, or `instants`, of which the steps count.
    """
    if "instants" in names:
        return _three_steps(settings)
    try:
        return [_refined(settings, names, factor) for factor in (0.5, 1, 2)], 1
    except SettingError:
        return [_refined(settings, names, factor) for factor in (1, 2, 4)], 0


def _three_steps(settings: Settings) -> tuple[list[Settings], int]:
    """Settings with three time steps, and the index of the given ones among them.

    Points of paths are instants, too. Where these alone make the steps of a run, other
    numbers of instants may change nothing: then the longest step counts.
    """
    steps = _steps_of(settings)
    if steps == settings.values()["instants"] - 1:
        try:
            coarse = _refined(settings, ["instants"], 0.5)
        except SettingError:
            coarse = settings
        if _steps_of(coarse) < steps:
            return [coarse, settings, _refined(settings, ["instants"], 2)], 1
    finer = [settings.replace(instants=factor * steps + 1) for factor in (2, 4)]
    return [settings, *finer], 0


def undivided(settings: Settings) -> str:
    """Sentence on steps that the study cannot divide, or ""."""
    three, own = _three_steps(settings)
    times = np.concatenate([[0.0], three[own].times()])
    # Numbers of the finest instants up to and before each of these.
    finest = three[-1].times()
    up_to = np.searchsorted(finest, times, side="right")
    before = np.searchsorted(finest, times, side="left")
    stay = (before[1:] == up_to[:-1]) & (np.diff(times) > 0.0)
    if not stay.any():
        return ""
    longest = float(np.diff(times)[stay].max())
    return f"Steps of up to {longest:.3g} s between points of a load stay as they are."


def _steps_of(settings: Settings) -> int:
    """Number of equal steps that are no longer than the longest step of a run."""
    longest = float(np.diff(settings.times(), prepend=0.0).max())
    return math.ceil((1.0 - EQUAL) * settings.duration / longest)


def _refined(settings: Settings, names: Sequence[str], factor: float) -> Settings:
    """Settings with a multiple of these numbers of elements, or of steps."""
    sizes = {}
    for name in names:
        first = 0
        if name == "instants":
            first = 1
        # Steps count, of which there is one fewer than instants.
        size = factor * (settings.values()[name] - first) + first
        if size == int(size):
            size = int(size)
        sizes[name] = size
    return settings.replace(**sizes)


def decides(settings: Settings, asked: Quantity) -> bool:
    """Check whether a quantity depends on the mesh: not on the course of a run."""
    return asked.reads is None and asked.applies(settings)


def value_on(settings: Settings, asked: Quantity) -> float:
    """Value of a quantity in the certified solution on a mesh; NaN without one."""
    # Certified runs differ by the mesh, not by their stop rules.
    certified = settings.replace(finish="at-once")
    run = finished_run(certified, errors=False, indicators=False)
    if run.solution.is_certified:
        return asked(run)
    return math.nan


def size_of(settings: Settings) -> str:
    """Text of the numbers of elements and instants."""
    sizes = []
    if settings.MESH:
        counts = " x ".join(str(getattr(settings, name)) for name in settings.MESH)
        sizes.append(f"{counts} elements")
    sizes.append(f"{settings.values()['instants']} instants")
    return ", ".join(sizes)


def answer(refinement: Refinement, unit: str, size: str = AN_ELEMENT) -> str:
    """Two sentences on the limit of a quantity, and on the error of this run."""
    if not refinement.has_values:
        return (
            "One of the runs came to no certified solution, or has no such value: "
            "no answer."
        )
    if refinement.margin == 0.0:
        return f"All three are equal: {size} does not change it."
    sentence = _limit_sentence(refinement, unit, size)
    if refinement.limit:
        return f"{sentence} This run is within {_share(refinement)} of that."
    return sentence


def _limit_sentence(refinement: Refinement, unit: str, size: str) -> str:
    """Sentence on the limit of a quantity with smaller sizes."""
    limit = f"{refinement.limit:.4g} ± {refinement.margin:.2g} {unit}".rstrip()
    order = refinement.order
    if order is None:
        return f"It follows no power of {size}: {limit} is all that is known."
    if order < LEAST_ORDER:
        return (
            f"It changes with the power {order:.2f} of {size}, which shows no limit: "
            f"{limit}, if there is one."
        )
    if order > LARGEST_ORDER:
        first, second = refinement.steps
        # The last change alone would promise too much.
        return (
            f"It changed by {abs(first):.3g} {unit}, then by {abs(second):.3g} {unit}, "
            f"which falls faster than any power of {size} that is to be expected: "
            f"{limit}, by the first change."
        ).replace(" ,", ",")
    return (
        f"Its error goes with the power {order:.2f} of {size}, and with ever smaller "
        f"ones it becomes {limit}."
    )


def which_to_refine(elements: Refinement, instants: Refinement) -> str:
    """Sentence on which of both errors is larger, or "" if one is unknown."""
    if not (elements.has_values and instants.has_values):
        return ""
    if elements.deviation == instants.deviation == 0.0:
        return "Neither more elements nor more instants change it."
    left = f"elements leave up to {_share(elements)}, instants up to {_share(instants)}"
    more = "instants"
    if elements.deviation >= instants.deviation:
        more = "elements"
    return f"Refine {more} first: {left}."


def _share(refinement: Refinement) -> str:
    """Text of the largest error as a share of the limit."""
    if refinement.deviation < 1.0:
        return f"{100.0 * refinement.deviation:.2g} %"
    return "all of it"
