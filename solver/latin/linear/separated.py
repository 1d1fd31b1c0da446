"""The linear stage on separated bases (paper, section 2.2; solver/README.md, 3).

With y = W + F/k, every space mode u of y stands for the admissible pair Z = H k u, G = k (u - Z)
(paper, eq. 3), whose G + k Z is k u. So the search direction is met as well as modes can: the
residual of problem 2.3 is k times what the new y has outside the modes.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.discrete.substructure import Substructure
from solver.latin.iterate import Checkpoint
from solver.latin.linear.family import Family, members_of
from solver.latin.linear.response import Responses
from solver.latin.linear.stage import Group, LinearStage
from solver.reduction.basis import Modes, Reduction, ReductionRecord, SeparatedBasis
from solver.reduction.enrichment import Enrichment

SHARE_EVERY = 10
"""Iterations between two looks for bases that can be shared."""
NOTHING_LEFT = 1e-13
"""Share of the field's squared norm below which a difference of squares is only rounding."""


class ReducedLinearStage(LinearStage[list[Family]]):
    """The linear stage on separated bases.

    Parameters
    ----------
    problem, k, multiscale, responses
        As of `LinearStage`.
    enrichment
        How modes are found, when, and how many are kept.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        enrichment: Enrichment,
        *,
        multiscale: bool,
        responses: Responses | None = None,
    ) -> None:
        make_group = partial(ReducedGroup, enrichment=enrichment)
        super().__init__(
            problem, k, multiscale=multiscale, make_group=make_group, responses=responses
        )
        self._reduced = [group for group in self.groups if isinstance(group, ReducedGroup)]
        place = {int(part.rows[0]): number for number, part in enumerate(problem.substructures)}
        self._numbers = [[place[int(row)] for row in group.rows[0]] for group in self.groups]

    def start(self, checkpoint: Checkpoint | None) -> list[list[Family]]:
        """Give the state of a checkpoint: its bases, or the nearest ones to its fields."""
        for group in self._reduced:
            group.iterations = checkpoint.number if checkpoint else 0
        if checkpoint is None or checkpoint.reduction is None:
            return super().start(checkpoint)
        modes, records = checkpoint.reduction.modes, checkpoint.reduction.records
        return [
            group.from_modes([modes[n] for n in numbers], [records[n] for n in numbers])
            for group, numbers in zip(self._reduced, self._numbers, strict=True)
        ]

    def reduction(self, state: list[list[Family]]) -> Reduction:
        """Show the bases of all substructures."""
        modes: dict[int, Modes] = {}
        records: dict[int, ReductionRecord] = {}
        stored = 0
        for group, numbers, families in zip(self._reduced, self._numbers, state, strict=True):
            for family in families:
                for place, member in enumerate(family.members):
                    modes[numbers[member]] = group.shown(family, place, stored)
                    records[numbers[member]] = family.record
                stored += 1
        order = range(len(modes))
        return Reduction(tuple(modes[n] for n in order), tuple(records[n] for n in order))


class ReducedGroup(Group[list[Family]]):
    """Identical substructures whose states are separated.

    The state is a list of families: one per substructure, fewer when bases are shared.

    Parameters
    ----------
    problem, parts, k, responses
        As of `Group`.
    enrichment
        As of `ReducedLinearStage`.

    Attributes
    ----------
    iterations
        Iterations done, which set the pace of looking for bases to share.
    """

    def __init__(
        self,
        problem: Problem,
        parts: list[Substructure],
        k: Array,
        responses: Responses,
        enrichment: Enrichment,
    ) -> None:
        super().__init__(problem, parts, k, responses)
        self._enrichment = enrichment
        self._weights = problem.time_weights
        self.iterations = 0

    def zero(self) -> list[Family]:
        """Give the state in which all is zero: bases without modes."""
        return [self._family([place], self._empty(1)) for place in range(self.rows.shape[1])]

    def from_boundary(self, outgoing: Array) -> list[Family]:
        """Give the state nearest to this W + F/k, shape (n_rows, n_instants)."""
        self.gather(outgoing)
        return [
            self._family([place], self._basis_of(self.target[:, place], 1))
            for place in range(self.rows.shape[1])
        ]

    def from_modes(self, modes: list[Modes], records: list[ReductionRecord]) -> list[Family]:
        """Give the state that was shown, bit by bit; one entry per substructure."""
        places: dict[int, list[int]] = {}
        for place, shown in enumerate(modes):
            places.setdefault(shown.stored, []).append(place)
        families = []
        for members in places.values():
            basis = self._empty(len(members))
            basis.modes = np.asfortranarray(modes[members[0]].outgoing)
            basis.time_functions = np.stack(
                [modes[place].time_functions for place in members], axis=2
            ).reshape(basis.n_modes, -1)
            family = self._family(members, basis)
            family.record = records[members[0]]
            families.append(family)
        return families

    def outgoing(self, state: list[Family]) -> Array:
        """Rebuild W + F/k of a state."""
        found = self.field()
        for family in state:
            self._put(found, family.members, family.basis.field())
        return found

    def relax(self, state: list[Family], relaxation: float) -> None:
        """Bring a state towards the target: update time functions, enrich, downsize."""
        for family in state:
            self._advance(family, relaxation)
        self.iterations += 1
        if self._enrichment.sharing > 0.0 and self.iterations % SHARE_EVERY == 0:
            self._share(state)

    def reflect(self, state: list[Family]) -> Array:
        """Give W - F/k of a state; the next call overwrites it."""
        for family in state:
            columns = family.columns(self._reflected)
            np.matmul(family.incoming_modes, family.basis.time_functions, out=columns)
            if len(family.members) > 1:
                self._put(self._reflected, family.members, columns)
        if self.body is not None:
            self._reflected += 2.0 * self.body
        return self._reflected

    def shown(self, family: Family, place: int, stored: int) -> Modes:
        """Show one member's modes; `stored` numbers the basis."""
        return Modes(
            outgoing=family.basis.modes,
            incoming=family.incoming_modes,
            time_functions=family.time_functions(place).copy(),
            k=self.k,
            stored=stored,
        )

    def _advance(self, family: Family, relaxation: float) -> None:
        basis, rule = family.basis, self._enrichment
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
        enough = rule.tolerance**2 * whole
        found, added, dropped = 0.0, 0, 0.0
        if left > enough:
            rest = target - basis.modes @ wanted
            while added < rule.pairs and left - found > enough:
                mode = basis.orthonormal(rule.mode(rest, self.k, basis.weights))
                if mode is None:
                    break
                time_function = (self.k * mode) @ rest
                rest -= np.multiply.outer(mode, time_function)
                basis.append(mode, relaxation * time_function)
                found += basis.squared_of(time_function[None])
                added += 1
            dropped = basis.downsize(rule.tolerance, self._enrichment.largest)
            family.incoming_modes = self._incoming(basis)
        family.record = ReductionRecord(
            modes=basis.n_modes,
            added=added,
            updated=updated / residual if residual > 0.0 else 1.0,
            enriched=min(found / residual, 1.0) if residual > 0.0 else 0.0,
            dropped=dropped,
        )

    def _share(self, state: list[Family]) -> None:
        """Join families whose fields lie in each other's modes up to the allowed share."""
        joined: list[Family] = []
        for family in state:
            for other in joined:
                apart = family.basis.outside(other.basis), other.basis.outside(family.basis)
                if max(apart) <= self._enrichment.sharing:
                    self._join(other, family)
                    break
            else:
                joined.append(family)
        state[:] = joined

    def _join(self, family: Family, other: Family) -> None:
        members = sorted(family.members + other.members)
        target = self.field()
        for part in (family, other):
            self._put(target, part.members, part.basis.field())
        columns = members_of(target, members).reshape(len(target), -1, order="F")
        basis = self._basis_of(columns, len(members))
        family.members, family.basis = members, basis
        family.incoming_modes = self._incoming(basis)

    def _family(self, members: list[int], basis: SeparatedBasis) -> Family:
        record = ReductionRecord.idle(basis.n_modes)
        return Family(members, basis, self._incoming(basis), record)

    def _basis_of(self, columns: Array, n_members: int) -> SeparatedBasis:
        return SeparatedBasis.of_field(
            columns,
            self.k,
            self._tiled(n_members),
            self._enrichment.tolerance,
            self._enrichment.largest,
        )

    def _empty(self, n_members: int) -> SeparatedBasis:
        return SeparatedBasis.empty(self.k, self._tiled(n_members))

    def _tiled(self, n_members: int) -> Array:
        return np.repeat(self._weights, n_members)

    def _incoming(self, basis: SeparatedBasis) -> Array:
        incoming = np.empty(basis.modes.shape, order="F")
        if basis.n_modes:
            self.response.reflect(basis.modes, incoming)
        return incoming

    def _put(self, field: Array, members: list[int], columns: Array) -> None:
        field[:, members] = columns.reshape(len(field), len(members), -1, order="F")
