"""Linear stage on separated bases (paper, section 2.2; MATHEMATICS.md, 3).

With y = W + F/k, every space mode u of y represents the admissible pair Z = H k u, G =
k (u - Z) (paper, eq. 3), whose G + k Z is k u. So the modes meet the search direction
as well as they can: the residual of problem 2.3 is k times the part of the new y
outside the modes.
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
"""Iterations between two searches for bases that can be shared."""
NOTHING_LEFT = 1e-13
"""Share of the field's squared norm below which a difference of squares is only
rounding."""


@dataclass(frozen=True)
class PGD:
    """Separated fields in the linear stage: a sum of a few modes (paper, section 2.2).

    A mode is a shape in space times a function of time.

    Attributes
    ----------
    modes
        Largest number of modes of a substructure; the smallest modes are dropped.
    tolerance
        Share of a substructure's field W + F/k that may be lost with the dropped modes;
        no mode is added for a residual below it. Most of W + F/k is displacement, so
        the share of the force that is lost is far larger: 1e-4 left 15 % of the force
        in layers whatever `modes` was (solver/study/README.md, 8).
    pairs
        Largest number of modes that one iteration adds to a substructure.
    sharing
        Largest share of a field that common modes may miss: equal substructures use the
        same modes if these miss no more of the field of each. With 0 each has modes of
        its own. 1e-5 costs no accuracy, 1e-3 does where modes are few
        (solver/study/README.md, 8).
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
    """Identical substructures with y on separated bases; some share a basis."""

    shared: list[SharedBasis]

    def __init__(
        self, problem: Problem, numbers: list[int], k: Array, pgd: PGD
    ) -> None:
        super().__init__(problem, numbers, k)
        self._pgd = pgd
        self._weights = problem.time_weights
        self._positions = {number: position for position, number in enumerate(numbers)}
        self.iterations = 0

    def restore(self, checkpoint: Checkpoint | None) -> None:
        """Set the bases to those of a checkpoint, or of its fields, or to zero."""
        self.iterations = 0
        field = self.field()
        if checkpoint is not None:
            self.iterations = checkpoint.number
            if checkpoint.bases:
                bases = [checkpoint.bases[number] for number in self.numbers]
                # Members that share a basis name the same one: keep each once.
                self.shared = list(dict.fromkeys(bases))
                return
            field = checkpoint.outgoing[self.rows]
        self.shared = [self._of_field((number,), field) for number in self.numbers]

    def outgoing(self) -> Array:
        """W + F/k, rebuilt from the bases.

        Shape (n_boundary, n_substructures, n_instants), scaled.
        """
        rebuilt = self.field()
        for shared in self.shared:
            self._put(shared.members, rebuilt, shared.basis.field())
        return rebuilt

    def relax(self, relaxation: float, instants: slice) -> None:
        """Fit the bases to the target: update time functions, enrich, downsize."""
        self.shared = [self._advanced(shared, relaxation) for shared in self.shared]
        self.iterations += 1
        if self._pgd.sharing > 0.0 and self.iterations % SHARE_EVERY == 0:
            self._share()

    def reflect(self, instants: slice) -> Array:
        """W - F/k at all instants; the next call overwrites it.

        Shape (n_boundary, n_substructures, n_instants), scaled.
        """
        for shared in self.shared:
            columns = self._columns(shared.members, self._reflected)
            np.matmul(shared.incoming, shared.basis.time_functions, out=columns)
            if len(shared.members) > 1:
                self._put(shared.members, self._reflected, columns)
        if self.body is not None:
            self._reflected += 2.0 * self.body
        return self._reflected

    def bases(self) -> Iterator[tuple[int, SharedBasis]]:
        """Separated bases, by index of the substructure."""
        for shared in self.shared:
            for number in shared.members:
                yield number, shared

    def _columns(self, members: Sequence[int], field: Array) -> Array:
        """Some members of a group field as one matrix, shape (n_boundary, n_columns).

        The matrix is a view of the field, (n_boundary, n_substructures, n_instants), if
        there is one member, otherwise a copy.
        """
        positions = [self._positions[number] for number in members]
        if len(positions) == 1:
            field = field[:, positions[0] : positions[0] + 1]
        else:
            field = np.asfortranarray(field[:, positions])
        return field.reshape(len(field), -1, order="F")

    def _put(self, members: Sequence[int], field: Array, columns: Array) -> None:
        """Write a matrix, (n_boundary, n_columns), into members of a group field."""
        positions = [self._positions[number] for number in members]
        field[:, positions] = columns.reshape(len(field), len(positions), -1, order="F")

    def _advanced(self, shared: SharedBasis, relaxation: float) -> SharedBasis:
        """Fit a basis to the target; enrich it if the modes leave a large rest."""
        basis = shared.basis
        pgd = self._pgd
        target = self._columns(shared.members, self.target)
        wanted = basis.coefficients(target)
        # The last reflection has been read, so its memory is free.
        scratch = self._columns(shared.members, self._reflected)
        whole = basis.squared(target, scratch)
        # By Pythagoras, as modes are orthonormal: the rest itself is made only if it
        # counts.
        missed = whole - basis.squared_of(wanted)
        change = wanted - basis.time_functions
        basis = replace(
            basis, time_functions=basis.time_functions + relaxation * change
        )
        if not missed > max(pgd.tolerance**2, NOTHING_LEFT) * whole:
            return SharedBasis(shared.members, basis, shared.incoming)
        residual = target - basis.modes @ wanted
        allowed = pgd.tolerance**2 * whole
        basis = self._enriched(basis, residual, missed, allowed, relaxation)
        basis = basis.downsized(pgd.tolerance, pgd.modes)
        return SharedBasis(shared.members, basis, self._incoming(basis))

    def _enriched(
        self,
        basis: SeparatedBasis,
        residual: Array,
        missed: float,
        allowed: float,
        relaxation: float,
    ) -> SeparatedBasis:
        """Add pairs to a basis until the rest is no larger than allowed.

        Parameters
        ----------
        basis
            The basis to be enriched.
        residual
            Part of the target outside the modes, shape (n_boundary, n_columns), scaled;
            overwritten.
        missed, allowed
            Squared norm of the residual, and that which may be left.
        relaxation
            Factor on the new time functions.
        """
        explained = 0.0
        for _ in range(self._pgd.pairs):
            if not missed - explained > allowed:
                break
            mode = basis.orthonormal(nearest_mode(residual, self.k, basis.weights))
            if mode is None:
                break
            time_function = (self.k * mode) @ residual
            # The rest is orthogonal to the new mode, so the next pair adds something
            # new.
            residual -= np.multiply.outer(mode, time_function)
            basis = basis.appended(mode, relaxation * time_function)
            explained += basis.squared_of(time_function[None])
        return basis

    def _share(self) -> None:
        """Merge bases of which the fields lie, up to a share, in each other's modes."""
        joined: list[SharedBasis] = []
        for shared in self.shared:
            position = self._partner(shared, joined)
            if position is None:
                joined.append(shared)
            else:
                joined[position] = self._union(joined[position], shared)
        self.shared = joined

    def _partner(self, shared: SharedBasis, others: list[SharedBasis]) -> int | None:
        """Index of the first other basis that can be merged with a basis, or None."""
        for position, other in enumerate(others):
            apart = (
                shared.basis.outside(other.basis),
                other.basis.outside(shared.basis),
            )
            if max(apart) <= self._pgd.sharing:
                return position
        return None

    def _union(self, first: SharedBasis, second: SharedBasis) -> SharedBasis:
        """Basis of the fields of two bases together."""
        field = self.field()
        for part in (first, second):
            self._put(part.members, field, part.basis.field())
        members = tuple(sorted(first.members + second.members))
        return self._of_field(members, field)

    def _of_field(self, members: tuple[int, ...], field: Array) -> SharedBasis:
        """Basis of some members of a group field.

        `field` has shape (n_boundary, n_substructures, n_instants), scaled.
        """
        columns = self._columns(members, field)
        pgd = self._pgd
        weights = np.repeat(self._weights, len(members))
        basis = SeparatedBasis.of_field(
            columns, self.k, weights, pgd.tolerance, pgd.modes
        )
        return SharedBasis(members, basis, self._incoming(basis))

    def _incoming(self, basis: SeparatedBasis) -> Array:
        """W - F/k of every mode, shape (n_boundary, n_modes), scaled."""
        incoming = np.empty_like(basis.modes)
        self.response.reflect(basis.modes, incoming)
        return incoming
