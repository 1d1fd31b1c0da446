"""The frames of a run that were shown, thinned under a memory limit."""

from __future__ import annotations

from bisect import bisect_right

from app.frame import Frame

LIMIT = 24_000_000
"""Bytes that the frames of a run may take; beyond, every other one is dropped."""


class History:
    """Frames of one run, by iteration."""

    def __init__(self) -> None:
        self._frames: list[Frame] = []

    def __len__(self) -> int:
        return len(self._frames)

    @property
    def newest(self) -> Frame | None:
        """The last frame, the answer where the run has one."""
        return self._frames[-1] if self._frames else None

    def add(self, frame: Frame) -> None:
        """Keep a frame; another one of the same iterate takes its place."""
        if self._frames and _key(self._frames[-1]) == _key(frame):
            self._frames.pop()
        self._frames.append(frame)
        while sum(kept.nbytes for kept in self._frames) > LIMIT and len(self) > 2:
            self._frames = [*self._frames[:-1:2], self._frames[-1]]

    def at(self, iteration: int) -> Frame:
        """The last kept frame of the search up to an iteration, or the first one."""
        return self._frames[max(bisect_right(self._search(), iteration) - 1, 0)]

    def after(self, iteration: int) -> int:
        """Number of the next iterate of the search that is kept; behind the last, of the answer."""
        numbers = self._search()
        place = bisect_right(numbers, iteration)
        return numbers[place] if place < len(numbers) else self._frames[-1].iteration + 1

    def _search(self) -> list[int]:
        return [kept.iteration for kept in self._frames if not kept.is_answer]


def _key(frame: Frame) -> tuple[int, bool]:
    return frame.iteration, frame.is_answer
