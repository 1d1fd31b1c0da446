"""What a run keeps of its past: checkpoints to seek from, and references to compare with."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable

from app.worker.rivals import find_reference
from solver.definitions import about
from solver.discrete import Problem
from solver.latin import Checkpoint
from solver.reference import incremental
from solver.settings import Settings

METHOD_GROUPS = frozenset({"Decomposition", "Method", "Stop"})
"""Groups of settings that lead to the same solution."""


class Recording:
    """Every s-th checkpoint of a run; s doubles whenever they outgrow the memory allowed.

    Parameters
    ----------
    budget
        Bytes that the checkpoints may take.
    """

    def __init__(self, budget: int = 48_000_000) -> None:
        self._budget = budget
        self._stride = 1
        self._kept: dict[int, Checkpoint] = {}

    def keep(self, checkpoint: Checkpoint) -> None:
        """Keep a checkpoint if its turn has come."""
        if checkpoint.number % self._stride == 0:
            self._kept[checkpoint.number] = checkpoint
        while len(self._kept) * _bytes_of(checkpoint) > self._budget:
            self._stride *= 2
            self._kept = {n: kept for n, kept in self._kept.items() if n % self._stride == 0}

    def before(self, iteration: int) -> Checkpoint | None:
        """Give the nearest checkpoint from which an iteration can be done again."""
        earlier = [number for number in self._kept if number < iteration]
        return self._kept[max(earlier)] if earlier else None


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
        self._kept: OrderedDict[tuple[object, ...], incremental.Reference] = OrderedDict()

    def of(
        self, settings: Settings, problem: Problem, stop: Callable[[], bool]
    ) -> incremental.Reference | None:
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


def physics(settings: Settings) -> tuple[object, ...]:
    """Give the scene and the values of the settings on which its solution depends."""
    values = settings.values()
    return settings.scene, *(
        (name, values[name])
        for name, definition in settings.definitions().items()
        if about(definition).group not in METHOD_GROUPS
    )


def _bytes_of(checkpoint: Checkpoint) -> int:
    bases = checkpoint.reduction.modes if checkpoint.reduction else ()
    fields = (
        field for modes in bases for field in (modes.outgoing, modes.incoming, modes.time_functions)
    )
    return checkpoint.nbytes + sum(field.nbytes for field in fields)


def _size(reference: incremental.Reference) -> int:
    fields = (reference.displacement, reference.friction_force, reference.status)
    return sum(field.nbytes for field in fields)
