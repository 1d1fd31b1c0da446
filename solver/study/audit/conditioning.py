"""Condition numbers of what a case makes the solvers solve."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.linalg import eigvalsh

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness

LARGEST = 2000
"""Degrees of freedom up to which condition numbers are found."""


def condition_of_structure(problem: Problem) -> float:
    """Give the condition number of the assembled stiffness without its held points."""
    free = np.setdiff1d(np.arange(problem.n_dofs), problem.prescribed[0])
    return _condition(assembled_stiffness(problem)[free][:, free])


def condition_of_substructures(problem: Problem, k: Array) -> float:
    """Give the largest condition number of K + B' k B over the substructures.

    Parameters
    ----------
    problem, k
        The structure, and the search direction, shape (n_rows,).
    """
    found = {}
    for part in problem.substructures:
        key = (id(part.elasticity), k[part.rows].tobytes())
        if key not in found:
            springs = np.zeros(len(part.dofs))
            np.add.at(springs, part.elasticity.trace, k[part.rows])
            stiffness = sparse.csr_array(part.elasticity.stiffness)
            found[key] = _condition(sparse.csr_array(stiffness + sparse.diags_array(springs)))
    return max(found.values())


def _condition(matrix: sparse.csr_array) -> float:
    """Give largest over smallest eigenvalue of a symmetric matrix; infinite if that is zero."""
    if matrix.shape[0] > LARGEST:
        return float("nan")
    found = eigvalsh(matrix.toarray())
    rounding = len(found) * np.finfo(float).eps * found[-1]
    return float(found[-1] / found[0]) if found[0] > rounding else float("inf")
