"""Whether elements and instants are enough: a quantity on three of each, and what it tends to.

Richardson's extrapolation, with the margin that Roache gives it (J. Fluids Eng. 116,
405, 1994). Runs end with the exact solution on their mesh, so what differs between them
is the mesh alone, or the time step alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from solver.settings.definitions import SettingError
from solver.settings.scene import Settings
from solver.study.quantities.finished import finished_run
from solver.study.quantities.quantity import Quantity

SAFETY = 1.25
"""Roache's factor on what is still missing, for three meshes."""
LEAST_ORDER = 0.5
LARGEST_ORDER = 2.1
"""Between which an order is believed: a smaller one has shown no limit yet, and a
larger one is luck, as no quantity of ours has one from linear elements."""
UNSURE = 3.0
"""Times the largest difference, where there is no limit to believe. Where the order is
luck it is `SAFETY` times (both: Eca and Hoekstra, J. Comput. Phys. 262, 104, 2014)."""
AN_ELEMENT = "an element's size"
TIME_STEP = "a time step"
"""What is halved, in words."""
EQUAL = 1e-6
"""Relative difference up to which two values are one."""


@dataclass(frozen=True)
class Refinement:
    """A quantity on three meshes, each with elements or steps of half the size of the one before.

    The coarse one is first; `own` is the place of the one that is asked about.
    """

    values: tuple[float, float, float]
    own: int

    @property
    def is_told(self) -> bool:
        """Whether all three have a value."""
        return all(math.isfinite(value) for value in self.values)

    @property
    def _steps(self) -> tuple[float, float]:
        """Differences from mesh to mesh; none where all are one value."""
        coarse, middle, fine = self.values
        if max(self.values) - min(self.values) <= EQUAL * max(map(abs, self.values)):
            return 0.0, 0.0
        return middle - coarse, fine - middle

    @property
    def order(self) -> float | None:
        """Power of that size with which the rest goes; None where there is no such."""
        first, second = self._steps
        if first * second > 0.0:
            return math.log2(first / second)
        return None

    @property
    def limit(self) -> float:
        """What the quantity tends to, or that on the finest mesh where nothing tells it."""
        order = self.order
        fine = self.values[-1]
        if order is None or not LEAST_ORDER <= order <= LARGEST_ORDER:
            return fine
        return fine + self._steps[1] / math.expm1(order * math.log(2.0))

    @property
    def margin(self) -> float:
        """To both sides of the limit."""
        order = self.order
        widest = max(map(abs, self._steps))
        if order is None or order < LEAST_ORDER:
            return UNSURE * widest
        return SAFETY * (
            widest if order > LARGEST_ORDER else abs(self.limit - self.values[-1])
        )

    @property
    def deviation(self) -> float:
        """How far the value that is asked about may be from the limit, as a share of that."""
        if not any(self._steps):
            return 0.0
        most = abs(self.values[self.own] - self.limit) + self.margin
        if self.limit:
            return most / abs(self.limit)
        if most:
            return math.inf
        return 0.0


def three_of(settings: Settings, names: Sequence[str]) -> tuple[list[Settings], int]:
    """Settings with three sizes, each twice as fine as the one before, and the place of their own.

    That is the middle one, or the first where the sizes cannot be halved. Names are
    those of the mesh, or `instants`, of which the steps are counted. What a scene does
    not take is refused.
    """

    def refined(factor: float) -> Settings:
        sizes = {}
        for name in names:
            first = 1 if name == "instants" else 0
            size = factor * (settings.values()[name] - first) + first
            if size == int(size):
                sizes[name] = int(size)
            else:
                sizes[name] = size
        return settings.replace(**sizes)

    try:
        return [refined(factor) for factor in (0.5, 1, 2)], 1
    except SettingError:
        return [refined(factor) for factor in (1, 2, 4)], 0


def decides(settings: Settings, asked: Quantity) -> bool:
    """Whether a mesh decides a quantity: not how a run went, but what it came to."""
    return asked.reads is None and asked.applies(settings)


def value_on(settings: Settings, asked: Quantity) -> float:
    """A quantity of the solution on a mesh; NaN where no run certifies one."""
    run = finished_run(
        settings.replace(finish="at-once"), errors=False, indicators=False
    )
    if run.solution.is_certified:
        return asked(run)
    return math.nan


def size_of(settings: Settings) -> str:
    """Numbers of elements and instants, in words."""
    elements = " x ".join(str(getattr(settings, name)) for name in settings.MESH)
    return f"{elements} elements, {settings.values()['instants']} instants"


def answer(refinement: Refinement, unit: str, size: str = AN_ELEMENT) -> str:
    """Two sentences on what three meshes, or numbers of instants, tell by halving a size."""
    if not refinement.is_told:
        return "One of the runs came to no certified solution, or has no such value: no answer."
    if refinement.margin == 0.0:
        return f"All three are equal: {size} does not change it."
    limit = f"{refinement.limit:.4g} ± {refinement.margin:.2g} {unit}".rstrip()
    if refinement.limit:
        own = f"This run is within {_share(refinement)} of that."
    else:
        own = ""
    order = refinement.order
    if order is None:
        told = f"It follows no power of {size}: {limit} is all that is known."
    elif order < LEAST_ORDER:
        told = (
            f"It changes with the power {order:.2f} of {size}, which shows no limit: {limit}, if "
            "there is one."
        )
    elif order > LARGEST_ORDER:
        told = f"It hardly changes any more with {size}: {limit}."
    else:
        told = (
            f"Its error goes with the power {order:.2f} of {size}, and with ever smaller ones it "
            f"becomes {limit}."
        )
    return f"{told} {own}".rstrip()


def which_to_refine(elements: Refinement, instants: Refinement) -> str:
    """What both leave of the error, in a sentence; empty where one of them tells nothing."""
    if not (elements.is_told and instants.is_told):
        return ""
    if elements.deviation == instants.deviation == 0.0:
        return "Neither more elements nor more instants change it."
    left = f"elements leave up to {_share(elements)}, instants up to {_share(instants)}"
    more = "elements" if elements.deviation >= instants.deviation else "instants"
    return f"Refine {more} first: {left}."


def _share(refinement: Refinement) -> str:
    if refinement.deviation < 1.0:
        return f"{100.0 * refinement.deviation:.2g} %"
    return "all of it"
