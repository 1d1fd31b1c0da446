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
    changes the targets of its groups, at the rows that carry macro quantities; the members of a
    group share the part of P that they see, so their macro forces are one product.
    """

    def __init__(self, problem: Problem, groups: Sequence[Member]) -> None:
        basis, load = problem.macro
        self._members = []
        seen, blocks = [], []
        constant = load.astype(float)
        for group in groups:
            own, local, assembly = _local_basis(basis, group.rows)
            forces = local.T @ group.response.force_rows(own)
            seen.append(assembly)
            own_system = forces[:, own] @ local
            blocks.append(np.broadcast_to(own_system, (group.rows.shape[1], *own_system.shape)))
            if group.body is not None:
                held = group.k[own, None, None] * group.body[own]
                held = local.T @ held.reshape(len(own), -1, order="F")
                constant += assembly @ held.reshape(-1, constant.shape[1], order="F")
            self._members.append((group, own, local, np.asfortranarray(forces)))
        self._spread = seen[0] if len(seen) == 1 else sparse.csr_array(sparse.hstack(seen))
        system = self._spread @ _diagonal(blocks) @ self._spread.T
        self._solve = _solver(sparse.csc_array(system), self._spread, constant)

    def add_multiplier(self) -> None:
        """Add W~ to the targets of all groups."""
        n_instants = self._members[0][0].target.shape[2]
        forces = [
            np.matmul(rows, group.target.reshape(rows.shape[1], -1, order="F")).reshape(
                -1, n_instants, order="F"
            )
            for group, _, _, rows in self._members
        ]
        multiplier = self._solve(np.concatenate(forces) if len(forces) > 1 else forces[0])
        first = 0
        for group, own, local, _ in self._members:
            size = local.shape[1] * group.rows.shape[1]
            part = multiplier[first : first + size].reshape(local.shape[1], -1, order="F")
            first += size
            group.target[own] += (local @ part).reshape(len(own), -1, n_instants, order="F")


def _local_basis(basis: sparse.csr_array, rows: Indices) -> tuple[Indices, Array, sparse.csr_array]:
    """Find the part of the macro basis that all members of a group see alike.

    Returns
    -------
    Places of the rows that carry macro quantities, shape (n_own,); the basis on them, shape
    (n_own, n_local); and what adds up the members' macro forces, (n_macro, n_members n_local).
    Where members do not see the same, or a row has but one macro quantity, the local basis is the
    identity.
    """
    counts = np.diff(basis.indptr)[rows]
    own = np.flatnonzero(counts.any(axis=1))
    whole = sparse.csr_array(basis[rows[own].ravel(order="F")].T)
    if counts.max() == 1:
        return own, np.eye(len(own)), whole
    members = [basis[rows[own, member]].tocoo() for member in range(rows.shape[1])]
    seen = []
    for member in members:
        # In the order in which the rows meet them, which the members share if anything.
        column, at = np.unique(member.coords[1], return_index=True)
        seen.append(column[np.argsort(member.coords[0][at], kind="stable")])
    local = members[0].toarray()[:, seen[0]]
    for member, column in zip(members, seen, strict=True):
        if len(column) != len(seen[0]) or not np.array_equal(member.toarray()[:, column], local):
            return own, np.eye(len(own)), whole
    chosen = np.concatenate(seen)
    shape = (basis.shape[1], len(chosen))
    ones = np.ones(len(chosen))
    return own, local, sparse.csr_array((ones, (chosen, np.arange(len(chosen)))), shape=shape)


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
