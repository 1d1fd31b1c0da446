"""A run that has ended, with what its quantities are taken from."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import count

import numpy as np

from solver.arrays import Array
from solver.discrete.loops import Loop
from solver.discrete.problem import Problem
from solver.latin import Checkpoint, Iterate, Solution, solve
from solver.latin.direction import search_direction
from solver.latin.warm import carry, fits
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.scenes import discretise, loop_of
from solver.settings import Settings

AT_ONCE = 4
"""Iterations from another run's solution after which the own start is taken. Where it holds at all,
a status step holds after four; eight found no more (solver/study/README.md, 7)."""


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """A run from its settings to its end.

    Attributes
    ----------
    has_errors
        Whether its records hold distances to a reference.
    loop
        As the scene shows it, where that is at hand: in the plane it takes a solution to make one.
    was_warm
        Whether it started from another run.
    """

    settings: Settings
    solution: Solution
    has_errors: bool
    loop: Loop | None = None
    was_warm: bool = False

    @property
    def iterate(self) -> Iterate:
        """Its last good iterate."""
        return self.solution.iterate

    @property
    def problem(self) -> Problem:
        """What it solves."""
        return self.iterate.problem

    @cached_property
    def _loop(self) -> Loop:
        return self.loop or loop_of(self.settings, self.problem)

    @property
    def measures_displacement(self) -> bool:
        """Whether its loop goes over a displacement, not over an angle."""
        return self._loop.across[1] == "m"

    @cached_property
    def displacement(self) -> Array:
        """Displacement of the loop that the scene shows, shape (n_instants,), m."""
        return self._loop.displacement(self.iterate.displacement)

    @cached_property
    def force(self) -> Array:
        """Force of that loop, shape (n_instants,), N."""
        force = self._loop.force
        return force if isinstance(force, np.ndarray) else force(self.iterate)

    @property
    def drive(self) -> Array:
        """What goes to and fro: the given force, or else the displacement; (n_instants,)."""
        return self.force if isinstance(self._loop.force, np.ndarray) else self.displacement

    @cached_property
    def dissipated(self) -> Array:
        """Energy that friction takes between each instant and the one before, (n_instants,), J.

        The friction force times the slip, both of the local stage, whose laws hold at every
        iterate. A point slips at the bound of the instant that it slips to.
        """
        iterate, scales = self.iterate, self.problem.scales
        moved, force = iterate.local_displacement, iterate.boundary_local_force
        found = np.zeros(self.problem.n_instants)
        for law in self.problem.rubbing.values():
            slip = np.diff(law.slider(moved, force), axis=1, prepend=0.0)
            found -= (force[law.tangent.above] * slip).sum(axis=0)
        return found * scales.force * scales.displacement


def finished_run(
    settings: Settings,
    *,
    errors: bool = True,
    indicators: bool = True,
    cancelled: Callable[[], bool] = lambda: False,
    before: Iterate | None = None,
) -> FinishedRun:
    """Run a scene to its stop rule.

    Parameters
    ----------
    settings
        Of the run.
    errors
        Whether the distance to a reference is wanted, which takes its time; where there is none,
        the run is made without.
    indicators
        Whether the indicators of every iteration are wanted, which take theirs.
    cancelled
        As for `solve`.
    before
        Last iterate of a run of like settings, from which a start is tried where that may pay.
    """
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    distance = None
    if errors:
        try:
            reference = reference_of(problem)
        except NoReferenceError:
            reference = None
        if reference is not None and reference.converged.all():
            distance = distance_to(reference, problem)
    if before is not None and (near := neighbour(problem, settings, before)) is not None:
        return FinishedRun(settings, near, has_errors=False, was_warm=True)
    solution = solve(
        problem, settings, distance=distance, watch=indicators, spent=spent, cancelled=cancelled
    )
    return FinishedRun(settings, solution, distance is not None)


def neighbour(problem: Problem, settings: Settings, before: Iterate) -> Solution | None:
    """Try a few iterations from the solution of a run of like settings.

    They count only if a status step then finds the one solution of the discrete problem, which does
    not depend on the start; a start from too far away would take more iterations than the own one.

    Returns
    -------
    That solution; None where it is not found at once.
    """
    if settings.finish != "status" or settings.is_reduced or problem.rest is not None:
        return None
    if not fits(before, problem):
        return None
    outgoing = carry(before, problem, search_direction(problem, settings))
    outgoing.flags.writeable = False
    number = count(1)
    solution = solve(
        problem,
        settings,
        start=Checkpoint(0, 0.0, outgoing),
        watch=False,
        cancelled=lambda: next(number) >= AT_ONCE,
    )
    return solution if solution.is_certified else None
