"""What a run keeps of its past, to go back to."""

from __future__ import annotations

from solver.latin import Checkpoint


class Checkpoints:
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


def _bytes_of(checkpoint: Checkpoint) -> int:
    bases = checkpoint.reduction.modes if checkpoint.reduction else ()
    fields = (
        field for modes in bases for field in (modes.outgoing, modes.incoming, modes.time_functions)
    )
    return checkpoint.nbytes + sum(field.nbytes for field in fields)
