"""The search direction k of every boundary row, constant in a run."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Array, Problem
from solver.settings import Settings


def search_direction(problem: Problem, settings: Settings) -> Array:
    """Give k of every row, shape (n_rows,), scaled: the paper's, times the settings' factors."""
    k: Array = settings.k_scale * problem.direction
    k[problem.friction.rows] *= settings.k_friction_scale
    return np.ascontiguousarray(k)
