"""The linear stage on separated bases (paper, section 2.2; solver/README.md, 3).

With y = W + F/k, every space mode u of y stands for the admissible pair Z = H k u, G = k (u - Z)
(paper, eq. 3), whose G + k Z is k u. So the search direction is met as well as modes can: the
residual of problem 2.3 is k times what the new y has outside the modes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.blocks import ALL
from solver.latin.iterate import Checkpoint
from solver.latin.linear_stage import Group
from solver.latin.response import Responses
from solver.reduction.basis import Modes, ReductionRecord, SeparatedBasis, nearest_mode
from solver.refusal import check_range

SHARE_EVERY = 10
"""Iterations between two looks for bases that can be shared."""
NOTHING_LEFT = 1e-13
"""Share of the field's squared norm below which a difference of squares is only rounding."""


@dataclass(frozen=True)
class PGD:
    """A sum of a few modes, each a shape in space times a function of time (paper, section 2.2).

    Attributes
    ----------
    modes
        Most modes of a substructure; the smallest are dropped.
    tolerance
        Share of a substructure's field that may be lost with them; no mode is added for a residual
        below it. It is that of W + F/k, most of which is displacement, and far below the share of
        the force: 1e-4 left 15 % of it in layers whatever `modes` was (solver/study/README.md, 8).
    pairs
        Most modes that one iteration adds to a substructure.
    sharing
        Equal substructures use the same modes if these miss at most this share of each one's field;
        0: each has modes of its own. 1e-5 costs no accuracy, 1e-3 does where modes are few
        (solver/study/README.md, 8).
    remedy, has_to_prove, responses
        As of `Full`.
    """

    remedy: ClassVar[str] = "The modes may be too few: raise pgd_modes, lower pgd_tolerance"
    has_to_prove: ClassVar[bool] = True

    modes: int = 10
    tolerance: float = 1e-7
    pairs: int = 2
    sharing: float = 1e-5
    responses: Responses | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        for name in ("modes", "pairs"):
            check_range(self, name, 1, 1000)
        for name in ("tolerance", "sharing"):
            check_range(self, name, 0.0, 1.0)

    def group(self, problem: Problem, numbers: list[int], k: Array) -> PGDGroup:
        """Group of identical substructures with the same k, shape (n_rows,)."""
        return PGDGroup(problem, numbers, k, self)


@dataclass
class Family:
    """One basis, and the substructures that use it by their places in a group.

    The basis is of y = W + F/k; its columns run through the members, then through the instants.
    Beside it W - F/k of every mode, (n_boundary, n_modes), and what the last iteration did.
    """

    members: list[int]
    basis: SeparatedBasis
    incoming_modes: Array
    record: ReductionRecord

    def columns(self, field: Array) -> Array:
        """The members of a group field as one matrix, shape (n_boundary, n_columns).

        It is a view of the field if there is one member, otherwise a copy.
        """
        members = self.members
        if len(members) == 1:
            field = field[:, members[0] : members[0] + 1]
        else:
            field = np.asfortranarray(field[:, members])
        return field.reshape(len(field), -1, order="F")

    def put(self, field: Array, columns: Array) -> None:
        """Write such a matrix into a group field."""
        field[:, self.members] = columns.reshape(len(field), len(self.members), -1, order="F")


