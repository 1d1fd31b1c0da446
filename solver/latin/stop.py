"""When a run ends, and how: criteria, and one status with advice."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.criteria.converged import Proven, agrees
from solver.latin.criteria.estimate import LAST
from solver.latin.criteria.judged_numbers import Numbers
from solver.latin.criteria.status import Ending, Status
from solver.latin.finish.certified import finished
from solver.latin.finish.status_step import Certificate
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.latin.iterate import Iterate
from solver.latin.method import Latin

STALL_WINDOW = 200
"""Iterations without a lower indicator after which a run is called stalled."""
STALL_FACTOR = 0.99
"""A lower indicator is one below this part of the lowest so far."""
SELDOM = 16
"""Every so many iterations the LATIN indicator is computed, for nothing but to see a stall."""
LOWEST = 1e-24
"""LATIN indicator, a ratio of squares, that rounding leaves of fields that agree."""
USUAL_ACCURACY = 0.01
"""Of a status step that ends a run which nobody asks to be accurate."""

_SEARCHED = " The iterates by themselves had come within {:g} % of its contact force."
_CERTIFIED = "Certified: equilibrium and all contact laws hold up to rounding"
_FOUND = " A status step found it from iterate {}, whose contact force was {} % away from it."
_BY_INCREMENTS = (
    " It is the incremental solver's answer: the status step began at the statuses of iterate {}, "
    "whose own contact force was still {} % away from it."
)
_ON_BASES = " The modes are those of that iterate."
FAR = 0.1
"""Error of the contact force from which on what a status step finds is not LATIN's own."""

JUMPS = (
    "At some instant no equilibrium goes on from the one before: friction falls with slip faster "
    "than the structure unloads, so that it jumps, and none is found beyond. Lower the load, raise "
    "friction_ratio or slip_length, or prescribe a displacement in place of a force."
)
_JUMPED = (
    " At {:.4g} s no equilibrium goes on from the one before, as friction falls with slip faster "
    "than the structure unloads: it jumps to another. Where it should not, raise friction_ratio, "
    "slip_length or the number of elements."
)


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


def proven(
    finish: Iterate,
    certificate: Certificate | None,
    seconds: float,
    found: float = math.nan,
    why: str = "",
) -> Decision:
    """Say of an iterate that is a certified solution that the run ends with it.

    Separated bases that it shows are those of the search. `found` is the error of the contact force
    of the last iterate before, and `why` says of a search that had to end earlier what to try.
    """
    residual = finish.residual or 0.0
    advice = f"{_CERTIFIED} (residual {residual:.0e})."
    if not math.isnan(found):
        away, before = float(f"{100.0 * found:.2g}"), finish.number - 1
        said = _SEARCHED.format(away) if finish.is_answer else _FOUND.format(before, f"{away:g}")
        if found > FAR:
            said = _BY_INCREMENTS.format(before, f"{away:g}" if found <= 1.0 else "more than 100")
        advice += said + _ON_BASES * (finish.reduction is not None) + f" {why}" * bool(why)
    status = with_jump(Status(Ending.CONVERGED, advice), finish.problem, certificate)
    return Decision(seconds, math.nan, math.nan, residual, status, certificate)


def with_jump(status: Status, problem: Problem, certificate: Certificate | None) -> Status:
    """Status that also says when the certified solution jumps, if it does."""
    if certificate is None or certificate.jumps_at is None:
        return status
    message = _JUMPED.format(problem.instants[certificate.jumps_at])
    return replace(status, advice=status.advice + message)


