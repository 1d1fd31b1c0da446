"""A search direction that may change in a run."""

from __future__ import annotations

from abc import ABC, abstractmethod

from solver.arrays import Array
from solver.latin.iterate import UpdateProgress


class ChangingDirection(ABC):
    """A search direction with a course, which a checkpoint may remember.

    Parameters
    ----------
    k
        At the start, shape (n_rows,), scaled, read-only.
    course
        From a checkpoint, if the run goes on from one.
    """

    def __init__(self, k: Array, course: UpdateProgress | None) -> None:
        self.course = course or UpdateProgress("first", k)

    @property
    def k(self) -> Array:
        """Search direction of the rows by now, shape (n_rows,), scaled, read-only."""
        return self.course.k

    @property
    @abstractmethod
    def is_due(self) -> bool:
        """Whether the next iteration is to begin with `turn`."""

    @abstractmethod
    def see(self, local_displacement: Array, incoming: Array) -> None:
        """Take in a local stage.

        Parameters
        ----------
        local_displacement, incoming
            Its W^, and W - F/k that it read, shape (n_rows, n_instants).
        """

    @abstractmethod
    def turn(self, displacement: Array, force: Array) -> tuple[Array, Array] | None:
        """Decide on k.

        Parameters
        ----------
        displacement, force
            W and F of the linear stage, shape (n_rows, n_instants), scaled.

        Returns
        -------
        W and F to go on from where k changes, or None.
        """
