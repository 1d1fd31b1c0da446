"""Contact: two sides that stick and slip, and where contact may be lost, open.

It is a normal law and a friction law put together. Where the pressure is known there is
no normal law. Below is a rigid support or another body. Forces act from what is below
on the body above, and the jump is that of the body above over what is below.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import NoneType
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.arrays import Array, Indices
from solver.checks import Numbers, Part, check
from solver.laws.friction import Friction
from solver.laws.interface import (
    Component,
    Gaps,
    IncrementalForm,
    Interface,
    MacroPart,
    Rule,
    beyond,
    joined,
    squared,
)
from solver.laws.play import Strength
from solver.laws.stiffness import Bodies, Rod
from solver.laws.unilateral import ContactRule, Unilateral
from solver.refusal import RefusedError, Words

OPEN = 2
"""Status of a point without contact; -1 is slip backward, 0 stick, +1 slip forward."""


@dataclass(frozen=True, eq=False)
class Behaviour:
    """What one interface's fields say of its law, shape (n_pairs, n_instants) each, scaled.

    Attributes
    ----------
    slip
        Increment of the tangential jump.
    friction
        Friction force on the body above.
    bound
        Largest friction force.
    pressing, opening
        Pressing force, and distance of the two sides; None where the pressure is known.
    """

    slip: Array
    friction: Array
    bound: Array
    pressing: Array | None
    opening: Array | None

    @cached_property
    def dissipated(self) -> Array:
        """What full sliding along the way would dissipate."""
        return self.bound * np.abs(self.slip)

    def violation(self, mean_slip: float, mean_force: Array | float) -> Array:
        """Violation of every pair and instant, an energy, scaled.

        With q|v| + F v, where F is cut to |F| <= q: it is nowhere negative and zero
        exactly where Coulomb's law holds; the excess of |F| over q times the mean slip;
        and of contact N g where both are positive, tension times the mean slip, and
        overlap times the mean force.
        """
        held = np.clip(self.friction, -self.bound, self.bound)
        violation = self.dissipated + held * self.slip
        violation += np.abs(self.friction - held) * mean_slip
        if self.pressing is not None and self.opening is not None:
            pressed = np.maximum(self.pressing, 0.0)
            opened = np.maximum(self.opening, 0.0)
            violation += pressed * opened + (pressed - self.pressing) * mean_slip
            violation += mean_force * (opened - self.opening)
        return np.maximum(violation, 0.0)


@dataclass(frozen=True, kw_only=True)
class Contact(Interface):
    """Pairs that stick and slip, and may open.

    A pair is a point of the body above and what lies below it; the pairs of one point
    (two, where a cut crosses the interface, or ends at it) share its force.

    Attributes
    ----------
    points
        Point of the interface that each pair belongs to, shape (n_pairs,).
    positions
        Place of the points along the interface, shape (n_points,), m.
    weights
        Tributary length or area of each pair, shape (n_pairs,), m or m^2.
    tangential
        The law along the interface.
    normal
        The law across it; None where the pressure is known.
    around
        What the search direction has to know of the bodies.
    macro
        Macro basis of each component between two bodies, shape (n_pairs, n_macro): what
        one takes from the other is in equilibrium in the coarse problem. None on a
        rigid support.
    slip_ratio
        Slip between both sides over the displacement along the interface that the rows
        have: 2 where the image of the body lies below, which no row sees and which
        moves the other way.
    copies
        Number of interfaces that this one stands for in sums over the structure that is
        shown, as one wire of a layer does for all: forces and energies of its points
        count as many times.
    is_spring
        Whether it is a spring that pulls at a point: no surface on which bodies touch.
    """

    points: Indices
    positions: Array
    weights: Array
    tangential: Friction
    normal: Unilateral | None = None
    around: Rod | Bodies = field(default_factory=Rod)
    macro: sparse.csr_array | None = None
    slip_ratio: float = 1.0
    copies: float = 1.0
    is_spring: bool = False

    remembers = True

    def __post_init__(self) -> None:
        check(
            self,
            tangential=Part(Friction),
            normal=Part(Unilateral),
            around=Part(Rod, Bodies),
            positions=Numbers(((None,),)),
        )
        size = len(self.tangential.component.above)
        most = len(self.positions) - 1
        check(
            self,
            points=Numbers(((size,),), low=0, high=most, whole=True),
            weights=Numbers(((size,),), low=0.0, above=True),
        )
        if self.normal is None and self.tangential.friction.any():
            raise RefusedError(
                "Contact.tangential.friction",
                float(self.tangential.friction.max()),
                "0 where there is no normal law",
                "give the bound mu times the pressure, or a normal law",
            )
        if self.normal is not None and len(self.normal.gap) != size:
            remedy = "give both components the same pairs"
            shown = Words(f"of {len(self.normal.gap)} pairs")
            raise RefusedError(
                "Contact.normal", shown, f"a law of {size} pairs", remedy
            )

    def incremental_form(self) -> IncrementalForm | None:
        """The law itself, where its parts are those that solvers read, and none derived of them."""
        along = self.tangential
        across = self.normal
        is_known = type(along) is Friction and type(along.strength) in (
            Strength,
            NoneType,
        )
        if not is_known or type(across) not in (Unilateral, NoneType):
            return None
        return IncrementalForm(contact=self)

    @property
    def n_instants(self) -> int | None:
        """Number of instants that the bound is for; None where it stays the same."""
        count = self.tangential.bound.shape[1]
        return None if count == 1 else count

    @cached_property
    def components(self) -> tuple[Component, ...]:
        """All components, the tangential one last."""
        along = self.tangential.component
        if self.normal is None:
            return (along,)
        return (self.normal.component, along)

    @property
    def rows(self) -> Indices:  # type: ignore[override]  # others are given them
        """Rows of all components, of both sides."""
        return np.concatenate(
            [rows for component in self.components for rows in component.sides]
        )

    @property
    def tangent(self) -> Component:
        """The component along the interface."""
        return self.tangential.component

    @property
    def is_on_support(self) -> bool:
        """Whether what lies below is rigid."""
        return self.tangent.below is None

    @property
    def opens(self) -> bool:
        """Whether contact may be lost."""
        return self.normal is not None

    @property
    def is_plain(self) -> bool:
        """Whether it is a rod's, of known bound, on a support, and nothing but slip moves there."""
        if not self.is_on_support or not isinstance(self.around, Rod) or self.opens:
            return False
        return self.tangential.softness is None and self.tangential.cap is None

    def begun(self, start: Array) -> Self:
        """Law whose sliders begin elsewhere, as `Friction.begun`."""
        return replace(self, tangential=self.tangential.begun(start))

    def during(self, instants: slice) -> Self:
        """Law of some instants alone."""
        return replace(self, tangential=self.tangential.during(instants))

    @property
    def kind(self) -> Hashable:
        """What interfaces have alike that may be treated as one."""
        along = self.tangential
        across = self.normal and self.normal.softness
        has = [
            field is not None
            for field in (along.cap, along.softness, along.start, across)
        ]
        return along.strength, self.is_on_support, self.opens, *has

    @classmethod
    def concatenated(cls, laws: Sequence[Self]) -> Self:
        """Interfaces of one kind put one after the other, without macro bases."""
        firsts = np.cumsum([0, *(len(law.positions) for law in laws[:-1])])
        points = [first + law.points for first, law in zip(firsts, laws, strict=True)]
        names = "tangential", "normal", "positions", "weights"
        both = {name: joined([getattr(law, name) for law in laws]) for name in names}
        return replace(laws[0], **both, points=np.concatenate(points), macro=None)

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Law for one k."""
        return ContactRule(self.normal, self.tangential, k, n_instants)

    def by_point(self, values: Array) -> Array:
        """Sum of the values of each point's pairs: (n_pairs, ...) to (n_points, ...)."""
        return np.asarray(self._pairs_of_points @ values)

    @cached_property
    def _pairs_of_points(self) -> sparse.csr_array:
        """1 where a pair is of a point, shape (n_points, n_pairs)."""
        size = len(self.points)
        places = self.points, np.arange(size)
        return sparse.csr_array(
            (np.ones(size), places), shape=(len(self.positions), size)
        )

    def mean_by_point(self, values: Array) -> Array:
        """Mean of the values of each point's pairs, shape (n_points, ...)."""
        counts = np.bincount(self.points, minlength=len(self.positions))
        return np.asarray(
            self.by_point(values) / counts.reshape(-1, *[1] * (values.ndim - 1))
        )

    def in_parallel(self, softness: Array | None) -> Array:
        """Compliance of every point whose pairs have one each, (n_points,); zero without."""
        if softness is None:
            return np.zeros(len(self.positions))
        return np.asarray(1.0 / self.by_point(1.0 / softness))

    @cached_property
    def shares(self) -> Array:
        """Share of each pair in the force of its point: as its law says, or of its area."""
        softness = self.tangential.softness
        if softness is None:
            along = self.tangential.highest.max(axis=1)
        else:
            along = 1.0 / softness
        for weights in (along, self.weights):
            whole = self.by_point(weights)[self.points]
            if np.all(whole > 0.0):
                return np.asarray(weights / whole)
        return 1.0 / np.bincount(self.points)[self.points]

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces of both sides, which cancel, component by component."""
        if self.macro is None:
            return
        basis = sparse.coo_array(sparse.vstack([self.macro, self.macro]))
        for component in self.components:
            yield MacroPart(np.concatenate(component.sides), basis)

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Compare the forces of both sides; where they move is what the law is about.

        Where a part of it is none that is known here, its local stage alone says what
        it is about.
        """
        if self.incremental_form() is None:
            return super().gaps(displacement, force, noise, k)
        if self.is_on_support:
            return Gaps()
        sums = (
            sum(force[rows] for rows in component.sides)
            for component in self.components
        )
        return Gaps(
            force=sum(squared(beyond(np.asarray(missing), noise)) for missing in sums)
        )

    def behaviour(self, displacement: Array, force: Array, noise: float) -> Behaviour:
        """Prepare the check of W and F against the law; parameters as of `gaps`."""
        opening = pressing = None
        if self.normal is not None:
            pressing = beyond(force[self.normal.component.above], noise)
            opening = beyond(self.normal.opening(displacement, force), 2.0 * noise)
        start = self.tangential.start
        before: Array | float = 0.0
        if start is not None:
            before = start[:, None]
        moved = np.diff(
            self.tangential.slider(displacement, force), axis=1, prepend=before
        )
        slip = beyond(moved, 2.0 * noise)
        return Behaviour(
            slip=slip,
            friction=force[self.tangent.above],
            bound=self.tangential.allowed(pressing, slip, opening),
            pressing=pressing,
            opening=opening,
        )

    def capacity(self, held: NDArray[np.bool_]) -> float:
        """Largest friction force that it can ever carry without pressing, beside the held rows."""
        return float(self.tangential.bound.max(axis=1)[~held[self.tangent.above]].sum())

    def carried(self, force: Array) -> float:
        """Largest force on a pair where it may open, of the force of all rows."""
        rows = [component.above for component in self.components if self.opens]
        return max((float(np.abs(force[above]).max()) for above in rows), default=0.0)

    @property
    def is_moved(self) -> bool:
        """Whether the bodies overlap, or sliders stand elsewhere, before anything is given."""
        overlaps = self.normal is not None and bool(
            self.normal.gap.min(initial=0.0) < 0.0
        )
        start = self.tangential.start
        return overlaps or (start is not None and bool(start.any()))
