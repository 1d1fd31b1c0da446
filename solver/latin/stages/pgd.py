"""The linear stage on separated bases (paper, section 2.2; solver/README.md, 3).

With y = W + F/k, every space mode u of y stands for the admissible pair Z = H k u, G =
k (u - Z) (paper, eq. 3), whose G + k Z is k u. So the search direction is met as well
as modes can: the residual of problem 2.3 is k times what the new y has outside the
modes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.checks import Count, Number, check
from solver.discrete.problem import Problem
from solver.latin.iterate import Checkpoint
from solver.latin.stages.group import Group
from solver.reduction.basis import SeparatedBasis, SharedBasis, nearest_mode

SHARE_EVERY = 10
"""Iterations between two looks for bases that can be shared."""
NOTHING_LEFT = 1e-13
"""Share of the field's squared norm below which a difference of squares is only
rounding."""


@dataclass(frozen=True)
class PGD:
    """A sum of a few modes, each a shape in space times a function of time (paper, section 2.2).

    Attributes
    ----------
    modes
        Most modes of a substructure; the smallest are dropped.
    tolerance
        Share of a substructure's field that may be lost with them; no mode is added for
        a residual below it. It is that of W + F/k, most of which is displacement, and
        far below the share of the force: 1e-4 left 15 % of it in layers whatever
        `modes` was (solver/study/README.md, 8).
    pairs
        Most modes that one iteration adds to a substructure.
    sharing
        Equal substructures use the same modes if these miss at most this share of each
        one's field; 0: each has modes of its own. 1e-5 costs no accuracy, 1e-3 does
        where modes are few (solver/study/README.md, 8).
    """

    modes: int = 10
    tolerance: float = 1e-7
    pairs: int = 2
    sharing: float = 1e-5

    def __post_init__(self) -> None:
        count = Count(1, 1000)
        share = Number(0.0, 1.0)
        check(self, modes=count, tolerance=share, pairs=count, sharing=share)

    def group(self, problem: Problem, numbers: list[int], k: Array) -> PGDGroup:
        """Group of identical substructures with the same k, shape (n_rows,)."""
        return PGDGroup(problem, numbers, k, self)


class PGDGroup(Group):
    """Identical substructures whose y is separated, on bases that some of them may share."""

    shared: list[SharedBasis]

    def __init__(
        self, problem: Problem, numbers: list[int], k: Array, pgd: PGD
    ) -> None:
        super().__init__(problem, numbers, k)
        self._pgd = pgd
        self._weights = problem.time_weights
        self._place = {number: place for place, number in enumerate(numbers)}
        self.iterations = 0

    def go_to(self, checkpoint: Checkpoint | None) -> None:
        """Take on the bases of a checkpoint, or the nearest ones to its fields, or none."""
        if checkpoint:
            self.iterations = checkpoint.number
        else:
            self.iterations = 0
        if checkpoint is not None and checkpoint.bases:
            self.shared = list(
                dict.fromkeys(checkpoint.bases[number] for number in self.numbers)
            )
            return
        field = self.field()
        if checkpoint is not None:
            field = checkpoint.outgoing[self.rows]
        self.shared = [self._of_field((number,), field) for number in self.numbers]

    def outgoing(self) -> Array:
        """W + F/k, rebuilt."""
        rebuilt = self.field()
        for shared in self.shared:
            self._put(shared.members, rebuilt, shared.basis.field())
        return rebuilt

    def relax(self, relaxation: float, instants: slice) -> None:
        """Bring the bases towards the target: update time functions, enrich, downsize."""
        self.shared = [self._advanced(shared, relaxation) for shared in self.shared]
        self.iterations += 1
        if self._pgd.sharing > 0.0 and self.iterations % SHARE_EVERY == 0:
            self._share()

    def reflect(self, instants: slice) -> Array:
        """W - F/k; the next call overwrites it."""
        for shared in self.shared:
            columns = self._columns(shared.members, self._reflected)
            np.matmul(shared.incoming, shared.basis.time_functions, out=columns)
            if len(shared.members) > 1:
                self._put(shared.members, self._reflected, columns)
        if self.body is not None:
            self._reflected += 2.0 * self.body
        return self._reflected

    def bases(self) -> Iterator[tuple[int, SharedBasis]]:
        """The bases, by number of the substructure."""
        for shared in self.shared:
            for number in shared.members:
                yield number, shared

    def _columns(self, members: Sequence[int], field: Array) -> Array:
        """Some members of a group field as one matrix, shape (n_boundary, n_columns).

        It is a view of the field if there is one member, otherwise a copy.
        """
        places = [self._place[number] for number in members]
        if len(places) == 1:
            field = field[:, places[0] : places[0] + 1]
        else:
            field = np.asfortranarray(field[:, places])
        return field.reshape(len(field), -1, order="F")

    def _put(self, members: Sequence[int], field: Array, columns: Array) -> None:
        """Write such a matrix into a group field."""
        places = [self._place[number] for number in members]
        field[:, places] = columns.reshape(len(field), len(places), -1, order="F")

    def _advanced(self, shared: SharedBasis, relaxation: float) -> SharedBasis:
        basis = shared.basis
        incoming = shared.incoming
        pgd = self._pgd
        target = self._columns(shared.members, self.target)
        wanted = basis.coefficients(target)
        # What was last reflected is read already, and its place is free.
        whole = basis.squared(target, self._columns(shared.members, self._reflected))
        left = whole - basis.squared_of(wanted)
        change = wanted - basis.time_functions
        basis = replace(
            basis, time_functions=basis.time_functions + relaxation * change
        )
        if left > max(pgd.tolerance**2, NOTHING_LEFT) * whole:
            rest = target - basis.modes @ wanted
            added = 0
            explained = 0.0
            while added < pgd.pairs and left - explained > pgd.tolerance**2 * whole:
                mode = basis.orthonormal(nearest_mode(rest, self.k, basis.weights))
                if mode is None:
                    break
                time_function = (self.k * mode) @ rest
                rest -= np.multiply.outer(mode, time_function)
                basis = basis.appended(mode, relaxation * time_function)
                explained += basis.squared_of(time_function[None])
                added += 1
            basis = basis.downsized(pgd.tolerance, pgd.modes)
            incoming = self._incoming(basis)
        return SharedBasis(shared.members, basis, incoming)

    def _share(self) -> None:
        """Join bases whose fields lie in each other's modes up to the allowed share."""
        joined: list[SharedBasis] = []
        for shared in self.shared:
            for place, other in enumerate(joined):
                apart = (
                    shared.basis.outside(other.basis),
                    other.basis.outside(shared.basis),
                )
                if max(apart) <= self._pgd.sharing:
                    field = self.field()
                    for part in (other, shared):
                        self._put(part.members, field, part.basis.field())
                    members = tuple(sorted(other.members + shared.members))
                    joined[place] = self._of_field(members, field)
                    break
            else:
                joined.append(shared)
        self.shared = joined

    def _of_field(self, members: tuple[int, ...], field: Array) -> SharedBasis:
        """Basis of some members' part of a group field."""
        columns = self._columns(members, field)
        pgd = self._pgd
        weights = np.repeat(self._weights, len(members))
        basis = SeparatedBasis.of_field(
            columns, self.k, weights, pgd.tolerance, pgd.modes
        )
        return SharedBasis(members, basis, self._incoming(basis))

    def _incoming(self, basis: SeparatedBasis) -> Array:
        """W - F/k of every mode."""
        incoming = np.empty_like(basis.modes)
        self.response.reflect(basis.modes, incoming)
        return incoming