class StopRules:
    """When a run ends; they remember what they have seen, and what they cost.

    A run has converged when its criterion says so, or when a status step ends it with a certified
    solution: at once, or once the iterates themselves are that near to it. It also ends when the
    LATIN indicator has stopped falling, or numbers to be finite.

    Parameters
    ----------
    latin
        The method.
    spent
        Seconds that the run took before its iterations, to make the problem.

    Attributes
    ----------
    seconds
        Time that the run took so far beside its iterations.
    """

    def __init__(self, latin: Latin, spent: float = 0.0) -> None:
        asked, stop = latin.stop.accuracy, latin.stop
        self._may_finish = latin.finish is not None
        self._searches = latin.finish is not None and not latin.finish.at_once
        if self._searches and math.isfinite(asked):
            stop = Proven(asked) | stop
        self._latin, self._criterion = latin, stop.at_work()
        self._estimate = latin.linear.estimate(asked if math.isfinite(asked) else USUAL_ACCURACY)
        self._stall = Stall(latin)
        self._is_first, self._had_its_last = True, False
        self._found, self._why = math.nan, ""
        self.seconds = spent

    def judge(self, iterate: Iterate) -> Decision:
        """Say whether the run ends after an iterate, and how."""
        began = time.perf_counter()
        billed = iterate.seconds + self.seconds
        self._estimate.deadline = began + self._latin.stop.seconds - billed
        if not math.isfinite(float(np.vdot(iterate.incoming.T, iterate.incoming.T))):
            seconds = self._billed(iterate, began)
            return Decision(seconds, math.nan, math.nan, math.nan, _diverged(iterate.number))
        numbers, status = self._ending(iterate)
        certificate = self._estimate.certificate
        indicator, behaviour = numbers.known("indicator"), numbers.known("behaviour")
        seconds = self._billed(iterate, began)
        is_over = status is not None or not self._searches
        if certificate is None or not (self._may_finish and is_over):
            estimated = numbers.known("estimated_error")
            if status is not None:
                status = with_jump(status, iterate.problem, certificate)
            return Decision(seconds, indicator, behaviour, estimated, status, certificate)
        began = time.perf_counter()
        self._found = estimated = certificate.distance.of_friction_force(iterate)
        if status is not None and status.ending is not Ending.CONVERGED:
            self._why = status.advice
        number, spent, searched = iterate.number + 1, iterate.seconds, iterate.reduction
        finish = finished(iterate.problem, iterate.k, certificate, number, spent, searched)
        finish = replace(finish, is_answer=self._searches)
        self._billed(iterate, began)
        return Decision(seconds, indicator, behaviour, estimated, None, certificate, finish)

    def close(self, finish: Iterate) -> Decision:
        """Judge the certified solution that ends a run."""
        seconds = finish.seconds + self.seconds
        verdict = proven(finish, self._estimate.certificate, seconds, self._found, self._why)
        behaviour = behaviour_indicator(finish)
        return replace(verdict, indicator=latin_indicator(finish), behaviour=behaviour)

    def _billed(self, iterate: Iterate, began: float) -> float:
        """Put the time since `began` on the bill; give the whole of it."""
        self.seconds += time.perf_counter() - began
        return iterate.seconds + self.seconds

    def _ending(self, iterate: Iterate) -> tuple[Numbers, Status | None]:
        """Say how the run ends after an iterate, or None, and by which numbers."""
        number, seconds = iterate.number, iterate.seconds + self.seconds
        is_last = self._criterion.is_last(number, seconds)
        are_asked = self._is_first or is_last
        self._is_first = False
        if self._may_finish and not self._had_its_last and self._estimate.is_last_chance(iterate):
            self._had_its_last = True
            self._estimate.try_step(iterate, LAST, least=math.inf)
        numbers = Numbers(iterate, self._estimate, seconds, are_asked=are_asked)
        if are_asked or number % SELDOM == 0:
            _ = numbers.indicator
        status = self._criterion.judge(numbers)
        stalled = self._stall.judge(numbers)
        if status is None or status.ending is Ending.EXHAUSTED:
            status = stalled or status
        if status is not None and status.ending is not Ending.CONVERGED:
            _ = numbers.behaviour
            self._try_at_last(iterate)
        if self._estimate.jumps:
            return numbers, Status(Ending.STALLED, JUMPS)
        if status is not None and status.ending is Ending.EXHAUSTED:
            return numbers, replace(status, advice=self._exhausted_advice(numbers, status))
        return numbers, status

    def _try_at_last(self, iterate: Iterate) -> None:
        """Try a status step, whatever it costs, where a run that may end with it would give up."""
        if self._may_finish and self._estimate.certificate is None:
            self._estimate.try_step(iterate, LAST)

    def _exhausted_advice(self, numbers: Numbers, status: Status) -> str:
        why = self._criterion.lacks(numbers) or "The run has come to its limit"
        remedy = of_bases(self._latin) or f"Raise max_iterations, or {remedy_of_k(self._latin)}."
        return f"{why}. {status.advice or remedy}"


