"""Contact: two sides that stick and slip, and where contact may be lost, open.

It is a normal law and a tangential law put together. Where the pressure is known there is no normal
law. Below is a rigid support or another body. Forces act from what is below on the body above, and
the jump is that of the body above over what is below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.laws.around import Around, Rod
from solver.laws.behaviour import Behaviour
from solver.laws.interface import Component, Rule, beyond
from solver.laws.pairs import Pairs
from solver.laws.rules import Rules
from solver.laws.tangential import Tangential
from solver.laws.unilateral import Unilateral

NO_SLIP = 1e-9
"""Slip, as a share of the largest displacement, up to which a point counts as stuck."""
OPEN = 2
"""Status of a point without contact; -1 is slip backward, 0 stick, +1 slip forward."""


@dataclass(frozen=True, kw_only=True)
class Contact(Pairs):
    """Pairs that stick and slip, and may open.

    Attributes
    ----------
    weights
        Tributary length or area of each pair, shape (n_pairs,), m or m^2.
    tangential
        The law along the interface.
    normal
        The law across it; None where the pressure is known.
    around
        What the search direction has to know of the bodies.
    """

    weights: Array
    tangential: Tangential
    normal: Unilateral | None = None
    around: Around = field(default_factory=Rod)

    remembers = True

    @cached_property
    def components(self) -> tuple[Component, ...]:
        """All components, the tangential one last."""
        along = self.tangential.component
        return (along,) if self.normal is None else (self.normal.component, along)

    def begun(self, start: Array) -> Self:
        """Give the law whose sliders begin elsewhere, as `Tangential.begun`."""
        return replace(self, tangential=self.tangential.begun(start))

    def during(self, some: slice) -> Self:
        """Give the law of some instants alone."""
        return replace(self, tangential=self.tangential.during(some))

    @property
    def opens(self) -> bool:
        """Whether contact may be lost."""
        return self.normal is not None

    @property
    def is_plain(self) -> bool:
        """Whether it is a rod's, of known bound, on a support, and nothing but slip moves there."""
        on_support = self.is_on_support and isinstance(self.around, Rod)
        return on_support and not self.opens and self.tangential.softness is None

    @cached_property
    def shares(self) -> Array:
        """Share of each pair in the force of its point: as its law says, or of its area."""
        for weights in (*self.tangential.divided_by, self.weights):
            whole = self.by_point(weights)[self.points]
            if np.all(whole > 0.0):
                return np.asarray(weights / whole)
        return 1.0 / np.bincount(self.points)[self.points]

    @classmethod
    def together(cls, laws: Sequence[Self]) -> list[Self]:
        """Join all of one law and of known bound, without macro bases; a lone support stays."""
        apart: list[Self] = []
        alike: dict[tuple[type[Tangential], bool], list[Self]] = {}
        for law in laws:
            kind = type(law.tangential), law.is_on_support
            (apart if law.opens else alike.setdefault(kind, [])).append(law)
        joined = [
            own[0] if on_support and len(own) == 1 else cls._joined(kind, own)
            for (kind, on_support), own in alike.items()
        ]
        return joined + apart

    @classmethod
    def _joined(cls, kind: type[Tangential], laws: Sequence[Self]) -> Self:
        return replace(
            laws[0],
            tangential=kind.joined([law.tangential for law in laws]),
            points=np.arange(sum(len(law.points) for law in laws)),
            positions=np.concatenate([law.positions[law.points] for law in laws]),
            weights=np.concatenate([law.weights for law in laws]),
            macro=None,
        )

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Prepare the law; contact comes first, because only it says what friction can carry."""
        if self.normal is not None:
            return self.normal.rule(self.tangential.rule(k, n_instants), k)
        return self.tangential.rule(k, n_instants)

    @cached_property
    def compliance(self) -> Array:
        """Tangential displacement before slip, per friction force, of every point, scaled."""
        return self._by_point_in_parallel(self.tangential.softness)

    def _by_point_in_parallel(self, softness: Array | None) -> Array:
        if softness is None:
            return np.zeros(len(self.positions))
        return np.asarray(1.0 / self.by_point(1.0 / softness))

    def behaviour(self, displacement: Array, force: Array, noise: float) -> Behaviour:
        """Prepare the check of W and F against the law; parameters as of `gaps`."""
        opening = pressing = None
        if self.normal is not None:
            pressing = beyond(force[self.normal.component.above], noise)
            opening = beyond(self.normal.opening(displacement, force), 2.0 * noise)
        start = self.tangential.start
        before = 0.0 if start is None else start[:, None]
        moved = np.diff(self.tangential.slider(displacement, force), axis=1, prepend=before)
        slip = beyond(moved, 2.0 * noise)
        return Behaviour(
            slip=slip,
            friction=force[self.tangent.above],
            bound=self.tangential.allowed(pressing, slip),
            pressing=pressing,
            opening=opening,
        )

    def capacity(self, held: NDArray[np.bool_]) -> float:
        """Give the friction force that it can ever carry without pressing, beside the supports.

        Parameters
        ----------
        held
            Rows whose displacement is prescribed, shape (n_rows,).
        """
        return float(self.tangential.bound.max(axis=1)[~held[self.tangent.above]].sum())

    def carried(self, force: Array) -> float:
        """Give the largest force on a pair where it may open, of that of all rows."""
        rows = [component.above for component in self.components if self.opens]
        return max((float(np.abs(force[own]).max()) for own in rows), default=0.0)

    def status(
        self, displacement: Array, force: Array | None = None, still: float = 0.0
    ) -> NDArray[np.int8]:
        """Give the contact status of a local stage, shape (n_points, n_instants).

        The law repeats the position of a stuck point bit by bit, or up to rounding where both sides
        move; a point that is just at its bound moves by rounding alone, and that is not called
        slip. Where a cut ends at the interface both sides have their say, and the larger slip wins.

        Parameters
        ----------
        displacement, force
            W^ and F^ of all rows, shape (n_rows, n_instants); F^ where the status
            shows in forces too.
        still
            Slip up to which a point counts as stuck, beside what is rounding, scaled.
        """
        return self.status_of(self.slip(displacement, force), displacement, force, still)

    def status_of(
        self, slip: Array, displacement: Array, force: Array | None, still: float
    ) -> NDArray[np.int8]:
        """Give the contact status, as `status`, where the slip is known."""
        largest = max(np.abs(displacement[rows]).max(initial=0.0) for rows in self.tangent.sides)
        if self.normal is not None and force is not None:
            # A stuck contact moves by rounding alone; but a scaled structure's compliance is 1.
            largest = max(np.abs(displacement).max(), np.abs(force).max())
        found = np.sign(slip).astype(np.int8)
        found[np.abs(slip) <= max(NO_SLIP * largest, still)] = 0
        if self.normal is not None and force is not None:
            found[self.by_point(force[self.normal.component.above]) <= 0.0] = OPEN
        return found

    def slip(self, displacement: Array, force: Array | None) -> Array:
        """Give the slip of every point at every instant, (n_points, n_instants), as `status`.

        It is the sum of its pairs'.
        """
        start = self.tangential.start
        before = 0.0 if start is None else self.by_point(start)[:, None]
        moved = self.by_point(self.tangential.slider(displacement, force))
        return np.diff(moved, axis=1, prepend=before)

    def rules(self, first: int) -> list[Rules]:
        """Say what the jumps of the points obey, component by component.

        Parameters
        ----------
        first
            Place of the first of them in a stack.
        """
        size = len(self.positions)
        none, own = np.zeros(size), first + np.arange(size)
        nothing = none[:, None]
        no, yes = np.zeros(size, dtype=bool), np.ones(size, dtype=bool)
        bound = self.by_point(self.tangential.bound)
        friction = self.mean_by_point(self.tangential.friction)
        ratio, length = np.ones(size), np.full(size, np.inf)
        ages = ratio, length
        along = self.tangential
        if along.ratio is not None and along.slip_length is not None:
            ages = self.mean_by_point(along.ratio), self.mean_by_point(along.slip_length)
        if self.normal is None:
            return [Rules(no, none, own, friction, bound, self.compliance, *ages)]
        gap = self.mean_by_point(self.normal.gap)
        soft = self._by_point_in_parallel(self.normal.softness)
        # Without friction what is in series along changes nothing, and tells the jump from others.
        sprung = self.compliance if bound.any() or friction.any() else soft
        tangential = Rules(no, none, own, friction, bound, sprung, *ages)
        return [Rules(yes, gap, own, none, nothing, soft, ratio, length), tangential]

    @property
    def acts(self) -> bool:
        """Whether the bodies overlap."""
        return self.normal is not None and bool(self.normal.gap.min(initial=0.0) < 0.0)
