"""Stop rules: the state of a run's criteria (`StopState`).

A run is judged by one rule, at iterations that grow by a sixteenth. The rule, and what
each constant of it buys, are in MATHEMATICS.md, 7.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from solver.arrays import Array
from solver.latin.end.certified import answer_of_iterate, certified_answer
from solver.latin.end.estimate import AGAIN, OBEYED, SAFETY, ErrorEstimate
from solver.latin.end.status import (
    ABOVE,
    AT_LIMIT,
    BELOW,
    CERTIFIED,
    EXPECTED,
    INACCURATE,
    NO_CERTIFICATE,
    UNCERTIFIED,
    Decision,
    Ending,
    Status,
    certified,
    diverged,
    exhausted,
    not_found,
    obeyed,
    remedies_of,
    stalled,
    with_jump,
    without_certificate,
)
from solver.latin.end.status_step import Certificate
from solver.latin.iterate import Iterate
from solver.latin.method import Latin
from solver.latin.stages.pgd import PGD
from solver.reference.assembly import never
from solver.reference.distance import HIDDEN, kkt_residual

LARGEST_VIOLATION = 1e-2
"""Largest limit of the k-free indicator at the end; below it the limit is the root of
the tolerance on eta, which is a ratio of squares. By default the friction force is then
within 0.1 % (block, layers) to 2 % (40 wires) of the reference; with a limit 100 times
as large it was up to 20 % off (measured)."""
SHARE = 16
"""Part of the iterations so far after which a run is judged again: the sixteenth."""
LATE = 100
"""Iterations before which no run is called stalled."""
AGREED = 0.25
"""Largest k-free indicator, over the accuracy, at which an estimate ends a run without
a certificate. Changes are small, too, where k is so far off that nothing moves: one of
1500 random runs, a wall of slender bricks, was 2.3 times as far away as its accuracy,
at an indicator of 0.6 of it (measured)."""


class StopState:
    """State of the stop rules during a run, and the time that they take.

    A run has converged when accuracy and tolerance hold, or when a status step ends it
    with a certified solution: at once, or as soon as the iterates themselves are within
    the accuracy of that solution. A run also ends when the LATIN indicator has stopped
    falling, or when fields are no longer finite.

    Most of these numbers cost as much as an iteration. They are computed at iterations
    that grow by a sixteenth, and at the last one.

    Parameters
    ----------
    latin
        Method of the run.
    spent
        Time that the run took beside its iterations so far, s.
    interrupted
        Returns True where a status step is to be given up.
    """

    def __init__(
        self,
        latin: Latin,
        spent: float = 0.0,
        interrupted: Callable[[], bool] = never,
    ) -> None:
        self._stop = latin.stop
        self._relaxation = latin.relaxation
        self.seconds = spent
        self._may_finish = latin.finish is not None
        self._searches = latin.finish is not None and not latin.finish.at_once
        self._asks_accuracy = math.isfinite(self._stop.accuracy)
        self._has_bases = isinstance(latin.linear, PGD)
        self._remedies = remedies_of(
            may_finish=self._may_finish, has_bases=self._has_bases
        )
        self.estimate = ErrorEstimate(
            self._stop.accuracy,
            needs_certificate=self._has_bases or latin.start is not None,
            may_shift=latin.may_shift,
            interrupted=interrupted,
        )
        self._next = 1
        self._stall = StallCheck()

    def judge(self, iterate: Iterate) -> Decision:
        """Decide whether the run ends after an iterate, and how."""
        began = time.perf_counter()
        self.estimate.deadline = (
            began + self._stop.seconds - iterate.seconds - self.seconds
        )
        # One number that is not finite makes the sum of squares not finite.
        if not math.isfinite(float(np.vdot(iterate.incoming.T, iterate.incoming.T))):
            return Decision(
                self._billed(iterate, began), status=diverged(iterate.number)
            )
        error, status = self._ending(iterate)
        certificate = self.estimate.certificate
        residual = self._own_residual(iterate, status)
        is_solution = residual <= OBEYED
        if is_solution:
            status = obeyed(residual)
        decision = Decision(self._billed(iterate, began), error, status, certificate)
        if is_solution and self._may_finish:
            answer = answer_of_iterate(iterate, residual, is_beside=self._searches)
            last = replace(decision, estimated_error=residual)
            return replace(decision, status=None, finished=(answer, last))
        # A search continues though its answer is known, until it comes to its own end.
        goes_on = self._searches and status is None
        if certificate is None or not self._may_finish or goes_on:
            return decision
        return self._finished(iterate, decision, certificate)

    def _finished(
        self, iterate: Iterate, decision: Decision, certificate: Certificate
    ) -> Decision:
        """End a run with its certified solution, as one more iterate."""
        began = time.perf_counter()
        error = certificate.distance.of_friction_force(iterate)
        answer = certified_answer(
            iterate.problem,
            iterate.k,
            certificate,
            iterate,
            is_beside=self._searches,
        )
        advice = ""
        if decision.status is not None and _is_failure(decision.status):
            advice = decision.status.advice
        status = certified(answer, certificate, error, advice)
        seconds = self._billed(iterate, began)
        last = Decision(seconds, certificate.residual, status, certificate)
        return replace(
            decision, estimated_error=error, status=None, finished=(answer, last)
        )

    def _own_residual(self, iterate: Iterate, status: Status | None) -> float:
        """KKT residual of an iterate at which a run would fail; NaN at all others.

        That iterate may be one where both stages agree up to rounding.
        """
        problem = iterate.problem
        has_rules = not (problem.no_reference or problem.has_start)
        if _is_failure(status) and has_rules and not self.estimate.is_certified:
            return kkt_residual(iterate, problem, HIDDEN)
        return math.nan

    def _billed(self, iterate: Iterate, began: float) -> float:
        """Add the time since `began` to that of the rules; return the run's seconds."""
        self.seconds += time.perf_counter() - began
        return iterate.seconds + self.seconds

    def _ending(self, iterate: Iterate) -> tuple[float, Status | None]:
        """Estimated error, NaN if not needed, and status, None if the run continues."""
        estimate = self.estimate
        is_last = self._is_last(iterate)
        is_due = is_last or iterate.number >= self._next
        # The iterations of a search are counted, so its error is needed at each of
        # them; a distance costs a hundredth to a sixth of one (measured on the five
        # scenes).
        counts = self._searches and estimate.is_certified
        error = math.nan
        if self._asks_accuracy and (is_due or counts):
            error = estimate(iterate)
        status = None
        if self._searches and estimate.is_certified and error <= self._stop.accuracy:
            status = CERTIFIED
        elif is_due:
            self._next = iterate.number + 1 + iterate.number // SHARE
            status = self._reached(iterate, error)
        gives_up = _is_failure(status) or (status is None and is_last)
        if gives_up and self._may_finish and not estimate.is_certified:
            # Without a certified solution the run would have no answer.
            estimate.try_step(iterate)
        if estimate.ending is not None:
            return error, estimate.ending
        if status is None and is_last:
            status = self._exhausted(iterate)
        if status is not None:
            problem = iterate.problem
            if _is_failure(status) and estimate.unsolved_from is not None:
                status = not_found(status, problem, estimate.unsolved_from)
            status = with_jump(status, problem, estimate.certificate)
            status = without_certificate(status, problem, has_bases=self._has_bases)
        return error, status

    def _is_last(self, iterate: Iterate) -> bool:
        """Check whether an iterate is at the limit of iterations or seconds."""
        seconds = iterate.seconds + self.seconds
        return iterate.number >= self._stop.iterations or seconds >= self._stop.seconds

    def _reached(self, iterate: Iterate, error: float) -> Status | None:
        """Status of a run that has converged or stalled; else None."""
        status = self._converged(iterate, error)
        if status is not None:
            return status
        # With the paper's k on many elements a low indicator says little: what is too
        # far away even by its changes alone continues.
        is_far = error > SAFETY * self._stop.accuracy
        sufficient = self._stop.sufficient
        if sufficient > 0.0 and not is_far and self._is_low(iterate, sufficient):
            return BELOW
        if self._stall.has_stalled(iterate):
            is_low = self._stall.indicator <= self._stop.tolerance
            return stalled(self._remedies, self._relaxation, is_low=is_low)
        return None

    def _converged(self, iterate: Iterate, error: float) -> Status | None:
        """Status of a run that meets accuracy and tolerance; else None."""
        asks_tolerance = math.isfinite(self._stop.tolerance)
        if self._asks_accuracy and not error <= self._stop.accuracy:
            return None
        if asks_tolerance and not self._is_low(iterate, self._stop.tolerance):
            return None
        if self._asks_accuracy:
            return self._status_of_accurate(iterate)
        if asks_tolerance:
            return BELOW
        return None

    def _status_of_accurate(self, iterate: Iterate) -> Status | None:
        """Status of a run that is accurate enough; None if a certificate is needed."""
        estimate = self.estimate
        if estimate.is_certified:
            # Without a search the iterate is the answer, and its displacement, too, has
            # to be near: where all slips, forces are right long before.
            accuracy = self._stop.accuracy
            if self._searches or estimate.is_within_certified(accuracy, iterate):
                return CERTIFIED
            return None
        # An estimate counts for nothing on bases, or where a step is worth its cost.
        if estimate.needs_certificate or estimate.is_step_worthwhile(iterate):
            return None
        if iterate.violation > AGREED * self._stop.accuracy:
            return None
        if iterate.problem.no_reference:
            return NO_CERTIFICATE
        return EXPECTED

    def _is_low(self, iterate: Iterate, tolerance: float) -> bool:
        """Check whether the LATIN indicator is low, confirmed by another measure.

        That is the k-free indicator, or the distance to a certified solution. The LATIN
        indicator alone can be fooled: a search direction that is far from the stiffness
        in play makes it as small as one likes (MATHEMATICS.md, 4). The k-free
        indicator is relative to the contact forces, which vanish where all contacts
        open.
        """
        if iterate.indicator > tolerance:
            return False
        enough = min(math.sqrt(tolerance), LARGEST_VIOLATION)
        if iterate.violation <= enough:
            return True
        return self.estimate.is_within_certified(enough, iterate)

    def _exhausted(self, iterate: Iterate) -> Status:
        """Status of a run at its limit, with the criterion that is not met."""
        is_certified = self.estimate.is_certified
        lack = AT_LIMIT
        if self._asks_accuracy and self._searches and is_certified:
            lack = INACCURATE
        elif iterate.indicator > self._stop.tolerance and not self._searches:
            lack = ABOVE
        elif self._asks_accuracy:
            lack = UNCERTIFIED
        may_go_on = iterate.number < self._stop.iterations
        return exhausted(lack, self._remedies, may_go_on=may_go_on)


def _is_failure(status: Status | None) -> bool:
    """Check whether a status is known and not convergence."""
    return status is not None and status.ending is not Ending.CONVERGED


class StallCheck:
    """Detector of a LATIN indicator that stops falling; `indicator` is the lowest.

    It has stopped where it was lowest in the first half of the iterations.
    """

    def __init__(self) -> None:
        self.indicator = math.inf
        self._number = 0
        self._k: Array | None = None

    def has_stalled(self, iterate: Iterate) -> bool:
        """Check whether the indicator has stopped falling."""
        number = iterate.number
        if AGAIN * number < LATE:
            return False
        if iterate.k is not self._k:
            # The indicator is measured by k, so values for another k do not compare.
            self.indicator = math.inf
            self._k = iterate.k
        if iterate.indicator < self.indicator:
            self.indicator = iterate.indicator
            self._number = number
        return number >= max(AGAIN * self._number, LATE)
