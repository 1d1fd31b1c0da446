"""When a run ends: what is asked of it, and what it remembers to see its end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from solver.checks import Number, check
from solver.latin.end.certified import finished
from solver.latin.end.cost import WAIT
from solver.latin.end.estimate import LAST, SOLVED, ErrorEstimate
from solver.latin.end.status import (
    BELOW,
    EXPECTED,
    PROVEN,
    UNPROVABLE,
    Decision,
    Ending,
    Status,
    certified,
    diverged,
    exhausted,
    obeyed,
    stalled,
    unprovable,
    with_jump,
)
from solver.latin.iterate import Iterate
from solver.latin.stages.pgd import PGD
from solver.reference.distance import HIDDEN, kkt_residual

if TYPE_CHECKING:
    from solver.latin.method import Latin

DEFAULT_ACCURACY = 0.01
"""Of a status step that ends a run which nobody asks to be accurate."""
LEAST_VIOLATION = 1e-12
LARGEST_VIOLATION = 1e-2
"""Bounds on what the k-free indicator may be at the end. Between them it is the root of
the tolerance on eta, a ratio of squares: by default the friction force is then within
0.1 % (block, layers) to 2 % (40 wires) of the reference; with 100 times as much it was
up to 20 % off (measured).
"""
SHARE = 8
"""What may be low enough is computed again at the latest after this part of the
iterations."""
WINDOW = 200
"""Iterations without a lower indicator after which a run is called stalled."""
OBEYED = 1e-10
"""KKT residual up to which an iterate is a solution of the discrete problem by
itself."""
FACTOR = 0.99
"""A lower indicator is one below this part of the lowest so far."""
SELDOM = 16
"""Every so many iterations the LATIN indicator is computed, for nothing but to see a
stall."""


@dataclass(frozen=True)
class Stop:
    """When a run ends; what is infinite is not asked.

    Accuracy and tolerance, where both are asked, have to hold together; it ends in any
    case after so many iterations or seconds.

    Attributes
    ----------
    accuracy
        Share that the contact force may be wrong by, by estimate; where a status step
        is worth its cost, the exact solution has to prove it.
    tolerance
        LATIN indicator eta, a ratio of squares, that is low enough if the k-free
        indicator agrees.
    iterations
        Most iterations.
    seconds
        Most seconds; a start or a status step that takes longer is given up.
    sufficient
        LATIN indicator that ends a run by itself, though the accuracy is not known; 0:
        none does.

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
        share = Number(0.0, 1.0, above=True, endless=True)
        check(
            self,
            accuracy=share,
            tolerance=share,
            iterations=Number(1, endless=True),
            seconds=Number(0.0, above=True, endless=True),
            sufficient=Number(0.0, 1.0),
        )


