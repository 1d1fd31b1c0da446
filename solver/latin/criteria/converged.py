"""The stop criteria of a run that has converged."""

from __future__ import annotations

import math
from dataclasses import dataclass

from solver.latin.criteria.criterion import Criterion, Judge
from solver.latin.criteria.estimate import WAIT
from solver.latin.criteria.judged_numbers import Numbers
from solver.latin.criteria.lookout import Lookout
from solver.latin.criteria.status import Ending, Status
from solver.refusal import check_range

LARGEST_VIOLATION = 1e-2
"""Of the k-free indicator at the end, however loose the tolerance."""
SMALLEST_VIOLATION = 1e-12
"""The same however tight it is."""
VIOLATION = 1.0
"""Times the root of the tolerance on eta, which is a ratio of squares: what the k-free indicator
may be at the end, between the two bounds above. Measured at the default tolerance: the friction
force is then within 0.1 % (block, layers), 0.4 % (bar, 2 to 20 wires) and 2 % (40 wires, or 200
elements with the paper's options) of the reference; with 100 it was up to 20 % off."""

_PROVEN = (
    "Accurate enough: the contact force of this iterate is within the accuracy of the exact "
    "solution on this mesh, which a status step has found. What is shown is the iterate, not that "
    "solution."
)
_EXPECTED = (
    "Accurate enough by estimate: the contact force hardly changes any more. Proof by a status "
    "step would take half as long again, or longer."
)
_BELOW = "The LATIN indicator is below its tolerance, and the k-free indicator agrees."


def agreement(tolerance: float) -> float:
    """Give the k-free indicator up to which it agrees that the run has converged.

    The LATIN indicator alone can be fooled: a search direction that is far from the stiffness in
    play makes it as small as one likes (solver/README.md, 4).
    """
    return min(max(VIOLATION * math.sqrt(tolerance), SMALLEST_VIOLATION), LARGEST_VIOLATION)


def agrees(numbers: Numbers, tolerance: float) -> bool:
    """Tell whether the k-free indicator says converged, or the solution itself does.

    The indicator is a share of what contact carries, which is nothing where all contacts open.
    """
    enough = agreement(tolerance)
    return numbers.behaviour <= enough or numbers.estimate.is_proven_within(enough, numbers.iterate)


@dataclass(frozen=True)
class Accuracy(Criterion):
    """The contact force is estimated to be wrong by at most a share of it.

    Where a status step is worth its cost, that has to be proven by the exact solution.
    """

    share: float = 0.01

    def __post_init__(self) -> None:
        check_range(self, "share", 0.0, 1.0, above=True)

    @property
    def accuracy(self) -> float:
        """The share."""
        return self.share

    def at_work(self) -> Judge:
        """Begin a run."""
        return _AccuracyJudge(self.share)


@dataclass(frozen=True)
class Proven(Accuracy):
    """The same, by the exact solution alone, which a status step has found: no other estimate."""

    def at_work(self) -> Judge:
        """Begin a run."""
        return _ProvenJudge(self.share)


class _AccuracyJudge(Judge):
    def __init__(self, share: float) -> None:
        self._share, self._lookout = share, Lookout()

    def is_due(self, number: int) -> bool:
        return self._lookout.is_due(number)

    def holds(self, numbers: Numbers) -> bool:
        found = numbers.estimated_error
        falls = found if numbers.estimate.is_proven else math.nan
        self._lookout.saw(numbers.number, falls, self._share)
        if found <= self._share:
            # What else has to hold says when to look again.
            self._lookout.next = numbers.number + 1
        return found <= self._share

    def status(self, numbers: Numbers) -> Status | None:
        if numbers.estimate.is_proven:
            return Status(Ending.CONVERGED, _PROVEN)
        if numbers.estimate.has_to_be_proven(numbers.iterate, WAIT):
            return None
        return Status(Ending.CONVERGED, _EXPECTED)

    def lacks(self, numbers: Numbers) -> str:
        return "The contact force is not known to be accurate enough"


class _ProvenJudge(_AccuracyJudge):
    def is_due(self, number: int) -> bool:
        # How many iterations it takes is what is asked; a distance costs a hundredth to a sixth
        # of one (measured on the five scenes).
        return True

    def holds(self, numbers: Numbers) -> bool:
        return super().holds(numbers) and numbers.estimate.is_proven

    def lacks(self, numbers: Numbers) -> str:
        if numbers.estimate.is_proven:
            return "The contact force of the iterates is not accurate enough"
        return super().lacks(numbers)


@dataclass(frozen=True)
class Indicator(Criterion):
    """The LATIN indicator eta, a ratio of squares, is at most this, and the k-free one agrees."""

    eta: float = 1e-3

    def __post_init__(self) -> None:
        check_range(self, "eta", 0.0, 1.0, above=True)

    @property
    def tolerance(self) -> float:
        """The value of eta."""
        return self.eta

    def at_work(self) -> Judge:
        """Begin a run."""
        return _IndicatorJudge(self.eta)


class _IndicatorJudge(Judge):
    def __init__(self, eta: float) -> None:
        self._eta, self._lookout = eta, Lookout()

    def is_due(self, number: int) -> bool:
        return self._lookout.is_due(number)

    def holds(self, numbers: Numbers) -> bool:
        self._lookout.saw(numbers.number, numbers.indicator, self._eta)
        return numbers.indicator <= self._eta and agrees(numbers, self._eta)

    def status(self, numbers: Numbers) -> Status:
        return Status(Ending.CONVERGED, _BELOW)

    def lacks(self, numbers: Numbers) -> str:
        is_low = numbers.indicator <= self._eta
        return "" if is_low else "The LATIN indicator is still above its tolerance"

    def has(self, numbers: Numbers) -> str:
        is_low = numbers.indicator <= self._eta
        return "The LATIN indicator is below its tolerance" if is_low else ""
