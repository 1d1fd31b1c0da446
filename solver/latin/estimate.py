"""How wrong the contact force of an iterate is, without any reference (solver/README.md, 7)."""

from __future__ import annotations

import math
import time

from solver.latin.force_changes import ForceChanges
from solver.latin.iterate import Iterate
from solver.latin.status_step import Certificate, states_of, status_step
from solver.latin.step_cost import Costs, costs_of, moving_share
from solver.reference.condensation import NoReferenceError
from solver.reference.incremental import Incremental, incremental_solver
from solver.reference.limit_analysis import Collapse
from solver.reference.solution import Interrupted

SETTLED = 0.04
"""Relative change of the whole contact force at which the status step is worth its first trial:
most statuses are right. Friction and pressure each need not have settled so far, as the step finds
both: where friction is small beside pressure it would wait for twice the iterations (measured on
four layers: 22 instead of 8)."""
SOLVED = 1e-20
"""LATIN indicator, a ratio of squares, that is worth a trial whatever has changed."""
LONG = 100
"""Iterations from which on it is tried whatever has changed, at every doubling: a contact force
that dies out changes by much of itself for ever."""
WAIT = 2.0
"""Seconds that a step may take before a run is called converged, whatever the iterations took."""
LAST = 10.0
"""Times more that a run's last trial may cost: without it the run has no answer."""
ROOM = 4.0
"""Times the seconds of a step that are left of a run's limit when its last trial begins: from
statuses that are not right yet it takes twice as long (measured on 200 wires)."""
AGAIN = 2.0
"""Ratio of the iteration at which a failed status step is tried again."""


class ErrorEstimate:
    """The relative error of the contact force, iterate after iterate.

    Once a status step is certified it is the distance to that solution. Before, and where the step
    costs more than it saves, it is what the last changes let expect, with a factor for safety.

    Parameters
    ----------
    accuracy
        Share of the contact force that is asked for.
    needs_proof
        Whether a certified solution alone counts, whatever it costs: bases that are too small
        converge to something else, which no change shows.

    Attributes
    ----------
    certificate
        The solution, once it is known.
    deadline
        When a status step is given up, and before which none begins that would take longer, by
        `time.perf_counter`.
    jumps
        Whether the last status step found nothing any more after the structure had jumped.
    collapse
        From when on no contact forces balance the loads, if the last status step ended there.
    """

    def __init__(self, accuracy: float, *, needs_proof: bool = False) -> None:
        self._accuracy, self._needs_proof = accuracy, needs_proof
        self._changes = ForceChanges()
        self._last_trial, self._next_trial = 0, 1
        self._solver: Incremental | None = None
        self._costs: Costs | None = None
        self._costs_at = 0
        self._has_solver = True
        self.certificate: Certificate | None = None
        self.deadline = math.inf
        self.jumps = False
        self.collapse: Collapse | None = None

    def __call__(self, iterate: Iterate, indicator: float) -> float:
        """The estimate; NaN while there is none.

        Parameters
        ----------
        iterate
            The next one of the run.
        indicator
            Its LATIN indicator: where that is rounding, the iterate may be the solution.
        """
        accuracy = self._accuracy
        is_due = iterate.number >= self._next_trial
        if self.certificate is not None:
            error = self.certificate.distance.of_friction_force(iterate)
            if is_due and accuracy < error and self._changes.left(iterate).worst <= accuracy:
                # It has come to rest elsewhere: there may be several solutions.
                self.try_step(iterate)
                error = self.certificate.distance.of_friction_force(iterate)
            return error
        expected = self._changes.left(iterate)
        ends_soon = any(left <= accuracy for left in expected)
        is_near = self._changes.last.whole <= SETTLED or ends_soon or indicator <= SOLVED
        if is_due and (is_near or self._is_worth_it(iterate)):
            self.try_step(iterate, least=WAIT if ends_soon else 0.0)
        if self.certificate is None:
            return expected.worst
        return self.certificate.distance.of_friction_force(iterate)

    @property
    def is_proven(self) -> bool:
        """Whether the last estimate was the distance to a certified solution."""
        return self.certificate is not None

    def is_proven_within(self, share: float, iterate: Iterate) -> bool:
        """Whether displacement and contact force are that near to a certified solution."""
        if self.certificate is None:
            return False
        distance = self.certificate.distance
        errors = distance.of_friction_force(iterate), distance.of_displacement(iterate)
        return max(errors) <= share

    def has_to_be_proven(self, iterate: Iterate, least: float) -> bool:
        """Whether the estimate counts for nothing without a status step, as one is worth its cost.

        `least` is what it may cost in any case, s.
        """
        return self._needs_proof or self.can_be_proven(iterate, least=least)

    def can_be_proven(self, iterate: Iterate, patience: float = 1.0, least: float = 0.0) -> bool:
        """Whether a status step is worth its cost by now.

        Parameters
        ----------
        iterate
            The last one.
        patience
            Times that it may cost more.
        least
            Seconds that it may cost in any case.
        """
        if not self._has_solver or not self._is_in_time(iterate):
            return False
        if self._needs_proof:
            return True
        return self._costs_of(iterate).afford(patience * iterate.number, least)

    def is_last_chance(self, iterate: Iterate) -> bool:
        """Whether a run without an answer would have no time for a status step later."""
        if self.certificate is not None or math.isinf(self.deadline):
            return False
        return self._left() <= ROOM * self._costs_of(iterate).step

    def try_step(self, iterate: Iterate, patience: float = 1.0, least: float = 0.0) -> bool:
        """Try the status step, unless it costs too much, as above; whether it holds."""
        if not self.can_be_proven(iterate, patience, least):
            return False
        self._last_trial = iterate.number
        self._next_trial = math.ceil(AGAIN * iterate.number) + 1
        problem, states = iterate.problem, states_of(iterate)
        systems = self._costs_of(iterate).systems(patience * iterate.number)
        try:
            self._solver = self._solver or incremental_solver(problem)
            solution, certificate = status_step(
                self._solver, problem, states, systems, lambda: time.perf_counter() > self.deadline
            )
        except NoReferenceError:
            self._has_solver = False
            return False
        except Interrupted:
            return False
        self.jumps, self.collapse = (
            solution.jumps_at is not None and solution.is_lost,
            solution.collapse,
        )
        if certificate is None or certificate.residual > self._accuracy:
            return False
        self.certificate = certificate
        return True

    def _is_worth_it(self, iterate: Iterate) -> bool:
        """Whether to try the step though the force is not near: it may never seem so.

        So it is where k is foolish, where solutions are all but several, or where the force dies.
        """
        is_long = iterate.number >= max(LONG, 2 * self._last_trial)
        return is_long or self._costs_of(iterate).are_small(iterate.number)

    def _is_in_time(self, iterate: Iterate) -> bool:
        return self._costs_of(iterate).step <= self._left()

    def _left(self) -> float:
        """Seconds that are left of the run's limit."""
        return self.deadline - time.perf_counter()

    def _costs_of(self, iterate: Iterate) -> Costs:
        """Estimate the costs by the statuses that an iterate shows, now and then anew."""
        if self._costs is None or iterate.number >= AGAIN * self._costs_at:
            self._costs_at = iterate.number
            self._costs = costs_of(iterate.problem, moving_share(states_of(iterate)))
        return self._costs
