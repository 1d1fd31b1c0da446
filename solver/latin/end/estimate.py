"""Error estimate of the contact force, without a reference (MATHEMATICS.md, 7)."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from solver.arrays import ROUNDING, Array, Flags
from solver.discrete.problem import Problem
from solver.latin.end.cost import Costs, costs_of
from solver.latin.end.status import Status, collapses, lost_jump
from solver.latin.end.status_step import Certificate, states_of, status_step
from solver.latin.indicators import ratio
from solver.latin.iterate import Iterate
from solver.reference.assembly import Interrupted, NoReferenceError, never
from solver.reference.distance import LEAST_SHARE, VANISHING
from solver.reference.incremental import Incremental, incremental_solver
from solver.reference.solution import Reference

SETTLED = 0.04
"""Relative change of the whole contact force at which most statuses are right. If
friction and pressure each had to settle, four layers would wait for 22 iterations
instead of 8 (measured)."""
OBEYED = 1e-10
"""KKT residual up to which an iterate is a solution of the discrete problem by itself,
and root of the LATIN indicator up to which the first iterate promises to be one."""
AGAIN = 2
"""Ratio of the iterations at which a failed status step is tried again, and at which
two rough numbers are computed again, as both cost much beside a small iteration: the
cost of the step, and the force that counts as none."""
LOOK_BACK = 0.7
"""Share of the iterations at which the contact force is compared with that of now."""
SAFETY = 8.0
"""Factor on the error that is left if changes continue to fall by the slower of their
last two ratios, which a power of the iterations has as well as a power of a number.
With 4 one of 880 random runs ended twice as far away as it said, at the beginning
of a long plateau (measured)."""
FEW = 10
"""Iterations up to which changes foretell nothing."""


class ErrorEstimate:
    """Estimator of the relative error of the contact force, iterate by iterate.

    Once a status step is certified, the error is the distance to the certified
    solution. Before, and where the step costs more than it saves, the error is
    estimated from the last changes, with a factor for safety.

    A status step is given up at the `deadline`, by `time.perf_counter`, and none begins
    that would take longer.

    Parameters
    ----------
    accuracy
        Relative error that the run asks for; infinite where it asks for none.
    needs_certificate
        Whether only a certified solution counts, whatever it costs: bases that are too
        small converge to something else, which no change shows, and from a start that
        is near changes are small also where k is so far off that nothing moves.
    may_shift
        Whether the method shifts bodies as rigid ones where hinges are free, which
        costs more than a plain iteration.
    interrupted
        Returns True where a status step is to be given up; it is tried again after the
        next iteration.

    Attributes
    ----------
    certificate
        The certified solution; None until it is known, and for ever where the problem
        has no reference.
    ending
        Status of a run whose last status step came to an instant without equilibrium.
    unsolved_from
        First instant at which the last status step found no equilibrium, though there
        may be one; None where it found all that it tried.
    """

    def __init__(
        self,
        accuracy: float,
        *,
        needs_certificate: bool = False,
        may_shift: bool = False,
        interrupted: Callable[[], bool] = never,
    ) -> None:
        self._accuracy = accuracy
        self.needs_certificate = needs_certificate
        self._may_shift = may_shift
        self._changes = ForceChanges()
        self._next_trial = 1
        self._solver: Incremental | None = None
        self._costs: tuple[int, Costs] | None = None
        self._has_solver = True
        self.certificate: Certificate | None = None
        self.deadline = math.inf
        self._interrupted = interrupted
        self.ending: Status | None = None
        self.unsolved_from: int | None = None

    def __call__(self, iterate: Iterate) -> float:
        """Estimate the relative error of the next iterate of a run; NaN if unknown."""
        error = math.nan
        if self.certificate is None:
            error = self._changes.remaining_error(iterate)
            if self._is_trial_due(iterate):
                self.try_step(iterate)
        if self.certificate is None:
            return error
        return self.certificate.distance.of_friction_force(iterate)

    def _is_trial_due(self, iterate: Iterate) -> bool:
        """Check whether a status step is likely to succeed now, and worth its cost."""
        number = iterate.number
        if number < self._next_trial or iterate.problem.no_reference:
            return False
        # A run may begin with its solution, so that no change shows it.
        begins_solved = number == 1 and iterate.indicator <= OBEYED**2
        if begins_solved or self._changes.whole <= SETTLED:
            return True
        return self._costs_of(iterate).is_small(number)

    @property
    def is_certified(self) -> bool:
        """Check whether the error is the distance to a certified solution."""
        return self.certificate is not None

    def is_within_certified(self, share: float, iterate: Iterate) -> bool:
        """Check whether an iterate is within a share of a certified solution.

        `share` is the largest relative error of its displacement and contact force.
        """
        if self.certificate is None:
            return False
        distance = self.certificate.distance
        of_force = distance.of_friction_force(iterate)
        of_displacement = distance.of_displacement(iterate)
        return max(of_force, of_displacement) <= share

    def is_step_worthwhile(self, iterate: Iterate) -> bool:
        """Check whether a status step is worth its cost at this iterate."""
        if iterate.problem.no_reference or not self._has_solver:
            return False
        costs = self._costs_of(iterate)
        if costs.step > self._time_left():
            return False
        return self.needs_certificate or costs.afford(iterate.number)

    def try_step(self, iterate: Iterate) -> None:
        """Try the status step, if it is worth its cost by `is_step_worthwhile`."""
        if not self.is_step_worthwhile(iterate):
            return
        self._next_trial = AGAIN * iterate.number + 1
        try:
            if self._solver is None:
                self._solver = incremental_solver(iterate.problem, self._stops)
            solution, certificate = status_step(
                self._solver,
                iterate.problem,
                states_of(iterate),
                stop=self._stops,
            )
        except NoReferenceError:
            self._has_solver = False
            return
        except Interrupted:
            if self._time_left() >= 0.0:
                self._next_trial = iterate.number + 1
            return
        self.ending = _lost_equilibrium(iterate.problem, solution)
        self.unsolved_from = None
        if solution.is_lost:
            self.unsolved_from = int(np.argmin(solution.converged))
        if certificate is not None and certificate.residual <= self._accuracy:
            self.certificate = certificate

    def _stops(self) -> bool:
        """Check whether a status step has to stop: time is up, or the caller asks."""
        return self._time_left() < 0.0 or self._interrupted()

    def _time_left(self) -> float:
        """Time left of the run's limit, s."""
        return self.deadline - time.perf_counter()

    def _costs_of(self, iterate: Iterate) -> Costs:
        """Costs from the statuses of an iterate, updated when iterations double."""
        if self._costs is None or iterate.number >= AGAIN * self._costs[0]:
            costs = costs_of(
                iterate.problem, states_of(iterate), may_shift=self._may_shift
            )
            self._costs = iterate.number, costs
        return self._costs[1]


