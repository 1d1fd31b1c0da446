"""Driving the iteration to an end: stop rules, records, and one status with advice."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from solver.discrete.problem import Problem
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iterations import iterations
from solver.reduction.basis import ReductionRecord
from solver.reference.distance import Distance
from solver.settings import Settings

STALL_WINDOW = 200
STALL_FACTOR = 0.99
ROUNDING = 1e-24
LARGEST_VIOLATION = 1e-2
SMALLEST_VIOLATION = 1e-12
VIOLATION = 1.0
"""Times the root of the tolerance on eta, which is a ratio of squares: what the k-free indicator
may be at the end, between the two bounds above. Measured at the default tolerance: the friction
force is then within 0.1 % (block, layers), 0.4 % (bar, 2 to 20 wires) and 2 % (40 wires, or 200
elements with the paper's options) of the reference; with 100 it was up to 20 % off."""


class Ending(StrEnum):
    """How a run can end."""

    CONVERGED = "converged"
    EXHAUSTED = "exhausted"
    STALLED = "stalled"
    CANCELLED = "cancelled"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class Status:
    """The end of a run, in a word, and what to try next in a sentence."""

    ending: Ending
    advice: str


@dataclass(frozen=True)
class Record:
    """The scalars of one iteration; an error is NaN while no reference is at hand.

    Attributes
    ----------
    seconds
        Time that the method took so far, s.
    indicator
        LATIN indicator eta (paper, eq. 2).
    behaviour, behaviour_largest
        The k-free indicator, and the largest entry of its map.
    error_displacement, error_force
        Relative L2 distance to the reference over space and time.
    reduction
        What the iteration did to the separated basis of every substructure; empty without bases.
    local_error
        Of the reduced local stage, as in `Iterate`.
    """

    iteration: int
    seconds: float
    indicator: float
    behaviour: float
    behaviour_largest: float
    error_displacement: float
    error_force: float
    reduction: tuple[ReductionRecord, ...] = ()
    local_error: float = 0.0


@dataclass(frozen=True, eq=False)
class Solution:
    """The last good iterate of a run, its records, and how it ended."""

    iterate: Iterate
    records: list[Record]
    status: Status


def record(iterate: Iterate, distance: Distance | None) -> Record:
    """Compute the scalars of an iterate, off the method's clock."""
    behaviour = behaviour_indicator(iterate)
    return Record(
        iteration=iterate.number,
        seconds=iterate.seconds,
        indicator=latin_indicator(iterate),
        behaviour=behaviour.total,
        behaviour_largest=behaviour.largest,
        error_displacement=distance.of_displacement(iterate) if distance else math.nan,
        error_force=distance.of_friction_force(iterate) if distance else math.nan,
        reduction=iterate.reduction.records if iterate.reduction else (),
        local_error=iterate.local_error,
    )


def agreement(tolerance: float) -> float:
    """Give the k-free indicator up to which it agrees that the run has converged.

    The LATIN indicator alone can be fooled: a search direction that is far from the stiffness in
    play makes it as small as one likes (theory.md, 4).
    """
    return min(max(VIOLATION * math.sqrt(tolerance), SMALLEST_VIOLATION), LARGEST_VIOLATION)


class StopRules:
    """When a run ends; it remembers the best indicator to see a stall."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._best = math.inf
        self._best_at = 0

    def judge(self, iteration: int, indicator: float, behaviour: float) -> Status | None:
        """Say how the run ends after an iteration with these indicators, or None if it goes on."""
        settings = self._settings
        if not math.isfinite(indicator):
            return Status(
                Ending.DIVERGED,
                f"Numbers stopped being finite at iteration {iteration}; the iterate before it is "
                "kept. Lower the relaxation, or bring k_scale and the loads nearer to 1.",
            )
        agreed = behaviour <= agreement(settings.tolerance)
        if indicator <= settings.tolerance and agreed:
            return Status(
                Ending.CONVERGED,
                "Both indicators are low. They are no errors: lower the tolerance if the error is "
                "still too large.",
            )
        if indicator < STALL_FACTOR * self._best:
            self._best, self._best_at = indicator, iteration
        if iteration - self._best_at >= STALL_WINDOW:
            return Status(Ending.STALLED, self._stall_advice(agreed))
        if iteration >= settings.max_iterations:
            still = indicator <= settings.tolerance
            laws = " before the interface laws hold as well as the tolerance asks" if still else ""
            return Status(Ending.EXHAUSTED, f"The iterations are used up{laws}. {self._remedy()}")
        return None

    def _stall_advice(self, agreed: bool) -> str:
        if self._best < ROUNDING and agreed:
            return "The indicator is down to rounding: this is as near as it gets."
        if self._best < ROUNDING:
            return (
                "The LATIN indicator is down to rounding, but the interface laws do not hold: the "
                "friction force is too small beside the load, or k too far from the stiffness, "
                "for more digits. Bring friction, the load and k_scale nearer to each other."
            )
        if self._best <= self._settings.tolerance:
            return (
                "The LATIN indicator is below the tolerance, but the interface laws do not hold: "
                "the k-free indicator says so. Try another k_scale."
            )
        if self._settings.relaxation > 0.9:
            return "The indicator does not fall any more. Lower the relaxation to 0.8."
        return f"The indicator does not fall any more. {self._remedy()}"

    def _remedy(self) -> str:
        if self._settings.is_reduced:
            return "The separated bases may be too small: raise pgd_modes, lower pgd_tolerance."
        return "Raise max_iterations, loosen the tolerance, or try another k_scale."


CANCELLED = Status(Ending.CANCELLED, "The run was stopped; it can be started again.")


def solve(
    problem: Problem,
    settings: Settings,
    *,
    distance: Distance | None = None,
    start: Checkpoint | None = None,
    cancelled: Callable[[], bool] = lambda: False,
) -> Solution:
    """Drive the iteration until a stop rule ends it.

    Parameters
    ----------
    problem, settings, start
        As for `iterations`.
    distance
        To a reference, for the errors in the records.
    cancelled
        Asked after every iteration.
    """
    rules = StopRules(settings)
    records: list[Record] = []
    last = None
    for iterate in iterations(problem, settings, start):
        entry = record(iterate, distance)
        status = rules.judge(iterate.number, entry.indicator, entry.behaviour)
        if status is not None and status.ending is Ending.DIVERGED:
            return Solution(last or iterate, records, status)
        records.append(entry)
        last = iterate
        if status is None and cancelled():
            status = CANCELLED
        if status is not None:
            return Solution(iterate, records, status)
    raise AssertionError("the iteration has no end of its own")
