"""The way back to an iterate that was done already."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from app.worker.checkpoints import Checkpoints
from solver.latin import Checkpoint, Iterate

Found = tuple[Iterate, Checkpoint | None]
"""An iterate, and the checkpoint of the one before it."""


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
        self._passed: Checkpoint | None = None

    @property
    def wanted(self) -> int | None:
        """Number of the iterate that is sought, if any is."""
        return self._wanted

    def keep(self, checkpoint: Checkpoint) -> None:
        """Take a checkpoint to seek from."""
        self._checkpoints.keep(checkpoint)

    def begin(self, iteration: int) -> None:
        """Seek an iterate, in place of any that was sought."""
        self._passed = self._checkpoints.before(iteration)
        self._generator, self._wanted = self._iterations(self._passed), iteration

    def stop(self) -> None:
        """Seek nothing any more."""
        self._generator = self._wanted = None

    def go_on(self) -> Found | None:
        """Do an iteration again; give it if it is the one that is sought."""
        if self._generator is None:
            return None
        iterate, before = next(self._generator), self._passed
        self._passed = iterate.checkpoint
        self.keep(iterate.checkpoint)
        if iterate.number != self._wanted:
            return None
        self.stop()
        return iterate, before