def _lost_equilibrium(problem: Problem, solution: Reference) -> Status | None:
    """Status of a run whose solution has no equilibrium at an instant, or None."""
    if solution.collapse is not None:
        return collapses(problem, solution.collapse)
    if solution.jumps_at is not None and solution.is_lost:
        lost_from = int(np.argmin(solution.converged))
        return lost_jump(problem, solution.jumps_at, lost_from)
    return None


class _EarlierForces(NamedTuple):
    """Contact forces of an earlier iterate.

    Attributes
    ----------
    number
        Number of the iterate.
    force
        Forces on `Problem.unknown_rows`, shape (n_instants, n_rows), scaled.
    worst
        Change of the forces up to that iterate, as `ForceChanges.worst`.
    """

    number: int
    force: Array
    worst: float


class ForceChanges:
    """Relative changes of the contact forces along a run.

    Attributes
    ----------
    worst, whole
        Change up to the newest iterate, since that at the share `LOOK_BACK` of the
        iterations: of the kind of force that changes most (friction, pressure, forces
        of laws of a user), and of all together; NaN if unknown.
    """

    def __init__(self) -> None:
        self._past: list[_EarlierForces] = []
        self._smallest_size = 0.0
        self._next_size = 0
        self.worst = math.nan
        self.whole = math.nan

    def remaining_error(self, iterate: Iterate) -> float:
        """Relative error that remains if changes continue to fall; NaN if unknown."""
        number = iterate.number
        force = _force_of(iterate)
        before = self._at(LOOK_BACK * number)
        earlier = None
        if before is not None:
            earlier = self._at(LOOK_BACK * before.number)
            change = force - before.force
            self.worst, self.whole = _change(
                iterate.problem, change, force, self._smallest_size
            )
        self._keep(_EarlierForces(number, force, self.worst), earlier)
        if number >= self._next_size:
            self._smallest_size = _vanishing_size(iterate)
            self._next_size = AGAIN * number
        if self.worst == 0.0:
            return 0.0
        if before is None or earlier is None or number <= FEW:
            return math.nan
        return _remaining_error(self.worst, before.worst, earlier.worst)

    def _keep(self, newest: _EarlierForces, earlier: _EarlierForces | None) -> None:
        """Store the forces of an iterate, and drop those before the `earlier` one."""
        if earlier is not None:
            self._past = [
                entry for entry in self._past if entry.number >= earlier.number
            ]
        self._past.append(newest)

    def _at(self, number: float) -> _EarlierForces | None:
        """Newest stored forces up to a number of iterations; None without any."""
        for entry in reversed(self._past):
            if entry.number <= number:
                return entry
        return None


