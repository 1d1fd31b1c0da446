"""The local stage: all interface laws at all points and instants (paper, problem 2.1)."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Array, Indices, Problem, space_time
from solver.laws import Dirichlet, Neumann, Perfect
from solver.laws.boundary import neumann
from solver.laws.friction import Play
from solver.laws.perfect import perfect


class LocalStage:
    """Interface laws along the search direction E+, ready for one problem and one k.

    It reads z = W - F/k of the linear stage alone, and what it gives is read as
    W^ + F^/k = 2 W^ - z (theory.md, 2). Laws of one kind are applied together.

    Attributes
    ----------
    displacement
        W^ of the last call, shape (n_rows, n_instants); the next call overwrites it.
    """

    def __init__(self, problem: Problem, k: Array) -> None:
        shape = (problem.n_rows, problem.n_instants)
        self.displacement = space_time(*shape)
        self._outgoing = space_time(*shape)
        friction = problem.friction
        self._friction = as_slice(friction.rows)
        self._reach = (friction.bound / k[friction.rows])[:, None]
        self._play = Play(len(friction.rows), problem.n_instants)
        cuts = [law for law in problem.of_law(Perfect) if isinstance(law, Perfect)]
        self._cuts = None
        if cuts:
            first = np.concatenate([law.first for law in cuts])
            second = np.concatenate([law.second for law in cuts])
            share = (k[first] / (k[first] + k[second]))[:, None]
            self._cuts = (as_slice(first), as_slice(second), share)
        self._loads = [
            (as_slice(law.rows), law.force / k[law.rows, None])
            for law in problem.of_law(Neumann)
            if isinstance(law, Neumann)
        ]
        for law in problem.of_law(Dirichlet):
            assert isinstance(law, Dirichlet)
            self.displacement[law.rows] = law.displacement

    def __call__(self, incoming: Array) -> Array:
        """Obey all laws.

        Parameters
        ----------
        incoming
            z = W - F/k of the linear stage, shape (n_rows, n_instants).

        Returns
        -------
        W^ + F^/k, same shape; the next call overwrites it.
        """
        found = self.displacement
        found[self._friction] = self._play(incoming[self._friction], self._reach)
        if self._cuts is not None:
            first, second, share = self._cuts
            common = perfect(incoming[first], incoming[second], share)
            found[first] = common
            found[second] = common
        for rows, force_over_k in self._loads:
            found[rows] = neumann(incoming[rows], force_over_k)
        np.multiply(found, 2.0, out=self._outgoing)
        return np.subtract(self._outgoing, incoming, out=self._outgoing)


def as_slice(rows: Indices) -> slice | Indices:
    """Give rows as a slice when they follow each other, so that reading them copies nothing."""
    first = int(rows[0])
    return slice(first, first + len(rows)) if np.all(np.diff(rows) == 1) else rows
