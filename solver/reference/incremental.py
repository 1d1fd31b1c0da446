"""The incremental reference: friction solved instant by instant, on the assembled structure.

Over one instant the displacement increment v minimises a strictly convex function
(solver/README.md, 6),

    phi(v) = 1/2 v' K v - g' v + sum r |v|,

with K the stiffness, r the friction bounds, and g the load that the friction force of the previous
instant leaves unbalanced. Its minimum is known once every point's status s is: v = 0 where s = 0,
and K v = g - r s elsewhere. The pull g - K v is then minus the friction force.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from solver.arrays import ROUNDING, Array
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force
from solver.reference.band import Band, pairs
from solver.reference.solution import Interrupted, Reference, States
from solver.reference.starts import Starts

NEWTON_LIMIT = 8
"""Steps from one guess of the statuses before a better one is sought."""
COARSEST = 8
"""Degrees of freedom below which no coarser mesh is asked for a guess."""


def incremental(problem: Problem, stop: Callable[[], bool] | None = None) -> Reference:
    """Solve instant by instant (solver/README.md, 6), as `IncrementalRod` does."""
    start = time.perf_counter()
    found = IncrementalRod(problem).march(stop=stop)
    return replace(found, seconds=time.perf_counter() - start)


class IncrementalRod:
    """The incremental solver of rods that rub on a rigid support, ready to march through time.

    A point whose displacement is prescribed may rub too. Where it moves, its friction force is
    -r sign(v). Where it stands still, only the sum of friction force and reaction is determinate:
    the friction force is taken as zero. LATIN shares the sum in a way that depends on k and on
    the decomposition (measured, once the whole bar slides), so compare no force there.

    Parameters
    ----------
    problem
        A structure with one frictional interface of known bound.

    Raises
    ------
    ValueError
        If its law is no play operator.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        if not problem.friction.is_plain:
            raise ValueError("this solver knows Coulomb's friction of known bound on a support")
        self._structure = _Structure(problem)

    def march(
        self,
        guess: States | None = None,
        most: int | None = None,
        stop: Callable[[], bool] | None = None,
    ) -> Reference:
        """Solve instant by instant.

        Parameters
        ----------
        guess
            Statuses from which an instant starts, shape (n_points, n_instants), unless those of the
            instant before turn out to be better.
        most
            Linear systems to solve; the instants that are not reached then do not move, and are
            not `converged`.
        stop
            Called once per instant.

        Raises
        ------
        Interrupted
            As soon as `stop` gives True.
        """
        start = time.perf_counter()
        structure = self._structure
        guesses = None if guess is None else structure.at_dofs(guess)
        solved, starts = structure.band.solutions, Starts()
        found: list[_Minimum] = []
        balance, status = np.zeros((2, self._problem.n_dofs))
        for instant in range(self._problem.n_instants):
            if stop is not None and stop():
                raise Interrupted
            if most is not None and structure.band.solutions - solved >= most:
                break
            done, from_guess = structure.band.solutions, starts.from_guess
            begin = guesses[instant] if guesses is not None and from_guess else status
            load = structure.load_steps[instant] + balance
            found.append(structure.minimise(load, structure.moves[instant], begin))
            starts.took(structure.band.solutions - done, from_guess=from_guess)
            balance, status = found[-1].pull, found[-1].status
        steps = structure.band.solutions - solved
        return self._gathered(found, steps, time.perf_counter() - start)

    def _gathered(self, found: list[_Minimum], steps: int, seconds: float) -> Reference:
        """Put together the minima of the first instants, from which on nothing moves."""
        problem, dofs = self._problem, self._structure.point_dofs
        increments, pulls = np.zeros((2, problem.n_instants, problem.n_dofs))
        for instant, one in enumerate(found):
            increments[instant], pulls[instant] = one.increment, one.pull
        return Reference(
            problem=problem,
            displacement=np.cumsum(increments, axis=0).T * problem.scales.displacement,
            contact_force=0.0 - pulls.T[dofs] * problem.scales.force,
            status=np.sign(increments.T[dofs]).astype(np.int8),
            residual=max([0.0, *(one.residual for one in found)]),
            unbalanced=max([0.0, *(one.violation for one in found)]) * problem.scales.force,
            converged=np.arange(problem.n_instants) < len(found),
            ambiguous=np.zeros(problem.n_instants, dtype=bool),
            steps=steps,
            seconds=seconds,
        )


@dataclass(frozen=True, eq=False)
class _Minimum:
    """Fields of shape (n_dofs,) at the minimum of phi, and its KKT residual, also relative."""

    increment: Array
    pull: Array
    status: Array
    violation: float
    residual: float


class _Guess(NamedTuple):
    """Statuses that were sought, with increment and pull if they are those of the minimum."""

    status: Array
    solved: tuple[Array, Array] | None