def _force_of(iterate: Iterate) -> Array:
    """Contact forces on `Problem.unknown_rows`, shape (n_instants, n_rows), scaled."""
    rows, _ = iterate.problem.unknown_rows
    outgoing = iterate.outgoing.T[:, rows]
    incoming = iterate.incoming.T[:, rows]
    force = np.ascontiguousarray(outgoing - incoming)
    force *= 0.5 * iterate.k[rows]
    return force


def _vanishing_size(iterate: Iterate) -> float:
    """Norm of contact forces that is negligible beside other forces, scaled."""
    hidden = VANISHING * float(np.linalg.norm(iterate.boundary_force))
    rounding = ROUNDING * float(np.linalg.norm(iterate.k[:, None] * iterate.outgoing))
    return max(hidden, rounding)


def _remaining_error(last: float, before: float, earlier: float) -> float:
    """Relative error that remains by the last three changes; NaN unless they fall."""
    fall = max(ratio(last, before), ratio(before, earlier))
    if not fall < 1.0:
        return math.nan
    return SAFETY * last * max(fall / (1.0 - fall), 1.0 - LOOK_BACK)


def _change(
    problem: Problem, change: Array, force: Array, smallest_size: float
) -> tuple[float, float]:
    """Largest and whole change, over the sizes in the errors of `reference.distance`.

    Parameters
    ----------
    problem
        The problem of the iterates.
    change, force
        Change of the forces, and the forces, on `Problem.unknown_rows`, shape
        (n_instants, n_rows), scaled.
    smallest_size
        Norm of forces that counts as none, scaled.
    """
    _, kinds = problem.unknown_rows
    changes = np.einsum("ij,ij->j", change, change)
    squares = np.einsum("ij,ij->j", force, force)

    def share(kind: Flags | slice, smallest: float) -> float:
        size = max(math.sqrt(float(squares[kind].sum())), smallest)
        if size > 0.0:
            return math.sqrt(float(changes[kind].sum())) / size
        return 0.0

    hidden = max(smallest_size, LEAST_SHARE * math.sqrt(float(squares.sum())))
    worst = max((share(kind, hidden) for kind in kinds), default=0.0)
    return worst, share(slice(None), smallest_size)
