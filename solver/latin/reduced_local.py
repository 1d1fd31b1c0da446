"""The local stage at reference points and instants (paper, section 3.2; solver/README.md, 3)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.linalg import qr

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.latin.clock import Clock
from solver.latin.iterate import Checkpoint
from solver.latin.linear import Group
from solver.latin.local import LocalStage
from solver.latin.reduced_linear import Family, ReducedLinearStage
from solver.reduction.basis import ReferencePoints

REFRESH = 5
"""Every so many iterations the laws are evaluated everywhere, and references chosen anew. From 2 to
10 the bar comes to 10 % in 33 to 40 iterations, and as near at the end (measured)."""


class ReducedLocalStage:
    """Interface laws at a few points and instants, from which the bases rebuild the target.

    At the reference instants the modes are fitted to what the laws say at the reference points,
    in least squares; in between the coefficients are linear in time. What the modes do not hold
    is not seen, so every few iterations the laws are evaluated everywhere. Rows of cuts, loads
    and supports are always evaluated.

    Parameters
    ----------
    problem, k
        Whose laws.
    shares
        Of the friction points, and of the instants, that are references.
    linear_stage
        Whose bases they are references of.

    Attributes
    ----------
    references
        Those at use, or None before they are chosen.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        shares: tuple[float, float],
        linear_stage: ReducedLinearStage,
    ) -> None:
        self._problem = problem
        self._k = k
        self._linear_stage = linear_stage
        self._points, self._instants = shares
        self._rubs = np.zeros(problem.n_rows, dtype=bool)
        self._partner = np.arange(problem.n_rows)
        for law in problem.rubbing.values():
            if law.opens:
                continue
            above, below = law.tangent
            self._rubs[np.concatenate(law.tangent.sides)] = True
            if below is not None:
                self._partner[above], self._partner[below] = below, above
        self._laws: LocalStage | None = None
        self.references: ReferencePoints | None = None

    def is_reduced(self, number: int) -> bool:
        """Tell whether this iteration's laws are evaluated at the references alone."""
        return number % REFRESH != 0 and self._laws is not None

    def keep_up(self, number: int, state: list[list[Family]]) -> None:
        """Choose references anew when an iteration evaluated all laws, or bases were joined."""
        families = sum(len(own) for own in state)
        joined = self.references is not None and len(self.references.places) != families
        if number % REFRESH == 0 or joined:
            self._choose(state)

    def _choose(self, state: list[list[Family]]) -> None:
        """Choose reference points and instants for the bases of a state.

        Points are the pivots of a QR decomposition of the modes, which tell them apart best, and
        evenly spaced ones up to the share asked for; instants likewise from the time functions,
        first and last included.
        """
        families = [family for group in state for family in group]
        if not any(family.basis.n_modes for family in families):
            return
        n_instants = self._problem.n_instants
        functions = np.concatenate(
            [
                family.time_functions(place)
                for family in families
                for place in range(len(family.members))
            ]
        )
        most = max(family.basis.n_modes for family in families)
        # Modes of all substructures share their instants: only the leading ones can be told apart.
        leading = np.linalg.svd(functions, full_matrices=False)[2][:most]
        wanted = round(self._instants * n_instants)
        instants = _pivots(leading, np.arange(n_instants), wanted)
        self.adopt(
            ReferencePoints(
                np.union1d(instants, [0, n_instants - 1]),
                self._with_partners(
                    [
                        (group.rows[:, family.members], self._reference_rows(group, family))
                        for group, own in zip(self._linear_stage.groups, state, strict=True)
                        for family in own
                    ]
                ),
            ),
            state,
        )

    def adopt(self, chosen: ReferencePoints, state: list[list[Family]]) -> None:
        """Use references that were chosen for the families of a state."""
        self.references = chosen
        at = chosen.instants
        rows = np.concatenate(
            [
                group.rows[places, member]
                for group, family, places in self._families(state)
                for member in family.members
            ]
        )
        # In order, so that rows of one law follow each other.
        self._order = np.argsort(rows, kind="stable")
        self._back = np.argsort(self._order)
        self._laws = LocalStage(self._problem, self._k, (rows[self._order], at))
        time = self._problem.instants
        before = np.searchsorted(at, np.arange(len(time)), "right") - 1
        self._before = np.clip(before, 0, max(len(at) - 2, 0))
        self._after = np.minimum(self._before + 1, len(at) - 1)
        spans = time[at[self._after]] - time[at[self._before]]
        spans[spans == 0.0] = 1.0
        self._share = (time - time[at[self._before]]) / spans

    def __call__(self, state: list[list[Family]]) -> None:
        """Evaluate the laws at the references and rebuild the targets of all substructures."""
        assert self._laws is not None
        assert self.references is not None
        at = self.references.instants
        read = [
            family.incoming_modes[places] @ family.time_functions(place)[:, at]
            + (0.0 if group.body is None else 2.0 * group.body[places, member][:, at])
            for group, family, places in self._families(state)
            for place, member in enumerate(family.members)
        ]
        incoming = np.asfortranarray(np.concatenate(read)[self._order])
        found = self._laws(incoming)[self._back]
        first = 0
        for group, family, places in self._families(state):
            for member in family.members:
                said = found[first : first + len(places)]
                first += len(places)
                group.target[:, member] = family.basis.modes @ self._fit(family, places, said)

    def _families(
        self, state: list[list[Family]]
    ) -> Iterator[tuple[Group[list[Family]], Family, Indices]]:
        assert self.references is not None
        places = iter(self.references.places)
        for group, own in zip(self._linear_stage.groups, state, strict=True):
            for family in own:
                yield group, family, next(places)

    def _fit(self, family: Family, places: Indices, said: Array) -> Array:
        root = np.sqrt(family.basis.k[places])[:, None]
        fitted = np.linalg.lstsq(root * family.basis.modes[places], root * said, rcond=None)[0]
        return np.asarray(
            fitted[:, self._before] * (1.0 - self._share) + fitted[:, self._after] * self._share
        )

    def _with_partners(self, chosen: list[tuple[Indices, Indices]]) -> tuple[Indices, ...]:
        """Add the places whose partners on the other side of a contact are reference rows.

        Parameters
        ----------
        chosen
            Of every family the rows of its members, shape (n_boundary, n_members), and places.
        """
        wanted = np.zeros(self._problem.n_rows, dtype=bool)
        for rows, places in chosen:
            wanted[rows[places]] = True
        grown = True
        while grown:
            before = wanted
            wanted = before | before[self._partner]
            for rows, _ in chosen:
                wanted[rows] = wanted[rows].any(axis=1, keepdims=True)
            grown = not np.array_equal(wanted, before)
        return tuple(np.flatnonzero(wanted[rows].any(axis=1)) for rows, _ in chosen)

    def _reference_rows(self, group: Group[list[Family]], family: Family) -> Indices:
        rows, basis = group.rows[:, family.members[0]], family.basis
        rubs = self._rubs[rows]
        friction = np.flatnonzero(rubs)
        wanted = round(self._points * len(friction))
        root = np.sqrt(basis.k)[:, None]
        chosen = _pivots((root * basis.modes).T[:, friction], friction, wanted)
        return np.union1d(np.flatnonzero(~rubs), chosen)


