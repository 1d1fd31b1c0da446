"""The reference of a problem, with doubts on its existence and uniqueness."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from solver.cache import CACHE
from solver.discrete.problem import Problem
from solver.latin.end.status import jump_of, limit_of
from solver.reference.assembly import Interrupted, NoReferenceError, never
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference


class KnownReference(NamedTuple):
    """Reference of a problem, with doubts on existence and uniqueness.

    Attributes
    ----------
    reference
        Reference solution, if there is one.
    doubt
        Reason why there is no reference, or why it is not the only solution.
    lost_from
        First instant that is known to have no solution.
    """

    reference: Reference | None = None
    doubt: str = ""
    lost_from: int | None = None


def known_reference(
    problem: Problem, stop: Callable[[], bool] = never
) -> KnownReference:
    """Find the reference; `stop` is called repeatedly, and ends the search.

    The cache is cleared afterwards, so that a run that follows is timed with all of its
    own preparations.
    """
    try:
        reference = reference_of(problem, stop)
    except Interrupted:
        return KnownReference(doubt="the reference takes longer")
    except NoReferenceError as refusal:
        return KnownReference(doubt=str(refusal))
    finally:
        CACHE.clear()
    if not reference.converged.all():
        return _without_solution(problem, reference)
    # A reference past a jump is one of several equilibria.
    if reference.jumps_at is not None:
        where = jump_of(problem, reference.jumps_at)
        return KnownReference(reference, f"at {where} it jumps to another equilibrium")
    several = np.count_nonzero(reference.ambiguous)
    if several:
        return KnownReference(
            reference, f"there are several solutions at {several} instants"
        )
    return KnownReference(reference)


def _without_solution(problem: Problem, reference: Reference) -> KnownReference:
    """Sentence on a problem whose reference has no solution at some instants."""
    lost = np.count_nonzero(~reference.converged)
    lost_from = None
    message = (
        f"the reference finds no solution at {lost} of {problem.n_instants} instants"
    )
    if reference.collapse is not None:
        lost_from = reference.collapse.instant
        message += f": there is no equilibrium {limit_of(problem, reference.collapse)}"
    elif reference.jumps_at is not None:
        # A jump of the reference is no proof: a run may converge at that instant.
        message += ": friction softens until the structure jumps"
    return KnownReference(None, message, lost_from)
