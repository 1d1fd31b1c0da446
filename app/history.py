"""The frames of a run that were shown, thinned under a memory limit."""

from __future__ import annotations

from bisect import bisect_right

from app.frame import Frame

LIMIT = 24_000_000
"""Bytes that the frames of a run may take."""


class History:
    """Frames of one run, by iteration.

    Parameters
    ----------
    limit
        Bytes that they may take; beyond, every other one is dropped, first and last excepted.
    """

    def __init__(self, limit: int = LIMIT) -> None:
        self._frames: list[Frame] = []
        self._limit = limit

    def __len__(self) -> int:
        return len(self._frames)

    @property
    def newest(self) -> Frame | None:
        """The last frame, the answer where the run has one."""
        return self._frames[-1] if self._frames else None

    def add(self, frame: Frame) -> None:
        """Keep a frame; another one of the same iterate takes its place."""
        same = self._frames and _key(self._frames[-1]) == _key(frame)
        self._frames[-1 if same else len(self._frames) :] = [frame]
        while sum(kept.nbytes for kept in self._frames) > self._limit and len(self) > 2:
            self._frames = [*self._frames[:-1:2], self._frames[-1]]

    def at(self, iteration: int) -> Frame | None:
        """The last kept frame up to an iteration, or the first one."""
        if not self._frames:
            return None
        search = [kept.iteration for kept in self._frames if not kept.is_answer]
        return self._frames[max(bisect_right(search, iteration) - 1, 0)]

    def after(self, iteration: int) -> int:
        """Number of the next iterate of the search that is kept; behind the last, of the answer."""
        numbers = [kept.iteration for kept in self._frames if not kept.is_answer]
        place = bisect_right(numbers, iteration)
        if place < len(numbers):
            return numbers[place]
        return (self._frames[-1].iteration if self._frames else iteration) + 1


def _key(frame: Frame) -> tuple[int, bool]:
    return frame.iteration, frame.is_answer
