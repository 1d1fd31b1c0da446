"""Rods on rigid supports, assembled: one instant after the other."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force
from solver.reference.band import Band
from solver.reference.changing_bound import Bounds, bounds_of, least_with_changing_bound
from solver.reference.search import Minimum, Search
from solver.reference.solution import States
from solver.reference.supports import points_dofs


class AssembledRods:
    """The assembled structure, and the steps of its load and supports, one row an instant."""

    def __init__(self, problem: Problem) -> None:
        self.point_dofs = points_dofs(problem)
        self.band = Band(assembled_stiffness(problem))
        self.load_steps = np.diff(external_force(problem).T, axis=0, prepend=0.0)
        self._fixed, prescribed = problem.prescribed
        self.moves = np.diff(prescribed.T, axis=0, prepend=0.0)
        self._movable = np.ones(problem.n_dofs)
        self._movable[self._fixed] = 0.0
        self._bounds = bounds_of(problem)
        self._search = self._search_with(self._bounds[0])

    def at_dofs(self, status: States) -> Array:
        """Give statuses of the points as those of degrees of freedom, (n_instants, n_dofs)."""
        found = np.zeros((status.shape[1], len(self._movable)))
        found[:, self.point_dofs] = status.T
        return found

    def minimise(
        self, instant: int, force: Array, moved: Array, status: Array, gone: Array
    ) -> Minimum | None:
        """Minimise phi over one instant, from a guess of the statuses; None where it has none.

        Parameters
        ----------
        instant
            Its number.
        force, status, gone
            Load, guess, and accumulated slip before, shape (n_dofs,).
        moved
            What the supports move by.
        """
        given = np.zeros(len(force))
        given[self._fixed] = moved
        bounds = self._bounds[min(instant, len(self._bounds) - 1)]
        search = self._search if len(self._bounds) == 1 else self._search_with(bounds)
        load = self._movable * (force - self.band.product(given))
        found: Minimum | None
        if bounds.stay:
            found = search(load, status * search.rubs)
        else:
            found = least_with_changing_bound(
                self.band, bounds, self._movable, load, status * search.rubs, gone
            )
        if found is not None:
            found.increment[self._fixed] = moved
            reached = bounds.at(gone + np.abs(found.increment))
            found.pull[self._fixed] = reached[self._fixed] * np.sign(moved)
        return found

    def _search_with(self, bounds: Bounds) -> Search:
        return Search(self.band, bounds.first * self._movable, self._movable)
