"""What a run is compared with, where that is quick enough to be found beside it."""

from __future__ import annotations

from collections.abc import Callable

from solver.discrete import Problem
from solver.reference.choice import reference_of
from solver.reference.condensation import NotHeldError
from solver.reference.incremental import Reference
from solver.settings import Settings

MOST_JUMPS = 1000
"""Jumps up to which a reference takes no longer than a second or two; its time grows with their
cube (measured: 8 s for 1900), and meanwhile the worker obeys no order."""


def has_reference(settings: Settings) -> bool:
    """Tell whether a run has a reference to measure errors by."""
    return settings.n_jumps <= MOST_JUMPS


def find_reference(
    settings: Settings, problem: Problem, stop: Callable[[], bool]
) -> Reference | None:
    """Compute the reference of a problem, or give None where there is none.

    Raises
    ------
    Interrupted
        As soon as `stop` gives True.
    """
    if not has_reference(settings):
        return None
    try:
        return reference_of(problem, stop)
    except NotHeldError:
        return None
