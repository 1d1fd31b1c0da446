"""The linear stage: elasticity of every substructure, all instants at once (paper, problem 2.2)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import splu

from solver.discrete.problem import Array, Elasticity, Indices, Problem, Substructure, space_time
from solver.latin.coarse import CoarseProblem
from solver.latin.iterate import Checkpoint
from solver.reduction.basis import Reduction

DENSE_UP_TO = 150
"""Boundary rows up to which a dense product is no slower than a sparse solution.

Measured for 101 instants: 0.17 against 0.13 ms at 200 rows, 4.2 against 0.7 ms at 1000.
"""


State = TypeVar("State")


DENSE_FROM_SHARE = 0.1
"""Share of nonzero entries from which a stiffness is dense, and so would be its factor."""
BLOCK = 12_000
"""Numbers that a sparse solution takes at once: larger intermediate fields come from fresh memory,
whose first touch costs up to ten times the solution (measured)."""


class LinearStage(Generic[State]):
    """Elasticity along the search direction E-, factored for one problem and one k.

    With y = W + F/k of a substructure, W = H k y + W_f, where H = B (K + B^T k B)^-1 B^T and W_f
    comes from body forces; then W - F/k = 2 W - y (theory.md, 2). Its state is y: it is what
    relaxation mixes, and everything else follows from it. How y is held is the groups' business:
    in full, or on separated bases.

    Parameters
    ----------
    problem, k
        What to solve; k has shape (n_rows,).
    multiscale
        Whether the coarse problem is part of it.
    make_group
        Makes a group of identical substructures with the same k.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        *,
        multiscale: bool,
        make_group: Callable[[Problem, list[Substructure], Array], Group[State]],
    ) -> None:
        self.groups: list[Group[State]] = [
            make_group(problem, parts, k) for parts in _alike(problem, k)
        ]
        self._coarse = (
            CoarseProblem(problem, self.groups) if multiscale and problem.has_cuts else None
        )
        self._shape = (problem.n_rows, problem.n_instants)

    def start(self, checkpoint: Checkpoint | None) -> list[State]:
        """Give the state of a checkpoint, or that in which all is zero; one entry per group."""
        if checkpoint is None:
            return [group.zero() for group in self.groups]
        return [group.from_boundary(checkpoint.outgoing) for group in self.groups]

    def distance_of_target(self, target: Array) -> float:
        """Give the relative distance of the groups' targets from a field (n_rows, n_instants)."""
        found = space_time(*self._shape)
        weight = np.empty(self._shape[0])
        for group in self.groups:
            group.scatter(group.target, found)
            weight[group.rows] = group.k[:, None]
        root = np.sqrt(weight)[:, None]
        size = float(np.linalg.norm(root * target))
        return float(np.linalg.norm(root * (found - target))) / size if size > 0.0 else 0.0

    def reduction(self, state: list[State]) -> Reduction | None:
        """Show the separated bases of a state, if it has any."""
        return None

    def to_boundary(self, state: list[State]) -> Array:
        """Give W + F/k of a state, shape (n_rows, n_instants)."""
        field = space_time(*self._shape)
        for group, own in zip(self.groups, state, strict=True):
            group.scatter(group.outgoing(own), field)
        return field

    def read(self, target: Array) -> None:
        """Take W^ + F^/k of the local stage, shape (n_rows, n_instants), as all groups' target."""
        for group in self.groups:
            group.gather(target)

    def advance(self, state: list[State], relaxation: float) -> None:
        """Solve the linear stage and relax: the state becomes a mean of the new and the old.

        Parameters
        ----------
        state
            Changed in place.
        relaxation
            Share of the new one.
        """
        if self._coarse is not None:
            self._coarse.add_multiplier()
        for group, own in zip(self.groups, state, strict=True):
            group.relax(own, relaxation)

    def incoming(self, state: list[State], field: Array) -> Array:
        """Write W - F/k of a state into a field of shape (n_rows, n_instants)."""
        for group, own in zip(self.groups, state, strict=True):
            group.scatter(group.reflect(own), field)
        return field


