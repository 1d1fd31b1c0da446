"""Past iterates of a run, which a page may show again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from solver.latin import Iterate

LIMIT = 24_000_000
"""Largest memory of past iterates, bytes."""
ENDS = 16
"""Number of first and of newest iterates of which none is left out."""


class PastIterates:
    """Past iterates of a run in `all`: first, newest, and evenly some in between."""

    def __init__(self) -> None:
        self.all: list[Iterate] = []

    def keep(self, iterate: Iterate) -> None:
        """Store an iterate; beyond the limit every other one in between is dropped."""
        # Without the fields that are computed from it, as large as its own.
        self.all.append(replace(iterate))
        # An iterate has four fields of this size.
        most = max(LIMIT // (4 * iterate.outgoing.nbytes), 3)
        if len(self.all) > most:
            ends = min(ENDS, most // 3)
            del self.all[ends:-ends:2]

    def numbered(self, number: int) -> Iterate | None:
        """The iterate with a number; None if that is not stored."""
        return next((each for each in self.all if each.number == number), None)

    def few(self) -> Sequence[Iterate]:
        """First and newest iterates, and up to `ENDS` in between.

        Those in between stay while further iterates come, until every other one goes.
        """
        between = self.all[ENDS:-ENDS]
        step = 1
        while len(between) > ENDS:
            step *= 2
            between = [each for each in between if each.number % step == 0]
        return [*self.all[:ENDS], *between, *self.all[ENDS:][-ENDS:]]
