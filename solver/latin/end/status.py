"""Endings of a run: status, advice, and the decision on an iterate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum

from solver.discrete.drives import describe_limit, describe_loads
from solver.discrete.problem import Problem
from solver.latin.end.certified import Answer
from solver.latin.end.status_step import Certificate
from solver.reference.limit_analysis import Collapse, Motion

AT_LIMIT = "The run has come to its limit"
INACCURATE = "The contact force of the iterates is not accurate enough"
UNCERTIFIED = "The contact force is not known to be accurate enough"
ABOVE = "The LATIN indicator is still above its tolerance"
"""Reasons why a run ends at its limit without convergence."""
FAR = 0.1
"""Relative error of the contact force of the last iterate, from which on the solution
counts as the incremental solver's answer and not as LATIN's own."""
RELAXED = 0.9
"""Relaxation above which a smaller one is the first thing to try when a run stalls."""


class Ending(StrEnum):
    """Kinds of ending of a run."""

    CONVERGED = "converged"
    EXHAUSTED = "exhausted"
    STALLED = "stalled"
    CANCELLED = "cancelled"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class Status:
    """Status of a run at its end: the kind of ending, and advice in a sentence.

    `lost_from` is the first instant that has no solution, if some are known to have
    none. The fields of an iterate from that instant on are no state of the structure.
    """

    ending: Ending
    advice: str
    lost_from: int | None = None


@dataclass(frozen=True, eq=False)
class Decision:
    """Decision of the stop rules on an iterate.

    Attributes
    ----------
    seconds
        Time of the run so far, stop rules included, s.
    estimated_error
        Relative error of the contact force; NaN where it was not needed.
    status
        Ending of the run; None where it continues.
    certificate
        The certified solution; None until a status step has found it.
    finished
        Where the run ends with the certified solution: the answer, and the decision on
        it.
    """

    seconds: float
    estimated_error: float = math.nan
    status: Status | None = None
    certificate: Certificate | None = None
    finished: tuple[Answer, Decision] | None = None


CANCELLED = Status(
    Ending.CANCELLED, "The run was stopped before its end; start it again."
)
CERTIFIED = Status(
    Ending.CONVERGED,
    "Accurate enough: the contact force of this iterate is within the accuracy of the "
    "exact solution on this mesh, which a status step has found. What is shown is the "
    "iterate, not that solution.",
)
EXPECTED = Status(
    Ending.CONVERGED,
    "Accurate enough by estimate: the contact force hardly changes any more. Proof by "
    "a status step would take as long again, or longer.",
)
NO_CERTIFICATE = Status(
    Ending.CONVERGED,
    "Accurate enough by estimate: the contact force hardly changes any more. Nothing "
    "can prove it.",
)
BELOW = Status(
    Ending.CONVERGED,
    "The LATIN indicator is below its tolerance, and the k-free indicator agrees.",
)
OF_MESH = (
    "This is the limit of the mesh, whose upright joints touch inside their ends "
    "alone: rigid stones carry up to 5 % more."
)
_MECHANISMS = {
    Motion.SLIDES: (
        "slides away",
        "Lower the load, or raise friction or pressure.",
    ),
    Motion.TIPS: (
        "tips over",
        "Lower the load, or make it wider, or press it more.",
    ),
    Motion.FOLDS: (
        "comes apart, as bodies turn about each other",
        "Lower the load, raise friction, or make it thicker or wider.",
    ),
}
"""What a structure does, and what to do, by the kind of its mechanism."""
_CERTIFIED = "Certified: equilibrium and all contact laws hold up to rounding"


def collapses(problem: Problem, collapse: Collapse) -> Status:
    """Status of a run without equilibrium from a point of the load path on."""
    motion, remedy = _MECHANISMS[collapse.motion]
    mesh = ""
    if problem.has_short_joints:
        mesh = f" {OF_MESH}"
    return Status(
        Ending.STALLED,
        f"There is no equilibrium {limit_of(problem, collapse)}: no contact forces "
        f"within friction balance the loads, and the structure {motion}. "
        f"{remedy}{mesh}",
        lost_from=collapse.instant,
    )


def limit_of(problem: Problem, collapse: Collapse) -> str:
    """Text of the last equilibrium: the loads that are carried, and the time."""
    loads = describe_limit(problem.drives, collapse.instant, collapse.share)
    time = f"from {collapse.time:.4g} s on"
    if loads:
        return f"{loads}, {time}"
    return time


def jump_of(problem: Problem, instant: int) -> str:
    """Text of an instant, as after a jump: its time, and the loads there."""
    loads = describe_loads(problem.drives, instant)
    time = f"{problem.instants[instant]:.4g} s"
    if loads:
        return f"{time}, with {loads},"
    return time


def lost_jump(problem: Problem, instant: int, lost_from: int) -> Status:
    """Status of a run that jumps, and has no equilibrium from an instant on."""
    return Status(
        Ending.STALLED,
        f"At {jump_of(problem, instant)} no equilibrium goes on from the one before: "
        "friction falls with slip faster than the structure unloads, so that it jumps, "
        "and none is found beyond. Lower the load, raise friction_ratio or "
        "slip_length, or prescribe a displacement in place of a force.",
        lost_from=lost_from,
    )


def not_found(status: Status, problem: Problem, instant: int) -> Status:
    """Status of a run whose status step finds no equilibrium from an instant on."""
    reason = (
        ", though contact forces within friction could balance the loads there: "
        "friction is not free to choose its forces, and where it is large it may leave "
        "no equilibrium, or bodies slide or tip until they come to one. Lower the load "
        "or mu, or press more."
    )
    if problem.is_chain:
        reason = (
            ": friction alone seems not to hold what is pulled. Lower the load, raise "
            "friction or pressure, or hold an end."
        )
    found = f"At {jump_of(problem, instant)} no equilibrium was found"
    return replace(status, advice=f"{found}{reason}")


def diverged(iteration: int) -> Status:
    """Status of a run whose fields are no longer finite."""
    return Status(
        Ending.DIVERGED,
        f"Numbers stopped being finite at iteration {iteration}, so that before it is "
        "kept. Lower the relaxation, or bring k_scale nearer to 1 and the loads to "
        "ordinary sizes.",
    )


def certified(
    answer: Answer, certificate: Certificate, error: float = math.nan, advice: str = ""
) -> Status:
    """Status of a run that ends with a certified solution.

    Parameters
    ----------
    answer, certificate
        The certified solution, with its residual.
    error
        Relative error of the contact force of the last iterate before; NaN where the
        states of another run led to the solution.
    advice
        What to try next, for a search that had to end earlier.
    """
    message = f"{_CERTIFIED} (residual {certificate.residual:.0e})."
    if math.isnan(error):
        message += (
            " A status step found it without an iteration, from where another run "
            "stuck, slipped and opened."
        )
    else:
        message += _error_of_search(answer, error)
        if advice:
            message += f" {advice}"
    return with_jump(Status(Ending.CONVERGED, message), answer.problem, certificate)


def _error_of_search(answer: Answer, error: float) -> str:
    """Sentence on the error of the last iterate before a certified solution."""
    before = answer.number - 1
    percent = float(f"{100.0 * error:.2g}")
    shown = f"{percent:g}"
    if error > 1.0:
        shown = "more than 100"
    if error > FAR:
        return (
            " It is the incremental solver's answer: the status step began at the "
            f"statuses of iterate {before}, whose own contact force was still {shown} "
            "% away from it."
        )
    if answer.is_beside:
        return (
            f" The iterates by themselves had come within {percent:g} % of its contact "
            "force."
        )
    return (
        f" A status step found it from iterate {before}, whose contact force was "
        f"{shown} % away from it."
    )


def without_certificate(status: Status, problem: Problem, *, has_bases: bool) -> Status:
    """Add to a status why no certificate is possible, if the problem has no reference.

    `has_bases` says that the linear stage is on separated bases.
    """
    if not problem.no_reference:
        return status
    advice = f"{status.advice} {problem.no_reference}"
    if has_bases:
        advice += " On separated bases no estimate counts: set linear to Full()."
    return replace(status, advice=advice)


def with_jump(
    status: Status, problem: Problem, certificate: Certificate | None
) -> Status:
    """Add to a status the instants at which the certified solution jumps, if any."""
    if certificate is None or certificate.solution.jumps_at is None:
        return status
    jump = jump_of(problem, certificate.solution.jumps_at)
    message = (
        f" At {jump} no equilibrium goes on from the one before, as friction falls "
        "with slip faster than the structure unloads: it jumps to another. Where it "
        "should not, raise friction_ratio, slip_length or the number of elements."
    )
    return replace(status, advice=status.advice + message)


def obeyed(residual: float) -> Status:
    """Status of a run whose iterate is itself a solution, with its KKT residual."""
    return Status(
        Ending.CONVERGED,
        f"{_CERTIFIED} in this iterate itself, which no status step had to find "
        f"(residual {residual:.0e}).",
    )


@dataclass(frozen=True)
class Remedies:
    """Advice on a method that does not converge.

    Attributes
    ----------
    of_k
        What helps against an unsuitable k, as part of a sentence.
    of_bases
        What helps against bases that are too small, as a sentence; empty for full
        fields.
    """

    of_k: str
    of_bases: str


def remedies_of(*, may_finish: bool, has_bases: bool) -> Remedies:
    """Remedies for a method: with or without a status step, and bases."""
    of_k = "set finish=at-once, for which k does not matter"
    also = ", or set finish=at-once"
    if may_finish:
        of_k = (
            "try a k_scale ten times smaller, and if that is no better ten times larger"
        )
        also = ""
    of_bases = ""
    if has_bases:
        of_bases = (
            f"The modes may be too few: raise pgd_modes, lower pgd_tolerance{also}."
        )
    return Remedies(of_k, of_bases)


def exhausted(lack: str, remedies: Remedies, *, may_go_on: bool) -> Status:
    """Status of a run at its limit of iterations or seconds.

    Parameters
    ----------
    lack
        Reason why the run goes no further than its limit, or the criterion that it has
        not met, without a full stop.
    remedies
        Advice on the method.
    may_go_on
        Whether iterations are left, so that seconds are the limit.
    """
    if may_go_on:
        remedy = (
            "Give the run longer, or ask for less: fewer elements or instants, a "
            "larger accuracy."
        )
    elif remedies.of_bases:
        remedy = remedies.of_bases
    else:
        remedy = f"Raise max_iterations, or {remedies.of_k}."
    return Status(Ending.EXHAUSTED, f"{lack}. {remedy}")


def stalled(remedies: Remedies, relaxation: float, *, is_low: bool) -> Status:
    """Status of a run whose LATIN indicator has stopped falling.

    `is_low` says that the indicator is within its tolerance.
    """
    remedy = remedies.of_bases
    if is_low:
        if not remedy:
            remedy = f"{remedies.of_k.capitalize()}."
        advice = (
            f"{UNCERTIFIED}, though the LATIN indicator is low: k is far from what "
            "suits, or rigid motion so large that it hides how the body deforms. "
            f"{remedy}"
        )
        return Status(Ending.STALLED, advice)
    if relaxation > RELAXED:
        remedy = "Lower the relaxation to 0.8."
    elif not remedy:
        remedy = f"Accept a larger tolerance, or {remedies.of_k}."
    advice = f"The LATIN indicator has stopped falling. {remedy}"
    return Status(Ending.STALLED, advice)