class Group(ABC, Generic[State]):
    """Identical substructures with the same k, which share one operator.

    Fields of a group have shape (n_boundary, n_substructures, n_instants), contiguous in space.

    Attributes
    ----------
    rows
        Boundary rows of the substructures, shape (n_boundary, n_substructures).
    k
        Shape (n_boundary,).
    response
        The boundary operator.
    body
        W_f, a field of the group, or None without body forces.
    target
        The field that the state is brought to.
    """

    def __init__(self, problem: Problem, parts: list[Substructure], k: Array) -> None:
        self.rows: Indices = np.stack([part.rows for part in parts], axis=1)
        self.k: Array = k[self.rows[:, 0]]
        self._n_instants = problem.n_instants
        self.response = response(parts[0].elasticity, self.k)
        self.body: Array | None = None
        if any(part.body_force is not None for part in parts):
            self.body = self.field()
            for member, part in enumerate(parts):
                if part.body_force is not None:
                    self.body[:, member] = self.response.of_body_force(part.body_force)
        self.target = self.field()
        self._reflected = self.field()
        self._order = np.ascontiguousarray(self.rows.T.ravel())
        covers = self.rows.size == problem.n_rows
        self._back = np.argsort(self._order) if covers else None

    def field(self) -> Array:
        """Allocate a zero field of the group."""
        return np.zeros((*self.rows.shape, self._n_instants), order="F")

    def gather(self, field: Array) -> None:
        """Take the group's rows of a boundary field as its target."""
        flat = self.target.T.reshape(self._n_instants, -1)
        np.take(field.T, self._order, axis=1, out=flat, mode="clip")

    def scatter(self, own: Array, field: Array) -> None:
        """Write a field of the group into the rows of a boundary field."""
        flat = own.T.reshape(self._n_instants, -1)
        if self._back is None:
            field.T[:, self._order] = flat
        else:
            np.take(flat, self._back, axis=1, out=field.T, mode="clip")

    @abstractmethod
    def zero(self) -> State:
        """Give the state in which all is zero."""

    @abstractmethod
    def from_boundary(self, outgoing: Array) -> State:
        """Give the state with this W + F/k, shape (n_rows, n_instants)."""

    @abstractmethod
    def outgoing(self, state: State) -> Array:
        """Give W + F/k of a state, a field of the group."""

    @abstractmethod
    def relax(self, state: State, relaxation: float) -> None:
        """Mix the target into a state."""

    @abstractmethod
    def reflect(self, state: State) -> Array:
        """Give W - F/k = 2 W - (W + F/k) of a state; the next call overwrites it."""


class FullGroup(Group[Array]):
    """A group whose state is y in full: one matrix product for all substructures and instants."""

    def zero(self) -> Array:
        """Give the zero field."""
        return self.field()

    def from_boundary(self, outgoing: Array) -> Array:
        """Give the group's rows of W + F/k, shape (n_rows, n_instants)."""
        return np.copy(outgoing[self.rows], order="F")

    def outgoing(self, state: Array) -> Array:
        """Give the state itself."""
        return state

    def relax(self, state: Array, relaxation: float) -> None:
        """Mix the target into a state."""
        if relaxation == 1.0:
            np.copyto(state, self.target)
            return
        np.subtract(self.target, state, out=self.target)
        np.multiply(self.target, relaxation, out=self.target)
        np.add(state, self.target, out=state)

    def reflect(self, state: Array) -> Array:
        """Give W - F/k = 2 W - (W + F/k) of a state; the next call overwrites it."""
        flat = (len(self.k), -1)
        self.response.reflect(
            state.reshape(flat, order="F"), self._reflected.reshape(flat, order="F")
        )
        if self.body is not None:
            self._reflected += 2.0 * self.body
        return self._reflected


class FullLinearStage(LinearStage[Array]):
    """The linear stage with full space-time fields."""

    def __init__(self, problem: Problem, k: Array, *, multiscale: bool) -> None:
        super().__init__(problem, k, multiscale=multiscale, make_group=FullGroup)


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
        """Give rows of k - k H k, which makes F of y / k, shape (len(rows), n_boundary)."""
        k = self._k
        full: Array = -k[rows, None] * self._compliance[rows] * k
        full[np.arange(len(rows)), rows] += k[rows]
        return full

    def of_body_force(self, force: Array) -> Array:
        """Give the boundary displacement under body forces, with k as a spring to rest."""
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
            some = slice(first, first + self._columns)
            displacement = self._factor.solve(np.asfortranarray(self._load @ outgoing[:, some]))
            np.multiply(displacement[self._trace], 2.0, out=out[:, some])
        np.subtract(out, outgoing, out=out)

    def force_rows(self, rows: Indices) -> Array:
        """Give rows of k - k H k, which makes F of y / k, shape (len(rows), n_boundary)."""
        load = self._load[:, rows].toarray()
        full = -(self._load.T @ self._factor.solve(load)).T
        full[np.arange(len(rows)), rows] += self._k[rows]
        return np.asarray(full)

    def of_body_force(self, force: Array) -> Array:
        """Give the boundary displacement under body forces, with k as a spring to rest."""
        return np.asarray(self._factor.solve(force)[self._trace])


def response(elasticity: Elasticity, k: Array) -> DenseResponse | SparseResponse:
    """Condense or factor the elasticity of a substructure with its search direction."""
    stiffness = elasticity.stiffness
    if isinstance(stiffness, np.ndarray):
        return DenseResponse(elasticity, k)
    is_dense = stiffness.nnz > DENSE_FROM_SHARE * stiffness.shape[0] ** 2
    dense = len(k) <= DENSE_UP_TO or is_dense
    return DenseResponse(elasticity, k) if dense else SparseResponse(elasticity, k)


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


def _alike(problem: Problem, k: Array) -> list[list[Substructure]]:
    groups: dict[tuple[int, bytes], list[Substructure]] = {}
    for part in problem.substructures:
        groups.setdefault((id(part.elasticity), k[part.rows].tobytes()), []).append(part)
    return list(groups.values())
