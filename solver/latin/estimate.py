"""How wrong the contact force of an iterate is, estimated without any reference (theory.md, 7)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from solver.discrete.problem import Array
from solver.latin.iterate import Iterate
from solver.latin.status_step import Certificate, StatusStep, is_affordable
from solver.reference.condensation import NoReferenceError
from solver.settings import Settings

LOOK_BACK = 0.7
"""The change of the contact force is that since the iterate at this share of the iterations."""
SAFETY = 4.0
"""On what is left, if the changes go on to fall from one such part of the iterations to the next as
they did in the last three: by the slower of both ratios. A force that converges as a power of the
iterations is foreseen by that as well as one that converges as a power of a number. From 10 % to
0.05 % of error the estimate was 1 to 300 times the truth in all but a few of 1500 iterates, scenes
and methods; a bar of 400 elements had one of 0.2 (measured)."""
SLOWEST = 0.97
"""Ratio at most: that of four wires of 320 elements, whose force converges as the iterations to the
power of -1/7."""
SETTLED = 0.04
"""Relative change at which the status step is worth its first trial: most statuses are right."""
SPACING = 1.1
"""Ratio of the iterations whose contact forces are kept to look back at."""
SOLVED = 1e-20
"""LATIN indicator, a ratio of squares, that is worth a trial whatever has changed."""
LONG = 100
"""Iterations from which on it is tried whatever has changed, at every doubling: a contact force
that dies out changes by much of itself for ever."""
WAIT = 2.0
"""Seconds that a step may take before a run is called converged, whatever the iterations took."""
LAST = 10.0
"""Times more that a run's last trial may cost: without it the run has no answer."""
VANISHING = 1e-8
"""Share of all forces at interfaces below which contact forces count as none, as in distances."""
ROUNDING = 64.0 * float(np.finfo(float).eps)
"""Share of what a force is the difference of that rounding leaves of it."""
AGAIN = 1.5
"""Ratio of the iteration at which a failed status step is tried again."""


_NOTHING: Array = np.zeros(0)


class _Past(NamedTuple):
    """The forces on the rows that rub at an iteration, and how they had changed by then."""

    number: int
    force: Array
    change: float


