"""Progress of a run: changes of the contact force, the next check of a number, and stalling."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from solver.arrays import ROUNDING, Array, Flags
from solver.discrete.problem import Problem
from solver.latin.indicators import ratio
from solver.latin.iterate import Iterate
from solver.reference.distance import LEAST_SHARE, VANISHING

LOOK_BACK = 0.7
"""A change of the contact force is that since the iterate at this share of the iterations."""
SAFETY = 4.0
"""On what is left, if the changes go on to fall by the slower of their last two ratios, which a
power of the iterations has as well as a power of a number: of 20 iterates of bars and strands one
had a larger error, by five times (measured)."""
SLOWEST = 0.97
"""Ratio at most: that of a force that converges as the iterations to the power of -0.085."""
FEW = 10
"""Iterations up to which changes foretell nothing: a nested start makes them small at once."""
SPACING = 1.1
"""Ratio of the iterations whose contact forces are kept to look back at."""
RARELY = 2.0
"""Ratio of the iterations at which it is asked anew which forces count as none."""


class Change(NamedTuple):
    """Relative change of friction or of pressure, whichever is larger, and of both as one field."""

    worst: float = math.nan
    whole: float = math.nan


class _Past(NamedTuple):
    """Forces on the rows that rub, (n_instants, n_rows), and how they had changed by then."""

    number: int
    force: Array
    change: Change


class ForceChanges:
    """How the contact force changes along a run; `last` since the iterate looked back at."""

    def __init__(self) -> None:
        self._past: list[_Past] = []
        self._least, self._least_next = 0.0, 0.0
        self.last = Change()

    def left(self, iterate: Iterate) -> Change:
        """The relative error that is left, if changes go on to fall as they did, or NaN."""
        number, (rows, _) = iterate.number, iterate.problem.rubbing_rows
        outgoing, incoming = iterate.outgoing.T[:, rows], iterate.incoming.T[:, rows]
        force = np.ascontiguousarray(outgoing - incoming)
        force *= 0.5 * iterate.k[rows]
        before = self._at(LOOK_BACK * number)
        self.last = Change()
        if before is not None:
            self.last = _change(iterate.problem, force - before.force, force, self._least)
        earlier = before and self._at(LOOK_BACK * before.number)
        if not self._past or number >= SPACING * self._past[-1].number:
            oldest = earlier.number if earlier else 0
            self._past = [entry for entry in self._past if entry.number >= oldest]
            self._past.append(_Past(number, force, self.last))
            if number >= self._least_next:
                around = VANISHING * float(np.linalg.norm(iterate.boundary_force))
                blurred = ROUNDING * float(np.linalg.norm(iterate.k[:, None] * iterate.outgoing))
                self._least, self._least_next = max(around, blurred), RARELY * number
        if before is None or earlier is None or number <= FEW:
            return Change(*(0.0 if last == 0.0 else math.nan for last in self.last))
        return Change(*map(_left, self.last, before.change, earlier.change))

    def _at(self, number: float) -> _Past | None:
        """What was last kept up to a number of iterations."""
        return next((entry for entry in reversed(self._past) if entry.number <= number), None)


def _left(last: float, before: float, earlier: float) -> float:
    """What is left of a force, of which these are the last three changes."""
    fall = max(ratio(last, before), ratio(before, earlier))
    fall = SLOWEST if math.isnan(fall) else min(fall, SLOWEST)
    return SAFETY * last * max(fall / (1.0 - fall), 1.0 - LOOK_BACK)


def _change(problem: Problem, change: Array, force: Array, least: float) -> Change:
    """A change relative to what `solver.reference.distance` divides an error by."""
    _, normal = problem.rubbing_rows
    changes, squares = (np.einsum("ij,ij->j", field, field) for field in (change, force))

    def share(kind: Flags | slice, least: float) -> float:
        size = max(math.sqrt(float(squares[kind].sum())), least)
        return math.sqrt(float(changes[kind].sum())) / size if size > 0.0 else 0.0

    hidden = max(least, LEAST_SHARE * math.sqrt(float(squares.sum())))
    return Change(max(share(normal, hidden), share(~normal, hidden)), share(slice(None), least))


SHARE = 8
"""What may be low enough is computed again at the latest after this part of the iterations."""


class NextCheck:
    """The next iteration at which a number that falls is worth computing.

    Half way to where its last two values, over what is low enough, would have it fall to 1; while
    it does not fall, after half of the longest wait. So it is missed by little, and only if it
    falls suddenly.
    """

    def __init__(self) -> None:
        self.next, self._last = 0, (0, math.nan)

    def update(self, iteration: int, value: float) -> None:
        """Take in a value."""
        (before, last), left = self._last, 0.0
        self._last = iteration, value
        if 1.0 < value < last and iteration > before:
            left = 0.5 * math.log(value) / math.log(last / value) * (iteration - before)
        least = 0 if value <= 1.0 else iteration // (2 * SHARE)
        self.next = iteration + 1 + max(int(min(left, iteration / SHARE)), least)


WINDOW = 200
"""Iterations without a lower indicator after which a run is called stalled."""
FACTOR = 0.99
"""A lower indicator is one below this part of the lowest so far."""
SELDOM = 16
"""Every so many iterations the LATIN indicator is computed, for nothing but to see a stall."""


class StallCheck:
    """Whether the LATIN indicator has stalled, and the lowest so far."""

    def __init__(self) -> None:
        self.indicator, self._number, self._k = math.inf, 0, np.zeros(0)

    def has_stalled(self, iterate: Iterate) -> bool:
        """Whether it has stopped falling."""
        number = iterate.number
        if iterate.k is not self._k:
            # It is measured by k: to look for the lowest begins anew.
            self.indicator, self._number, self._k = math.inf, number, iterate.k
        if number % SELDOM and number - self._number < WINDOW:
            return False
        if iterate.indicator < FACTOR * self.indicator:
            self.indicator, self._number = iterate.indicator, number
        return number - self._number >= WINDOW
