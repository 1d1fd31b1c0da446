"""Interfaces with friction: two sides that stick and slip, and where contact may be lost, open.

One law serves them all: the friction force is at most r + mu N. Where the pressure is known N is
part of r, and there is no normal component; unilateral contact has one, with Coulomb's mu or with
Tresca's r. Below is a rigid support or another body. Forces act from what is below on the body
above, and the jump is that of the body above over what is below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.laws.around import Around, Rod
from solver.laws.behaviour import Behaviour
from solver.laws.interface import Component, Region, Rule, beyond
from solver.laws.obeying import ContactRule, FrictionRule
from solver.laws.pairs import Pairs
from solver.laws.rules import Rules

NO_SLIP = 1e-9
"""Slip, as a share of the largest displacement, up to which a point counts as stuck."""
OPEN = 2
"""Status of a point without contact; -1 is slip backward, 0 stick, +1 slip forward."""


@dataclass(frozen=True, kw_only=True)
class Friction(Pairs):
    """Pairs that stick and slip, and may open.

    Attributes
    ----------
    weights
        Tributary length or area of each pair, shape (n_pairs,), m or m^2.
    bound
        r, the friction force of each pair that needs no pressing one, (n_pairs,), non-negative.
    friction
        Coefficient mu of each pair, shape (n_pairs,), non-negative; 0 where the pressure is known.
    gap
        Opening between the undeformed bodies, shape (n_pairs,), scaled; negative where they
        overlap.
    around
        What the search direction has to know of the bodies.
    """

    weights: Array
    bound: Array
    friction: Array
    gap: Array = field(default_factory=lambda: np.zeros(0))
    around: Around = field(default_factory=Rod)

    remembers = True
    of_pairs: ClassVar[tuple[str, ...]] = ("weights", "bound", "friction")
    """Attributes of shape (n_pairs,) that tell pairs of one kind of interface apart."""

    @classmethod
    def of_known_bound(cls, tangent: Component, bound: Array, **others: Any) -> Self:
        """Make one whose friction force is at most r, whatever presses.

        Parameters
        ----------
        tangent, bound, others
            As the attributes.
        """
        return cls(tangent=tangent, bound=bound, friction=np.zeros(len(bound)), **others)

    @classmethod
    def of_contact(
        cls, normal: Component, tangent: Component, friction: Array, **others: Any
    ) -> Self:
        """Make unilateral contact with Coulomb's friction.

        Parameters
        ----------
        normal, tangent, friction, others
            As the attributes.
        """
        none = np.zeros(len(friction))
        return cls(tangent=tangent, normal=normal, bound=none, friction=friction, **others)

    @property
    def is_plain(self) -> bool:
        """Whether it is the play operator: of known bound, and nothing but slip below it moves."""
        return self.is_on_support and not self.opens and not self.compliance.any()

    @cached_property
    def shares(self) -> Array:
        """Share of each pair in the force of its point: of its bound, or of its area."""
        for weights in (self.bound, self.weights):
            whole = self.by_point(weights)[self.points]
            if np.all(whole > 0.0):
                return np.asarray(weights / whole)
        return 1.0 / np.bincount(self.points)[self.points]

    @classmethod
    def together(cls, laws: Sequence[Self]) -> list[Self]:
        """Join all of known bound between two bodies; the macro bases stay behind."""
        pairs = [law for law in laws if not law.opens and not law.is_on_support]
        if not pairs:
            return list(laws)
        values: dict[str, Any] = {
            name: np.concatenate([getattr(law, name) for law in pairs]) for name in cls.of_pairs
        }
        joined = replace(
            pairs[0],
            tangent=Component(
                np.concatenate([law.tangent.above for law in pairs]),
                np.concatenate([law.tangent.sides[1] for law in pairs]),
            ),
            points=np.arange(sum(len(law.points) for law in pairs)),
            positions=np.concatenate([law.positions[law.points] for law in pairs]),
            macro=None,
            **values,
        )
        return [joined, *(law for law in laws if law.opens or law.is_on_support)]

    def rule(self, region: Region) -> Rule:
        """Prepare the law; contact comes first, because only it says what friction can carry."""
        own = self._kept(region.place[self.tangent.above] >= 0)
        friction = own.friction_rule(region)
        if own.normal is None:
            return friction
        return own.contact_rule(friction, region)

    def contact_rule(self, friction: FrictionRule, region: Region) -> ContactRule:
        """Prepare the normal part of the law for a region, which tells friction what presses."""
        assert self.normal is not None
        return ContactRule(self.normal, self.gap, friction, region)

    def friction_rule(self, region: Region) -> FrictionRule:
        """Prepare the tangential part of the law for a region."""
        return FrictionRule(self.tangent, self.bound, self.friction, region)

    def _kept(self, chosen: NDArray[np.bool_]) -> Self:
        """Keep some pairs of a law that does not open."""
        if chosen.all() or self.opens:
            return self
        below = self.tangent.below
        kept = Component(self.tangent.above[chosen], None if below is None else below[chosen])
        values: dict[str, Any] = {name: getattr(self, name)[chosen] for name in self.of_pairs}
        return replace(self, tangent=kept, points=self.points[chosen], **values)

    @property
    def compliance(self) -> Array:
        """Tangential displacement before slip, per friction force, of every point, scaled."""
        return np.zeros(len(self.positions))

    def slider(self, displacement: Array, force: Array | None) -> Array:
        """Give the slip of every pair up to every instant, shape (n_pairs, n_instants), scaled.

        Parameters
        ----------
        displacement, force
            W and F of all rows, shape (n_rows, n_instants); F may be None where nobody reads it.
        """
        return self.tangent.jump(displacement)

    def opening(self, displacement: Array, force: Array) -> Array:
        """Give the distance of the two sides where it may open, shape (n_pairs, n_instants)."""
        assert self.normal is not None
        return np.asarray(self.normal.jump(displacement) + self.gap[:, None])

    def behaviour(self, displacement: Array, force: Array, noise: float) -> Behaviour:
        """Prepare the check of W and F against the law; parameters as of `gaps`."""
        opening = pressing = None
        if self.normal is not None:
            pressing = beyond(force[self.normal.above], noise)
            opening = beyond(self.opening(displacement, force), 2.0 * noise)
        slip = np.diff(self.slider(displacement, force), axis=1, prepend=0.0)
        bound = self.bound[:, None]
        if pressing is not None:
            bound = bound + self.friction[:, None] * np.maximum(pressing, 0.0)
        return Behaviour(
            slip=beyond(slip, 2.0 * noise),
            friction=force[self.tangent.above],
            bound=np.broadcast_to(bound, slip.shape),
            pressing=pressing,
            opening=opening,
        )

    def capacity(self, held: NDArray[np.bool_]) -> float:
        """Give the friction force that it can carry without pressing, beside the supports.

        Parameters
        ----------
        held
            Rows whose displacement is prescribed, shape (n_rows,).
        """
        return float(self.bound[~held[self.tangent.above]].sum())

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
        total = self.slip(displacement, force)
        largest = max(np.abs(displacement[rows]).max(initial=0.0) for rows in self.tangent.sides)
        if self.normal is not None and force is not None:
            # A stuck contact moves by rounding alone; but a scaled structure's compliance is 1.
            largest = max(np.abs(displacement).max(), np.abs(force).max())
        total[np.abs(total) <= max(NO_SLIP * largest, still)] = 0.0
        found = np.sign(total).astype(np.int8)
        if self.normal is not None and force is not None:
            found[self.by_point(force[self.normal.above]) <= 0.0] = OPEN
        return found

    def slip(self, displacement: Array, force: Array | None) -> Array:
        """Give the slip of every point at every instant, (n_points, n_instants), as `status`.

        It is the sum of its pairs'.
        """
        return np.diff(self.by_point(self.slider(displacement, force)), axis=1, prepend=0.0)

    def rules(self, first: int) -> list[Rules]:
        """Say what the jumps of the points obey, component by component.

        Parameters
        ----------
        first
            Place of the first of them in a stack.
        """
        size = len(self.positions)
        none, own = np.zeros(size), first + np.arange(size)
        no, yes = np.zeros(size, dtype=bool), np.ones(size, dtype=bool)
        bound, friction = self.by_point(self.bound), self.mean_by_point(self.friction)
        tangential = Rules(no, none, own, friction, bound, self.compliance)
        if not self.opens:
            return [tangential]
        return [Rules(yes, self.mean_by_point(self.gap), own, none, none, none), tangential]

    @property
    def acts(self) -> bool:
        """Whether the bodies overlap."""
        return bool(self.gap.min(initial=0.0) < 0.0)
