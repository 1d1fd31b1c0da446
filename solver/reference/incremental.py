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
from dataclasses import replace
from functools import cached_property

import numpy as np

from solver.discrete.problem import Problem
from solver.reference.assembled_rods import AssembledRods
from solver.reference.condensation import LEFT_INSIDE
from solver.reference.contact import IncrementalContact
from solver.reference.search import Minimum
from solver.reference.solution import Interrupted, Reference, States
from solver.reference.starts import Starts
from solver.reference.supports import rubs_on_supports

DEARER = 30
"""Points that make a system of the general solver cost one more of the band's (measured)."""


def incremental(problem: Problem, stop: Callable[[], bool] | None = None) -> Reference:
    """Solve instant by instant (solver/README.md, 6), as `IncrementalRod` does."""
    start = time.perf_counter()
    found = IncrementalRod(problem).march(stop=stop)
    return replace(found, seconds=time.perf_counter() - start)


class IncrementalRod:
    """The incremental solver of rods that rub on rigid supports, ready to march through time.

    A point whose displacement is prescribed may rub too. Where it moves, its friction force is
    -r sign(v). Where it stands still, only the sum of friction force and reaction is determinate:
    the friction force is taken as zero. LATIN shares the sum in a way that depends on k and on
    the decomposition (measured, once the whole bar slides), so compare no force there.

    Parameters
    ----------
    problem
        A structure whose interfaces with friction are supports, of known bound.

    Raises
    ------
    ValueError
        If its law is no play operator.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        if not rubs_on_supports(problem):
            raise ValueError("this solver knows Coulomb's friction of known bound on supports")
        self._structure = AssembledRods(problem)

    @cached_property
    def _general(self) -> IncrementalContact:
        """The solver that also follows friction which softens faster than a rod unloads."""
        return IncrementalContact(self._problem)

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
        TooLargeError
            If friction softens so fast that the general solver is needed, and there are too many
            points for it.
        """
        start = time.perf_counter()
        structure, starts = self._structure, Starts()
        guesses = None if guess is None else structure.at_dofs(guess)
        solved = structure.band.solutions
        found: list[Minimum] = []
        balance, status, gone = np.zeros((3, self._problem.n_dofs))
        for instant in range(self._problem.n_instants):
            if stop is not None and stop():
                raise Interrupted
            if most is not None and structure.band.solutions - solved >= most:
                break
            done, from_guess = structure.band.solutions, starts.from_guess
            begin = guesses[instant] if guesses is not None and from_guess else status
            load, move = structure.load_steps[instant] + balance, structure.moves[instant]
            least = structure.minimise(instant, load, move, begin, gone)
            if least is None:
                return self._general.march(guess, most and most // self._dearer, stop)
            found.append(least)
            starts.took(structure.band.solutions - done, from_guess=from_guess)
            balance, status = least.pull, least.status
            gone = gone + np.abs(least.increment)
        seconds = time.perf_counter() - start
        return self._gathered(found, structure.band.solutions - solved, seconds)

    @property
    def _dearer(self) -> int:
        """How many of these systems one of the general solver takes as long as."""
        return 1 + len(self._structure.point_dofs) // DEARER

    def _gathered(self, found: list[Minimum], steps: int, seconds: float) -> Reference:
        """Put together the minima of the first instants, from which on nothing moves."""
        problem, dofs = self._problem, self._structure.point_dofs
        increments, pulls = np.zeros((2, problem.n_instants, problem.n_dofs))
        for instant, one in enumerate(found):
            increments[instant], pulls[instant] = one.increment, one.pull
        moved = np.cumsum(increments, axis=0).T
        inside = self._structure.band.largest_row * float(np.abs(moved).max(initial=0.0))
        return Reference(
            problem=problem,
            displacement=moved * problem.scales.displacement,
            contact_force=0.0 - pulls.T[dofs] * problem.scales.force,
            status=np.sign(increments.T[dofs]).astype(np.int8),
            residual=max([0.0, *(one.residual for one in found)]),
            unbalanced=max([0.0, *(one.violation for one in found)]) * problem.scales.force,
            rounding=LEFT_INSIDE * inside * problem.scales.force,
            converged=np.arange(problem.n_instants) < len(found),
            ambiguous=np.zeros(problem.n_instants, dtype=bool),
            steps=steps,
            seconds=seconds,
        )
