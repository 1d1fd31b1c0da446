"""Coarse problem: macro forces of the linear stage in equilibrium (paper, eq. 1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices, as_slice, ones_at, sparse_factor
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
    (MATHEMATICS.md, 2). The coarse problem reads and changes the targets of its
    groups, at the rows that carry macro quantities. The members of a group share the
    part of P that they see, so their macro forces are one product.
    """

    def __init__(
        self, problem: Problem, groups: Sequence[Group], blocks: Blocks
    ) -> None:
        basis, load = problem.macro
        self._blocks = blocks
        self._members: list[_Member] = []
        assemblies: list[sparse.csr_array] = []
        systems: list[sparse.coo_array] = []
        constant = load.astype(float)
        carries_macro = np.diff(basis.indptr) > 0
        # Members of a group have the same system, which is assembled for each of them.
        for group in groups:
            if not carries_macro[group.rows].any():
                continue
            local = _local_basis(basis, group.rows)
            forces = local.basis.T @ group.response.force_rows(local.rows)
            system = sparse.coo_array(forces[:, local.rows] @ local.basis)
            assemblies.append(local.assembly)
            systems += [system] * group.rows.shape[1]
            if group.body is not None:
                held = _macro_body_force(group.k, group.body, local)
                constant += local.assembly @ held
            self._members.append(_Member(group, local, np.asfortranarray(forces)))
        spread = sparse.csr_array(sparse.hstack(assemblies))
        whole = sparse.block_diag(systems, format="csr")
        self._solve = _solver(
            sparse.csc_array(spread @ whole @ spread.T), spread, constant
        )

    def add_multiplier(self) -> None:
        """Add W~ to the targets of all groups."""
        self._blocks.each(self._add_at)

    def _add_at(self, instants: slice) -> None:
        """Add W~ to the targets of all groups, at some instants."""
        # The macro forces of all groups first, as w~ couples them.
        targets = [member.target(instants) for member in self._members]
        forces = []
        for member, target in zip(self._members, targets, strict=True):
            by_member = np.matmul(member.forces, target)
            forces.append(by_member.reshape(member.size, -1, order="F"))
        multiplier = self._solve(np.concatenate(forces), instants)
        first = 0
        for member, target in zip(self._members, targets, strict=True):
            part = multiplier[first : first + member.size]
            member.add(part, target)
            first += member.size


class _LocalBasis(NamedTuple):
    """Part of the macro basis on the rows of a group's substructures.

    Attributes
    ----------
    rows
        Positions of the rows that carry macro quantities among those of a
        substructure, shape (n_carrying,).
    basis
        The basis on these rows, shape (n_carrying, n_local).
    assembly
        Sum of the macro forces of the substructures, one substructure after the other,
        shape (n_macro, n_substructures n_local).
    """

    rows: Indices
    basis: Array
    assembly: sparse.csr_array


class _Member:
    """A group in the coarse problem.

    Parameters
    ----------
    group
        The group, whose target is read and changed.
    local
        Part of the macro basis that its substructures see.
    forces
        Macro forces of a target, shape (n_local, n_boundary).

    Attributes
    ----------
    size
        Number of macro forces at an instant, of all its substructures.
    """

    def __init__(self, group: Group, local: _LocalBasis, forces: Array) -> None:
        self.forces = forces
        self.size = len(forces) * group.rows.shape[1]
        self._group = group
        self._rows = as_slice(local.rows)
        self._basis = local.basis

    def target(self, instants: slice) -> Array:
        """Target at some instants, a view of shape (n_boundary, n_columns)."""
        part = self._group.target[:, :, instants]
        return part.reshape(len(self._group.k), -1, order="F")

    def add(self, multiplier: Array, target: Array) -> None:
        """Add W~ to a target of shape (n_boundary, n_columns).

        `multiplier` is w~ as the substructures see it, shape (size, n_instants).
        """
        by_column = multiplier.reshape(len(self.forces), -1, order="F")
        change = np.empty((len(self._basis), target.shape[1]), order="F")
        np.matmul(self._basis, by_column, out=change)
        target[self._rows] += change


