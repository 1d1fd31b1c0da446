"""Caches of a process: references, and the states of the last answer."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

from app.messages import Needs, Start
from solver.discrete import Problem
from solver.reference.assembly import NoReferenceError
from solver.reference.incremental import reference_of
from solver.reference.rules import States
from solver.reference.solution import Reference, fingerprint
from solver.settings.method import MethodSettings
from solver.settings.scene import Settings
from solver.study.quantities import reading

MOST_JUMPS = 1500
"""Jumps up to which a reference takes no longer than some seconds; its time grows with
their cube (measured: layers 8 s for 1900, a wall 1 s for 1400)."""
ENTRIES = 8
OF_THE_SEARCH = {"start", "finish"}
"""Settings of the method that a dragged slider sets by itself."""


@dataclass(frozen=True, eq=False)
class LastAnswer:
    """The states of a certified solution, as start of a similar run.

    Attributes
    ----------
    order
        Order of the run.
    states
        What stuck, slipped and was open, shape (n_forces, n_instants).
    """

    order: Start
    states: States

    def start_of(self, order: Start, needs: Needs) -> States | None:
        """States as start of an ordered run; None to start from zero.

        A run that a changed method, a step or a reading asks for is there to be seen
        from its own start, and so is one that is begun again.
        """
        is_shown_from_start = order.pace == 0.0 or any(
            reading(name).reads for name in needs.readings
        )
        if is_shown_from_start or order.settings.scene != self.order.settings.scene:
            return None
        values = self.order.settings.values()
        changed = {
            name
            for name, value in order.settings.values().items()
            if value != values[name]
        }
        is_of_method = MethodSettings.definitions().keys() - OF_THE_SEARCH
        if changed & is_of_method:
            return None
        is_new = bool(changed - OF_THE_SEARCH)
        return self.states if is_new or self.order.is_dragged else None


def has_reference(settings: Settings) -> bool:
    """Check whether a run is compared with the incremental solver."""
    return settings.n_jumps <= MOST_JUMPS


class ReferenceCache:
    """Cache of recently used references, without problems, which take most memory."""

    def __init__(self) -> None:
        self._kept: OrderedDict[bytes, Reference] = OrderedDict()

    def of(
        self, settings: Settings, problem: Problem, stop: Callable[[], bool]
    ) -> Reference | None:
        """Reference of a problem, and its collapse if any; None without a reference.

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
