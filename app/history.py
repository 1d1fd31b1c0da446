"""History of the shown frames of a run, in the memory of the page."""

from __future__ import annotations

from bisect import bisect_right

from app.frame import Frame

LIMIT = 24_000_000
"""Largest memory of the frames of a run, bytes; beyond, every other frame is
dropped."""


class History:
    """Shown frames of a run by iteration, thinned to a memory limit.

    The frame of an iteration that is missing comes from the worker (`Show`).
    """

    def __init__(self) -> None:
        self._frames: list[Frame] = []

    @property
    def newest(self) -> Frame | None:
        """The last frame: at the end of a run the answer."""
        if self._frames:
            return self._frames[-1]
        return None

    def add(self, frame: Frame) -> None:
        """Insert a frame in order, replacing one of the same iterate."""
        others = [kept for kept in self._frames if kept.place != frame.place]
        self._frames = sorted([*others, frame], key=lambda kept: kept.place)
        while len(self._frames) > 2 and self._nbytes() > LIMIT:
            # Every other frame goes, but neither the first nor the last one, which is
            # seen.
            self._frames = [*self._frames[:-1:2], self._frames[-1]]

    def at(self, iteration: int) -> Frame:
        """The last stored frame of the search up to an iteration, or the first."""
        search = [kept.iteration for kept in self._frames if not kept.is_answer]
        return self._frames[max(bisect_right(search, iteration) - 1, 0)]

    def _nbytes(self) -> int:
        return sum(kept.nbytes for kept in self._frames)