def _macro_body_force(k: Array, body: Array, local: _LocalBasis) -> Array:
    """Macro part of k W_f of a group, shape (n_substructures n_local, n_instants).

    `k` has shape (n_boundary,) and `body`, W_f, shape (n_boundary, n_substructures,
    n_instants), scaled.
    """
    held = k[local.rows, None, None] * body[local.rows]
    n_instants = held.shape[2]
    held = local.basis.T @ held.reshape(len(local.rows), -1, order="F")
    return held.reshape(-1, n_instants, order="F")


def _local_basis(basis: sparse.csr_array, rows: Indices) -> _LocalBasis:
    """Part of a macro basis, (n_rows, n_macro), common to all members of a group.

    `rows` are the boundary rows of the group, shape (n_boundary, n_substructures).
    Where members do not see the same, or a row has only one macro quantity, the local
    basis is the identity.
    """
    counts = np.diff(basis.indptr)[rows]
    carrying = np.flatnonzero(counts.any(axis=1))
    counts = counts[carrying]
    stacked = sparse.csr_array(basis[rows[carrying].ravel(order="F")])
    has_several = counts.max() > 1 and bool(np.all(counts == counts[:, :1]))
    if has_several:
        shared = _shared_basis(stacked, counts)
        if shared is not None:
            local, assembly = shared
            return _LocalBasis(carrying, local, assembly)
    return _LocalBasis(carrying, np.eye(len(carrying)), sparse.csr_array(stacked.T))


def _shared_basis(
    stacked: sparse.csr_array, counts: Indices
) -> tuple[Array, sparse.csr_array] | None:
    """Common basis and assembly as in `_LocalBasis`; None if members' parts differ.

    Parameters
    ----------
    stacked
        The macro basis on the carrying rows, one member after the other, shape
        (n_substructures n_carrying, n_macro).
    counts
        Macro quantities of every row, shape (n_carrying, n_substructures), the same for
        all members.
    """
    n_carrying, n_members = counts.shape
    indices = stacked.indices.reshape(n_members, -1)
    values = stacked.data.reshape(n_members, -1)
    _, first, position = np.unique(indices[0], return_index=True, return_inverse=True)
    # In the order in which rows meet them: members share that order, if any.
    columns = indices[:, np.sort(first)]
    position = np.argsort(np.argsort(first))[position]
    has_same_columns = np.array_equal(columns[:, position], indices)
    if not has_same_columns or not np.all(values == values[0]):
        return None
    # One member's part of the basis serves all; only the macro unknowns differ.
    local = np.zeros((n_carrying, len(first)))
    local[np.repeat(np.arange(n_carrying), counts[:, 0]), position] = values[0]
    shape = stacked.shape[1], columns.size
    return local, ones_at(columns.ravel(), np.arange(columns.size), shape)


def _solver(
    system: sparse.csc_array, spread: sparse.csr_array, constant: Array
) -> Callable[[Array, slice], Array]:
    """Map from macro forces of the targets at some instants to w~ of the groups.

    Parameters
    ----------
    system
        The coarse system, shape (n_macro, n_macro).
    spread
        Sum of the macro forces of all members, shape (n_macro, n_local), where n_local
        counts those of all members.
    constant
        Macro forces of loads, shape (n_macro, n_instants).

    Returns
    -------
    A function of the macro forces, shape (n_local, n_some), and of the instants; its
    result has the shape of the macro forces.
    """
    factor = sparse_factor(system)
    if system.shape[0] > DENSE_UP_TO:
        back = spread.T

        def solve(forces: Array, instants: slice) -> Array:
            """W~ by the sparse factor, shape (n_local, n_some), scaled."""
            right = constant[:, instants] - spread @ forces
            return np.asarray(back @ factor.solve(right))

        return solve
    # Few macro unknowns: all products are made once, and an iteration has one.
    inverse = spread.T @ factor.solve(np.eye(system.shape[0]))
    shift = np.asfortranarray(inverse @ constant)
    product = np.asfortranarray(inverse @ spread)

    def multiply(forces: Array, instants: slice) -> Array:
        """W~ by one dense product, shape (n_local, n_some), scaled."""
        return np.asarray(shift[:, instants] - product @ forces)

    return multiply
