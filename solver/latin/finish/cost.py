"""What a status step costs beside the iterations that it saves.

All of it is estimated from counts, never measured by a clock, so that a run ends alike on every
machine.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.discrete.problem import Problem
from solver.latin.local.slide import slide_of
from solver.reference.choice import is_alone
from solver.reference.contact import jumps_in

SYSTEMS = 3
"""Linear systems for every instant that a step may solve in any case."""
SHARE = 1.0 / 3.0
"""Share of the time of all iterations that a step may take: it is tried again at half as many
iterations more, so that all trials together take as long as the iterations. Under loads far beyond
friction an instant takes ten systems from any statuses, and from the exact force (measured)."""
AFFORDABLE = 40
"""Iterations that a status step may cost in any case: about as many as it saves."""
DENSE, SPARSE = 1e10, 2e9
"""Operations a second of dense factors and products, and of sparse factors (measured)."""
PASSES, PASS = 30, 1e-9
"""How often an iteration passes over a boundary field, and seconds a number (measured)."""
CALLS, OF_ITERATION = 1e-4, 5e-4
"""Seconds of a dense system, and of an iteration, that no size makes less (measured)."""
SHIFT = 8e-6
"""Seconds that an iteration takes an instant to shift a body that slides as a whole (measured)."""
BAND, BAND_CALLS = 6e-8, 3e-5
"""Seconds a number of a system with a band matrix, and those that no size makes less (measured)."""


@dataclass(frozen=True)
class Costs:
    """Estimated times, s.

    Attributes
    ----------
    condensing
        Of the structure onto its contacts, once; none where they are of known bound, on one rigid
        support.
    system
        Of one linear system of the step.
    iteration
        Of one iteration.
    n_instants
        Number of instants.
    """

    condensing: float
    system: float
    iteration: float
    n_instants: int

    @property
    def step(self) -> float:
        """Of a status step whose statuses are right."""
        return self.condensing + self.n_instants * self.system

    def afford(self, iterations: float, least: float = 0.0) -> bool:
        """Tell whether a step costs no more than the iterations done so far, or that it saves.

        So a run never costs more than twice what the better of both ways would have. `least` is
        what it may cost in any case, s.
        """
        return self.step <= max(max(iterations, AFFORDABLE) * self.iteration, least)

    def are_small(self, iterations: float) -> bool:
        """Tell whether a step, also one with some wrong statuses, costs little beside them."""
        step = self.condensing + SYSTEMS * self.n_instants * self.system
        return step <= SHARE * iterations * self.iteration

    def systems(self, iterations: float) -> int:
        """Give the number of linear systems that a step may solve after so many iterations."""
        worth = SHARE * iterations * self.iteration
        return max(SYSTEMS * self.n_instants, int(worth / self.system))


def costs_of(problem: Problem) -> Costs:
    """Estimate the times of a problem."""
    n_jumps, entries = jumps_in(problem), 0.0
    products = sum(2.0 * len(part.rows) ** 2 for part in problem.substructures)
    products = min(products, 200.0 * problem.n_rows)
    passes = products / DENSE + PASSES * PASS * problem.n_rows
    shift = 0.0 if slide_of(problem) is None else SHIFT
    iteration = OF_ITERATION + problem.n_instants * (passes + shift)
    if is_alone(problem):
        return Costs(0.0, BAND_CALLS + BAND * n_jumps, iteration, problem.n_instants)
    for part in problem.substructures:
        stiffness = part.elasticity.stiffness
        entries += stiffness.size if isinstance(stiffness, np.ndarray) else stiffness.nnz
    condensing = 4.0 * entries * n_jumps / SPARSE + 2.0 * n_jumps**3 / DENSE
    # A third of the jumps moves at an instant, in the scenes at hand.
    system = CALLS + (6.0 * n_jumps**2 + 2.0 / 3.0 * (n_jumps / 3.0) ** 3) / DENSE
    return Costs(condensing, system, iteration, problem.n_instants)
