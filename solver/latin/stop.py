"""When a run ends: what is asked of it, and what it remembers to see its end."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from solver.arrays import Array
from solver.latin.certified import finished
from solver.latin.cost import WAIT
from solver.latin.estimate import LAST, ErrorEstimate
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.latin.iterate import Iterate
from solver.latin.judged_numbers import Awaited, Numbers
from solver.latin.status import (
    BELOW,
    BELOW_UNPROVEN,
    EXPECTED,
    JUMPS,
    PROVEN,
    Ending,
    Status,
    certified,
    collapses,
    diverged,
    exhausted,
    stalled,
    with_jump,
)
from solver.latin.status_step import Certificate
from solver.refusal import check_range

if TYPE_CHECKING:
    from solver.latin.method import Latin

STALL_WINDOW = 200
"""Iterations without a lower indicator after which a run is called stalled."""
STALL_FACTOR = 0.99
"""A lower indicator is one below this part of the lowest so far."""
SELDOM = 16
"""Every so many iterations the LATIN indicator is computed, for nothing but to see a stall."""
DEFAULT_ACCURACY = 0.01
"""Of a status step that ends a run which nobody asks to be accurate."""


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
        The iterate that it makes, where the run ends with it, and the decision on that.
    """

    seconds: float
    indicator: float
    behaviour: float
    estimated_error: float
    status: Status | None
    certificate: Certificate | None = None
    finished: tuple[Iterate, Decision] | None = None


