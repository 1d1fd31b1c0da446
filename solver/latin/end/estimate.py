"""How wrong the contact force of an iterate is, without any reference (solver/README.md, 7)."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from solver.arrays import ROUNDING, Array, Flags
from solver.discrete.problem import Problem
from solver.latin.end.cost import WAIT, Costs, costs_of
from solver.latin.end.status import Status, collapses, lost_jump
from solver.latin.end.status_step import Certificate, states_of, status_step
from solver.latin.indicators import ratio
from solver.latin.iterate import Iterate
from solver.reference.assembly import Interrupted, NoReferenceError
from solver.reference.distance import LEAST_SHARE, VANISHING
from solver.reference.incremental import Incremental, incremental_solver

SETTLED = 0.04
"""Relative change of the whole contact force at which most statuses are right. If
friction and pressure each had to settle, four layers would wait for 22 iterations
instead of 8 (measured)."""
SOLVED = 1e-20
"""LATIN indicator, a ratio of squares, of a run that begins with its solution."""
LONG = 100
"""Iterations from which on a status step is tried at every doubling, whatever has
changed: a contact force that dies out changes by much of itself for ever."""
LAST = 10.0
"""Times more that a run's last trial may cost: without it the run has no answer."""
AGAIN = 2.0
"""Ratio of the iterations at which a failed status step is tried again, its cost is
estimated anew, and which forces count as none: rough numbers, and dear beside a small
iteration."""
LOOK_BACK = 0.7
"""A change of the contact force is that since the iterate at this share of the
iterations."""
SAFETY = 4.0
"""On what is left, if the changes go on to fall by the slower of their last two ratios,
which a power of the iterations has as well as a power of a number: of 20 iterates of
bars and strands one had a larger error, by five times (measured)."""
SLOWEST = 0.97
"""Ratio at most: that of a force that converges as the iterations to the power of
-0.085."""
FEW = 10
"""Iterations up to which changes foretell nothing: a nested start makes them small at
once."""
SPACING = 1.1
"""Ratio of the iterations whose contact forces are kept to look back at."""


class ErrorEstimate:
    """The relative error of the contact force, iterate after iterate.

    Once a status step is certified it is the distance to that solution. Before, and
    where the step costs more than it saves, it is what the last changes let expect,
    with a factor for safety.

    With `needs_proof` a certified solution alone counts, whatever it costs: bases that
    are too small converge to something else, which no change shows. The `certificate`
    is None until it is known; for ever, where the problem has no reference. A status
    step is given up at the `deadline`, by `time.perf_counter`, and none begins that
    would take longer. Where `interrupted` returns True it is given up, too, and tried
    again after the next iteration. The `ending` is that of a run whose last status step
    came to where no equilibrium goes on.
    """

    def __init__(
        self,
        accuracy: float,
        *,
        needs_proof: bool = False,
        interrupted: Callable[[], bool] = lambda: False,
    ) -> None:
        self._accuracy = accuracy
        self.needs_proof = needs_proof
        self._changes = ForceChanges()
        self._next_trial = 1
        self._solver: Incremental | None = None
        self._costs: tuple[int, Costs] | None = None
        self._has_solver = True
        self.certificate: Certificate | None = None
        self.deadline = math.inf
        self._interrupted = interrupted
        self.ending: Status | None = None

    def __call__(self, iterate: Iterate) -> float:
        """The estimate for the next iterate of a run; NaN where there is none."""
        number = iterate.number
        worst = math.nan
        if self.certificate is None:
            worst, whole = self._changes.left(iterate)
            ends_soon = worst <= self._accuracy or whole <= self._accuracy
            # A run may begin with its solution, so that no change shows it.
            is_near = self._changes.last.whole <= SETTLED or number >= LONG
            is_near |= number == 1 and iterate.indicator <= SOLVED
            is_due = number >= self._next_trial and not iterate.problem.no_reference
            if is_due and (is_near or number >= self._costs_of(iterate).small_from):
                self.try_step(iterate, least=WAIT if ends_soon else 0.0)
        if self.certificate is None:
            return worst
        return self.certificate.distance.of_friction_force(iterate)

    @property
    def is_proven(self) -> bool:
        """Whether it is the distance to a certified solution."""
        return self.certificate is not None

    def is_proven_within(self, share: float, iterate: Iterate) -> bool:
        """Whether displacement and contact force are that near to a certified solution."""
        if self.certificate is None:
            return False
        distance = self.certificate.distance
        errors = distance.of_friction_force(iterate), distance.of_displacement(iterate)
        return max(errors) <= share

    def can_be_proven(
        self, iterate: Iterate, patience: float = 1.0, least: float = 0.0
    ) -> bool:
        """Whether a status step is worth its cost by now.

        It may cost `patience` times more than usual, and in any case `least` seconds.
        """
        if iterate.problem.no_reference or not self._has_solver:
            return False
        costs = self._costs_of(iterate)
        if costs.step > self._left():
            return False
        return self.needs_proof or costs.afford(patience * iterate.number, least)

    def try_step(
        self, iterate: Iterate, patience: float = 1.0, least: float = 0.0
    ) -> None:
        """Try the status step, unless it costs too much, as above."""
        if not self.can_be_proven(iterate, patience, least):
            return
        self._next_trial = math.ceil(AGAIN * iterate.number) + 1
        systems = self._costs_of(iterate).systems(patience * iterate.number)
        try:
            self._solver = self._solver or incremental_solver(
                iterate.problem, self._stops
            )
            solution, certificate = status_step(
                self._solver,
                iterate.problem,
                states_of(iterate),
                systems,
                self._stops,
            )
        except NoReferenceError:
            self._has_solver = False
            return
        except Interrupted:
            if self._left() >= 0.0:
                self._next_trial = iterate.number + 1
            return
        self.ending = None
        if solution.collapse is not None:
            self.ending = collapses(iterate.problem, solution.collapse)
        elif solution.jumps_at is not None and solution.is_lost:
            lost_from = int(np.argmin(solution.converged))
            self.ending = lost_jump(iterate.problem, solution.jumps_at, lost_from)
        if certificate is not None and certificate.residual <= self._accuracy:
            self.certificate = certificate

    def _stops(self) -> bool:
        """Whether a status step is to be given up."""
        return self._left() < 0.0 or self._interrupted()

    def _left(self) -> float:
        """Seconds that are left of the run's limit."""
        return self.deadline - time.perf_counter()

    def _costs_of(self, iterate: Iterate) -> Costs:
        """Estimate the costs by the statuses that an iterate shows, now and then anew."""
        if self._costs is None or iterate.number >= AGAIN * self._costs[0]:
            self._costs = iterate.number, costs_of(iterate.problem, states_of(iterate))
        return self._costs[1]