class ErrorEstimate:
    """The relative error of the contact force, iterate after iterate.

    Once a status step is certified it is the distance to that solution. Before, and where the step
    costs more than it saves, it is what the last changes let expect, with a factor for safety.

    Parameters
    ----------
    settings
        Of the run.
    proves
        Whether status steps are tried at all.

    Attributes
    ----------
    certificate
        The solution, once it is known.
    """

    def __init__(self, settings: Settings, *, proves: bool = True) -> None:
        self._accuracy, self._is_reduced = float(settings.accuracy), settings.is_reduced
        self._past: list[_Past] = []
        self._change = math.nan
        self._least = 0.0
        self._last_trial, self._next_trial = 0, 1
        self._step: StatusStep | None = None
        self._has_solver = proves
        self.certificate: Certificate | None = None

    def __call__(self, iterate: Iterate, indicator: float) -> float:
        """Give the estimate; NaN while there is none.

        Parameters
        ----------
        iterate
            The next one of the run.
        indicator
            Its LATIN indicator: where that is rounding, the iterate may be the solution.
        """
        expected, accuracy = self._by_changes(iterate), self._accuracy
        is_due = iterate.number >= self._next_trial
        is_near = self._change <= SETTLED or expected <= accuracy or indicator <= SOLVED
        is_near |= iterate.number >= max(LONG, 2 * self._last_trial)
        if self.certificate is None and is_due and is_near:
            self.try_step(iterate, least=WAIT if expected <= accuracy else 0.0)
        if self.certificate is None:
            return expected
        found = self.certificate.distance.of_friction_force(iterate)
        if is_due and expected <= accuracy < found and self.try_step(iterate):
            # It has come to rest elsewhere: there may be several solutions.
            found = self.certificate.distance.of_friction_force(iterate)
        return found

    @property
    def is_proven(self) -> bool:
        """Whether the last estimate was the distance to a certified solution."""
        return self.certificate is not None

    def is_proven_within(self, share: float, iterate: Iterate) -> bool:
        """Tell whether displacement and contact force are that near to a certified solution."""
        if self.certificate is None:
            return False
        distance = self.certificate.distance
        errors = distance.of_friction_force(iterate), distance.of_displacement(iterate)
        return max(errors) <= share

    def can_be_proven(self, iterate: Iterate, patience: float = 1.0, least: float = 0.0) -> bool:
        """Tell whether a status step is worth its cost by now.

        Parameters
        ----------
        iterate
            From which it would be tried.
        patience
            Times as much that it may cost.
        least
            What it may cost in any case, s.
        """
        if not self._has_solver:
            return False
        # Bases that are too small converge to something else, which no change shows.
        allowed = patience * iterate.number
        return self._is_reduced or is_affordable(iterate.problem, allowed, least)

    def try_step(self, iterate: Iterate, patience: float = 1.0, least: float = 0.0) -> bool:
        """Try the status step, unless it costs too much, as above; tell whether it holds."""
        if not self.can_be_proven(iterate, patience, least):
            return False
        self._last_trial = iterate.number
        self._next_trial = math.ceil(AGAIN * iterate.number) + 1
        self._step = self._step or StatusStep(iterate.problem)
        try:
            found = self._step(iterate, patience)
        except NoReferenceError:
            self._has_solver = False
            return False
        if found is None or found.residual > self._accuracy:
            return False
        self.certificate = found
        return True

    def _by_changes(self, iterate: Iterate) -> float:
        """Give what is left, if the changes of the force go on to fall as they did."""
        force, number = _force_on_rows(iterate), iterate.number
        before = _at(self._past, LOOK_BACK * number)
        self._change = math.nan
        if before is not None:
            size = max(float(np.linalg.norm(force)), self._least)
            change = float(np.linalg.norm(force - before.force))
            self._change = change / size if size > 0.0 else 0.0
        now = _Past(number, force, self._change)
        if not self._past or number >= SPACING * self._past[-1].number:
            self._past = [*_still_needed(self._past, number), now]
            self._least = _least(iterate)
        earlier = before and _at(self._past, LOOK_BACK * before.number)
        if before is None or earlier is None:
            return 0.0 if self._change == 0.0 else math.nan
        fall = max(_ratio(self._change, before.change), _ratio(before.change, earlier.change))
        fall = SLOWEST if math.isnan(fall) else min(fall, SLOWEST)
        return SAFETY * self._change * max(fall / (1.0 - fall), 1.0 - LOOK_BACK)

    def __getstate__(self) -> dict[str, object]:
        """Go elsewhere without what belongs to one problem: it is found again there."""
        return {**self.__dict__, "_step": None, "certificate": None, "_past": []}


def _still_needed(past: list[_Past], number: int) -> list[_Past]:
    """Give the entries that later iterations look back at; of the oldest the change is enough."""
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
    """Give the last entry up to a number of iterations."""
    found = None
    for entry in past:
        if entry.number > number:
            break
        found = entry
    return found


def _ratio(part: float, whole: float) -> float:
    """Divide, where nothing of nothing has fallen as far as can be."""
    if part == 0.0:
        return 0.0
    return part / whole if whole != 0.0 else math.inf


def _least(iterate: Iterate) -> float:
    """Give the norm of contact forces that count as none, scaled."""
    around = VANISHING * float(np.linalg.norm(iterate.boundary_force))
    blurred = ROUNDING * float(np.linalg.norm(iterate.k[:, None] * iterate.outgoing))
    return max(around, blurred)


def _force_on_rows(iterate: Iterate) -> Array:
    """Give the forces on the rows of the bodies above that rub, in a row, scaled."""
    rows = iterate.problem.rubbing_rows
    difference = iterate.outgoing[rows] - iterate.incoming[rows]
    difference *= 0.5 * iterate.k[rows, None]
    return difference.reshape(-1, order="F")
