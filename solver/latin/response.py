"""The boundary response of a substructure to its search direction: dense, or by a factor."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import splu

from solver.arrays import Array, Indices
from solver.discrete.substructure import Elasticity

DENSE_UP_TO = 150
"""Boundary rows up to which a dense product is no slower than a sparse solution: of 101 instants it
takes 0.17 against 0.13 ms at 200 rows, 4.2 against 0.7 ms at 1000 (measured)."""
DENSE_FROM_SHARE = 0.1
"""Share of nonzero entries from which a stiffness is dense, and so would be its factor."""
BLOCK = 12_000
"""Numbers that a sparse solution takes at once: larger intermediate fields come from fresh memory,
whose first touch costs up to ten times the solution (measured)."""


class DenseResponse:
    """The boundary response of a substructure as one dense matrix."""

    def __init__(self, elasticity: Elasticity, k: Array) -> None:
        self._factor = _factor(elasticity, k)
        self._trace = elasticity.trace
        n_boundary = len(k)
        ones = np.zeros((elasticity.stiffness.shape[0], n_boundary))
        ones[elasticity.trace, np.arange(n_boundary)] = 1.0
        compliance = self._factor.solve(ones)[elasticity.trace]
        self._compliance = 0.5 * (compliance + compliance.T)
        self._k = k
        self._reflection = 2.0 * self._compliance * k - np.eye(n_boundary)

    def reflect(self, outgoing: Array, out: Array) -> None:
        """Write 2 H k y - y for y of shape (n_boundary, n)."""
        np.matmul(self._reflection, outgoing, out=out)

    def force_rows(self, rows: Indices) -> Array:
        """Rows of k - k H k, which makes F of y / k, shape (len(rows), n_boundary)."""
        k = self._k
        full: Array = -k[rows, None] * self._compliance[rows] * k
        full[np.arange(len(rows)), rows] += k[rows]
        return full

    def of_body_force(self, force: Array) -> Array:
        """Boundary displacement under body forces, with k as a spring to rest."""
        return np.asarray(self._factor.solve(force)[self._trace])


class SparseResponse:
    """The boundary response of a large substructure, by a sparse solution for all columns."""

    def __init__(self, elasticity: Elasticity, k: Array) -> None:
        self._factor = _factor(elasticity, k)
        self._trace = elasticity.trace
        self._k = k
        n_dofs, n_boundary = elasticity.stiffness.shape[0], len(k)
        self._columns = max(BLOCK // n_dofs, 4)
        self._load = sparse.csr_array(
            (k, (elasticity.trace, np.arange(n_boundary))), shape=(n_dofs, n_boundary)
        )

    def reflect(self, outgoing: Array, out: Array) -> None:
        """Write 2 H k y - y for y of shape (n_boundary, n)."""
        for first in range(0, outgoing.shape[1], self._columns):
            columns = slice(first, first + self._columns)
            displacement = self._factor.solve(np.asfortranarray(self._load @ outgoing[:, columns]))
            np.multiply(displacement[self._trace], 2.0, out=out[:, columns])
        np.subtract(out, outgoing, out=out)

    def force_rows(self, rows: Indices) -> Array:
        """Rows of k - k H k, which makes F of y / k, shape (len(rows), n_boundary)."""
        load = self._load[:, rows].toarray()
        full = -(self._load.T @ self._factor.solve(load)).T
        full[np.arange(len(rows)), rows] += self._k[rows]
        return np.asarray(full)

    def of_body_force(self, force: Array) -> Array:
        """Boundary displacement under body forces, with k as a spring to rest."""
        return np.asarray(self._factor.solve(force)[self._trace])


class Responses:
    """Boundary responses that are factored once, however many runs with one k need them."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, bytes], DenseResponse | SparseResponse] = {}
        self._owners: list[Elasticity] = []  # so that no other takes over its identity

    def of(self, elasticity: Elasticity, k: Array) -> DenseResponse | SparseResponse:
        """Condense or factor an elasticity with a k, unless that is done."""
        key = id(elasticity), k.tobytes()
        if key not in self._known:
            stiffness = elasticity.stiffness
            is_dense = isinstance(stiffness, np.ndarray) or bool(
                stiffness.nnz > DENSE_FROM_SHARE * stiffness.shape[0] ** 2
            )
            kind = DenseResponse if is_dense or len(k) <= DENSE_UP_TO else SparseResponse
            self._known[key] = kind(elasticity, k)
            self._owners.append(elasticity)
        return self._known[key]


class _Cholesky:
    """A dense factor that solves like a sparse one."""

    def __init__(self, matrix: Array) -> None:
        self._factor = cho_factor(matrix, check_finite=False)

    def solve(self, force: Array) -> Array:
        return np.asarray(cho_solve(self._factor, force, check_finite=False))


def _factor(elasticity: Elasticity, k: Array):  # type: ignore[no-untyped-def]  # SuperLU
    stiffness = elasticity.stiffness
    n_dofs = stiffness.shape[0]
    springs = np.bincount(elasticity.trace, weights=k, minlength=n_dofs)
    if isinstance(stiffness, np.ndarray):
        return _Cholesky(stiffness + np.diag(springs))
    of_entries = np.repeat(np.arange(n_dofs), np.diff(stiffness.indptr))
    diagonal = stiffness.indices == of_entries
    if np.count_nonzero(diagonal) < n_dofs or not stiffness.has_sorted_indices:
        return splu(sparse.csc_array(stiffness + sparse.diags_array(springs)))
    entries = stiffness.data.copy()
    entries[diagonal] += springs
    # Symmetric, so its rows are its columns.
    return splu(sparse.csc_array((entries, stiffness.indices, stiffness.indptr)))
