"""The linear stage: elasticity of every substructure, all instants at once (paper, problem 2.2)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.discrete.substructure import Substructure
from solver.latin.blocks import ALL, Blocks, at_once
from solver.latin.coarse import CoarseProblem
from solver.latin.iterate import Checkpoint
from solver.latin.response import Responses
from solver.reduction.basis import Modes, Reduction, ReductionRecord

if TYPE_CHECKING:
    from solver.latin.pgd import PGD

State = TypeVar("State")
Bases = dict[int, tuple[Modes, ReductionRecord]]
"""Modes of substructures, and what the last iteration did to them, by number."""


class LinearStage:
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
    form
        How fields are held.
    blocks
        Of instants, in which it works; None for all at once.

    Attributes
    ----------
    groups
        Of identical substructures with the same k.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        form: Full | PGD | None = None,
        blocks: Blocks | None = None,
        *,
        multiscale: bool,
    ) -> None:
        form = form or Full()
        responses = form.responses or Responses()
        self.groups: list[Group[Any]] = [
            form.group(problem, alike, k, responses) for alike in _alike(problem, k)
        ]
        if blocks is None or not form.is_local_in_time:
            blocks = at_once(problem.n_instants)
        self._blocks = blocks
        self._coarse = (
            CoarseProblem(problem, self.groups, self._blocks)
            if multiscale and problem.has_cuts
            else None
        )
        self._shape = (problem.n_rows, problem.n_instants)

    def start(self, checkpoint: Checkpoint | None) -> list[Any]:
        """State of a checkpoint, or that in which all is zero; one entry per group."""
        return [group.start(checkpoint) for group in self.groups]

    def reduction(self, state: list[Any]) -> Reduction | None:
        """The separated bases of a state, if it has any."""
        bases: Bases = {}
        for group, part in zip(self.groups, state, strict=True):
            bases |= group.bases(part)
        if not bases:
            return None
        modes, records = zip(*(bases[number] for number in sorted(bases)), strict=True)
        return Reduction(modes, records)

    def outgoing(self, state: list[Any]) -> Array:
        """W + F/k of a state, shape (n_rows, n_instants)."""
        boundary = np.empty(self._shape, order="F")
        for group, part in zip(self.groups, state, strict=True):
            group.scatter(group.outgoing(part), boundary)
        return boundary

    def read(self, target: Array) -> None:
        """Make W^ + F^/k of the local stage, (n_rows, n_instants), the target of all groups."""

        def work(instants: slice) -> None:
            for group in self.groups:
                group.gather(target, instants)

        self._blocks.each(work)

    def advance(self, state: list[Any], relaxation: float) -> None:
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

        def work(instants: slice) -> None:
            for group, part in zip(self.groups, state, strict=True):
                group.relax(part, relaxation, instants)

        self._blocks.each(work)

    def incoming(self, state: list[Any]) -> Array:
        """W - F/k of a state, shape (n_rows, n_instants)."""
        boundary = np.empty(self._shape, order="F")

        def work(instants: slice) -> None:
            for group, part in zip(self.groups, state, strict=True):
                group.scatter(group.reflect(part, instants), boundary, instants)

        self._blocks.each(work)
        return boundary


@dataclass(frozen=True)
class Full:
    """A linear stage with a value for every point and instant.

    Attributes
    ----------
    remedy
        What helps a run that does not converge, to begin a sentence with; nothing here.
    has_to_prove
        Whether a run ends by proof alone, whatever that costs.
    is_local_in_time
        Whether it may work on a few instants at a time.
    responses
        Factors of substructures that runs with one k share; None: each run has its own.
    """

    remedy: ClassVar[str] = ""
    has_to_prove: ClassVar[bool] = False
    is_local_in_time: ClassVar[bool] = True

    responses: Responses | None = field(default=None, repr=False)

    def group(
        self, problem: Problem, parts: list[Substructure], k: Array, responses: Responses
    ) -> FullGroup:
        """Group of identical substructures with the same k, shape (n_rows,)."""
        return FullGroup(problem, parts, k, responses)


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

    def gather(self, field: Array, instants: slice = ALL) -> None:
        """Make the group's rows of a boundary field its target, at some instants."""
        flat = self.target.T.reshape(self._n_instants, -1)[instants]
        np.take(field.T[instants], self._order, axis=1, out=flat, mode="clip")

    def scatter(self, values: Array, field: Array, instants: slice = ALL) -> None:
        """Write a field of the group into the rows of a boundary field, at some instants."""
        flat = values.T.reshape(self._n_instants, -1)[instants]
        if self._back is None:
            field.T[instants, self._order] = flat
        else:
            np.take(flat, self._back, axis=1, out=field.T[instants], mode="clip")

    @abstractmethod
    def start(self, checkpoint: Checkpoint | None) -> State:
        """State of a checkpoint, or that in which all is zero."""

    @abstractmethod
    def outgoing(self, state: State) -> Array:
        """W + F/k of a state, a field of the group."""

    @abstractmethod
    def relax(self, state: State, relaxation: float, instants: slice = ALL) -> None:
        """Mix the target into a state, at some instants."""

    @abstractmethod
    def reflect(self, state: State, instants: slice = ALL) -> Array:
        """W - F/k = 2 W - (W + F/k) of a state, at some instants; the next call overwrites it."""

    def weights(self, time_weights: Array) -> Array | None:
        """Squared weights of an inner product of states; None where these cannot be mixed."""
        return None

    def bases(self, state: State) -> Bases:
        """Separated bases of a state, if it has any."""
        return {}


class FullGroup(Group[Array]):
    """A group whose state is y in full: one matrix product for all substructures and instants."""

    def start(self, checkpoint: Checkpoint | None) -> Array:
        """State of a checkpoint, or that in which all is zero."""
        if checkpoint is None:
            return self.field()
        return np.copy(checkpoint.outgoing[self.rows], order="F")

    def outgoing(self, state: Array) -> Array:
        """W + F/k of a state, which is the state itself."""
        return state

    def relax(self, state: Array, relaxation: float, instants: slice = ALL) -> None:
        """Mix the target into a state, at some instants."""
        old, target = state[:, :, instants], self.target[:, :, instants]
        if relaxation == 1.0:
            np.copyto(old, target)
            return
        np.subtract(target, old, out=target)
        np.multiply(target, relaxation, out=target)
        np.add(old, target, out=old)

    def reflect(self, state: Array, instants: slice = ALL) -> Array:
        """W - F/k = 2 W - (W + F/k) of a state, up to date at some instants."""
        flat = (len(self.k), -1)
        reflected = self._reflected[:, :, instants]
        self.response.reflect(
            state[:, :, instants].reshape(flat, order="F"), reflected.reshape(flat, order="F")
        )
        if self.body is not None:
            reflected += 2.0 * self.body[:, :, instants]
        return self._reflected

    def weights(self, time_weights: Array) -> Array:
        """Those of the norm of k over boundary and time."""
        return np.broadcast_to(self.k[:, None, None] * time_weights, self.target.shape)


def _alike(problem: Problem, k: Array) -> list[list[Substructure]]:
    """Substructures with one elasticity and one k, together."""
    groups: dict[tuple[int, bytes], list[Substructure]] = {}
    for part in problem.substructures:
        groups.setdefault((id(part.elasticity), k[part.rows].tobytes()), []).append(part)
    return list(groups.values())