class _Structure:
    """The assembled structure, and the steps of its load and supports, one row an instant."""

    def __init__(self, problem: Problem) -> None:
        law = problem.friction
        rubbing = problem.row_dofs[law.tangent.above]
        self.point_dofs = np.zeros(len(law.positions), dtype=np.intp)
        self.point_dofs[law.points] = rubbing
        self.band = Band(assembled_stiffness(problem))
        self.load_steps = np.diff(external_force(problem).T, axis=0, prepend=0.0)
        self._fixed, prescribed = problem.prescribed
        self.moves = np.diff(prescribed.T, axis=0, prepend=0.0)
        self._movable, bound = np.ones(problem.n_dofs), np.zeros(problem.n_dofs)
        self._movable[self._fixed] = 0.0
        np.add.at(bound, rubbing, law.tangential.bound)
        self._support_bound = bound[self._fixed]
        self._search = _Search(self.band, bound * self._movable, self._movable)

    def at_dofs(self, status: States) -> Array:
        """Give statuses of the points as those of degrees of freedom, (n_instants, n_dofs)."""
        found = np.zeros((status.shape[1], len(self._movable)))
        found[:, self.point_dofs] = status.T
        return found * self._search.rubs

    def minimise(self, force: Array, moved: Array, status: Array) -> _Minimum:
        """Minimise phi over one instant, from a guess of the statuses."""
        given = np.zeros(len(force))
        given[self._fixed] = moved
        found = self._search(self._movable * (force - self.band.product(given)), status)
        found.increment[self._fixed] = moved
        found.pull[self._fixed] = self._support_bound * np.sign(moved)
        return found


class _Search:
    """Minimise phi where some degrees of freedom are held at zero.

    Newton's method for the statuses takes a few steps from a good guess, but a front then advances
    by one point a step, and the method may cycle. So it gives up early, and starts again from the
    statuses of a mesh twice as coarse, found in the same way. Where that fails too, an active-set
    method ends in finitely many steps.
    """

    def __init__(self, band: Band, bound: Array, movable: Array) -> None:
        self._band = band
        self._bound = bound
        self._movable = movable
        self.rubs = (bound > 0.0) * movable
        self._free = movable - self.rubs  # neither held nor rubbing
        self._limit = np.where(self.rubs > 0.0, bound, np.inf)

    def __call__(self, force: Array, status: Array) -> _Minimum:
        """Find the minimum from a guess of the statuses; no force where nothing moves."""
        status, solved = self._sought(force, status)
        if solved is None:
            status = self._descend(force, status)
            increment = self._slip(force, status)
            solved = increment, force - self._band.product(increment)
        increment, pull = solved
        bound = self._bound
        held = np.where(status != 0.0, bound * status, np.minimum(np.maximum(pull, -bound), bound))
        violation = float((np.abs(pull - held) * self._movable).max())
        relative = violation / float(np.abs(force).sum()) if violation else 0.0
        return _Minimum(increment, held, status, violation, relative)

    def _sought(self, force: Array, status: Array) -> _Guess:
        """Seek the statuses, from a guess, and from that of a coarser mesh if need be."""
        found = self._newton(force, status)
        if found.solved is not None or len(force) < COARSEST:
            return found
        coarse = self._coarser._sought(pairs(force), np.sign(pairs(status)))
        return self._newton(force, self.rubs * np.repeat(coarse.status, 2)[: len(force)])

    def _newton(self, force: Array, status: Array) -> _Guess:
        largest = np.abs(force).max()
        for _ in range(NEWTON_LIMIT):
            increment = self._slip(force, status)
            pull = force - self._band.product(increment)
            limit = self._limit + self._rounding(largest, increment)
            corrected = np.where(
                status != 0.0,
                status * (status * increment > 0.0),
                np.sign(pull) * (np.abs(pull) > limit),
            )
            if (corrected == status).all():
                return _Guess(status, (increment, pull))
            status = corrected
        return _Guess(status, None)

    @cached_property
    def _coarser(self) -> _Search:
        """The same structure with each two successive degrees of freedom tied together."""
        movable = np.minimum(pairs(self._movable), 1.0)
        band = self._band.tied_in_pairs(self._movable, movable)
        return _Search(band, pairs(self._bound), movable)

    def _slip(self, force: Array, status: Array) -> Array:
        """Solve for the increment under given statuses; exactly zero where they are zero."""
        keep = self._free + np.abs(status)
        return self._band.solve_kept(keep, keep * (force - self._bound * status))

    def _rounding(self, largest: float, increment: Array) -> float:
        """Give what rounding leaves of a pull, where the largest force is given."""
        return ROUNDING * float(self._band.largest_row * np.abs(increment).max() + largest)

    def _descend(self, force: Array, status: Array) -> Array:
        """Minimise phi by an active-set method, every step of which lowers phi.

        A step ends where a first point stops, which then sticks; at a minimum over the slipping
        points, the point pulled most beyond its bound is released, and moves the way it is
        pulled. So no set of statuses has its minimum reached twice.
        """
        largest = np.abs(force).max()
        increment = self._slip(force, status)
        status = status * (status * increment > 0.0)
        increment *= self._free + np.abs(status)
        while True:
            target = self._slip(force, status)
            stops = np.flatnonzero(status * target < 0.0)
            if len(stops):
                share = increment[stops] / (increment[stops] - target[stops])
                first = stops[share.argmin()]
                if increment[first] == 0.0:  # released a moment ago, within rounding of its bound
                    status[first] = 0.0
                    return status
                increment += share.min() * (target - increment)
                increment[first] = 0.0
                status = status * (status * increment > 0.0)
                increment *= self._free + np.abs(status)
                continue
            increment = target
            pull = force - self._band.product(increment)
            excess = np.where(status == 0.0, np.abs(pull) - self._limit, -np.inf)
            most = int(excess.argmax())
            if excess[most] <= self._rounding(largest, increment):
                return status
            status[most] = np.sign(pull[most])
