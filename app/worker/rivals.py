"""What runs are compared with, where that is quick enough to be found beside them."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable

from app.worker.shown import has_reference
from solver.definitions import about
from solver.discrete import Problem
from solver.reference.choice import reference_of
from solver.reference.condensation import NotHeldError
from solver.reference.incremental import Reference
from solver.settings import Settings

METHOD_GROUPS = frozenset({"Decomposition", "Method", "Stop"})
"""Groups of settings that lead to the same solution."""


class References:
    """The references last used, by the settings that define the physics.

    Parameters
    ----------
    entries, budget
        How many are kept at most, and how many bytes they may take together.
    """

    def __init__(self, entries: int = 8, budget: int = 200_000_000) -> None:
        self._entries = entries
        self._budget = budget
        self._kept: OrderedDict[tuple[object, ...], Reference] = OrderedDict()

    def of(
        self, settings: Settings, problem: Problem, stop: Callable[[], bool]
    ) -> Reference | None:
        """Give the reference of a problem, if it has one, computed only if it is not at hand.

        Raises
        ------
        Interrupted
            As soon as `stop` gives True.
        """
        key = physics(settings)
        found = self._kept.pop(key, None) or find_reference(settings, problem, stop)
        if found is None:
            return None
        self._kept[key] = found
        while (
            len(self._kept) > self._entries or sum(map(_size, self._kept.values())) > self._budget
        ):
            self._kept.popitem(last=False)
        return found


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
        found = reference_of(problem, stop)
    except NotHeldError:
        return None
    return found if found.converged.all() else None


def physics(settings: Settings) -> tuple[object, ...]:
    """Give the scene and the values of the settings on which its solution depends."""
    values = settings.values()
    return settings.scene, *(
        (name, values[name])
        for name, definition in settings.definitions().items()
        if about(definition).group not in METHOD_GROUPS
    )


def _size(reference: Reference) -> int:
    fields = (reference.displacement, reference.friction_force, reference.status)
    return sum(field.nbytes for field in fields)
