"""The coarse problem: macro forces of the linear stage in equilibrium (paper, eq. 1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from solver.discrete.problem import Array, Indices, Problem

DENSE_UP_TO = 50
"""Macro unknowns up to which one dense product is no slower than the sparse factor (measured)."""


class Response(Protocol):
    """What the coarse problem asks of a substructure's boundary response."""

    def force_rows(self, rows: Indices) -> Array:
        """Give rows of k - k H k."""


class Member(Protocol):
    """What the coarse problem asks of a group of identical substructures."""

    rows: Indices
    k: Array
    target: Array
    body: Array | None

    @property
    def response(self) -> Response:
        """The boundary response that the group shares."""


class CoarseProblem:
    """The multiplier W~ = P w~ that brings the macro forces into equilibrium.

    F = (k - k H k)(y + W~) - k W_f for a target y, and P^T F = P^T F_d fixes w~: one small system
    on the whole structure, factored once, solved for all instants (theory.md, 2). It reads and
    changes the targets of its groups, at the few rows that carry macro quantities.
    """

    def __init__(self, problem: Problem, groups: Sequence[Member]) -> None:
        basis, load = problem.macro
        carries = np.diff(basis.indptr) > 0
        self._members = []
        order, blocks = [], []
        constant = load.astype(float)
        for group in groups:
            own = np.flatnonzero(carries[group.rows].any(axis=1))
            forces = group.response.force_rows(own)
            rows = group.rows[own].ravel(order="F")
            order.append(rows)
            blocks.append(
                np.broadcast_to(forces[:, own], (group.rows.shape[1], len(own), len(own)))
            )
            if group.body is not None:
                held = group.k[own, None, None] * group.body[own]
                selected = sparse.csr_array(basis[rows].T)
                constant += selected @ held.reshape(-1, held.shape[2], order="F")
            self._members.append((group, own, np.asfortranarray(forces)))
        self._spread = sparse.csr_array(basis[np.concatenate(order)].T)
        system = self._spread @ _diagonal(blocks) @ self._spread.T
        self._solve = _solver(sparse.csc_array(system), self._spread, constant)

    def add_multiplier(self) -> None:
        """Add W~ to the targets of all groups."""
        n_instants = self._members[0][0].target.shape[2]
        forces = [
            np.matmul(rows, group.target.reshape(rows.shape[1], -1, order="F")).reshape(
                -1, n_instants, order="F"
            )
            for group, _, rows in self._members
        ]
        multiplier = self._solve(np.concatenate(forces) if len(forces) > 1 else forces[0])
        first = 0
        for group, own, _ in self._members:
            size = len(own) * group.rows.shape[1]
            part = multiplier[first : first + size]
            group.target[own] += part.reshape(len(own), -1, n_instants, order="F")
            first += size


def _diagonal(blocks: list[Array]) -> sparse.csr_array:
    """Set square blocks, stacked by size, shape (n, size, size), along a diagonal."""
    columns, ends, first = [], [np.zeros(1, dtype=np.intp)], 0
    for stack in blocks:
        n, size, _ = stack.shape
        starts = first + size * np.arange(n)
        columns.append((starts[:, None, None] + np.arange(size)).repeat(size, axis=1).ravel())
        ends.append(ends[-1][-1] + size * np.arange(1, n * size + 1))
        first += n * size
    entries = np.concatenate([stack.ravel() for stack in blocks])
    return sparse.csr_array(
        (entries, np.concatenate(columns), np.concatenate(ends)), shape=(first, first)
    )


def _solver(
    system: sparse.csc_array, spread: sparse.csr_array, constant: Array
) -> Callable[[Array], Array]:
    """Give the map from macro-row forces of the targets to W~ at these rows."""
    factor = splu(system)
    if system.shape[0] > DENSE_UP_TO:
        return lambda forces: spread.T @ factor.solve(constant - spread @ forces)
    inverse = spread.T @ factor.solve(np.eye(system.shape[0]))
    shift = np.asfortranarray(inverse @ constant)
    product = np.asfortranarray(inverse @ spread)
    return lambda forces: shift - product @ forces
