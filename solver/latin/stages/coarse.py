"""The coarse problem: macro forces of the linear stage in equilibrium (paper, eq. 1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices, as_slice, sparse_factor
from solver.discrete.problem import Problem
from solver.latin.stages.blocks import Blocks
from solver.latin.stages.group import Group

DENSE_UP_TO = 50
"""Macro unknowns up to which one dense product is no slower than the sparse factor
(measured)."""


class CoarseProblem:
    """The multiplier W~ = P w~ that brings the macro forces into equilibrium.

    F = (k - k H k)(y + W~) - k W_f for a target y, and P^T F = P^T F_d fixes w~: one
    small system on the whole structure, factored once, solved for all instants
    (solver/README.md, 2). It reads and changes the targets of its groups, at the rows
    that carry macro quantities; the members of a group share the part of P that they
    see, so their macro forces are one product.
    """

    def __init__(
        self, problem: Problem, groups: Sequence[Group], blocks: Blocks
    ) -> None:
        basis, load = problem.macro
        self._blocks = blocks
        self._members: list[_Member] = []
        seen: list[sparse.csr_array] = []
        systems: list[Array] = []
        constant = load.astype(float)
        carries = np.diff(basis.indptr) > 0
        for group in groups:
            if not carries[group.rows].any():
                continue
            rows, local, assembly = _local_basis(basis, group.rows)
            forces = local.T @ group.response.force_rows(rows)
            seen.append(assembly)
            systems += [forces[:, rows] @ local] * group.rows.shape[1]
            if group.body is not None:
                held = group.k[rows, None, None] * group.body[rows]
                held = local.T @ held.reshape(len(rows), -1, order="F")
                constant += assembly @ held.reshape(-1, constant.shape[1], order="F")
            size = local.shape[1] * group.rows.shape[1]
            forces = np.asfortranarray(forces)
            self._members.append(_Member(group, as_slice(rows), local, forces, size))
        self._spread = sparse.csr_array(sparse.hstack(seen))
        whole = sparse.block_diag(list(map(sparse.coo_array, systems)), format="csr")
        system = self._spread @ whole @ self._spread.T
        self._solve = _solver(sparse.csc_array(system), self._spread, constant)

    def add_multiplier(self) -> None:
        """Add W~ to the targets of all groups."""

        def work(instants: slice) -> None:
            targets = [
                member.group.target[:, :, instants].reshape(
                    len(member.group.k), -1, order="F"
                )
                for member in self._members
            ]
            forces = [
                np.matmul(member.forces, target).reshape(member.size, -1, order="F")
                for member, target in zip(self._members, targets, strict=True)
            ]
            multiplier = self._solve(np.concatenate(forces), instants)
            first = 0
            for member, target in zip(self._members, targets, strict=True):
                part = multiplier[first : first + member.size]
                change = np.empty((len(member.local), target.shape[1]), order="F")
                np.matmul(
                    member.local,
                    part.reshape(len(member.forces), -1, order="F"),
                    out=change,
                )
                target[member.rows] += change
                first += member.size

        self._blocks.each(work)


class _Member(NamedTuple):
    """A group, and the part of the macro basis that its substructures see, as `_local_basis`.

    With what makes macro forces of a target, and the number of these forces at an
    instant.
    """

    group: Group
    rows: slice | Indices
    local: Array
    forces: Array
    size: int


def _local_basis(
    basis: sparse.csr_array, rows: Indices
) -> tuple[Indices, Array, sparse.csr_array]:
    """Part of the macro basis that all members of a group see alike.

    Places of the rows that carry macro quantities, the basis on them, (n_carrying,
    n_local), and what adds up the members' macro forces, (n_macro, n_members n_local).
    Where members do not see the same, or a row has but one macro quantity, the local
    basis is the identity.
    """
    counts = np.diff(basis.indptr)[rows]
    carrying = np.flatnonzero(counts.any(axis=1))
    counts = counts[carrying]
    n_members = rows.shape[1]
    stacked = sparse.csr_array(basis[rows[carrying].ravel(order="F")])
    is_alike = counts.max() > 1 and bool(np.all(counts == counts[:, :1]))
    if is_alike:
        indices, values = (
            of.reshape(n_members, -1) for of in (stacked.indices, stacked.data)
        )
        _, first, place = np.unique(indices[0], return_index=True, return_inverse=True)
        # In the order in which rows meet them: that is what members share, if anything.
        columns = indices[:, np.sort(first)]
        place = np.argsort(np.argsort(first))[place]
        is_alike = np.array_equal(columns[:, place], indices) and bool(
            np.all(values == values[0])
        )
    if not is_alike:
        return carrying, np.eye(len(carrying)), sparse.csr_array(stacked.T)
    local = np.zeros((len(carrying), len(first)))
    local[np.repeat(np.arange(len(carrying)), counts[:, 0]), place] = values[0]
    entries = np.ones(columns.size), (columns.ravel(), np.arange(columns.size))
    return (
        carrying,
        local,
        sparse.csr_array(entries, shape=(basis.shape[1], columns.size)),
    )


def _solver(
    system: sparse.csc_array, spread: sparse.csr_array, constant: Array
) -> Callable[[Array, slice], Array]:
    """The map from macro-row forces of the targets at some instants to W~ at these rows."""
    factor = sparse_factor(system)
    if system.shape[0] > DENSE_UP_TO:

        def solve(forces: Array, instants: slice) -> Array:
            return np.asarray(
                spread.T @ factor.solve(constant[:, instants] - spread @ forces)
            )

        return solve
    inverse = spread.T @ factor.solve(np.eye(system.shape[0]))
    shift = np.asfortranarray(inverse @ constant)
    product = np.asfortranarray(inverse @ spread)
    return lambda forces, instants: shift[:, instants] - product @ forces
