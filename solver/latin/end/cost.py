"""Estimated costs of a status step and of an iteration.

All estimates come from counts and never from a clock, so that a run ends alike on every
machine.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.discrete.problem import Problem
from solver.latin.direction.directions import sliding_share
from solver.latin.stages.rigid_bodies import moves_rigidly
from solver.reference.contact import jumps_in
from solver.reference.incremental import rubs_on_supports
from solver.reference.rules import HELD, States

AFFORDABLE = 40
"""Iterations that a status step may cost in any case: about as many as it saves."""
TRIED = 2.0
"""Largest cost of the incremental solver, over that of the iterations so far, at which
a status step is tried whatever the iterates are like."""
SYSTEMS = 3
"""Linear systems per instant that a status step or a reference takes (measured)."""
OPERATIONS = 1e10
"""Operations of products and factors a second (measured: sparse 6e9, factors 2e10)."""
NUMBER = 3e-8
"""Seconds per number of a boundary field in an iteration, or of a matrix that a system
is made from (measured)."""
OF_SYSTEM = 2e-4
"""Seconds of a dense system, whatever its size (measured)."""
OF_BAND = 3e-5
"""Seconds of a system with a band matrix, whatever its size (measured)."""
OF_ITERATION = 5e-4
"""Seconds of an iteration, whatever its size (measured)."""
OF_MOTION = 2.5e-6
"""Seconds of the balance of rigid bodies, per motion and instant of an iteration: the
mean of the first twelve, for 15 to 121 voussoirs right within a third (measured)."""
MOVING = 1.0 / 3.0
"""Share of the jumps that move at an instant where contacts open or bodies bend
(measured)."""
NEXT = 2.0
"""Number of interfaces that slide where a load passes from body to body."""


@dataclass(frozen=True)
class Costs:
    """Estimated times of the parts of a run.

    Attributes
    ----------
    condensing
        Time of condensing the structure once, s.
    system
        Time of a linear system of the status step, s.
    iteration
        Time of an iteration, without shifts of rigid bodies, s.
    n_instants
        Number of instants; a status step solves at least one system for each.
    is_at_rest
        Whether no jump moves, so that one system for each instant is expected to do.
    shifts
        Time of the shifts of rigid bodies in an iteration, s.
    """

    condensing: float
    system: float
    iteration: float
    n_instants: int
    is_at_rest: bool = False
    shifts: float = 0.0

    @property
    def whole_iteration(self) -> float:
        """Time of an iteration with its shifts, s."""
        return self.iteration + self.shifts

    @property
    def step(self) -> float:
        """Time of a status step that starts from correct statuses, s."""
        return self.condensing + self.n_instants * self.system

    @property
    def incremental(self) -> float:
        """Time of the incremental solver, s."""
        return self.condensing + SYSTEMS * self.n_instants * self.system

    def afford(self, iterations: float) -> bool:
        """Check whether a status step is worth its cost after a number of iterations.

        It may cost as much as these, or as those that it saves.
        """
        return self.step <= max(iterations, AFFORDABLE) * self.whole_iteration

    def is_small(self, iterations: float) -> bool:
        """Check whether even a failing status step is cheap beside some iterations."""
        if self.is_at_rest:
            # 37 of 240 random runs are at rest first: they end in 11 % fewer iterations
            # and 14 % less time so (measured).
            return self.afford(iterations)
        # Statuses are as far off after iterations with shifts as after others: counted
        # with their shifts, nine arches of free hinges take 26 % longer (measured).
        return self.incremental <= TRIED * iterations * self.iteration

    def systems(self, iterations: float) -> int:
        """Number of linear systems with the cost of some iterations."""
        affordable = int(iterations * self.whole_iteration / self.system)
        return max(SYSTEMS * self.n_instants, affordable)


def costs_of(
    problem: Problem, states: States | None = None, *, may_shift: bool = False
) -> Costs:
    """Estimate the times of a problem, by the states of its jumps if they are known.

    Parameters
    ----------
    problem
        The problem to be solved.
    states
        States of an iterate as by `states_of`, shape (n_forces, n_instants); None
        before the first iterate.
    may_shift
        Whether the method shifts bodies as rigid ones where hinges are free.
    """
    n_jumps = jumps_in(problem)
    condensing = 0.0
    system = OF_BAND + NUMBER * n_jumps
    if not rubs_on_supports(problem):
        if states is None:
            moving = _expected_share(problem)
        else:
            moving = float(np.mean(states != HELD))
        condensing = _condensing_cost(problem, n_jumps)
        system = OF_SYSTEM + 2.0 / 3.0 * (moving * n_jumps) ** 3 / OPERATIONS
    shifts = 0.0
    if may_shift and moves_rigidly(problem):
        shifts = _balance_cost(problem)
    return Costs(
        condensing,
        system,
        _iteration_cost(problem),
        problem.n_instants,
        is_at_rest=states is not None and bool(np.all(states == HELD)),
        shifts=shifts,
    )


def _iteration_cost(problem: Problem) -> float:
    """Time of an iteration, s."""
    products = sum(2.0 * len(part.rows) ** 2 for part in problem.substructures)
    products = min(products, 200.0 * problem.n_rows)
    passes = products / OPERATIONS + NUMBER * problem.n_rows
    return OF_ITERATION + problem.n_instants * passes


def _balance_cost(problem: Problem) -> float:
    """Time of the balance of rigid bodies in an iteration, s."""
    assert problem.inside is not None
    n_motions = 3 * len(np.unique(problem.inside.body_of_dofs))
    return OF_MOTION * n_motions * problem.n_instants


def _condensing_cost(problem: Problem, n_jumps: int) -> float:
    """Time of condensing a structure to its jumps, s."""
    entries = 0.0
    for part in problem.substructures:
        stiffness = part.elasticity.stiffness
        if isinstance(stiffness, np.ndarray):
            entries += stiffness.size
        else:
            entries += stiffness.nnz
    return 4.0 * entries * n_jumps / OPERATIONS + NUMBER * n_jumps**2


def _expected_share(problem: Problem) -> float:
    """Assumed share of the jumps that move at an instant, before the first iterate."""
    if problem.opens:
        return MOVING
    if not problem.contacts:
        return 0.0
    return min(MOVING, NEXT * sliding_share(problem) / len(problem.contacts))
