"""The numbers by which an iterate is judged, each computed when it is first asked for."""

from __future__ import annotations

import math
from functools import cached_property

from solver.latin.criteria.estimate import ErrorEstimate
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.latin.iterate import Iterate


class Numbers:
    """Numbers of one iterate.

    Parameters
    ----------
    iterate
        Which is judged.
    estimate
        Of the run, which remembers the iterates before.
    seconds
        That the run has taken so far.
    are_asked
        Whether criteria shall look at all of them, due or not.
    """

    def __init__(
        self, iterate: Iterate, estimate: ErrorEstimate, seconds: float, *, are_asked: bool
    ) -> None:
        self.iterate, self.estimate = iterate, estimate
        self.seconds, self.are_asked = seconds, are_asked

    @property
    def number(self) -> int:
        """Number of the iteration."""
        return self.iterate.number

    @cached_property
    def indicator(self) -> float:
        """LATIN indicator eta, a ratio of squares (paper, eq. 2)."""
        return latin_indicator(self.iterate)

    @cached_property
    def behaviour(self) -> float:
        """The k-free indicator (solver/README.md, 4)."""
        return behaviour_indicator(self.iterate)

    @cached_property
    def estimated_error(self) -> float:
        """Relative error of the contact force, estimated; NaN while that cannot be."""
        return self.estimate(self.iterate, self.known("indicator"))

    def known(self, name: str) -> float:
        """Give one of these numbers if somebody has asked for it, else NaN."""
        found: float = self.__dict__.get(name, math.nan)
        return found
