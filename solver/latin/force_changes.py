"""What the last changes of the contact force let expect of those to come."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import ROUNDING, Array
from solver.latin.indicators import ratio
from solver.latin.iterate import Iterate
from solver.reference.distance import LEAST_SHARE, VANISHING

LOOK_BACK = 0.7
"""A change of the contact force is that since the iterate at this share of the iterations."""
SAFETY = 4.0
"""On what is left, if the changes go on to fall from one such part of the iterations to the next as
they did in the last three: by the slower of both ratios. A force that converges as a power of the
iterations is foreseen by that as well as one that converges as a power of a number. On six runs of
bars and strands, from 10 % to 0.05 % of error, the estimate was 1 to 300 times the truth in 19 of
20 iterates; the least was 0.2 of it, on a bar of 400 elements (measured)."""
SLOWEST = 0.97
"""Ratio at most: that of a force that converges as the iterations to the power of -0.085. Four
wires of 320 elements come to as little as -0.07 (measured)."""
FEW = 10
"""Iterations up to which changes foretell nothing. A nested start whose k does not suit the run
makes them small at once: eight wires of 332 elements on the paper's k, 32 % wrong, change by less
each time until the sixth iteration, and by more from then on (measured)."""
SPACING = 1.1
"""Ratio of the iterations whose contact forces are kept to look back at."""
RARELY = 2.0
"""Ratio of the iterations at which it is asked anew which forces count as none: a matter of orders
of magnitude, and dear beside a small iteration."""
_NOTHING: Array = np.zeros(0)


class Change(NamedTuple):
    """A relative change of the contact force, or what is left to change.

    Attributes
    ----------
    worst
        Of friction or of pressure, whichever is larger.
    whole
        Of both as one field.
    """

    worst: float
    whole: float


UNKNOWN = Change(math.nan, math.nan)


class _Past(NamedTuple):
    """The forces on the rows that rub at an iteration, and how they had changed by then."""

    number: int
    force: Array
    change: Change


class ForceChanges:
    """How the contact force changes along a run.

    Attributes
    ----------
    last
        Change since the iterate looked back at; NaN while there is none.
    """

    def __init__(self) -> None:
        self._past: list[_Past] = []
        self._least = 0.0
        self._least_next = 0.0
        self.last = UNKNOWN

    def left(self, iterate: Iterate) -> Change:
        """The relative error that is left, if changes go on to fall as they did, or NaN."""
        force, number = _force_on_rows(iterate), iterate.number
        before = _at(self._past, LOOK_BACK * number)
        self.last = UNKNOWN
        if before is not None:
            self.last = _change(iterate, force - before.force, force, self._least)
        if not self._past or number >= SPACING * self._past[-1].number:
            now = _Past(number, force, self.last)
            self._past = [*_still_needed(self._past, number), now]
            if number >= self._least_next:
                self._least, self._least_next = _least(iterate), RARELY * number
        earlier = before and _at(self._past, LOOK_BACK * before.number)
        if before is None or earlier is None or number <= FEW:
            return Change(*(0.0 if last == 0.0 else math.nan for last in self.last))
        return Change(*map(_left, self.last, before.change, earlier.change))


def _left(last: float, before: float, earlier: float) -> float:
    """What is left of a force, of which these are the last three changes."""
    fall = max(ratio(last, before), ratio(before, earlier))
    fall = SLOWEST if math.isnan(fall) else min(fall, SLOWEST)
    return SAFETY * last * max(fall / (1.0 - fall), 1.0 - LOOK_BACK)


def _still_needed(past: list[_Past], number: int) -> list[_Past]:
    """The entries that later iterations look back at; of the oldest the change is enough."""
    first = _at(past, LOOK_BACK * number)
    if first is None:
        return past
    oldest = _at(past, LOOK_BACK * first.number) or past[0]
    return [
        entry if entry.number >= first.number else entry._replace(force=_NOTHING)
        for entry in past
        if entry.number >= oldest.number
    ]


def _at(past: Iterable[_Past], number: float) -> _Past | None:
    """The last entry up to a number of iterations."""
    last = None
    for entry in past:
        if entry.number > number:
            break
        last = entry
    return last


def _change(iterate: Iterate, change: Array, force: Array, least: float) -> Change:
    """A change relative to what `solver.reference.distance` divides an error by."""
    n_instants, normal = iterate.problem.n_instants, iterate.problem.rubbing_is_normal
    changes, squares = (
        np.einsum("ij,ij->j", by_instant, by_instant)
        for by_instant in (field.reshape(n_instants, -1) for field in (change, force))
    )

    def share(kind: NDArray[np.bool_] | slice, least: float) -> float:
        size = max(math.sqrt(float(squares[kind].sum())), least)
        return math.sqrt(float(changes[kind].sum())) / size if size > 0.0 else 0.0

    hidden = max(least, LEAST_SHARE * math.sqrt(float(squares.sum())))
    return Change(max(share(normal, hidden), share(~normal, hidden)), share(slice(None), least))


def _least(iterate: Iterate) -> float:
    """The norm of contact forces that count as none, scaled."""
    around = VANISHING * float(np.linalg.norm(iterate.boundary_force))
    blurred = ROUNDING * float(np.linalg.norm(iterate.k[:, None] * iterate.outgoing))
    return max(around, blurred)


def _force_on_rows(iterate: Iterate) -> Array:
    """The forces on the rows of the bodies above that rub, in a row, scaled."""
    rows = iterate.problem.rubbing_rows
    difference = iterate.outgoing[rows] - iterate.incoming[rows]
    difference *= 0.5 * iterate.k[rows, None]
    return difference.reshape(-1, order="F")