class StopState:
    """What a run remembers to see its end, and what that costs.

    A run has converged when accuracy and tolerance hold, or when a status step ends it
    with a certified solution: at once, or once the iterates themselves are that near to
    it. It also ends when the LATIN indicator has stopped falling, or numbers to be
    finite. Most numbers cost as much as an iteration: they are computed when they may
    be low enough, and at the first and the last. Beside its iterations the run took so
    many `seconds` so far. A status step is given up where `interrupted` returns True.
    """

    def __init__(
        self,
        latin: Latin,
        spent: float = 0.0,
        interrupted: Callable[[], bool] = lambda: False,
    ) -> None:
        self._latin = latin
        self._stop = latin.stop
        self.seconds = spent
        self._may_finish = latin.finish is not None
        self._searches = latin.finish is not None and not latin.finish.at_once
        self._asks_accuracy = math.isfinite(self._stop.accuracy)
        if self._asks_accuracy:
            accuracy = self._stop.accuracy
        else:
            accuracy = DEFAULT_ACCURACY
        has_bases = isinstance(latin.linear, PGD)
        self.estimate = ErrorEstimate(
            accuracy, needs_proof=has_bases, interrupted=interrupted
        )
        self._on_goal = NextCheck()
        self._on_sufficient = NextCheck()
        self._stall = StallCheck()

    def judge(self, iterate: Iterate) -> Decision:
        """Whether the run ends after an iterate, and how."""
        began = time.perf_counter()
        self.estimate.deadline = (
            began + self._stop.seconds - iterate.seconds - self.seconds
        )
        if not math.isfinite(float(np.vdot(iterate.incoming.T, iterate.incoming.T))):
            return Decision(
                self._billed(iterate, began), status=diverged(iterate.number)
            )
        error, status = self._ending(iterate)
        certificate = self.estimate.certificate
        residual = self._residual(iterate, status)
        if residual <= OBEYED:
            status = obeyed(residual)
        decision = Decision(self._billed(iterate, began), error, status, certificate)
        if residual <= OBEYED and self._may_finish:
            answer = replace(
                iterate,
                number=iterate.number + 1,
                residual=residual,
                is_answer=self._searches,
            )
            last = replace(decision, estimated_error=residual)
            return replace(decision, status=None, finished=(answer, last))
        goes_on = self._searches and status is None
        if certificate is None or not self._may_finish or goes_on:
            return decision
        began = time.perf_counter()
        error = certificate.distance.of_friction_force(iterate)
        answer = finished(iterate.problem, iterate.k, certificate, iterate)
        answer = replace(answer, is_answer=self._searches)
        gave_up = status is not None and status.ending is not Ending.CONVERGED
        end = certified(
            answer, certificate, error, status.advice if status and gave_up else ""
        )
        last = Decision(
            self._billed(iterate, began), certificate.residual, end, certificate
        )
        return replace(
            decision, estimated_error=error, status=None, finished=(answer, last)
        )

    def _residual(self, iterate: Iterate, status: Status | None) -> float:
        """KKT residual of an iterate that may be a solution though none is certified, or NaN.

        It may be where the stages agree up to rounding. It is dear: so it is computed
        now and then, and where a run would end without an answer.
        """
        gives_up = status is not None and status.ending is not Ending.CONVERGED
        ends = self._may_finish and not self._searches
        is_due = gives_up or (ends and status is None and iterate.number % SELDOM == 0)
        problem = iterate.problem
        is_judged = not (problem.no_reference or problem.goes_on)
        if self.estimate.is_proven or not is_due or iterate.indicator > SOLVED:
            return math.nan
        if is_judged:
            return kkt_residual(iterate, problem, HIDDEN)
        return math.nan

    def _billed(self, iterate: Iterate, began: float) -> float:
        """Seconds of the whole run, with those since `began`."""
        self.seconds += time.perf_counter() - began
        return iterate.seconds + self.seconds

    def _ending(self, iterate: Iterate) -> tuple[float, Status | None]:
        """Estimated error of an iterate, NaN where nobody asks, and how the run ends, or None."""
        stop = self._stop
        estimate = self.estimate
        number = iterate.number
        is_last = (
            number >= stop.iterations or iterate.seconds + self.seconds >= stop.seconds
        )
        is_due = is_last or number >= self._on_goal.next
        error = math.nan
        status = None
        # How many iterations a search takes is asked; a distance costs a hundredth to a
        # sixth of one (measured on the five scenes).
        if self._asks_accuracy and (is_due or self._searches):
            error = estimate(iterate)
        if self._searches and estimate.is_proven and error <= stop.accuracy:
            status = PROVEN
        elif is_due:
            status = self._converged(iterate, error)
        if status is None and stop.sufficient > 0.0:
            check = self._on_sufficient
            if (is_last or number >= check.next) and self._is_low(
                iterate, stop.sufficient, check
            ):
                status = BELOW
        if status is None and self._stall.has_stalled(iterate):
            status = stalled(self._latin, self._stall.indicator)
        if status is None:
            gives_up = is_last
        else:
            gives_up = status.ending is not Ending.CONVERGED
        if gives_up and self._may_finish and not estimate.is_proven:
            # Whatever it costs, where a run that may end with it would give up.
            estimate.try_step(iterate, LAST)
        if estimate.ending is not None:
            return error, estimate.ending
        if status is None and is_last:
            status = exhausted(self._latin, iterate, is_proven=estimate.is_proven)
        if status is not None:
            status = with_jump(status, iterate.problem, estimate.certificate)
            status = unprovable(status, iterate.problem, self._latin)
        return error, status

    def _converged(self, iterate: Iterate, error: float) -> Status | None:
        """Status of a run that is accurate enough, at a low indicator, as far as both are asked."""
        stop = self._stop
        estimate = self.estimate
        number = iterate.number
        if self._asks_accuracy:
            value = error / stop.accuracy
            self._on_goal.update(number, value if estimate.is_proven else math.nan)
            if not value <= 1.0:
                return None
            # The indicator says when to check again.
            self._on_goal.next = number + 1
        asks_tolerance = math.isfinite(stop.tolerance)
        if asks_tolerance and not self._is_low(iterate, stop.tolerance, self._on_goal):
            return None
        if not self._asks_accuracy:
            return BELOW if asks_tolerance else None
        if estimate.is_proven:
            return PROVEN
        # An estimate counts for nothing on bases, or where a step is worth its cost.
        counts = not (
            estimate.needs_proof or estimate.can_be_proven(iterate, least=WAIT)
        )
        if not counts:
            return None
        return UNPROVABLE if iterate.problem.no_reference else EXPECTED

    def _is_low(self, iterate: Iterate, tolerance: float, check: NextCheck) -> bool:
        """Whether the LATIN indicator is low enough, and the k-free one or the solution agrees.

        The LATIN indicator alone can be fooled: a search direction that is far from the
        stiffness in play makes it as small as one likes (solver/README.md, 4). The
        k-free one is a share of what contact carries, which is nothing where all
        contacts open.
        """
        check.update(iterate.number, iterate.indicator / tolerance)
        if iterate.indicator > tolerance:
            return False
        enough = min(max(math.sqrt(tolerance), LEAST_VIOLATION), LARGEST_VIOLATION)
        return iterate.behaviour <= enough or self.estimate.is_proven_within(
            enough, iterate
        )