class Change(NamedTuple):
    """Relative changes of the forces that are sought: of one kind, the largest, and of all.

    Kinds are friction, pressure, and what laws of one's own carry.
    """

    worst: float = math.nan
    whole: float = math.nan


class _Past(NamedTuple):
    """Forces on `Problem.sought_rows`, (n_instants, n_rows), and how they had changed by then."""

    number: int
    force: Array
    change: Change


class ForceChanges:
    """How the contact force changes along a run; `last` since the iterate looked back at."""

    def __init__(self) -> None:
        self._past: list[_Past] = []
        self._least = 0.0
        self._least_next = 0.0
        self.last = Change()

    def left(self, iterate: Iterate) -> Change:
        """The relative error that is left, if changes go on to fall as they did, or NaN."""
        number = iterate.number
        (rows, _) = iterate.problem.sought_rows
        outgoing = iterate.outgoing.T[:, rows]
        incoming = iterate.incoming.T[:, rows]
        force = np.ascontiguousarray(outgoing - incoming)
        force *= 0.5 * iterate.k[rows]
        before = self._at(LOOK_BACK * number)
        self.last = Change()
        if before is not None:
            self.last = _change(
                iterate.problem, force - before.force, force, self._least
            )
        earlier = before and self._at(LOOK_BACK * before.number)
        if not self._past or number >= SPACING * self._past[-1].number:
            oldest = earlier.number if earlier else 0
            self._past = [entry for entry in self._past if entry.number >= oldest]
            self._past.append(_Past(number, force, self.last))
            if number >= self._least_next:
                around = VANISHING * float(np.linalg.norm(iterate.boundary_force))
                blurred = ROUNDING * float(
                    np.linalg.norm(iterate.k[:, None] * iterate.outgoing)
                )
                self._least = max(around, blurred)
                self._least_next = AGAIN * number
        if before is None or earlier is None or number <= FEW:
            return Change(*(0.0 if last == 0.0 else math.nan for last in self.last))
        return Change(*map(_left, self.last, before.change, earlier.change))

    def _at(self, number: float) -> _Past | None:
        """What was last kept up to a number of iterations."""
        return next(
            (entry for entry in reversed(self._past) if entry.number <= number), None
        )


def _left(last: float, before: float, earlier: float) -> float:
    """What is left of a force, of which these are the last three changes."""
    fall = max(ratio(last, before), ratio(before, earlier))
    if math.isnan(fall):
        fall = SLOWEST
    else:
        fall = min(fall, SLOWEST)
    return SAFETY * last * max(fall / (1.0 - fall), 1.0 - LOOK_BACK)


def _change(problem: Problem, change: Array, force: Array, least: float) -> Change:
    """A change relative to what `solver.reference.distance` divides an error by."""
    _, kinds = problem.sought_rows
    changes, squares = (
        np.einsum("ij,ij->j", field, field) for field in (change, force)
    )

    def share(kind: Flags | slice, least: float) -> float:
        size = max(math.sqrt(float(squares[kind].sum())), least)
        if size > 0.0:
            return math.sqrt(float(changes[kind].sum())) / size
        return 0.0

    hidden = max(least, LEAST_SHARE * math.sqrt(float(squares.sum())))
    worst = max((share(kind, hidden) for kind in kinds), default=0.0)
    return Change(worst, share(slice(None), least))
