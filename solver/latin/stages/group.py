"""Groups of identical substructures with the same k, with common arrays of fields."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.latin.iterate import Checkpoint
from solver.latin.stages.blocks import ALL
from solver.latin.stages.response import response_of
from solver.reduction.basis import SharedBasis


class Group:
    """Identical substructures with the same k, which share one operator.

    Fields of a group have shape (n_boundary, n_substructures, n_instants), scaled, and
    are contiguous in space.

    Attributes
    ----------
    numbers
        Indices of the substructures.
    rows
        Boundary rows, shape (n_boundary, n_substructures).
    k
        Search direction of the rows of each substructure, shape (n_boundary,), scaled.
    response
        Boundary response that all substructures share.
    state
        y = W + F/k in full, a field of the group, changed in place.
    target
        Field to which relaxation brings the state.
    body
        W_f, a field of the group; None without body forces.
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
        """Zero field, shape (n_boundary, n_substructures, n_instants)."""
        return np.zeros((*self.rows.shape, self._n_instants), order="F")

    def gather(self, field: Array, instants: slice) -> None:
        """Copy the group's rows of a field into its target, at some instants.

        `field` has shape (n_rows, n_instants), scaled.
        """
        # One instant after the other in memory, so that each is gathered in one piece.
        flat = self.target.T.reshape(self._n_instants, -1)[instants]
        np.take(field.T[instants], self._order, axis=1, out=flat, mode="clip")

    def scatter(self, values: Array, field: Array, instants: slice = ALL) -> None:
        """Write a field of the group into its rows of a larger one, at some instants.

        `values` is the field of the group, `field` that of all rows, shape (n_rows,
        n_instants), scaled.
        """
        flat = values.T.reshape(self._n_instants, -1)
        field.T[instants, self._order] = flat[instants]

    def restore(self, checkpoint: Checkpoint | None) -> None:
        """Set the state to that of a checkpoint, or to zero without one."""
        self.state = self.field()
        if checkpoint is not None:
            self.state[:] = checkpoint.outgoing[self.rows]

    def outgoing(self) -> Array:
        """W + F/k, shape (n_boundary, n_substructures, n_instants), scaled."""
        return self.state

    def relax(self, relaxation: float, instants: slice) -> None:
        """Mix the target into the state, at some instants."""
        old = self.state[:, :, instants]
        target = self.target[:, :, instants]
        if relaxation == 1.0:
            np.copyto(old, target)
            return
        # In place: new fields of this size would cost more than the arithmetic.
        np.subtract(target, old, out=target)
        np.multiply(target, relaxation, out=target)
        np.add(old, target, out=old)

    def reflect(self, instants: slice) -> Array:
        """W - F/k = 2 W - (W + F/k), updated at some instants.

        Shape (n_boundary, n_substructures, n_instants), scaled; the next call
        overwrites the field.
        """
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
        """Separated bases, by index of the substructure; empty for full fields."""
        return iter(())
