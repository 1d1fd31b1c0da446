"""The linear stage: elasticity of every substructure, all instants at once (paper, problem 2.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.latin.iterate import Checkpoint
from solver.latin.stages.blocks import ALL, Blocks
from solver.latin.stages.coarse import CoarseProblem
from solver.latin.stages.response import response_of
from solver.reduction.basis import SharedBasis

if TYPE_CHECKING:
    from solver.latin.stages.pgd import PGD


@dataclass(frozen=True)
class Full:
    """A linear stage with a value for every point and instant."""

    def group(self, problem: Problem, numbers: list[int], k: Array) -> Group:
        """Group of identical substructures with the same k, shape (n_rows,)."""
        return Group(problem, numbers, k)


class LinearStage:
    """Elasticity along the search direction E-, factored for one problem and one k, (n_rows,).

    With y = W + F/k of a substructure, W = H k y + W_f, where H = B (K + B^T k B)^-1
    B^T and W_f comes from body forces; then W - F/k = 2 W - y (solver/README.md, 2).
    Its state is y: it is what relaxation mixes, and everything else follows from it.
    How y is held is the groups' business: in full, block by block of instants, or on
    separated bases.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        form: Full | PGD,
        blocks: Blocks,
        *,
        multiscale: bool,
    ) -> None:
        self.groups = [form.group(problem, alike, k) for alike in _alike(problem, k)]
        self.is_full = isinstance(form, Full)
        if self.is_full:
            self._blocks = blocks
        else:
            self._blocks = Blocks(1, problem.n_instants)
        self._coarse = None
        meets = problem.cuts or any(
            law.macro is not None for law in problem.rubbing.values()
        )
        if multiscale and meets:
            self._coarse = CoarseProblem(problem, self.groups, self._blocks)
        self._shape = (problem.n_rows, problem.n_instants)

    def go_to(self, checkpoint: Checkpoint | None) -> None:
        """Take on the state of a checkpoint, or that in which all is zero."""
        for group in self.groups:
            group.go_to(checkpoint)

    def bases(self) -> tuple[SharedBasis, ...]:
        """The separated bases of the state, one per substructure; none of one in full."""
        bases = dict(basis for group in self.groups for basis in group.bases())
        return tuple(bases[number] for number in sorted(bases))

    def read(self, target: Array) -> None:
        """Make W^ + F^/k of the local stage, (n_rows, n_instants), the target of all groups."""
        self._each(lambda group, instants: group.gather(target, instants))

    def advance(self, relaxation: float) -> None:
        """Solve the linear stage: the state takes on so large a share of the new one."""
        if self._coarse is not None:
            self._coarse.add_multiplier()
        self._each(lambda group, instants: group.relax(relaxation, instants))

    def outgoing(self) -> Array:
        """W + F/k, shape (n_rows, n_instants)."""
        boundary = np.empty(self._shape, order="F")
        for group in self.groups:
            group.scatter(group.outgoing(), boundary)
        return boundary

    def incoming(self) -> Array:
        """W - F/k, shape (n_rows, n_instants)."""
        boundary = np.empty(self._shape, order="F")
        self._each(
            lambda group, some: group.scatter(group.reflect(some), boundary, some)
        )
        return boundary

    def _each(self, work: Callable[[Group, slice], None]) -> None:
        """Do some work for every group at every block of instants."""

        def of_block(instants: slice) -> None:
            for group in self.groups:
                work(group, instants)

        self._blocks.each(of_block)


class Group:
    """Identical substructures with the same k, which share one operator.

    Fields of a group have shape (n_boundary, n_substructures, n_instants), contiguous
    in space: the `state` y in full, changed in place; the `target` that it is brought
    to; and `body`, W_f, None without body forces. `rows` are the boundary rows,
    (n_boundary, n_substructures).
    """

    state: Array

    def __init__(self, problem: Problem, numbers: list[int], k: Array) -> None:
        self.numbers = numbers
        parts = [problem.substructures[number] for number in numbers]
        self.rows: Indices = np.stack([part.rows for part in parts], axis=1)
        self.k: Array = k[self.rows[:, 0]]
        self._n_instants = problem.n_instants
        self.response = response_of(parts[0].elasticity, self.k)
        self.body: Array | None = None
        if any(part.body_force is not None for part in parts):
            self.body = self.field()
            for member, part in enumerate(parts):
                if part.body_force is not None:
                    self.body[:, member] = self.response.of_body_force(part.body_force)
        self.target = self.field()
        self._reflected = self.field()
        self._order = np.ascontiguousarray(self.rows.T.ravel())

    def field(self) -> Array:
        """Allocate a zero field of the group."""
        return np.zeros((*self.rows.shape, self._n_instants), order="F")

    def gather(self, field: Array, instants: slice) -> None:
        """Make the group's rows of a boundary field its target, at some instants."""
        flat = self.target.T.reshape(self._n_instants, -1)[instants]
        np.take(field.T[instants], self._order, axis=1, out=flat, mode="clip")

    def scatter(self, values: Array, field: Array, instants: slice = ALL) -> None:
        """Write a field of the group into the rows of a boundary field, at some instants."""
        field.T[instants, self._order] = values.T.reshape(self._n_instants, -1)[
            instants
        ]

    def go_to(self, checkpoint: Checkpoint | None) -> None:
        """Take on the state of a checkpoint, or that in which all is zero."""
        self.state = self.field()
        if checkpoint is not None:
            self.state[:] = checkpoint.outgoing[self.rows]

    def outgoing(self) -> Array:
        """W + F/k, a field of the group."""
        return self.state

    def relax(self, relaxation: float, instants: slice) -> None:
        """Mix the target into the state, at some instants."""
        old = self.state[:, :, instants]
        target = self.target[:, :, instants]
        if relaxation == 1.0:
            np.copyto(old, target)
            return
        np.subtract(target, old, out=target)
        np.multiply(target, relaxation, out=target)
        np.add(old, target, out=old)

    def reflect(self, instants: slice) -> Array:
        """W - F/k = 2 W - (W + F/k), up to date at some instants; the next call overwrites it."""
        flat = (len(self.k), -1)
        reflected = self._reflected[:, :, instants]
        self.response.reflect(
            self.state[:, :, instants].reshape(flat, order="F"),
            reflected.reshape(flat, order="F"),
        )
        if self.body is not None:
            reflected += 2.0 * self.body[:, :, instants]
        return self._reflected

    def bases(self) -> Iterator[tuple[int, SharedBasis]]:
        """Separated bases, by number of the substructure."""
        return iter(())


def _alike(problem: Problem, k: Array) -> list[list[int]]:
    """Numbers of substructures with one elasticity and one k, together."""
    groups: dict[tuple[int, bytes], list[int]] = {}
    for number, part in enumerate(problem.substructures):
        groups.setdefault((id(part.elasticity), k[part.rows].tobytes()), []).append(
            number
        )
    return list(groups.values())
