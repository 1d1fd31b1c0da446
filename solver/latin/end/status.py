"""How a run ends: in a word, and what to try next in a sentence."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

from solver.discrete.drives import beyond, loads_at
from solver.discrete.problem import Problem
from solver.latin.end.status_step import Certificate
from solver.latin.iterate import Iterate
from solver.latin.stages.pgd import PGD
from solver.reference.limit_analysis import Collapse

if TYPE_CHECKING:
    from solver.latin.method import Latin

UNPROVEN = "The contact force is not known to be accurate enough"
FAR = 0.1
"""Error of the contact force from which on what a status step finds is not LATIN's
own."""


class Ending(StrEnum):
    """How a run can end."""

    CONVERGED = "converged"
    EXHAUSTED = "exhausted"
    STALLED = "stalled"
    CANCELLED = "cancelled"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class Status:
    """The end of a run, in a word, and what to try next in a sentence.

    `lost_from` is the first instant that has no solution, where some are known to have
    none: what an iterate shows from there on is no state of the structure.
    """

    ending: Ending
    advice: str
    lost_from: int | None = None


@dataclass(frozen=True, eq=False)
class Decision:
    """What the stop rules make of an iterate after so many seconds, their own included.

    The estimated error is NaN where it was not needed, the status None where the run
    goes on, the certificate None until a status step has found the solution. Where the
    run ends with that, `finished` is the iterate that it makes, and the decision on it.
    """

    seconds: float
    estimated_error: float = math.nan
    status: Status | None = None
    certificate: Certificate | None = None
    finished: tuple[Iterate, Decision] | None = None


CANCELLED = Status(
    Ending.CANCELLED, "The run was stopped before its end; start it again."
)
PROVEN = Status(
    Ending.CONVERGED,
    "Accurate enough: the contact force of this iterate is within the accuracy of the exact "
    "solution on this mesh, which a status step has found. What is shown is the iterate, not that "
    "solution.",
)
EXPECTED = Status(
    Ending.CONVERGED,
    "Accurate enough by estimate: the contact force hardly changes any more. Proof by a status "
    "step would take half as long again, or longer.",
)
UNPROVABLE = Status(
    Ending.CONVERGED,
    "Accurate enough by estimate: the contact force hardly changes any more. Nothing can prove it.",
)
BELOW = Status(
    Ending.CONVERGED,
    "The LATIN indicator is below its tolerance, and the k-free indicator agrees.",
)
OF_MESH = (
    "This is the limit of the mesh, whose upright joints touch inside their ends alone: rigid "
    "stones carry up to 5 % more."
)
_LOST_JUMP = (
    "At {} no equilibrium goes on from the one before: friction falls with slip faster "
    "than the structure unloads, so that it jumps, and none is found beyond. Lower the load, raise "
    "friction_ratio or slip_length, or prescribe a displacement in place of a force."
)
_JUMPED = (
    " At {} no equilibrium goes on from the one before, as friction falls with slip faster "
    "than the structure unloads: it jumps to another. Where it should not, raise friction_ratio, "
    "slip_length or the number of elements."
)
_SEARCHED = " The iterates by themselves had come within {:g} % of its contact force."
_CERTIFIED = "Certified: equilibrium and all contact laws hold up to rounding"
_FOUND = " A status step found it from iterate {}, whose contact force was {} % away from it."
_BY_INCREMENTS = (
    " It is the incremental solver's answer: the status step began at the statuses of iterate {}, "
    "whose own contact force was still {} % away from it."
)
_FEW_MODES = "The modes may be too few: raise pgd_modes, lower pgd_tolerance"
_LONGER = "Give the run longer, or ask for less: fewer elements or instants, a larger accuracy."


def collapses(problem: Problem, collapse: Collapse) -> Status:
    """Status of a run whose loads no contact forces balance from a point of a path on."""
    way = "slides away"
    remedy = "Lower the load, or raise friction or pressure."
    if collapse.tips:
        way = "tips over"
        remedy = "Lower the load, or make it wider, or press it more."
    if problem.has_short_joints:
        mesh = f" {OF_MESH}"
    else:
        mesh = ""
    return Status(
        Ending.STALLED,
        f"There is no equilibrium {limit_of(problem, collapse)}: no contact forces within friction "
        f"balance the loads, and the structure {way}. {remedy}{mesh}",
        lost_from=collapse.instant,
    )


def limit_of(problem: Problem, collapse: Collapse) -> str:
    """Words on where an equilibrium ends: the loads that are carried, and when."""
    loads = beyond(problem.drives, collapse.instant, collapse.share)
    time = f"from {collapse.time:.4g} s on"
    if loads:
        return f"{loads}, {time}"
    return time


def jump_of(problem: Problem, instant: int) -> str:
    """Words on where a structure jumps: the loads at the instant after it, and when."""
    loads = loads_at(problem.drives, instant)
    time = f"{problem.instants[instant]:.4g} s"
    if loads:
        return f"{time}, with {loads},"
    return time


def lost_jump(problem: Problem, instant: int, lost_from: int) -> Status:
    """Status of a run that jumps at an instant, and finds no equilibrium from another on."""
    advice = _LOST_JUMP.format(jump_of(problem, instant))
    return Status(Ending.STALLED, advice, lost_from=lost_from)


def diverged(iteration: int) -> Status:
    """Status of a run whose numbers stopped being finite."""
    return Status(
        Ending.DIVERGED,
        f"Numbers stopped being finite at iteration {iteration}, so that before it is kept. Lower "
        "the relaxation, or bring k_scale nearer to 1 and the loads to ordinary sizes.",
    )


def certified(
    finish: Iterate, certificate: Certificate, error: float = math.nan, advice: str = ""
) -> Status:
    """Status of a run that ends with a certified solution.

    `error` is that of the contact force of the last iterate before it, NaN without one;
    `advice` what to try, of a search that had to end earlier.
    """
    message = f"{_CERTIFIED} (residual {finish.residual or 0.0:.0e})."
    if not math.isnan(error):
        away = float(f"{100.0 * error:.2g}")
        before = finish.number - 1
        if error > FAR:
            if error <= 1.0:
                shown = f"{away:g}"
            else:
                shown = "more than 100"
            message += _BY_INCREMENTS.format(before, shown)
        elif finish.is_answer:
            message += _SEARCHED.format(away)
        else:
            message += _FOUND.format(before, f"{away:g}")
        message += f" {advice}" * bool(advice)
    return with_jump(Status(Ending.CONVERGED, message), finish.problem, certificate)


def unprovable(status: Status, problem: Problem, latin: Latin) -> Status:
    """Status that also says why there is no proof, where none can be had."""
    if not problem.no_reference:
        return status
    advice = f"{status.advice} {problem.no_reference}"
    if isinstance(latin.linear, PGD):
        advice += " On separated bases no estimate counts: set linear to Full()."
    return replace(status, advice=advice)


def with_jump(
    status: Status, problem: Problem, certificate: Certificate | None
) -> Status:
    """Status that also says when the certified solution jumps, if it does."""
    if certificate is None or certificate.solution.jumps_at is None:
        return status
    message = _JUMPED.format(jump_of(problem, certificate.solution.jumps_at))
    return replace(status, advice=status.advice + message)


def obeyed(residual: float) -> Status:
    """Status of a run whose iterate is a solution, by the residual of the equations."""
    return Status(
        Ending.CONVERGED,
        f"{_CERTIFIED} in this iterate itself, which no status step had to find (residual "
        f"{residual:.0e}).",
    )


def exhausted(latin: Latin, iterate: Iterate, *, is_proven: bool) -> Status:
    """Status of a run at its limit, of iterations or seconds.

    `is_proven` says whether the solution, and so the distance to it, is known.
    """
    stop = latin.stop
    lack = "The run has come to its limit"
    searches = latin.finish is not None and not latin.finish.at_once
    if math.isfinite(stop.accuracy) and searches and is_proven:
        lack = "The contact force of the iterates is not accurate enough"
    elif iterate.indicator > stop.tolerance and not searches:
        lack = "The LATIN indicator is still above its tolerance"
    elif math.isfinite(stop.accuracy):
        lack = UNPROVEN
    of_k, of_bases = _remedies(latin)
    remedy = of_bases or f"Raise max_iterations, or {of_k}."
    return Status(
        Ending.EXHAUSTED,
        f"{lack}. {_LONGER if iterate.number < stop.iterations else remedy}",
    )


def stalled(latin: Latin, lowest: float) -> Status:
    """Status of a run whose LATIN indicator has stopped falling."""
    of_k, of_bases = _remedies(latin)
    advice = "The LATIN indicator has stopped falling. "
    if lowest <= latin.stop.tolerance:
        advice = (
            f"{UNPROVEN}, though the LATIN indicator is low: k is far from what suits, or rigid "
            f"motion so large that it hides how the body deforms. "
        )
        advice += of_bases or f"{of_k.capitalize()}."
    elif latin.relaxation > 0.9:
        advice += "Lower the relaxation to 0.8."
    else:
        advice += of_bases or f"Accept a larger tolerance, or {of_k}."
    return Status(Ending.STALLED, advice)


def _remedies(latin: Latin) -> tuple[str, str]:
    """What helps against an unsuitable k, as part of a sentence, and bases that are too small."""
    of_k = "set finish=at-once, for which k does not matter"
    also = ", or set finish=at-once"
    if latin.finish is not None:
        of_k = (
            "try a k_scale ten times smaller, and if that is no better ten times larger"
        )
        also = ""
    has_bases = isinstance(latin.linear, PGD)
    return of_k, f"{_FEW_MODES}{also}." if has_bases else ""
