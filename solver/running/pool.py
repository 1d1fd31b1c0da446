"""What an executor has to be to run a sweep."""

from __future__ import annotations

from concurrent.futures import Executor


class EndedError(RuntimeError):
    """The process of a call was ended before the call was done."""


class OverdueError(EndedError):
    """It was ended because the call took longer than it may."""


class GoneError(RuntimeError):
    """Nobody is there any more who could do a call."""


class Pool(Executor):
    """An executor that knows how many calls it does at once."""

    @property
    def width(self) -> int:
        """Calls that go on at once."""
        raise NotImplementedError
