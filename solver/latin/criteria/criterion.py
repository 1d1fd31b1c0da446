"""What a stop criterion is, and how two combine by `&` and `|`.

In a run a criterion looks at an iterate when it is due, as most numbers cost as much as an
iteration, or when it is asked to, at the first and the last one.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from solver.latin.criteria.judged_numbers import Numbers
from solver.latin.criteria.status import Status


class Judge(ABC):
    """A criterion in a run: it may remember when to look next."""

    def is_due(self, number: int) -> bool:
        """Tell whether to look at this iteration."""
        return True

    def is_last(self, number: int, seconds: float) -> bool:
        """Tell whether the run ends at this iteration whatever its numbers are."""
        return False

    @abstractmethod
    def holds(self, numbers: Numbers) -> bool:
        """Tell whether an iterate meets it."""

    @abstractmethod
    def status(self, numbers: Numbers) -> Status | None:
        """Say how the run ends where it holds; None where that is not known well enough."""

    def lacks(self, numbers: Numbers) -> str:
        """Say what is not met yet, in a sentence without its full stop; or nothing."""
        return ""

    def has(self, numbers: Numbers) -> str:
        """Say what is met although the run goes on, likewise; or nothing worth saying."""
        return ""

    def judge(self, numbers: Numbers) -> Status | None:
        """Look at an iterate if it is time to; say how the run ends, or None."""
        looks = numbers.are_asked or self.is_due(numbers.number)
        return self.status(numbers) if looks and self.holds(numbers) else None


class Criterion(ABC):
    """When a run ends, as a value."""

    def __and__(self, other: Criterion) -> Criterion:
        """Give the criterion that both meet."""
        return All((self, other))

    def __or__(self, other: Criterion) -> Criterion:
        """Give the criterion that either meets."""
        return Either((self, other))

    @property
    def accuracy(self) -> float:
        """Share that the contact force may be wrong by; infinite where it is not asked about."""
        return math.inf

    @property
    def tolerance(self) -> float:
        """Value of the LATIN indicator that is low enough; infinite where it is not asked about."""
        return math.inf

    @property
    def seconds(self) -> float:
        """Seconds after which the run ends in any case; infinite without such a limit."""
        return math.inf

    @abstractmethod
    def at_work(self) -> Judge:
        """Begin a run."""


@dataclass(frozen=True)
class Combined(Criterion):
    """Criteria that make one; it asks for what the tightest of them does."""

    parts: tuple[Criterion, ...]

    @property
    def accuracy(self) -> float:
        """The tightest of the parts."""
        return min(part.accuracy for part in self.parts)

    @property
    def tolerance(self) -> float:
        """The tightest of the parts."""
        return min(part.tolerance for part in self.parts)


@dataclass(frozen=True)
class All(Combined):
    """All parts hold; they are looked at in order, as long as they do."""

    @property
    def seconds(self) -> float:
        """The longest of the parts."""
        return max(part.seconds for part in self.parts)

    def at_work(self) -> Judge:
        """Begin a run."""
        return _AllJudge([part.at_work() for part in self.parts])


class _AllJudge(Judge):
    def __init__(self, parts: Sequence[Judge]) -> None:
        self._parts = parts

    def is_due(self, number: int) -> bool:
        return all(part.is_due(number) for part in self._parts)

    def is_last(self, number: int, seconds: float) -> bool:
        return all(part.is_last(number, seconds) for part in self._parts)

    def holds(self, numbers: Numbers) -> bool:
        return all(part.holds(numbers) for part in self._parts)

    def status(self, numbers: Numbers) -> Status | None:
        found = [part.status(numbers) for part in self._parts]
        return None if None in found else found[0]

    def lacks(self, numbers: Numbers) -> str:
        # What is looked at last is the dearest to meet, and says the most.
        lack = next(filter(None, (part.lacks(numbers) for part in reversed(self._parts))), "")
        met = next(filter(None, (part.has(numbers) for part in self._parts)), "")
        return f"{met}, yet {lack[0].lower()}{lack[1:]}" if met and lack else lack


@dataclass(frozen=True)
class Either(Combined):
    """Any part holds."""

    @property
    def seconds(self) -> float:
        """The shortest of the parts."""
        return min(part.seconds for part in self.parts)

    def at_work(self) -> Judge:
        """Begin a run."""
        return _EitherJudge([part.at_work() for part in self.parts])


class _EitherJudge(Judge):
    def __init__(self, parts: Sequence[Judge]) -> None:
        self._parts = parts
        self._status: Status | None = None

    def is_due(self, number: int) -> bool:
        return any(part.is_due(number) for part in self._parts)

    def is_last(self, number: int, seconds: float) -> bool:
        return any(part.is_last(number, seconds) for part in self._parts)

    def holds(self, numbers: Numbers) -> bool:
        found = (part.judge(numbers) for part in self._parts)
        self._status = next((status for status in found if status is not None), None)
        return self._status is not None

    def status(self, numbers: Numbers) -> Status | None:
        return self._status

    def lacks(self, numbers: Numbers) -> str:
        return next(filter(None, (part.lacks(numbers) for part in self._parts)), "")
