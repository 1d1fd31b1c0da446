"""The boundary response of a substructure to its search direction: dense, or by a factor."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial

import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve

from solver.arrays import Array, Indices, sparse_factor
from solver.discrete.substructure import Elasticity

DENSE_UP_TO = 150
"""Boundary rows up to which a dense product is no slower than a sparse solution: of 101
instants it takes 0.17 against 0.13 ms at 200 rows, 4.2 against 0.7 ms at 1000
(measured)."""
DENSE_FROM_SHARE = 0.1
"""Share of nonzero entries from which a stiffness is dense, and so would be its
factor."""
BLOCK = 12_000
"""Numbers that a sparse solution takes at once: larger intermediate fields come from
fresh memory, whose first touch costs up to ten times the solution (measured)."""


class Response:
    """The boundary response of a substructure, by a solution for all columns.

    H k is that of the boundary to k y, with k as springs to rest (solver/README.md, 2).
    """

    def __init__(self, elasticity: Elasticity, k: Array) -> None:
        self._elasticity = elasticity
        self._trace = elasticity.trace
        self._k = k
        self._solve = _solver(elasticity, k)
        self._n_dofs = elasticity.stiffness.shape[0]

    @cached_property
    def _load(self) -> sparse.csr_array:
        places = self._trace, np.arange(len(self._k))
        return sparse.csr_array((self._k, places), shape=(self._n_dofs, len(self._k)))

    def reflect(self, outgoing: Array, out: Array) -> None:
        """Write 2 H k y - y for y of shape (n_boundary, n)."""
        n_columns = max(BLOCK // self._n_dofs, 4)
        for first in range(0, outgoing.shape[1], n_columns):
            columns = slice(first, first + n_columns)
            displacement = self._solve(
                np.asfortranarray(self._load @ outgoing[:, columns])
            )
            np.multiply(displacement[self._trace], 2.0, out=out[:, columns])
        np.subtract(out, outgoing, out=out)

    def force_rows(self, rows: Indices) -> Array:
        """Rows of k - k H k, which makes F of y / k, shape (len(rows), n_boundary)."""
        load = self._load[:, rows].toarray()
        full = -(self._load.T @ self._solve(load)).T
        full[np.arange(len(rows)), rows] += self._k[rows]
        return np.asarray(full)

    def of_body_force(self, force: Array) -> Array:
        """Boundary displacement under body forces, with k as a spring to rest."""
        return self._solve(force)[self._trace]


class DenseResponse(Response):
    """The boundary response of a small substructure as one dense matrix."""

    def __init__(self, elasticity: Elasticity, k: Array) -> None:
        super().__init__(elasticity, k)
        pulled = np.zeros((self._n_dofs, len(k)))
        pulled[self._trace, np.arange(len(k))] = 1.0
        compliance = self._solve(pulled)[self._trace]
        self._compliance = 0.5 * (compliance + compliance.T)
        self._reflection = 2.0 * self._compliance * k - np.eye(len(k))

    def reflect(self, outgoing: Array, out: Array) -> None:
        """Write 2 H k y - y for y of shape (n_boundary, n)."""
        np.matmul(self._reflection, outgoing, out=out)

    def force_rows(self, rows: Indices) -> Array:
        """Rows of k - k H k, which makes F of y / k, shape (len(rows), n_boundary)."""
        full: Array = -self._k[rows, None] * self._compliance[rows] * self._k
        full[np.arange(len(rows)), rows] += self._k[rows]
        return full


def response_of(elasticity: Elasticity, k: Array) -> Response:
    """Condense or factor an elasticity with a k."""
    stiffness = elasticity.stiffness
    is_dense = isinstance(stiffness, np.ndarray) or bool(
        stiffness.nnz > DENSE_FROM_SHARE * stiffness.shape[0] ** 2
    )
    if is_dense or len(k) <= DENSE_UP_TO:
        return DenseResponse(elasticity, k)
    return Response(elasticity, k)


def _solver(elasticity: Elasticity, k: Array) -> Callable[[Array], Array]:
    """The map from forces on all degrees of freedom, (n_dofs, n), to displacements."""
    stiffness = elasticity.stiffness
    springs = np.bincount(elasticity.trace, weights=k, minlength=stiffness.shape[0])
    if isinstance(stiffness, np.ndarray):
        factor = cho_factor(stiffness + np.diag(springs), check_finite=False)
        return partial(cho_solve, factor, check_finite=False)
    held = stiffness.copy()
    held.setdiag(held.diagonal() + springs)
    # Symmetric, so its rows are its columns.
    solve: Callable[[Array], Array] = sparse_factor(held.T).solve
    return solve
