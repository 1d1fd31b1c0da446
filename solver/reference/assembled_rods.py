"""Rods on a rigid support, assembled: one instant after the other."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force
from solver.reference.band import Band
from solver.reference.changing_bound import bounds_of, least_with_changing_bound
from solver.reference.search import Minimum, Search
from solver.reference.solution import States


class AssembledRods:
    """The assembled structure, and the steps of its load and supports, one row an instant."""

    def __init__(self, problem: Problem) -> None:
        law = problem.friction
        self.point_dofs = np.zeros(len(law.positions), dtype=np.intp)
        self.point_dofs[law.points] = problem.row_dofs[law.tangent.above]
        self.band = Band(assembled_stiffness(problem))
        self.load_steps = np.diff(external_force(problem).T, axis=0, prepend=0.0)
        self._fixed, prescribed = problem.prescribed
        self.moves = np.diff(prescribed.T, axis=0, prepend=0.0)
        self._movable = np.ones(problem.n_dofs)
        self._movable[self._fixed] = 0.0
        self._bounds = bounds_of(problem)
        self._search = Search(self.band, self._bounds.first * self._movable, self._movable)

    def at_dofs(self, status: States) -> Array:
        """Give statuses of the points as those of degrees of freedom, (n_instants, n_dofs)."""
        found = np.zeros((status.shape[1], len(self._movable)))
        found[:, self.point_dofs] = status.T
        return found * self._search.rubs

    def minimise(self, force: Array, moved: Array, status: Array, gone: Array) -> Minimum | None:
        """Minimise phi over one instant, from a guess of the statuses; None where it has none.

        Parameters
        ----------
        force, status, gone
            Load, guess, and accumulated slip before, shape (n_dofs,).
        moved
            What the supports move by.
        """
        given = np.zeros(len(force))
        given[self._fixed] = moved
        found = self._least(self._movable * (force - self.band.product(given)), status, gone)
        if found is not None:
            found.increment[self._fixed] = moved
            slip = gone[self._fixed] + np.abs(moved)
            found.pull[self._fixed] = self._bounds.at(slip, self._fixed) * np.sign(moved)
        return found

    def _least(self, force: Array, status: Array, gone: Array) -> Minimum | None:
        if self._bounds.stay:
            return self._search(force, status)
        return least_with_changing_bound(
            self.band, self._bounds, self._movable, force, status, gone
        )
