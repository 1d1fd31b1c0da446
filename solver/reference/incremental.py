"""The incremental reference: friction on the assembled structure, instant by instant.

Over one instant the displacement increment v minimises a strictly convex function
(MATHEMATICS.md, 6),

    phi(v) = 1/2 v' K v - g' v + sum r |v|,

with K the stiffness, r the friction bounds, and g the load that the friction force of
the previous instant leaves unbalanced. Its minimum is known once every point's status s
is: v = 0 where s = 0, and K v = g - r s elsewhere. The pull g - K v is then minus the
friction force.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.linalg import LinAlgError

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.assembly import (
    Interrupted,
    NoReferenceError,
    assembled_stiffness,
    external_force,
    never,
    points_dofs,
)
from solver.reference.condensation import LEFT_INSIDE
from solver.reference.contact import IncrementalContact
from solver.reference.rod_minimum import Minimum, Search, Tridiagonal
from solver.reference.rules import Starts, States, rules_of
from solver.reference.solution import Reference

DEARER = 30
"""A system of the general solver costs 1 + n_points / DEARER of these (measured)."""
TRIALS = 50
"""Largest number of trials of how far friction changes within an instant."""
BALANCED = 1e-6
"""KKT residual over all that acts up to which an instant is solved; rounding leaves
1e-15, and more beside loads of 1e9 times what friction holds."""


def rubs_on_supports(problem: Problem) -> bool:
    """Check whether all friction is of rods on rigid supports, with known bounds."""
    laws = problem.contacts.laws.values()
    if not laws or not problem.is_chain or not all(law.is_plain for law in laws):
        return False
    dofs = points_dofs(problem)
    return len(problem.contacts) == 1 or len(np.unique(dofs)) == len(dofs)


class IncrementalRod:
    """The incremental solver of rods that rub on supports (`rubs_on_supports`).

    A point whose displacement is prescribed may rub too: only the sum of friction force
    and reaction is determinate there, and friction is as `Problem.with_driven_friction`
    says.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._dofs = points_dofs(problem)
        self._rules = rules_of(problem)
        # Degrees of freedom are numbered along one rod after the other.
        whole = assembled_stiffness(problem)
        self._stiffness = Tridiagonal(whole.diagonal(), whole.diagonal(1))
        self._fixed, prescribed = problem.prescribed
        # The steps of the load and of the supports, one row an instant.
        self._load_steps = np.diff(external_force(problem).T, axis=0, prepend=0.0)
        self._moves = np.diff(prescribed.T, axis=0, prepend=0.0)
        self._movable = np.ones(problem.n_dofs)
        self._movable[self._fixed] = 0.0
        first = self._on_dofs(self._rules.bound_at(0)) * self._movable
        self._search = Search(self._stiffness, first, self._movable)
        self._systems = 0
        self._general: IncrementalContact | None = None

    def _marched_in_general(
        self,
        guess: States | None,
        max_systems: int | None,
        stop: Callable[[], bool],
    ) -> Reference:
        """Solve by the general solver, which can follow fast softening."""
        if self._general is None:
            self._general = IncrementalContact(self._problem, stop)
        dearer = 1 + len(self._dofs) // DEARER
        limit = None
        if max_systems is not None:
            limit = max_systems // dearer
        return self._general.march(guess, limit, stop)

    def march(
        self,
        guess: States | None = None,
        max_systems: int | None = None,
        stop: Callable[[], bool] = never,
    ) -> Reference:
        """Solve instant by instant, as `IncrementalContact.march`, by statuses.

        Raises
        ------
        Interrupted
            As soon as `stop` returns True.
        NoReferenceError
            If friction softens so fast that the general solver is needed, and there are
            too many points for it.
        """
        starts = Starts()
        self._systems = 0
        minima: list[Minimum] = []
        balance, status, accumulated_slip = np.zeros((3, self._problem.n_dofs))
        for instant in range(self._problem.n_instants):
            if stop():
                raise Interrupted
            if max_systems is not None and self._systems >= max_systems:
                break
            done = self._systems
            from_guess = starts.from_guess
            if guess is not None and from_guess:
                status = self._on_dofs(guess[:, instant])
            minimum = self._minimise(
                instant, self._load_steps[instant] + balance, status, accumulated_slip
            )
            if minimum is None:
                return self._marched_in_general(guess, max_systems, stop)
            minima.append(minimum)
            starts.took(self._systems - done, from_guess=from_guess)
            balance = minimum.pull
            status = minimum.status
            accumulated_slip = accumulated_slip + np.abs(minimum.increment)
        return self._gathered(minima)

    def _on_dofs(self, values: Array | States) -> Array:
        """Values (n_points,) at the points that rub, and 0 elsewhere, (n_dofs,)."""
        spread = np.zeros(self._problem.n_dofs)
        spread[self._dofs] = values
        return spread

    def _minimise(
        self, instant: int, force: Array, status: Array, accumulated_slip: Array
    ) -> Minimum | None:
        """Minimise phi over one instant; None without a certain minimum.

        By the load, a guess of the statuses, and the slip accumulated before, shape
        (n_dofs,) each.
        """
        move = self._moves[instant]
        rules = self._rules
        given = np.zeros(len(force))
        given[self._fixed] = move
        load = self._movable * (force - self._stiffness.product(given))
        bound = self._on_dofs(rules.bound_at(instant))
        minimum: Minimum | None
        if rules.changes_with_slip:
            minimum = self._with_changing_bound(bound, load, status, accumulated_slip)
        else:
            search = self._search
            # A constant bound keeps one search, and with it its coarser meshes.
            if rules.bound.shape[1] > 1:
                search = Search(self._stiffness, bound * self._movable, self._movable)
            done = search.solutions
            minimum = search(load, status * search.rubs)
            self._systems += search.solutions - done
        if minimum is not None:
            minimum.increment[self._fixed] = move
        return minimum

    def _with_changing_bound(
        self, first: Array, force: Array, status: Array, accumulated_slip: Array
    ) -> Minimum | None:
        """Minimum that continues the instant before; None if that is uncertain.

        How far friction changes within the instant is found by trial. The minimum is
        sure if the structure is stable where points slip, however far they have
        softened on the way: then no other minimum slips there alone. All arrays have
        the shape (n_dofs,).
        """
        slip_factor = self._rules.slip_factor
        dofs = self._dofs
        end = accumulated_slip
        for _ in range(TRIALS):
            # The bound is linear in the slip on a segment of the slip_factor: its slope
            # goes into the stiffness, and the rest is a constant bound.
            slope = first * self._on_dofs(slip_factor.slope(end[dofs])) * self._movable
            before = first * self._on_dofs(slip_factor(end[dofs]))
            bound = (before - slope * (end - accumulated_slip)) * self._movable
            stiffness = self._stiffness.stiffened(slope)
            search = Search(stiffness, bound, self._movable)
            try:
                minimum = search(force, status * search.rubs)
            except LinAlgError:
                return None
            finally:
                self._systems += search.solutions
            reached = accumulated_slip + np.abs(minimum.increment)
            # The trial was right if the slip ends on the segment that was assumed.
            assumed = slip_factor.segment(end[dofs])
            if np.array_equal(assumed, slip_factor.segment(reached[dofs])):
                slips = self._movable * (minimum.increment != 0.0)
                if np.any(bound[slips > 0.0] < 0.0):
                    return None
                if not self._is_stable(first, slips, accumulated_slip, reached):
                    return None
                pull = minimum.pull + slope * minimum.increment
                return replace(minimum, pull=pull)
            end = reached
            status = minimum.status
        return None

    def _is_stable(
        self, first: Array, slips: Array, begin: Array, reached: Array
    ) -> bool:
        """Check whether the structure is stable under the steepest fall of friction.

        All arrays have the shape (n_dofs,).

        Parameters
        ----------
        first
            Friction bound before any slip, scaled.
        slips
            1 where a point slips, else 0.
        begin, reached
            Accumulated slip at both ends of the instant, scaled.
        """
        dofs = self._dofs
        growth = self._rules.slip_factor.lowest_slope(begin[dofs], reached[dofs])
        softening = first * self._on_dofs(growth) * self._movable
        # Factoring fails where the structure is not stable.
        try:
            self._stiffness.stiffened(softening).solve_kept(slips, np.zeros_like(slips))
        except LinAlgError:
            return False
        return True

    def _gathered(self, minima: list[Minimum]) -> Reference:
        """Reference from the minima of the first instants; afterwards nothing moves."""
        problem = self._problem
        dofs = self._dofs
        # An instant is a row here: each is filled as a whole.
        increments, pulls = np.zeros((2, problem.n_instants, problem.n_dofs))
        for instant, minimum in enumerate(minima):
            increments[instant] = minimum.increment
            pulls[instant] = minimum.pull
        solved = np.zeros(problem.n_instants, dtype=bool)
        solved[: len(minima)] = [minimum.residual <= BALANCED for minimum in minima]
        moved = np.cumsum(increments, axis=0).T
        inside = self._stiffness.largest_row * float(np.abs(moved).max(initial=0.0))
        displacement = moved * problem.scales.displacement
        friction = problem.with_driven_friction(
            0.0 - pulls.T[dofs], moved[problem.row_dofs]
        )
        return Reference(
            problem=problem,
            displacement=displacement,
            deformation=displacement,
            contact_force=friction * problem.scales.force,
            status=np.sign(increments.T[dofs]).astype(np.int8),
            unbalanced=max([0.0] + [minimum.violation for minimum in minima])
            * problem.scales.force,
            rounding=LEFT_INSIDE * inside * problem.scales.force,
            converged=solved,
            is_lost=not solved[: len(minima)].all(),
            ambiguous=np.zeros(problem.n_instants, dtype=bool),
            steps=self._systems,
        )


Incremental = IncrementalRod | IncrementalContact


def reference_of(problem: Problem, stop: Callable[[], bool] = never) -> Reference:
    """Solve a problem instant by instant, with the solver for its interfaces.

    `stop` is asked before each linear system, or each instant where these are small;
    `Interrupted` is raised as soon as it returns True.
    """
    start = time.perf_counter()
    solution = incremental_solver(problem, stop).march(stop=stop)
    return replace(solution, seconds=time.perf_counter() - start)


def incremental_solver(
    problem: Problem, stop: Callable[[], bool] = never
) -> Incremental:
    """Prepare the solver for the interfaces of a problem.

    Raises
    ------
    Interrupted
        As soon as `stop` returns True.
    NoReferenceError
        If there is no solver, as the problem holds data that no solver reads, or
        continues another run.
    """
    if problem.has_start:
        raise NoReferenceError(
            "Incremental solvers begin where nothing has slipped yet."
        )
    if rubs_on_supports(problem):
        return IncrementalRod(problem)
    return IncrementalContact(problem, stop)
