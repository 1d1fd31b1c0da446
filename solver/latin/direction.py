"""The search direction k of every boundary row, constant in a run."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Array, Problem
from solver.laws import Dirichlet, Neumann, Perfect
from solver.settings import Settings

FRICTION_FACTOR = 2.0
"""k of a friction point over the geometric mean of the two stiffnesses in play, ES/s and ES/h.
Measured with Anderson acceleration and a nested start, sine and decaying cycles of 300 to 2400 N:
1 % of friction force within 23 iterations with 1.5 and 2, 19 with 3, 28 with 1, 43 with 4; and
1e-6 the later the larger it is."""
CUT_FACTOR = 10.0
"""k of a cut over the paper's ES/l_sub. Measured with 1 to 50 substructures: 1 % of friction force
takes 16 to 17 iterations with 10, 16 to 20 with 3, 16 to 19 with 100, 16 to 31 with 1."""


def search_direction(problem: Problem, settings: Settings) -> Array:
    """Give k of every row, shape (n_rows,), scaled.

    It is the paper's, or the automatic one, times the settings' factors.
    """
    is_paper = settings.search_direction == "paper"
    k: Array = settings.k_scale * (problem.direction if is_paper else automatic(problem))
    k[problem.friction.rows] *= settings.k_friction_scale
    return np.ascontiguousarray(k)


def automatic(problem: Problem) -> Array:
    """Give k of every row by a rule that needs no tuning, shape (n_rows,), scaled.

    Small k converges fast globally and slowly locally, large k the reverse (theory.md, 5). What
    is global on the frictional interface is the length s that is expected to slide, what is local
    the distance h of its points. So k of a point is `FRICTION_FACTOR` times the geometric mean of
    ES/s and ES/h, for which neither end is slower than the other, and a row's share of it is by
    tributary length, so that cuts change nothing. On cuts, k is `CUT_FACTOR` times the paper's.
    """
    k = problem.direction.copy()
    friction = problem.friction
    length = friction.weights.sum()
    spacing = length / max(len(friction.positions) - 1, 1)
    parts = length / spacing / sliding_share(problem)
    k[friction.rows] = FRICTION_FACTOR * np.sqrt(parts) * friction.weights / spacing
    for cut in problem.of_law(Perfect):
        assert isinstance(cut, Perfect)
        k[cut.first] *= CUT_FACTOR
        k[cut.second] *= CUT_FACTOR
    return k


def sliding_share(problem: Problem) -> float:
    """Estimate the share of the frictional interface that slides at the largest load.

    It is that load over all that friction can carry, between two points and all of them. Where
    displacements are prescribed the load is not known beforehand, and all may slide.
    """
    capacity = float(problem.friction.bound.sum())
    smallest = min(2.0 / len(problem.friction.positions), 1.0)
    load = np.zeros(problem.n_instants)
    for law in problem.interfaces.values():
        if isinstance(law, Neumann):
            load += law.force.sum(axis=0)
        elif isinstance(law, Dirichlet) and law.displacement.any():
            return 1.0
    for part in problem.substructures:
        if part.body_force is not None:
            load += part.body_force.sum(axis=0)
    largest = float(np.abs(load).max())
    return float(np.clip(largest / capacity, smallest, 1.0)) if capacity > 0.0 else 1.0
