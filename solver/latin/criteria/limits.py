"""The stop criteria of a run that has taken long enough."""

from __future__ import annotations

import math
from dataclasses import dataclass

from solver.latin.criteria.criterion import Criterion, Judge
from solver.latin.criteria.judged_numbers import Numbers
from solver.latin.criteria.status import Ending, Status
from solver.refusal import check_range

LONGER = "Give the run longer, or ask for less: fewer elements or instants, a larger accuracy."


class _Limit(Judge):
    """What ends a run that has not converged."""

    remedy = ""

    def holds(self, numbers: Numbers) -> bool:
        return self.is_last(numbers.number, numbers.seconds)

    def status(self, numbers: Numbers) -> Status:
        return Status(Ending.EXHAUSTED, self.remedy)


@dataclass(frozen=True)
class Iterations(Criterion):
    """So many iterations are done."""

    most: int = 1000

    def __post_init__(self) -> None:
        check_range(self, "most", 1, math.inf)

    def at_work(self) -> Judge:
        """Begin a run."""
        return _IterationsJudge(self.most)


class _IterationsJudge(_Limit):
    def __init__(self, most: int) -> None:
        self._most = most

    def is_last(self, number: int, seconds: float) -> bool:
        return number >= self._most


@dataclass(frozen=True)
class Seconds(Criterion):
    """So many seconds are on the bill; a start or a status step that takes longer is given up."""

    most: float

    def __post_init__(self) -> None:
        check_range(self, "most", 0.0, math.inf, above=True)

    @property
    def seconds(self) -> float:
        """Themselves."""
        return self.most

    def at_work(self) -> Judge:
        """Begin a run."""
        return _SecondsJudge(self.most)


class _SecondsJudge(_Limit):
    remedy = LONGER

    def __init__(self, most: float) -> None:
        self._most = most

    def is_last(self, number: int, seconds: float) -> bool:
        return seconds >= self._most
