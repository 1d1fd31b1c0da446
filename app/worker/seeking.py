"""The way back to an iterate that was done already, and what is kept of a run for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from solver.latin import Checkpoint, Iterate

Found = tuple[Iterate, Iterate | None]
"""An iterate, and the one before it."""


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


class Seeking:
    """A search from the nearest checkpoint kept, one iteration at a time.

    Parameters
    ----------
    iterations
        Gives the iterates of the run from a checkpoint on, or from its start.
    """

    def __init__(self, iterations: Callable[[Checkpoint | None], Iterator[Iterate]]) -> None:
        self._iterations = iterations
        self._checkpoints = Checkpoints()
        self._generator: Iterator[Iterate] | None = None
        self._wanted: int | None = None
        self._passed: Iterate | None = None

    @property
    def wanted(self) -> int | None:
        """Number of the iterate that is sought, if any is."""
        return self._wanted

    def keep(self, checkpoint: Checkpoint) -> None:
        """Take a checkpoint to seek from."""
        self._checkpoints.keep(checkpoint)

    def begin(self, iteration: int) -> None:
        """Seek an iterate, in place of any that was sought."""
        # The iterate before is done again too: what has changed since is compared with it.
        start = self._checkpoints.before(iteration - 1)
        self._passed, self._wanted = None, iteration
        self._generator = self._iterations(start)

    def stop(self) -> None:
        """Seek nothing any more."""
        self._generator = self._wanted = None

    def go_on(self) -> Found | None:
        """Do an iteration again; give it if it is the one that is sought."""
        if self._generator is None:
            return None
        iterate, before = next(self._generator), self._passed
        self._passed = iterate
        self.keep(iterate.checkpoint)
        if iterate.number != self._wanted:
            return None
        self.stop()
        return iterate, before