class NextCheck:
    """The next iteration at which a number that falls is worth computing.

    Half way to where its last two values, over what is low enough, would have it fall
    to 1; while it does not fall, after half of the longest wait: it is missed by
    little.
    """

    def __init__(self) -> None:
        self.next = 0
        self._last = (0, math.nan)

    def update(self, iteration: int, value: float) -> None:
        """Take in a value."""
        (before, last) = self._last
        left = 0.0
        self._last = iteration, value
        if 1.0 < value < last and iteration > before:
            left = 0.5 * math.log(value) / math.log(last / value) * (iteration - before)
        if value <= 1.0:
            least = 0
        else:
            least = iteration // (2 * SHARE)
        self.next = iteration + 1 + max(int(min(left, iteration / SHARE)), least)


class StallCheck:
    """Whether the LATIN indicator has stalled, and the lowest so far."""

    def __init__(self) -> None:
        self.indicator = math.inf
        self._number = 0
        self._k = np.zeros(0)

    def has_stalled(self, iterate: Iterate) -> bool:
        """Whether it has stopped falling."""
        number = iterate.number
        if iterate.k is not self._k:
            # It is measured by k: to look for the lowest begins anew.
            self.indicator = math.inf
            self._number = number
            self._k = iterate.k
        if number % SELDOM and number - self._number < WINDOW:
            return False
        if iterate.indicator < FACTOR * self.indicator:
            self.indicator = iterate.indicator
            self._number = number
        return number - self._number >= WINDOW
