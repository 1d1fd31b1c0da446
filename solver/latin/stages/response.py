"""Boundary response of a substructure along its search direction: dense or factored."""

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
"""Share of nonzero entries from which a stiffness counts as dense, as its factor would
be dense."""
BLOCK = 12_000
"""Count of numbers in the intermediate fields of a sparse solution: larger fields come
from fresh memory, whose first touch costs up to ten times the solution (measured)."""


class Response:
    """Boundary response H k of a substructure, by a sparse solve for every column.

    H k y is the boundary displacement under boundary forces k y, with k as springs to
    rest (MATHEMATICS.md, 2).

    Parameters
    ----------
    elasticity
        Stiffness of the substructure.
    k
        Search direction of its rows, shape (n_boundary,), scaled.
    """

    def __init__(self, elasticity: Elasticity, k: Array) -> None:
        self._trace = elasticity.trace
        self._k = k
        self._solve = _solver(elasticity, k)
        self._n_dofs = elasticity.stiffness.shape[0]

    @cached_property
    def _load(self) -> sparse.csr_array:
        """Map from y to forces on all dofs, shape (n_dofs, n_boundary)."""
        positions = self._trace, np.arange(len(self._k))
        shape = self._n_dofs, len(self._k)
        return sparse.csr_array((self._k, positions), shape=shape)

    def reflect(self, outgoing: Array, out: Array) -> None:
        """Write 2 H k y - y for y = `outgoing`, both of shape (n_boundary, n)."""
        n_columns = max(BLOCK // self._n_dofs, 4)
        for first in range(0, outgoing.shape[1], n_columns):
            columns = slice(first, first + n_columns)
            displacement = self._solve(
                np.asfortranarray(self._load @ outgoing[:, columns])
            )
            np.multiply(displacement[self._trace], 2.0, out=out[:, columns])
        np.subtract(out, outgoing, out=out)

    def force_rows(self, rows: Indices) -> Array:
        """Some rows of k - k H k, the map from y to F, shape (n_some, n_boundary).

        `rows` are positions on the boundary, shape (n_some,).
        """
        load = self._load[:, rows].toarray()
        full = -(self._load.T @ self._solve(load)).T
        full[np.arange(len(rows)), rows] += self._k[rows]
        return np.asarray(full)

    def of_body_force(self, force: Array) -> Array:
        """Boundary displacement under a body force, with springs k to the ground.

        `force` has shape (n_dofs, n_instants), the result (n_boundary, n_instants),
        scaled.
        """
        return self._solve(force)[self._trace]


class DenseResponse(Response):
    """Boundary response of a small substructure as one dense matrix."""

    def __init__(self, elasticity: Elasticity, k: Array) -> None:
        super().__init__(elasticity, k)
        pulled = np.zeros((self._n_dofs, len(k)))
        pulled[self._trace, np.arange(len(k))] = 1.0
        compliance = self._solve(pulled)[self._trace]
        # A compliance is symmetric; rounding of the solution is not.
        self._compliance = 0.5 * (compliance + compliance.T)
        self._reflection = 2.0 * self._compliance * k - np.eye(len(k))

    def reflect(self, outgoing: Array, out: Array) -> None:
        """Write 2 H k y - y for y = `outgoing`, both of shape (n_boundary, n)."""
        np.matmul(self._reflection, outgoing, out=out)

    def force_rows(self, rows: Indices) -> Array:
        """Some rows of k - k H k, the map from y to F, shape (n_some, n_boundary).

        `rows` are positions on the boundary, shape (n_some,).
        """
        full: Array = -self._k[rows, None] * self._compliance[rows] * self._k
        full[np.arange(len(rows)), rows] += self._k[rows]
        return full


def response_of(elasticity: Elasticity, k: Array) -> Response:
    """Boundary response of a substructure with a k of shape (n_boundary,), scaled."""
    if len(k) <= DENSE_UP_TO or _is_dense(elasticity):
        return DenseResponse(elasticity, k)
    return Response(elasticity, k)


def _is_dense(elasticity: Elasticity) -> bool:
    """Check whether a stiffness is dense, or has as many entries that its factor is."""
    stiffness = elasticity.stiffness
    if isinstance(stiffness, np.ndarray):
        return True
    return bool(stiffness.nnz > DENSE_FROM_SHARE * stiffness.shape[0] ** 2)


def _solver(elasticity: Elasticity, k: Array) -> Callable[[Array], Array]:
    """Map from forces on all degrees of freedom to displacements, with springs k.

    `k` has shape (n_boundary,); forces and displacements have shape (n_dofs, n), all
    scaled.
    """
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
