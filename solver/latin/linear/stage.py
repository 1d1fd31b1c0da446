"""The linear stage: elasticity of every substructure, all instants at once (paper, problem 2.2)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np

from solver.arrays import Array, Indices, space_time
from solver.discrete.problem import Problem
from solver.discrete.substructure import Substructure
from solver.latin.blocks import ALL, Blocks
from solver.latin.iterate import Checkpoint
from solver.latin.linear.coarse import CoarseProblem
from solver.latin.linear.response import Responses
from solver.reduction.basis import Reduction

State = TypeVar("State")


class LinearStage(Generic[State]):
    """Elasticity along the search direction E-, factored for one problem and one k.

    With y = W + F/k of a substructure, W = H k y + W_f, where H = B (K + B^T k B)^-1 B^T and W_f
    comes from body forces; then W - F/k = 2 W - y (solver/README.md, 2). Its state is y: it is what
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
    blocks
        Of instants, in which it works; None for all at once.
    responses
        Of stages before it that may serve again.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        *,
        multiscale: bool,
        make_group: Callable[[Problem, list[Substructure], Array, Responses], Group[State]],
        blocks: Blocks | None = None,
        responses: Responses | None = None,
    ) -> None:
        kept = Responses() if responses is None else responses
        self.groups: list[Group[State]] = [
            make_group(problem, parts, k, kept) for parts in _alike(problem, k)
        ]
        self._coarse = (
            CoarseProblem(problem, self.groups, blocks) if multiscale and problem.has_cuts else None
        )
        self._shape = (problem.n_rows, problem.n_instants)

    def weights(self, time_weights: Array) -> list[Array] | None:
        """Give the squared weights of an inner product of states, one array for each group.

        None where states are not fields that can be mixed.
        """
        return None

    def start(self, checkpoint: Checkpoint | None) -> list[State]:
        """Give the state of a checkpoint, or that in which all is zero; one entry per group."""
        if checkpoint is None:
            return [group.zero() for group in self.groups]
        return [group.from_boundary(checkpoint.outgoing) for group in self.groups]

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

    def __init__(
        self, problem: Problem, parts: list[Substructure], k: Array, responses: Responses
    ) -> None:
        self.rows: Indices = np.stack([part.rows for part in parts], axis=1)
        self.k: Array = k[self.rows[:, 0]]
        self._n_instants = problem.n_instants
        self.response = responses.of(parts[0].elasticity, self.k)
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

    def gather(self, field: Array, some: slice = ALL) -> None:
        """Take the group's rows of a boundary field as its target, at some instants."""
        flat = self.target.T.reshape(self._n_instants, -1)[some]
        np.take(field.T[some], self._order, axis=1, out=flat, mode="clip")

    def scatter(self, own: Array, field: Array, some: slice = ALL) -> None:
        """Write a field of the group into the rows of a boundary field, at some instants."""
        flat = own.T.reshape(self._n_instants, -1)[some]
        if self._back is None:
            field.T[some, self._order] = flat
        else:
            np.take(flat, self._back, axis=1, out=field.T[some], mode="clip")

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


def _alike(problem: Problem, k: Array) -> list[list[Substructure]]:
    groups: dict[tuple[int, bytes], list[Substructure]] = {}
    for part in problem.substructures:
        groups.setdefault((id(part.elasticity), k[part.rows].tobytes()), []).append(part)
    return list(groups.values())
