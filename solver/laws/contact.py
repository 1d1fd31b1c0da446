"""Contact law: sides stick or slip, and open where contact may be lost.

A contact is a normal law and a friction law put together. Where the pressure is known
there is no normal law. A rigid support or another body lies below. Forces act on the
body above, and the jump is the displacement of the body above relative to that below.
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
from solver.checks import InstanceOf, Numbers, check
from solver.laws.friction import Friction
from solver.laws.interface import (
    Component,
    Gaps,
    IncrementalForm,
    MacroPart,
    Rule,
    beyond,
    joined,
    restricted,
    squared,
)
from solver.laws.pairs import Pairs
from solver.laws.play import SlipFactor
from solver.laws.stiffness import BodyStiffness, NodalStiffness, RodStiffness
from solver.laws.unilateral import ContactRule, Unilateral
from solver.refusal import RefusedError, Words

OPEN = 2
"""Status of a point without contact; -1 is slip backward, 0 stick, +1 slip forward."""


@dataclass(frozen=True, eq=False)
class Violation:
    """Fields that determine the violation of a contact law.

    All have the shape (n_pairs, n_instants), scaled.

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
        """Dissipation of this slip under the bound, (n_pairs, n_instants), scaled."""
        return self.bound * np.abs(self.slip)

    def energy(self, mean_slip: float, mean_force: Array | float) -> Array:
        """Violation of every pair and instant, (n_pairs, n_instants), a scaled energy.

        The sum of q|v| + F v, where F is cut to |F| <= q, which is nowhere negative and
        zero exactly where Coulomb's law holds; of the excess of |F| over q times the
        mean slip; and for the normal law of N g where both are positive, of tension
        times the mean slip, and of overlap times the mean force.
        """
        # Without the cut, a force beyond its bound would make the sum negative.
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
class Contact(Pairs):
    """Pairs that stick and slip, and may open.

    The pairs of one point share its force.

    Attributes
    ----------
    tangential
        Friction law along the interface.
    normal
        Normal law across the interface; None where the pressure is known.
    stiffness_beside
        Stiffness of the bodies beside the interface, for the search direction.
    macro
        Macro basis of each component between two bodies, shape (n_pairs, n_macro), in
        which the forces on both are in equilibrium in the coarse problem. None on a
        rigid support. Columns of one interface follow those of the other.
    slip_ratio
        Slip between both sides over the tangential displacement of the rows: 2 where
        the image of the body lies below, which has no rows and moves the other way.
    copies
        Number of interfaces for which this one stands in sums over the structure that
        is shown, as one wire of a layer represents all: forces and energies of its
        points count as many times.
    """

    tangential: Friction
    normal: Unilateral | None = None
    stiffness_beside: RodStiffness | BodyStiffness | NodalStiffness = field(
        default_factory=RodStiffness
    )
    macro: sparse.csr_array | None = None
    slip_ratio: float = 1.0
    copies: float = 1.0

    remembers = True

    def __post_init__(self) -> None:
        super().__post_init__()
        check(
            self,
            tangential=InstanceOf(Friction),
            normal=InstanceOf(Unilateral),
            stiffness_beside=InstanceOf(RodStiffness, BodyStiffness, NodalStiffness),
        )
        # The parts are known to be laws now, so that their sizes may be read.
        size = len(self.tangential.component.above)
        check(self, points=Numbers(((size,),), whole=True))
        # Friction of a pressing force that no law provides would silently be zero.
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
        """The law itself; None if a part is an instance of a user's subclass.

        Incremental solvers read the fields of the classes here, and would not see what
        a subclass changes.
        """
        friction = self.tangential
        # Exact types: an instance of a subclass may follow another law.
        is_friction = type(friction) is Friction
        is_slip_factor = type(friction.slip_factor) in (SlipFactor, NoneType)
        is_normal = type(self.normal) in (Unilateral, NoneType)
        if is_friction and is_slip_factor and is_normal:
            return IncrementalForm(contact=self)
        return None

    @property
    def n_instants(self) -> int | None:
        """Number of instants of the bound; None where the bound is constant."""
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
    def opens(self) -> bool:
        """Check whether contact may be lost."""
        return self.normal is not None

    @property
    def is_plain(self) -> bool:
        """Check whether the law is that of a rod on a support, with a known bound."""
        if (
            not self.is_on_support
            or not isinstance(self.stiffness_beside, RodStiffness)
            or self.opens
        ):
            return False
        return self.tangential.compliance is None and self.tangential.cap is None

    def with_start(self, start: Array) -> Self:
        """The law with initial positions of its sliders, as `Friction.with_start`."""
        return replace(self, tangential=self.tangential.with_start(start))

    def during(self, instants: slice) -> Self:
        """The law restricted to a range of instants."""
        return replace(self, tangential=self.tangential.during(instants))

    @property
    def kind(self) -> Hashable:
        """Key of laws: those with equal keys can be concatenated."""
        friction = self.tangential
        normal = self.normal
        return (
            friction.slip_factor,
            self.is_on_support,
            self.opens,
            friction.cap is not None,
            friction.compliance is not None,
            friction.start is not None,
            normal is not None and normal.compliance is not None,
        )

    @classmethod
    def concatenated(cls, laws: Sequence[Self]) -> Self:
        """Concatenate interfaces of one kind, without macro bases and names."""
        sizes = [len(law.positions) for law in laws]
        firsts = np.cumsum([0, *sizes[:-1]])
        points = [first + law.points for first, law in zip(firsts, laws, strict=True)]
        return replace(
            laws[0],
            tangential=joined([law.tangential for law in laws]),
            normal=joined([law.normal for law in laws]),
            positions=joined([law.positions for law in laws]),
            weights=joined([law.weights for law in laws]),
            points=np.concatenate(points),
            macro=None,
            names=(),
            interfaces=None,
        )

    def interface(self, number: int) -> Self:
        """The law of one of several interfaces."""
        if self.interfaces is None:
            return self
        points, pairs = self.ranges[number]
        return replace(
            self,
            tangential=restricted(self.tangential, pairs),
            normal=restricted(self.normal, pairs),
            stiffness_beside=restricted(self.stiffness_beside, pairs),
            positions=self.positions[points],
            weights=self.weights[pairs],
            points=self.points[pairs] - points.start,
            macro=self._macro_of(number, pairs),
            names=(),
            interfaces=None,
        )

    def _macro_of(self, number: int, pairs: slice) -> sparse.csr_array | None:
        """Macro basis of one interface, (n_pairs, n_macro), or None."""
        if self.macro is None:
            return None
        columns = np.flatnonzero(self._interface_of_macro == number)
        if not columns.size:
            return None
        return sparse.csr_array(self.macro[pairs][:, columns])

    @cached_property
    def _interface_of_macro(self) -> Indices:
        """Index of the interface of each column of the macro basis, (n_macro,)."""
        assert self.macro is not None
        entries = sparse.coo_array(self.macro)
        owners = np.zeros(self.macro.shape[1], dtype=np.intp)
        owners[entries.coords[1]] = self.interface_of_pairs[entries.coords[0]]
        return owners

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Local stage for k of all rows, (n_rows,), scaled."""
        return ContactRule(self.normal, self.tangential, k, n_instants)

    @cached_property
    def shares(self) -> Array:
        """Share of each pair in the force of its point, (n_pairs,).

        By the stiffnesses of the point's pairs, or their bounds, or else, where they
        have none, by their areas.
        """
        compliance = self.tangential.compliance
        if compliance is None:
            along = self.tangential.largest_bound.max(axis=1)
        else:
            along = 1.0 / compliance
        whole = self.by_point(along)[self.points]
        known = whole > 0.0
        weights = np.where(known, along, self.weights)
        return np.asarray(weights / self.by_point(weights)[self.points])

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces of both sides, in equilibrium, interface by interface."""
        if self.macro is None:
            return
        # The same basis on both sides, whose macro forces add up to zero.
        basis = sparse.coo_array(sparse.vstack([self.macro, self.macro]))
        numbers, columns = basis.coords
        n_rows, n_columns = basis.shape
        n_components = len(self.components)
        rows = [np.concatenate(component.sides) for component in self.components]
        places = [number * n_rows + numbers for number in range(n_components)]
        entries = (
            np.tile(basis.data, n_components),
            (np.concatenate(places), self._macro_columns(columns)),
        )
        shape = (n_components * n_rows, n_components * n_columns)
        yield MacroPart(np.concatenate(rows), sparse.coo_array(entries, shape=shape))

    def _macro_columns(self, columns: Indices) -> Indices:
        """Columns of the macro basis of all components, from those of one, (n,).

        One component behind the other, (n_components n,). In the basis, of every
        interface the columns of one component follow those of the other.
        """
        owners = self._interface_of_macro
        counts = np.bincount(owners, minlength=len(self.sizes))
        firsts = np.cumsum(counts) - counts
        before = firsts[owners[columns]]
        begins = len(self.components) * before + columns - before
        step = counts[owners[columns]]
        of_components = [
            begins + number * step for number in range(len(self.components))
        ]
        return np.concatenate(of_components)

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Violation of action and reaction between both sides, as `Interface.gaps`.

        Displacements obey no linear law at a contact. Where a part is of a user's
        subclass, the local stage finds all violations.
        """
        if self.incremental_form() is None:
            return super().gaps(displacement, force, noise, k)
        if self.is_on_support:
            return Gaps()
        unbalanced = 0.0
        for component in self.components:
            missing = sum(force[rows] for rows in component.sides)
            unbalanced += squared(beyond(np.asarray(missing), noise))
        return Gaps(force=unbalanced)

    def violation(self, displacement: Array, force: Array, noise: float) -> Violation:
        """Fields for the violation of the law by W and F; parameters as `gaps`."""
        opening = None
        pressing = None
        if self.normal is not None:
            pressing = beyond(force[self.normal.component.above], noise)
            opening = beyond(self.normal.opening(displacement, force), 2.0 * noise)
        start = self.tangential.start
        before: Array | float = 0.0
        if start is not None:
            before = start[:, None]
        slider = self.tangential.slider(displacement, force)
        # Differences of two values have the noise of both.
        slip = beyond(np.diff(slider, axis=1, prepend=before), 2.0 * noise)
        return Violation(
            slip=slip,
            friction=force[self.tangent.above],
            bound=self.tangential.bound_after_slip(pressing, slip, opening),
            pressing=pressing,
            opening=opening,
        )

    def capacity(self, held: NDArray[np.bool_]) -> float:
        """Largest friction force without a normal force, of pairs not held, scaled.

        `held` is a mask of all rows, (n_rows,).
        """
        return float(self.tangential.bound.max(axis=1)[~held[self.tangent.above]].sum())

    def carried(self, force: Array) -> float:
        """Largest force on a pair if the contact may open; else 0.

        `force` is that of all rows, (n_rows, n_instants), scaled.
        """
        if not self.opens:
            return 0.0
        rows = [component.above for component in self.components]
        return max(float(np.abs(force[above]).max()) for above in rows)

    @property
    def is_moved(self) -> bool:
        """Check whether bodies overlap, or sliders are displaced, before any load."""
        if self.normal is not None and self.normal.gap.min(initial=0.0) < 0.0:
            return True
        start = self.tangential.start
        return start is not None and bool(start.any())