class Stall:
    """Whether the LATIN indicator has stopped falling.

    Parameters
    ----------
    latin
        The method, which says what to try.
    """

    def __init__(self, latin: Latin) -> None:
        self._latin = latin
        self._best, self._best_at = math.inf, 0
        self._k: Array | None = None

    def judge(self, numbers: Numbers) -> Status | None:
        """Say that the run has stalled, or None."""
        iterate = numbers.iterate
        if iterate.k is not self._k:
            # The indicator is measured by k: to look for the smallest begins anew.
            self._best, self._best_at = math.inf, iterate.number
        self._k = iterate.k
        indicator = numbers.known("indicator")
        if indicator < STALL_FACTOR * self._best:
            self._best, self._best_at = indicator, iterate.number
        if math.isfinite(indicator) and iterate.number - self._best_at >= STALL_WINDOW:
            return Status(Ending.STALLED, self._advice(numbers))
        return None

    def _advice(self, numbers: Numbers) -> str:
        tolerance, modes = self._latin.stop.tolerance, of_bases(self._latin)
        if self._best < LOWEST and agrees(numbers, tolerance):
            return "The LATIN indicator is down to rounding: more iterations change nothing."
        if self._best < LOWEST:
            return (
                "The LATIN indicator is down to rounding, yet the k-free indicator shows that the "
                "contact laws are broken: friction is too small beside the load, or k too far from "
                "the stiffness, for more digits. Bring friction, the load and k_scale nearer to "
                "each other."
            )
        if self._best <= tolerance and modes:
            return (
                "The LATIN indicator is below its tolerance, yet the contact force is not known to "
                f"be accurate enough. {modes}"
            )
        if self._best <= tolerance:
            return (
                "The LATIN indicator is below its tolerance, yet the k-free indicator shows that "
                "the contact laws are broken: k is far from what suits, or rigid motion so large "
                f"that it hides how the body deforms. {remedy_of_k(self._latin).capitalize()}."
            )
        if self._latin.relaxation > 0.9:
            return "The LATIN indicator has stopped falling. Lower the relaxation to 0.8."
        remedy = modes or f"Accept a larger tolerance, or {remedy_of_k(self._latin)}."
        return f"The LATIN indicator has stopped falling. {remedy}"


def remedy_of_k(latin: Latin) -> str:
    """Say what helps against an unsuitable k, as part of a sentence; a status step needs none."""
    if latin.finish is None:
        return "set finish=at-once, for which k does not matter"
    return "try a k_scale ten times smaller, and if that is no better ten times larger"


def of_bases(latin: Latin) -> str:
    """Say what helps a run on separated bases, in a sentence; empty for full fields."""
    remedy, also = latin.linear.remedy, ", or set finish=at-once" if latin.finish is None else ""
    return f"{remedy}{also}." if remedy else ""


def _diverged(iteration: int) -> Status:
    return Status(
        Ending.DIVERGED,
        f"Numbers stopped being finite at iteration {iteration}, so that before it is kept. Lower "
        "the relaxation, or bring k_scale nearer to 1 and the loads to ordinary sizes.",
    )