class StopState:
    """What a run remembers to see its end, and what that costs.

    A run has converged when accuracy and tolerance hold, or when a status step ends it with a
    certified solution: at once, or once the iterates themselves are that near to it. It also ends
    when the LATIN indicator has stopped falling, or numbers to be finite. Most numbers cost as much
    as an iteration: they are computed when they may be low enough, and at the first and the last.

    Attributes
    ----------
    estimate
        Of the error of the contact force.
    seconds
        Time that the run took so far beside its iterations, with those before, to make the problem.
    """

    def __init__(self, latin: Latin, spent: float = 0.0) -> None:
        self._latin, self._stop, finish = latin, latin.stop, latin.finish
        self._may_finish = finish is not None
        self._searches = finish is not None and not finish.at_once
        self._asks_accuracy = math.isfinite(self._stop.accuracy)
        self._asks_tolerance = math.isfinite(self._stop.tolerance)
        self.estimate = ErrorEstimate(
            self._stop.accuracy if self._asks_accuracy else DEFAULT_ACCURACY,
            needs_proof=latin.linear.has_to_prove,
        )
        self._on_accuracy, self._on_tolerance, self._on_sufficient = (Awaited() for _ in range(3))
        self._is_first, self._had_its_last = True, False
        self._lowest, self._lowest_at = math.inf, 0
        self._k: Array | None = None
        self.seconds = spent

    def judge(self, iterate: Iterate) -> Decision:
        """Whether the run ends after an iterate, and how."""
        began = time.perf_counter()
        self.estimate.deadline = began + self._stop.seconds - iterate.seconds - self.seconds
        if not math.isfinite(float(np.vdot(iterate.incoming.T, iterate.incoming.T))):
            seconds = self._billed(iterate, began)
            return Decision(seconds, math.nan, math.nan, math.nan, diverged(iterate.number))
        numbers = Numbers(iterate, self.estimate)
        status = self._ending(numbers)
        certificate = self.estimate.certificate
        indicator, behaviour = numbers.known("indicator"), numbers.known("behaviour")
        seconds = self._billed(iterate, began)
        is_over = status is not None or not self._searches
        if certificate is None or not (self._may_finish and is_over):
            error = numbers.known("estimated_error")
            if status is not None:
                status = with_jump(status, iterate.problem, certificate)
            return Decision(seconds, indicator, behaviour, error, status, certificate)
        error, finish = self._finished(iterate, certificate, status)
        return Decision(seconds, indicator, behaviour, error, None, certificate, finish)

    def _finished(
        self, iterate: Iterate, certificate: Certificate, status: Status | None
    ) -> tuple[float, tuple[Iterate, Decision]]:
        """Error of the last iterate of a search, its answer, and the decision that this ends it."""
        began = time.perf_counter()
        error = certificate.distance.of_friction_force(iterate)
        number, spent, searched = iterate.number + 1, iterate.seconds, iterate.reduction
        answer = finished(iterate.problem, iterate.k, certificate, number, spent, searched)
        answer = replace(answer, is_answer=self._searches)
        gave_up = status is not None and status.ending is not Ending.CONVERGED
        end = certified(answer, certificate, error, status.advice if status and gave_up else "")
        seconds, residual = self._billed(iterate, began), answer.residual or 0.0
        numbers = latin_indicator(answer), behaviour_indicator(answer), residual
        return error, (answer, Decision(seconds, *numbers, end, certificate))

    def _billed(self, iterate: Iterate, began: float) -> float:
        """Seconds of the whole run, with those since `began`."""
        self.seconds += time.perf_counter() - began
        return iterate.seconds + self.seconds

    def _ending(self, numbers: Numbers) -> Status | None:
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
            agrees = numbers.agree(tolerance)
            status = stalled(self._latin, self._lowest, tolerance, agrees=agrees)
        is_exhausted = status is None and is_last
        if is_exhausted or (status is not None and status.ending is not Ending.CONVERGED):
            _ = numbers.behaviour
            if self._may_finish and self.estimate.certificate is None:
                # Whatever it costs, where a run that may end with it would give up.
                self.estimate.try_step(iterate, LAST)
        if self.estimate.collapse is not None:
            return collapses(self.estimate.collapse)
        if self.estimate.jumps:
            return JUMPS
        if is_exhausted:
            is_late = number < self._stop.iterations
            return exhausted(self._latin, self._lack(numbers), is_late=is_late)
        return status

    def _converged(self, numbers: Numbers, *, looks_at_all: bool, is_last: bool) -> Status | None:
        """Status of a run that has converged; None where it has not, or where nobody looks."""
        stop, number = self._stop, numbers.iterate.number
        # How many iterations a search takes is asked; a distance costs a hundredth to a sixth of
        # one (measured on the five scenes).
        looks_always = self._searches and self._asks_accuracy
        if looks_always and numbers.estimated_error <= stop.accuracy and self._is_proven:
            return PROVEN
        is_due = self._on_accuracy.is_due(number) and self._on_tolerance.is_due(number)
        if (looks_at_all or is_due) and (status := self._goal(numbers)) is not None:
            return status
        if is_last or not stop.sufficient:
            return None
        is_due = looks_at_all or self._on_sufficient.is_due(number)
        is_low = is_due and numbers.is_low(stop.sufficient, self._on_sufficient)
        return BELOW if is_low else None

    def _goal(self, numbers: Numbers) -> Status | None:
        """Status of a run that is accurate enough, at a low indicator, as far as both are asked."""
        stop, number = self._stop, numbers.iterate.number
        if self._asks_accuracy:
            error = numbers.estimated_error
            self._on_accuracy.saw(number, error if self._is_proven else math.nan, stop.accuracy)
            if not error <= stop.accuracy:
                return None
            # The indicator says when to look again.
            self._on_accuracy.next = number + 1
        if self._asks_tolerance and not numbers.is_low(stop.tolerance, self._on_tolerance):
            return None
        if not self._asks_accuracy:
            return BELOW if self._asks_tolerance else None
        if self._is_proven:
            return PROVEN
        if self._latin.linear.has_to_prove:
            return None
        # An estimate counts for nothing where a step is worth its cost.
        return None if self.estimate.can_be_proven(numbers.iterate, least=WAIT) else EXPECTED

    @property
    def _is_proven(self) -> bool:
        """Whether the estimate is the distance to a certified solution."""
        return self.estimate.certificate is not None

    def _lack(self, numbers: Numbers) -> str:
        """What is not met, in a sentence without its full stop."""
        if self._asks_accuracy and self._searches and self._is_proven:
            return "The contact force of the iterates is not accurate enough"
        if self._asks_accuracy and (self._searches or not self._asks_tolerance):
            return "The contact force is not known to be accurate enough"
        if self._asks_tolerance and not numbers.indicator <= self._stop.tolerance:
            return "The LATIN indicator is still above its tolerance"
        if self._asks_accuracy:
            return BELOW_UNPROVEN
        return "The run has come to its limit"

    def _has_stalled(self, numbers: Numbers) -> bool:
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
