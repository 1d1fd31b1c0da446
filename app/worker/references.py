"""A cache of the references of the last problems that a process has solved."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

from solver.discrete import Problem
from solver.reference.assembly import NoReferenceError
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference, fingerprint
from solver.settings.scene import Settings

MOST_JUMPS = 1500
"""Jumps up to which a reference takes no longer than some seconds; its time grows with
their cube (measured: layers 8 s for 1900, a wall 1 s for 1400)."""
ENTRIES = 8


def has_reference(settings: Settings) -> bool:
    """Check whether a run is compared with the incremental solver."""
    return settings.jumps <= MOST_JUMPS


class ReferenceCache:
    """The references last used, without their problems: matrices take most memory."""

    def __init__(self) -> None:
        self._kept: OrderedDict[bytes, Reference] = OrderedDict()

    def of(
        self, settings: Settings, problem: Problem, stop: Callable[[], bool]
    ) -> Reference | None:
        """Reference of a problem, with a collapse if it has one; None without any.

        Raises
        ------
        Interrupted
            As soon as `stop` gives True.
        """
        if problem.no_reference or not has_reference(settings):
            return None
        key = fingerprint(problem)
        reference = self._kept.pop(key, None)
        if reference is None:
            with suppress(NoReferenceError):
                reference = reference_of(problem, stop)
        if reference is None:
            return None
        # A reference that ends early is of use only if it tells of a collapse.
        if not reference.converged.all():
            if reference.collapse is None:
                return None
            return reference
        self._kept[key] = replace(reference, problem=None)
        # The first is the one that was used longest ago.
        if len(self._kept) > ENTRIES:
            self._kept.popitem(last=False)
        return replace(reference, problem=problem)