class PGDGroup(Group):
    """Identical substructures whose y is separated, in families that each share a basis."""

    families: list[Family]

    def __init__(self, problem: Problem, numbers: list[int], k: Array, pgd: PGD) -> None:
        super().__init__(problem, numbers, k, pgd.responses)
        self._pgd, self._weights = pgd, problem.time_weights
        self.iterations = 0

    def go_to(self, checkpoint: Checkpoint | None) -> None:
        """Take on the bases of a checkpoint, or the nearest ones to its fields, or none."""
        self.iterations = checkpoint.number if checkpoint else 0
        if checkpoint is not None and checkpoint.bases:
            self.families = list(self._shown(checkpoint.bases))
            return
        field = self.field()
        if checkpoint is not None:
            field = checkpoint.outgoing[self.rows]
        self.families = [self._family([place], field) for place in range(self.rows.shape[1])]

    def outgoing(self) -> Array:
        """W + F/k, rebuilt."""
        rebuilt = self.field()
        for family in self.families:
            family.put(rebuilt, family.basis.field())
        return rebuilt

    def relax(self, relaxation: float, instants: slice = ALL) -> None:
        """Bring the bases towards the target: update time functions, enrich, downsize."""
        for family in self.families:
            self._advance(family, relaxation)
        self.iterations += 1
        if self._pgd.sharing > 0.0 and self.iterations % SHARE_EVERY == 0:
            self._share()

    def reflect(self, instants: slice = ALL) -> Array:
        """W - F/k; the next call overwrites it."""
        for family in self.families:
            columns = family.columns(self._reflected)
            np.matmul(family.incoming_modes, family.basis.time_functions, out=columns)
            if len(family.members) > 1:
                family.put(self._reflected, columns)
        if self.body is not None:
            self._reflected += 2.0 * self.body
        return self._reflected

    def bases(self) -> Iterator[tuple[int, Modes]]:
        """The bases, by number of the substructure."""
        for family in self.families:
            time_functions = family.basis.time_functions
            for place, member in enumerate(family.members):
                modes = Modes(
                    outgoing=family.basis.modes,
                    incoming=family.incoming_modes,
                    time_functions=time_functions[:, place :: len(family.members)].copy(),
                    k=self.k,
                    stored=self.numbers[family.members[0]],
                    record=family.record,
                )
                yield self.numbers[member], modes

    def _shown(self, bases: Sequence[Modes]) -> Iterator[Family]:
        """Families that were shown, bit by bit."""
        places: dict[int, list[int]] = {}
        for place, number in enumerate(self.numbers):
            places.setdefault(bases[number].stored, []).append(place)
        for members in places.values():
            shown = [bases[self.numbers[place]] for place in members]
            modes = np.asfortranarray(shown[0].outgoing)
            time_functions = [basis.time_functions for basis in shown]
            joined = np.stack(time_functions, axis=2).reshape(modes.shape[1], -1)
            weights = np.repeat(self._weights, len(members))
            basis = SeparatedBasis(modes, joined, self.k, weights)
            yield Family(members, basis, self._incoming(basis), shown[0].record)

    def _advance(self, family: Family, relaxation: float) -> None:
        basis, pgd = family.basis, self._pgd
        target = family.columns(self.target)
        wanted = basis.coefficients(target)
        # What was last reflected is read already, and its place is free.
        whole = basis.squared(target, family.columns(self._reflected))
        inside = basis.squared_of(wanted)
        change = wanted - basis.time_functions
        updated = basis.squared_of(change)
        basis.time_functions += relaxation * change
        left = whole - inside
        if left < NOTHING_LEFT * whole:
            left = 0.0
        residual = left + updated
        enough = pgd.tolerance**2 * whole
        explained, added, dropped = 0.0, 0, 0.0
        if left > enough:
            rest = target - basis.modes @ wanted
            while added < pgd.pairs and left - explained > enough:
                mode = basis.orthonormal(nearest_mode(rest, self.k, basis.weights))
                if mode is None:
                    break
                time_function = (self.k * mode) @ rest
                rest -= np.multiply.outer(mode, time_function)
                basis.append(mode, relaxation * time_function)
                explained += basis.squared_of(time_function[None])
                added += 1
            dropped = basis.downsize(pgd.tolerance, pgd.modes)
            family.incoming_modes = self._incoming(basis)
        family.record = ReductionRecord(
            modes=basis.n_modes,
            added=added,
            updated=updated / residual if residual > 0.0 else 1.0,
            enriched=min(explained / residual, 1.0) if residual > 0.0 else 0.0,
            dropped=dropped,
        )

    def _share(self) -> None:
        """Join families whose fields lie in each other's modes up to the allowed share."""
        joined: list[Family] = []
        for family in self.families:
            for place, other in enumerate(joined):
                apart = family.basis.outside(other.basis), other.basis.outside(family.basis)
                if max(apart) <= self._pgd.sharing:
                    field = self.field()
                    for part in (other, family):
                        part.put(field, part.basis.field())
                    members = sorted(other.members + family.members)
                    joined[place] = replace(self._family(members, field), record=other.record)
                    break
            else:
                joined.append(family)
        self.families = joined

    def _family(self, members: list[int], field: Array) -> Family:
        """Some members with a basis of their part of a group field."""
        columns = field[:, members].reshape(len(field), -1, order="F")
        weights, pgd = np.repeat(self._weights, len(members)), self._pgd
        basis = SeparatedBasis.of_field(columns, self.k, weights, pgd.tolerance, pgd.modes)
        return Family(members, basis, self._incoming(basis), ReductionRecord.idle(basis.n_modes))

    def _incoming(self, basis: SeparatedBasis) -> Array:
        incoming = np.empty(basis.modes.shape, order="F")
        if basis.n_modes:
            self.response.reflect(basis.modes, incoming)
        return incoming
