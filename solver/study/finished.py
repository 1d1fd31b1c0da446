"""A run that has ended, with what its quantities are taken from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.discrete.loops import Loop
from solver.discrete.problem import Problem
from solver.latin import Iterate, Solution, solve
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.scenes import discretise, loop_of
from solver.settings import Settings


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """A run from its settings to its end.

    Attributes
    ----------
    has_errors
        Whether its records hold distances to a reference.
    loop
        As the scene shows it, where that is at hand: in the plane it takes a solution to make one.
    """

    settings: Settings
    solution: Solution
    has_errors: bool
    loop: Loop | None = None

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
    settings: Settings, *, errors: bool = True, indicators: bool = True
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
    """
    problem = discretise(settings)
    distance = None
    if errors:
        try:
            reference = reference_of(problem)
        except NoReferenceError:
            reference = None
        if reference is not None and reference.converged.all():
            distance = distance_to(reference, problem)
    solution = solve(problem, settings, distance=distance, watch=indicators)
    return FinishedRun(settings, solution, distance is not None)
