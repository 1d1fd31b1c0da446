"""Verdicts on runs by their outcomes, and what each means."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import NamedTuple

from solver.latin import Ending
from solver.study.outcomes import AT_ROUNDING, Outcome
from solver.study.scene_run import BROKEN, REFUSED


class Verdict(StrEnum):
    """Verdict on a run."""

    RIGHT = "right"
    UNSOLVED = "unsolved"
    REFUSED = "refused"
    UNCLEAR = "unclear"
    WRONG = "wrong"


class Judge(StrEnum):
    """Source of a verdict on a run."""

    LAWS = "laws"
    REFERENCE = "reference"
    NOTHING = "nothing"


MEANING: dict[str, str] = {
    Verdict.RIGHT: (
        "balance and all laws hold up to rounding, or to the residual that a certified "
        "answer states; or the distance to a reference that obeys them is as small as "
        "it has to be"
    ),
    Verdict.UNSOLVED: "not the right answer, and the run says so, and what to try",
    Verdict.REFUSED: "a problem without a solution, or senseless, is refused in words",
    Verdict.UNCLEAR: (
        "called converged, not certified, and not judged, as the reference finds "
        "several solutions or none, or breaks a law"
    ),
    Verdict.WRONG: (
        "called converged with a larger error, certified and breaks a law by more than "
        "the residual that it states, not finite, or ended in a warning or an exception"
    ),
}
"""Meaning of every verdict."""
JUDGES: dict[str, str] = {
    Judge.LAWS: (
        "the answer obeys balance and all laws up to rounding; or it is certified, and "
        "does so up to the residual that it states, or not: it is what the reference's "
        "own solver finds, so that its distance to the reference says nothing"
    ),
    Judge.REFERENCE: (
        "by the distance to a reference that obeys them: the incremental solver's, or, "
        "of a run that is called converged where several solutions exist, the one that "
        "it came to"
    ),
    Judge.NOTHING: (
        "no judge is needed, or there is none: not solved, refused, broken off, unclear"
    ),
}
"""Meaning of every judge."""
MOST_STATED = 1e-5
"""Largest residual with which an answer may be called certified."""


class Judgement(NamedTuple):
    """A verdict, and the judge that found it."""

    verdict: Verdict
    by: Judge


def judge(outcome: Outcome, force: float, displacement: float = math.inf) -> Judgement:
    """Judge an outcome by its numbers and its status.

    Laws come first, and of a certified answer they alone count, up to the residual that
    it states: a body that deforms far, or is stiff beside what holds it, has no digits
    for less. Other answers are right up to the relative errors `force` of the contact
    force and `displacement`.
    """
    # A run without advice leaves its user alone, however it ends.
    if outcome.ending == BROKEN or not outcome.advice:
        return Judgement(Verdict.WRONG, Judge.NOTHING)
    if outcome.ending == REFUSED:
        return Judgement(Verdict.REFUSED, Judge.NOTHING)
    if outcome.laws <= AT_ROUNDING:
        return Judgement(Verdict.RIGHT, Judge.LAWS)
    if outcome.certified:
        verdict = Verdict.WRONG
        if outcome.laws <= outcome.residual <= MOST_STATED:
            verdict = Verdict.RIGHT
        return Judgement(verdict, Judge.LAWS)
    has_reference = outcome.reference_laws <= AT_ROUNDING
    is_force_near = outcome.error_force <= force
    is_near = is_force_near and outcome.error_displacement <= displacement
    if has_reference and is_near:
        return Judgement(Verdict.RIGHT, Judge.REFERENCE)
    if outcome.ending != Ending.CONVERGED:
        return Judgement(Verdict.UNSOLVED, Judge.NOTHING)
    if outcome.doubt:
        return Judgement(Verdict.UNCLEAR, Judge.NOTHING)
    if has_reference:
        return Judgement(Verdict.WRONG, Judge.REFERENCE)
    return Judgement(Verdict.WRONG, Judge.NOTHING)
