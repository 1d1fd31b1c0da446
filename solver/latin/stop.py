"""When a run ends: what is asked of it, and what it remembers to see its end."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from solver.arrays import Array
from solver.latin.certified import finished
from solver.latin.estimate import LAST, WAIT, ErrorEstimate
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.latin.iterate import Iterate
from solver.latin.status import (
    BELOW,
    EXPECTED,
    JUMPS,
    PROVEN,
    Advice,
    Ending,
    Status,
    certified,
    collapses,
    diverged,
    with_jump,
)
from solver.latin.status_step import Certificate
from solver.refusal import check_range

if TYPE_CHECKING:
    from solver.latin.method import Latin

LARGEST_VIOLATION = 1e-2
"""Of the k-free indicator at the end, however loose the tolerance."""
SMALLEST_VIOLATION = 1e-12
"""The same however tight it is."""
VIOLATION = 1.0
"""Times the root of the tolerance on eta, which is a ratio of squares: what the k-free indicator
may be at the end, between the two bounds above. Measured at the default tolerance: the friction
force is then within 0.1 % (block, layers), 0.4 % (bar, 2 to 20 wires) and 2 % (40 wires, or 200
elements with the paper's options) of the reference; with 100 it was up to 20 % off."""
STALL_WINDOW = 200
"""Iterations without a lower indicator after which a run is called stalled."""
STALL_FACTOR = 0.99
"""A lower indicator is one below this part of the lowest so far."""
SELDOM = 16
"""Every so many iterations the LATIN indicator is computed, for nothing but to see a stall."""
DEFAULT_ACCURACY = 0.01
"""Of a status step that ends a run which nobody asks to be accurate."""
SHARE = 8
"""A value that is awaited is computed again at the latest after this part of the iterations."""


@dataclass(frozen=True)
class Stop:
    """When a run ends; what is infinite is not asked.

    Accuracy and tolerance, where both are asked, have to hold together; it ends in any case after
    so many iterations or seconds.

    Attributes
    ----------
    accuracy
        Share that the contact force may be wrong by, by estimate; where a status step is worth its
        cost, the exact solution has to prove it.
    tolerance
        LATIN indicator eta, a ratio of squares, that is low enough if the k-free indicator agrees.
    iterations
        Most iterations.
    seconds
        Most seconds; a start or a status step that takes longer is given up.
    sufficient
        LATIN indicator that ends a run by itself, though the accuracy is not known; 0: none does.

    Raises
    ------
    RefusedError
        For a number out of its range.
    """

    accuracy: float = math.inf
    tolerance: float = math.inf
    iterations: float = math.inf
    seconds: float = math.inf
    sufficient: float = 0.0

    def __post_init__(self) -> None:
        for name in ("accuracy", "tolerance"):
            if getattr(self, name) != math.inf:
                check_range(self, name, 0.0, 1.0, above=True)
        check_range(self, "iterations", 1, math.inf)
        check_range(self, "seconds", 0.0, math.inf, above=True)
        check_range(self, "sufficient", 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Decision:
    """What the stop rules make of an iterate.

    Attributes
    ----------
    seconds
        Time that the run took so far, the stop rules' own included, s.
    indicator, behaviour, estimated_error
        As in `Record`; NaN where the rules did not need them.
    status
        How the run ends, or None if it goes on.
    certificate
        The solution of the discrete problem, if a status step has found it.
    finished
        The iterate that it makes, where the run ends with it.
    """

    seconds: float
    indicator: float
    behaviour: float
    estimated_error: float
    status: Status | None
    certificate: Certificate | None = None
    finished: Iterate | None = None


class StopState:
    """What a run remembers to see its end, and what that costs.

    A run has converged when accuracy and tolerance hold, or when a status step ends it with a
    certified solution: at once, or once the iterates themselves are that near to it. It also ends
    when the LATIN indicator has stopped falling, or numbers to be finite.

    Most numbers cost as much as an iteration, so they are computed when they may be low enough, and
    at the first and the last iteration.

    Parameters
    ----------
    latin
        The method.
    spent
        Seconds that the run took before its iterations, to make the problem.

    Attributes
    ----------
    estimate
        Of the error of the contact force.
    seconds
        Time that the run took so far beside its iterations.
    """

    def __init__(self, latin: Latin, spent: float = 0.0) -> None:
        self._stop, finish = latin.stop, latin.finish
        self._may_finish = finish is not None
        self._searches = finish is not None and not finish.at_once
        self._advice = Advice(latin.linear.remedy, self._may_finish, latin.relaxation)
        self._asks_accuracy = math.isfinite(self._stop.accuracy)
        self._asks_tolerance = math.isfinite(self._stop.tolerance)
        self.estimate = ErrorEstimate(
            self._stop.accuracy if self._asks_accuracy else DEFAULT_ACCURACY,
            needs_proof=latin.linear.has_to_prove,
        )
        self._on_accuracy, self._on_tolerance, self._on_sufficient = (_Awaited() for _ in range(3))
        self._is_first, self._had_its_last = True, False
        self._error, self._why = math.nan, ""
        self._lowest, self._lowest_at = math.inf, 0
        self._k: Array | None = None
        self.seconds = spent

    def judge(self, iterate: Iterate) -> Decision:
        """Whether the run ends after an iterate, and how."""
        began = time.perf_counter()
        billed = iterate.seconds + self.seconds
        self.estimate.deadline = began + self._stop.seconds - billed
        if not math.isfinite(float(np.vdot(iterate.incoming.T, iterate.incoming.T))):
            seconds = self._billed(iterate, began)
            return Decision(seconds, math.nan, math.nan, math.nan, diverged(iterate.number))
        numbers = _Numbers(iterate, self.estimate)
        status = self._ending(numbers)
        certificate = self.estimate.certificate
        indicator, behaviour = numbers.known("indicator"), numbers.known("behaviour")
        seconds = self._billed(iterate, began)
        is_over = status is not None or not self._searches
        if certificate is None or not (self._may_finish and is_over):
            estimated = numbers.known("estimated_error")
            if status is not None:
                status = with_jump(status, iterate.problem, certificate)
            return Decision(seconds, indicator, behaviour, estimated, status, certificate)
        began = time.perf_counter()
        self._error = estimated = certificate.distance.of_friction_force(iterate)
        if status is not None and status.ending is not Ending.CONVERGED:
            self._why = status.advice
        number, spent, searched = iterate.number + 1, iterate.seconds, iterate.reduction
        finish = finished(iterate.problem, iterate.k, certificate, number, spent, searched)
        finish = replace(finish, is_answer=self._searches)
        self._billed(iterate, began)
        return Decision(seconds, indicator, behaviour, estimated, None, certificate, finish)

    def close(self, finish: Iterate) -> Decision:
        """The end of a run with its certified solution."""
        certificate = self.estimate.certificate
        seconds = finish.seconds + self.seconds
        return Decision(
            seconds,
            latin_indicator(finish),
            behaviour_indicator(finish),
            finish.residual or 0.0,
            certified(finish, certificate, self._error, self._why),
            certificate,
        )

    def _billed(self, iterate: Iterate, began: float) -> float:
        """Seconds of the whole run, with those since `began`."""
        self.seconds += time.perf_counter() - began
        return iterate.seconds + self.seconds

    def _ending(self, numbers: _Numbers) -> Status | None:
        """How the run ends after an iterate, or None."""
        iterate, number = numbers.iterate, numbers.iterate.number
        is_late = iterate.seconds + self.seconds >= self._stop.seconds
        is_last = number >= self._stop.iterations or is_late
        looks_at_all = self._is_first or is_last
        self._is_first = False
        if self._may_finish and not self._had_its_last and self.estimate.is_last_chance(iterate):
            self._had_its_last = True
            self.estimate.try_step(iterate, LAST, least=math.inf)
        if looks_at_all or number % SELDOM == 0:
            _ = numbers.indicator
        status = self._converged(numbers, looks_at_all=looks_at_all, is_last=is_last)
        stalls = self._has_stalled(numbers)
        if status is None and stalls:
            tolerance = min(self._stop.tolerance, self._stop.sufficient or math.inf)
            agrees = _agrees(numbers, tolerance)
            status = self._advice.stalled(self._lowest, tolerance, agrees=agrees)
        is_exhausted = status is None and is_last
        if is_exhausted or (status is not None and status.ending is not Ending.CONVERGED):
            _ = numbers.behaviour
            if self._may_finish and self.estimate.certificate is None:
                # Whatever it costs, where a run that may end with it would give up.
                self.estimate.try_step(iterate, LAST)
        if self.estimate.collapse is not None:
            return collapses(self.estimate.collapse.time)
        if self.estimate.jumps:
            return JUMPS
        if is_exhausted:
            is_late = number < self._stop.iterations
            return self._advice.exhausted(self._lack(numbers), is_late=is_late)
        return status

    def _converged(self, numbers: _Numbers, *, looks_at_all: bool, is_last: bool) -> Status | None:
        """Status of a run that has converged; None where it has not, or where nobody looks."""
        stop, number = self._stop, numbers.iterate.number
        # How many iterations a search takes is asked; a distance costs a hundredth to a sixth of
        # one (measured on the five scenes).
        looks_always = self._searches and self._asks_accuracy
        if looks_always and numbers.estimated_error <= stop.accuracy and self.estimate.is_proven:
            return PROVEN
        is_due = self._on_accuracy.is_due(number) and self._on_tolerance.is_due(number)
        if (looks_at_all or is_due) and (status := self._goal(numbers)) is not None:
            return status
        if is_last or not stop.sufficient:
            return None
        is_due = looks_at_all or self._on_sufficient.is_due(number)
        is_low = is_due and _is_low(numbers, stop.sufficient, self._on_sufficient)
        return BELOW if is_low else None

    def _goal(self, numbers: _Numbers) -> Status | None:
        """Status of a run that is accurate enough, at a low indicator, as far as both are asked."""
        stop, estimate, number = self._stop, self.estimate, numbers.iterate.number
        if self._asks_accuracy:
            error = numbers.estimated_error
            self._on_accuracy.saw(number, error if estimate.is_proven else math.nan, stop.accuracy)
            if not error <= stop.accuracy:
                return None
            # The indicator says when to look again.
            self._on_accuracy.next = number + 1
        if self._asks_tolerance and not _is_low(numbers, stop.tolerance, self._on_tolerance):
            return None
        if not self._asks_accuracy:
            return BELOW if self._asks_tolerance else None
        if estimate.is_proven:
            return PROVEN
        return None if estimate.has_to_be_proven(numbers.iterate, WAIT) else EXPECTED

    def _lack(self, numbers: _Numbers) -> str:
        """What is not met, in a sentence without its full stop."""
        if self._asks_accuracy and self._searches and self.estimate.is_proven:
            return "The contact force of the iterates is not accurate enough"
        if self._asks_accuracy and (self._searches or not self._asks_tolerance):
            return "The contact force is not known to be accurate enough"
        if self._asks_tolerance and not numbers.indicator <= self._stop.tolerance:
            return "The LATIN indicator is still above its tolerance"
        if self._asks_accuracy:
            return (
                "The LATIN indicator is below its tolerance, yet the contact force is not known to "
                "be accurate enough"
            )
        return "The run has come to its limit"

    def _has_stalled(self, numbers: _Numbers) -> bool:
        """Whether the LATIN indicator has stopped falling."""
        iterate = numbers.iterate
        if iterate.k is not self._k:
            # The indicator is measured by k: to look for the lowest begins anew.
            self._lowest, self._lowest_at = math.inf, iterate.number
        self._k = iterate.k
        indicator = numbers.known("indicator")
        if indicator < STALL_FACTOR * self._lowest:
            self._lowest, self._lowest_at = indicator, iterate.number
        return math.isfinite(indicator) and iterate.number - self._lowest_at >= STALL_WINDOW


class _Numbers:
    """Numbers by which one iterate is judged, each computed when it is first needed."""

    def __init__(self, iterate: Iterate, estimate: ErrorEstimate) -> None:
        self.iterate, self.estimate = iterate, estimate

    @cached_property
    def indicator(self) -> float:
        """LATIN indicator eta, a ratio of squares (paper, eq. 2)."""
        return latin_indicator(self.iterate)

    @cached_property
    def behaviour(self) -> float:
        """The k-free indicator (solver/README.md, 4)."""
        return behaviour_indicator(self.iterate)

    @cached_property
    def estimated_error(self) -> float:
        """Relative error of the contact force, estimated; NaN while that cannot be."""
        return self.estimate(self.iterate, self.known("indicator"))

    def known(self, name: str) -> float:
        """One of these numbers if it was computed, else NaN."""
        value: float = self.__dict__.get(name, math.nan)
        return value


class _Awaited:
    """The next iteration at which a number that falls towards a level is worth computing.

    Half way to where its last two values would have it cross the level; while it does not fall,
    after half of the longest wait. So it is missed by little, and only if it falls suddenly.
    """

    def __init__(self) -> None:
        self.next = 0
        self._last = (0, math.nan)

    def is_due(self, iteration: int) -> bool:
        """Whether to compute it at this iteration."""
        return iteration >= self.next

    def saw(self, iteration: int, value: float, level: float) -> None:
        """Take in a value."""
        before, last = self._last
        self._last = iteration, value
        left = 0.0
        if level < value < last and iteration > before:
            rate = math.log(last / value) / (iteration - before)
            left = 0.5 * math.log(value / level) / rate
        least = 0 if value <= level else iteration // (2 * SHARE)
        self.next = iteration + 1 + max(int(min(left, iteration / SHARE)), least)


def _is_low(numbers: _Numbers, tolerance: float, awaited: _Awaited) -> bool:
    """Whether the LATIN indicator is low enough, and the k-free one agrees."""
    awaited.saw(numbers.iterate.number, numbers.indicator, tolerance)
    return numbers.indicator <= tolerance and _agrees(numbers, tolerance)


def _agrees(numbers: _Numbers, tolerance: float) -> bool:
    """Whether the k-free indicator says converged, or the solution itself does.

    The LATIN indicator alone can be fooled: a search direction that is far from the stiffness in
    play makes it as small as one likes (solver/README.md, 4). The k-free one is a share of what
    contact carries, which is nothing where all contacts open.
    """
    enough = min(max(VIOLATION * math.sqrt(tolerance), SMALLEST_VIOLATION), LARGEST_VIOLATION)
    return numbers.behaviour <= enough or numbers.estimate.is_proven_within(enough, numbers.iterate)