class AtReferences:
    """The laws at reference points and instants, and now and then everywhere."""

    def __init__(
        self, stage: LocalStage, linear: ReducedLinearStage, few: ReducedLocalStage, clock: Clock
    ) -> None:
        self.stage, self._linear, self.few, self._clock = stage, linear, few, clock

    @property
    def references(self) -> ReferencePoints | None:
        """Those at use, or None before they are chosen."""
        return self.few.references

    def obey(self, number: int, incoming: Array, state: list[list[Family]]) -> float:
        """Obey the laws, as `LocalPart` says."""
        if not self.few.is_reduced(number):
            self._linear.read(self.stage(incoming))
            return 0.0
        self.few(state)
        self._clock.stop()
        # What the laws say everywhere is for those who look, and for the error of the few.
        error = self._linear.distance_of_target(self.stage(incoming))
        self._clock.go_on()
        return error

    def keep_up(self, number: int, state: list[list[Family]]) -> None:
        """Choose references anew when it is time to."""
        self.few.keep_up(number, state)

    def recall(self, start: Checkpoint, state: list[list[Family]]) -> None:
        """Use the references of a checkpoint."""
        if start.references is not None:
            self.few.adopt(start.references, state)


def _pivots(functions: Array, places: Indices, wanted: int) -> Indices:
    """Choose the places that tell functions apart, and evenly spaced ones up to a number."""
    count = min(len(functions), len(places))
    if count == 0:
        return places
    pivots = qr(functions, mode="r", pivoting=True)[1][:count]
    spread = np.linspace(0, len(places) - 1, max(wanted, 1)).round().astype(np.intp)
    return np.union1d(places[pivots], places[spread] if wanted > count else places[pivots])
