"""Condition numbers of what a case makes the solvers solve."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.linalg import eigvals_banded, eigvalsh

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness

LARGEST_DENSE = 2000
"""Degrees of freedom up to which condition numbers of other than tridiagonal matrices are found."""


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
    size = matrix.shape[0]
    if size == 1:
        return 1.0
    rows, columns = sparse.coo_array(matrix).coords
    if np.abs(rows - columns).max() > 1:
        return _condition_of_dense(matrix)
    band = np.zeros((2, size))
    band[0], band[1, :-1] = matrix.diagonal(), matrix.diagonal(1)
    first, last = (
        float(eigvals_banded(band, lower=True, select="i", select_range=(place, place))[0])
        for place in (0, size - 1)
    )
    return last / first if first > 0.0 else float("inf")


def _condition_of_dense(matrix: sparse.csr_array) -> float:
    if matrix.shape[0] > LARGEST_DENSE:
        return float("nan")
    found = eigvalsh(matrix.toarray())
    rounding = len(found) * np.finfo(float).eps * found[-1]
    return float(found[-1] / found[0]) if found[0] > rounding else float("inf")
