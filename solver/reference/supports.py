"""Interfaces on rigid supports, with a known bound each: rods that do not rub on each other."""

from __future__ import annotations

import numpy as np

from solver.arrays import Indices
from solver.discrete.problem import Problem


def rubs_on_supports(problem: Problem) -> bool:
    """Tell whether all friction is of known bound, on rigid supports, one at every point."""
    if not all(law.is_plain for law in problem.rubbing.values()):
        return False
    dofs = points_dofs(problem)
    return len(problem.rubbing) == 1 or len(np.unique(dofs)) == len(dofs)


def points_dofs(problem: Problem) -> Indices:
    """Give the degree of freedom under every point, stacked interface by interface."""
    found = []
    for law in problem.rubbing.values():
        own = np.zeros(len(law.positions), dtype=np.intp)
        own[law.points] = problem.row_dofs[law.tangent.above]
        found.append(own)
    return np.concatenate(found)
