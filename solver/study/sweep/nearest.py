"""The runs of a sweep that a process has done, of which the nearest is where the next begins."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.reference.solution import States

KEPT = 500
"""Runs at most: a dozen lines of a chart of 41 x 41. Of the scenes as they are each takes 5 to
30 kB."""


class Nearest:
    """What stuck, slipped and opened in the last runs.

    Parameters
    ----------
    shape
        Points along every axis of the plan.
    """

    def __init__(self, shape: Sequence[int]) -> None:
        self._shape = tuple(shape)
        self._found: dict[int, States] = {}

    def keep(self, number: int, states: States) -> None:
        """Take in a run, and forget the oldest one if there are too many."""
        self._found[number] = states
        while len(self._found) > KEPT:
            self._found.pop(next(iter(self._found)), None)

    def to(self, number: int) -> States | None:
        """Give the states of the run nearest to a point; distances are shares of the axes."""
        known = list(self._found.items())
        if not known:
            return None
        places = np.unravel_index([number, *(one for one, _ in known)], self._shape)
        share = np.stack(places) / np.array(self._shape)[:, None]
        away = ((share[:, 1:] - share[:, :1]) ** 2).sum(axis=0)
        return known[int(away.argmin())][1]
