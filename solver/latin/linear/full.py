"""The linear stage with full space-time fields, all of which is local in time."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.blocks import ALL, Blocks, at_once
from solver.latin.linear.response import Responses
from solver.latin.linear.stage import Group, LinearStage


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

    def relax(self, state: Array, relaxation: float, some: slice = ALL) -> None:
        """Mix the target into a state, at some instants."""
        old, target = state[:, :, some], self.target[:, :, some]
        if relaxation == 1.0:
            np.copyto(old, target)
            return
        np.subtract(target, old, out=target)
        np.multiply(target, relaxation, out=target)
        np.add(old, target, out=old)

    def reflect(self, state: Array, some: slice = ALL) -> Array:
        """Give W - F/k = 2 W - (W + F/k) of a state; the next call overwrites it.

        Only some instants are up to date.
        """
        flat = (len(self.k), -1)
        reflected = self._reflected[:, :, some]
        self.response.reflect(
            state[:, :, some].reshape(flat, order="F"), reflected.reshape(flat, order="F")
        )
        if self.body is not None:
            reflected += 2.0 * self.body[:, :, some]
        return self._reflected


class FullLinearStage(LinearStage[Array]):
    """The linear stage with full space-time fields, all of which is local in time."""

    def __init__(
        self,
        problem: Problem,
        k: Array,
        *,
        multiscale: bool,
        blocks: Blocks | None = None,
        responses: Responses | None = None,
    ) -> None:
        super().__init__(
            problem,
            k,
            multiscale=multiscale,
            make_group=FullGroup,
            blocks=blocks,
            responses=responses,
        )
        self._full = [group for group in self.groups if isinstance(group, FullGroup)]
        self._blocks = blocks or at_once(problem.n_instants)

    def weights(self, time_weights: Array) -> list[Array]:
        """Give those of the norm of k over boundary and time."""
        return [
            np.broadcast_to(group.k[:, None, None] * time_weights, group.target.shape)
            for group in self.groups
        ]

    def read(self, target: Array) -> None:
        """Take W^ + F^/k of the local stage, shape (n_rows, n_instants), as all groups' target."""

        def work(some: slice) -> None:
            for group in self._full:
                group.gather(target, some)

        self._blocks.each(work)

    def advance(self, state: list[Array], relaxation: float) -> None:
        """Solve the linear stage and relax, as `LinearStage.advance` says."""
        if self._coarse is not None:
            self._coarse.add_multiplier()

        def work(some: slice) -> None:
            for group, own in zip(self._full, state, strict=True):
                group.relax(own, relaxation, some)

        self._blocks.each(work)

    def incoming(self, state: list[Array], field: Array) -> Array:
        """Write W - F/k of a state into a field of shape (n_rows, n_instants)."""

        def work(some: slice) -> None:
            for group, own in zip(self._full, state, strict=True):
                group.scatter(group.reflect(own, some), field, some)

        self._blocks.each(work)
        return field
