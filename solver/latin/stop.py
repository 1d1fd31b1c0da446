"""When a run ends, and how: stop rules, and one status with advice."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from solver.arrays import Array
from solver.latin.estimate import LAST, WAIT, ErrorEstimate
from solver.latin.finish import finished
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.latin.iterate import Iterate
from solver.latin.lookout import Lookout
from solver.latin.status_step import Certificate
from solver.settings import Settings

STALL_WINDOW = 200
"""Iterations without a lower indicator after which a run is called stalled."""
STALL_FACTOR = 0.99
"""A lower indicator is one below this part of the lowest so far."""
SELDOM = 16
"""Every so many iterations the LATIN indicator is computed, for nothing but to see a stall."""
LOWEST = 1e-24
"""LATIN indicator, a ratio of squares, that rounding leaves of fields that agree."""
LARGEST_VIOLATION = 1e-2
"""Of the k-free indicator at the end, however loose the tolerance."""
SMALLEST_VIOLATION = 1e-12
"""The same however tight it is."""
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


_CERTIFIED = (
    "Certified: equilibrium and all contact laws hold up to rounding, so no iteration can better "
    "this solution on this mesh"
)
_PROVEN = (
    "Accurate enough: the contact force of this iterate is within the accuracy of the exact "
    "solution on this mesh, which a status step has found. What is shown is the iterate, not that "
    "solution."
)
_EXPECTED = (
    "Accurate enough by estimate: the contact force hardly changes any more. Proof by a status "
    "step would take longer than the whole run."
)
CANCELLED = Status(Ending.CANCELLED, "The run was stopped before its end; start it again.")


@dataclass(frozen=True, eq=False)
class Verdict:
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


def agreement(tolerance: float) -> float:
    """Give the k-free indicator up to which it agrees that the run has converged.

    The LATIN indicator alone can be fooled: a search direction that is far from the stiffness in
    play makes it as small as one likes (solver/README.md, 4).
    """
    return min(max(VIOLATION * math.sqrt(tolerance), SMALLEST_VIOLATION), LARGEST_VIOLATION)


def proven(finish: Iterate, certificate: Certificate | None, seconds: float) -> Verdict:
    """Say of an iterate that is a certified solution that the run ends with it."""
    residual = finish.residual or 0.0
    status = Status(Ending.CONVERGED, f"{_CERTIFIED} (residual {residual:.0e}).")
    return Verdict(seconds, math.nan, math.nan, residual, status, certificate)


class StopRules:
    """When a run ends; they remember what they have seen, and what they cost.

    A run has converged when the estimated error of its contact force is below `accuracy` and both
    indicators agree, or when a status step ends it with a certified solution.

    Parameters
    ----------
    settings
        Of the run.
    proves
        Whether status steps are tried at all.
    spent
        Seconds that the run took before its iterations, to make the problem.

    Attributes
    ----------
    seconds
        Time that the run took so far beside its iterations.
    """

    def __init__(self, settings: Settings, *, proves: bool = True, spent: float = 0.0) -> None:
        # Plain values: a setting takes longer to read than an iteration has for all of this.
        self._accuracy, self._tolerance = float(settings.accuracy), float(settings.tolerance)
        self._most, self._relaxation = settings.max_iterations, settings.relaxation
        self._is_reduced = settings.is_reduced
        self._may_finish = settings.finish == "status" and not settings.is_reduced
        self._estimate = ErrorEstimate(settings, proves=proves)
        self._of_estimate, self._of_indicator = Lookout(), Lookout()
        self._best = math.inf
        self._best_at = 0
        self._k: Array | None = None
        self.seconds = spent

    def judge(self, iterate: Iterate) -> Verdict:
        """Say whether the run ends after an iterate, and how."""
        began = time.perf_counter()
        if not math.isfinite(float(np.vdot(iterate.incoming.T, iterate.incoming.T))):
            status = _diverged(iterate.number)
            return Verdict(self._billed(iterate, began), math.nan, math.nan, math.nan, status)
        self._heed_change_of_k(iterate)
        indicator, estimated = self._figures(iterate)
        behaviour = self._agreement_asked(iterate, indicator, estimated)
        status_now = self._ending(iterate, indicator, estimated, behaviour)
        self._try_at_last(iterate, status_now)
        certificate = self._estimate.certificate
        seconds = self._billed(iterate, began)
        if certificate is None or not self._may_finish:
            return Verdict(seconds, indicator, behaviour, estimated, status_now, certificate)
        began = time.perf_counter()
        estimated = certificate.distance.of_friction_force(iterate)
        number, spent = iterate.number + 1, iterate.seconds
        finish = finished(iterate.problem, iterate.k, certificate, number, spent)
        self._billed(iterate, began)
        return Verdict(seconds, indicator, behaviour, estimated, None, certificate, finish)

    def _billed(self, iterate: Iterate, began: float) -> float:
        """Put the time since `began` on the bill; give the whole of it."""
        self.seconds += time.perf_counter() - began
        return iterate.seconds + self.seconds

    def _figures(self, iterate: Iterate) -> tuple[float, float]:
        """Compute the LATIN indicator and the estimate, or NaN where they cannot matter yet."""
        number = iterate.number
        indicator = estimated = math.nan
        is_asked = self._of_estimate.next == 0 or number == self._most
        if is_asked or number % SELDOM == 0:
            indicator = latin_indicator(iterate)
        if self._of_estimate.is_due(number) or is_asked:
            estimated = self._estimate(iterate, indicator)
            falls = estimated if self._estimate.is_proven else math.nan
            self._of_estimate.saw(number, falls, self._accuracy)
        if estimated <= self._accuracy:
            if math.isnan(indicator):
                indicator = latin_indicator(iterate)
            self._of_indicator.saw(number, indicator, self._tolerance)
            self._of_estimate.next = self._of_indicator.next
        return indicator, estimated

    def close(self, finish: Iterate) -> Verdict:
        """Judge the certified solution that ends a run."""
        verdict = proven(finish, self._estimate.certificate, finish.seconds + self.seconds)
        behaviour = behaviour_indicator(finish)
        return replace(verdict, indicator=latin_indicator(finish), behaviour=behaviour)

    def _heed_change_of_k(self, iterate: Iterate) -> None:
        """Begin anew to look for the smallest indicator, which is measured by k."""
        if iterate.k is not self._k:
            self._best, self._best_at = math.inf, iterate.number
        self._k = iterate.k

    def _try_at_last(self, iterate: Iterate, status: Status | None) -> None:
        """Try a status step, whatever it costs, where a run that may end with it would give up."""
        gives_up = status is not None and status.ending is not Ending.CONVERGED
        if self._may_finish and self._estimate.certificate is None and gives_up:
            self._estimate.try_step(iterate, LAST)

    def _agreement_asked(self, iterate: Iterate, indicator: float, estimated: float) -> float:
        """Compute the k-free indicator, which is dear, where all else says converged or stalled."""
        is_low = indicator <= self._tolerance
        is_stalled = math.isfinite(indicator) and iterate.number >= self._best_at + STALL_WINDOW
        is_last = is_stalled or iterate.number >= self._most
        if (is_low and estimated <= self._accuracy) or is_last:
            return behaviour_indicator(iterate)
        return math.nan

    def _ending(
        self,
        iterate: Iterate,
        indicator: float,
        estimated: float,
        behaviour: float,
    ) -> Status | None:
        iteration = iterate.number
        agreed = not math.isnan(behaviour) and self._agrees(iterate, behaviour)
        if indicator <= self._tolerance and agreed and estimated <= self._accuracy:
            if self._estimate.is_proven:
                return Status(Ending.CONVERGED, _PROVEN)
            may_be_proven = self._estimate.can_be_proven(iterate, least=WAIT)
            if not self._is_reduced and not may_be_proven:
                return Status(Ending.CONVERGED, _EXPECTED)
        if indicator < STALL_FACTOR * self._best:
            self._best, self._best_at = indicator, iteration
        if math.isfinite(indicator) and iteration - self._best_at >= STALL_WINDOW:
            return Status(Ending.STALLED, self._stall_advice(agreed))
        if iteration >= self._most:
            return Status(Ending.EXHAUSTED, self._exhausted_advice(indicator))
        return None

    def _agrees(self, iterate: Iterate, behaviour: float) -> bool:
        """Tell whether the k-free indicator says converged, or the solution itself does.

        The indicator is a share of what contact carries, which is nothing where all contacts open.
        """
        enough = agreement(self._tolerance)
        return behaviour <= enough or self._estimate.is_proven_within(enough, iterate)

    def _exhausted_advice(self, indicator: float) -> str:
        is_low = indicator <= self._tolerance
        inexact = "below its tolerance, yet the contact force is not known to be accurate enough"
        why = f"The LATIN indicator is {inexact if is_low else 'still above its tolerance'}"
        remedy = "Raise max_iterations, or try another k_scale."
        return f"{why}. {self._remedy(remedy)}"

    def _stall_advice(self, agreed: bool) -> str:
        if self._best < LOWEST and agreed:
            return "The LATIN indicator is down to rounding: more iterations change nothing."
        if self._best < LOWEST:
            return (
                "The LATIN indicator is down to rounding, yet the k-free indicator shows that the "
                "contact laws are broken: friction is too small beside the load, or k too far from "
                "the stiffness, for more digits. Bring friction, the load and k_scale nearer to "
                "each other."
            )
        if self._best <= self._tolerance:
            return (
                "The LATIN indicator is below its tolerance, yet the k-free indicator shows that "
                "the contact laws are broken: k is far from what suits. Try another k_scale."
            )
        if self._relaxation > 0.9:
            return "The LATIN indicator has stopped falling. Lower the relaxation to 0.8."
        remedy = "Accept a larger tolerance, or try another k_scale."
        return f"The LATIN indicator has stopped falling. {self._remedy(remedy)}"

    def _remedy(self, otherwise: str) -> str:
        if self._is_reduced:
            return "The modes may be too few: raise pgd_modes, lower pgd_tolerance."
        return otherwise


def _diverged(iteration: int) -> Status:
    return Status(
        Ending.DIVERGED,
        f"Numbers stopped being finite at iteration {iteration}, so that before it is kept. Lower "
        "the relaxation, or bring k_scale nearer to 1 and the loads to ordinary sizes.",
    )
