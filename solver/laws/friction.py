"""The friction law: a spring in series with a slider (MATHEMATICS.md, 8 and 14).

Asperities, or the part of a joint that no mesh shows, deform before they slip: along
the interface a spring k_t is in series with a slider, whose friction force is at most

    b = g(s) min(r + mu N, cap),

with the known part r, the pressing force N, and a factor g of the slip s that the
slider has accumulated, g(0) = 1. The slider stands at p = w + f / k_t, where w is the
tangential jump and f the friction force on the body above. Along the search direction
it is the play operator (problem 2.1 of the paper), whose slack is longer by the bound
over k_t. Coulomb's friction is mu alone, Jenkins' element has k_t, friction that
hardens or softens has g; a bond has cohesion in r.

Where contact opens the cohesion of a pair is gone for good: a brittle bond.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.checks import NON_NEGATIVE, InstanceOf, Number, Numbers, check
from solver.laws.interface import Component
from solver.laws.play import SlipFactor
from solver.refusal import RefusedError

OPENED = 1e-9
"""Largest opening of an intact bond, as a share of the largest opening."""


@dataclass(frozen=True)
class FrictionLaw:
    """Parameters of the friction law besides mu and pressure; default: Coulomb's law.

    "Area" is the tributary length along a rod, in m, and the area of a metre of
    thickness in the plane, in m^2.

    Attributes
    ----------
    stiffness
        k_t per area, N/m over m or m^2; infinite without a spring.
    normal_stiffness
        k_n per area across the interface, where contact may open; infinite likewise.
    cohesion
        Friction force per area without pressure, N/m or Pa.
    cap
        Largest friction force per area, before slip; N/m or Pa.
    slip_factor
        Factor on the bound over accumulated slip; None where slip does not change it.

    Raises
    ------
    RefusedError
        For stiffnesses or a cap that are not above zero, or a cohesion below zero.
    """

    stiffness: float = np.inf
    normal_stiffness: float = np.inf
    cohesion: float = 0.0
    cap: float = np.inf
    slip_factor: SlipFactor | None = None

    def __post_init__(self) -> None:
        above = Number(0.0, above=True, endless=True)
        check(
            self,
            stiffness=above,
            normal_stiffness=above,
            cohesion=NON_NEGATIVE,
            cap=above,
            slip_factor=InstanceOf(SlipFactor),
        )

    def at(
        self,
        component: Component,
        weights: Array,
        scales: tuple[float, float],
        *,
        known: Array | None = None,
        friction: Array | None = None,
    ) -> Friction:
        """Friction at the pairs of an interface.

        `component` has their rows, `weights` their tributary areas, (n_pairs,), m or
        m^2. `scales` are the units of length, m, and of force, N. `known` is the
        friction force that known pressure makes, scaled, (n_pairs, n_instants) or
        (n_pairs, 1);
        `friction` is mu of each pair, (n_pairs,), where pressure is not known.
        """
        length, force = scales
        if known is None:
            bound = np.zeros((len(weights), 1))
        else:
            bound = known.reshape(len(known), -1)
        if self.cohesion > 0.0:
            bound = bound + (self.cohesion / force * weights)[:, None]
        if np.isinf(self.cap):
            cap = None
        else:
            cap = self.cap / force * weights
        if cap is not None:
            # A known bound is cut once and for all; only a pressing force needs the cap
            # later.
            bound = np.minimum(bound, cap[:, None])
        slip_factor = self.slip_factor
        if slip_factor is not None:
            # Fields of a run are scaled, so the table is, too.
            slips = tuple(slip / length for slip in slip_factor.slips)
            slip_factor = SlipFactor(slips, slip_factor.factors)
        if friction is None:
            friction = np.zeros(len(weights))
            cap = None
        return Friction(
            component=component,
            bound=bound,
            friction=friction,
            cap=cap,
            compliance=compliance_of(self.stiffness, weights, scales),
            slip_factor=slip_factor,
        )

    def of_one_side(self) -> FrictionLaw:
        """Law of a body on its mirror image, which moves the opposite way.

        The body moves by half of the slip, so that over its own displacement the spring
        is twice as stiff, and the factor changes after half the slip.
        """
        slip_factor = self.slip_factor
        if slip_factor is not None:
            slips = tuple(0.5 * slip for slip in slip_factor.slips)
            slip_factor = SlipFactor(slips, slip_factor.factors)
        return replace(self, stiffness=2.0 * self.stiffness, slip_factor=slip_factor)

    def bound_before_slip(self, rubbed: Array, size: float = 1.0) -> Array:
        """Friction bound before any slip, of the shape of mu N.

        Both are forces, N, on an area `size`, m or m^2, or per area with size 1.
        """
        return np.asarray(np.minimum(rubbed + self.cohesion * size, self.cap * size))

    @property
    def is_by_pressure_alone(self) -> bool:
        """Check whether the bound is mu N, whatever has slipped."""
        is_unbounded = np.isinf(self.cap)
        has_no_bond = self.cohesion == 0.0
        return bool(is_unbounded and has_no_bond and self.slip_factor is None)

    @property
    def largest_factor(self) -> float:
        """Largest factor on the bound at any slip."""
        if self.slip_factor is None:
            return 1.0
        return max(self.slip_factor.factors)


def compliance_of(
    stiffness: float, weights: Array, scales: tuple[float, float]
) -> Array | None:
    """Compliance of pairs, (n_pairs,), scaled; None for infinite stiffness.

    `stiffness` is per area, `weights` are the areas of the pairs, (n_pairs,), m or m^2,
    `scales` the units of length, m, and of force, N.
    """
    length, force = scales
    if np.isinf(stiffness):
        return None
    return force / (length * stiffness * weights)


@dataclass(frozen=True, kw_only=True)
class Friction:
    """Friction law at the pairs of an interface.

    Attributes
    ----------
    component
        Rows of the pairs.
    bound
        r, the friction force of each pair without pressing, non-negative, scaled: shape
        (n_pairs, n_instants), or (n_pairs, 1) where it is constant.
    friction
        Coefficient mu of each pair, shape (n_pairs,), non-negative; 0 where the
        pressure is known.
    cap
        Largest friction force before slip, (n_pairs,), scaled; None if there is none.
    compliance
        1 / k_t of each pair, (n_pairs,), scaled; None if there is none.
    slip_factor
        Factor over accumulated slip, scaled; None where slip does not change the bound.
    start
        Position of every slider before the first instant, (n_pairs,), scaled; None is
        zero.
    """

    component: Component
    bound: Array
    friction: Array
    cap: Array | None = None
    compliance: Array | None = None
    slip_factor: SlipFactor | None = None
    start: Array | None = None

    def __post_init__(self) -> None:
        size = len(self.component.above)
        positive = Numbers(((size,),), low=0.0, above=True)
        check(
            self,
            bound=Numbers(((size, None),), low=0.0),
            friction=Numbers(((size,),), low=0.0),
            cap=Numbers(((size,),), low=0.0),
            compliance=positive,
            slip_factor=InstanceOf(SlipFactor),
            start=Numbers(((size,),)),
        )

    @property
    def has_friction(self) -> bool:
        """Check whether there is friction at any pair."""
        return bool(self.bound.any() or self.friction.any())

    def slider(self, displacement: Array, force: Array | None) -> Array:
        """Position of the slider of every pair, shape (n_pairs, n_instants), scaled.

        From W and F of all rows, (n_rows, n_instants); None for F leaves the spring
        out.
        """
        jump = self.component.jump(displacement)
        if self.compliance is None or force is None:
            return jump
        return np.asarray(jump + self.compliance[:, None] * force[self.component.above])

    def with_start(self, start: Array) -> Friction:
        """The law with initial positions of its sliders, (n_pairs,), scaled.

        Raises
        ------
        RefusedError
            If the law remembers more than these positions.
        """
        # Accumulated slip, and bonds that broke, are not told by the sliders.
        if self.slip_factor is not None or (self.bound.any() and self.friction.any()):
            kind = "general"
            if self.slip_factor is not None:
                kind = "slip-dependent"
            raise RefusedError(
                "friction_law",
                kind,
                "a law that remembers nothing but where its sliders stand",
                "solve the whole interval at once, or take Coulomb's friction",
            )
        return replace(self, start=start)

    def bound_before_slip(
        self, pressing: Array | None, opening: Array | None = None
    ) -> Array:
        """Friction bound before any slip, (n_pairs, n_instants), scaled.

        With a known pressure it has the shape of the bound. `pressing` is the pressing
        force, None where the pressure is known, `opening` the distance of the sides
        where it may break a bond; both (n_pairs, n_instants), scaled.
        """
        bound = self.bound
        if pressing is not None:
            if opening is not None and bound.any():
                bound = bound * is_intact(opening, pressing)
            bound = bound + self.friction[:, None] * np.maximum(pressing, 0.0)
        if self.cap is not None:
            bound = np.minimum(bound, self.cap[:, None])
        return bound

    def bound_after_slip(
        self, pressing: Array | None, slip: Array, opening: Array | None = None
    ) -> Array:
        """Friction bound after increments of slip, (n_pairs, n_instants), scaled."""
        bound = np.broadcast_to(self.bound_before_slip(pressing, opening), slip.shape)
        if self.slip_factor is None:
            return bound
        return np.asarray(bound * self.slip_factor(np.cumsum(np.abs(slip), axis=1)))

    @property
    def largest_bound(self) -> Array:
        """Largest known part of the bound over all slips, of the shape of the bound."""
        if self.slip_factor is None:
            return self.bound
        return self.bound * max(self.slip_factor.factors)

    @property
    def steepest_fall(self) -> Array:
        """Largest fall of a known bound per slip, shape (n_pairs,), scaled."""
        if self.slip_factor is None:
            fall = 0.0
        else:
            fall = -float(self.slip_factor.slopes.min())
        return np.asarray(self.bound.max(axis=1) * fall)

    @property
    def softens(self) -> bool:
        """Check whether the bound falls with slip anywhere."""
        return self.slip_factor is not None and bool(
            self.slip_factor.slopes.min() < 0.0
        )

    def during(self, instants: slice) -> Friction:
        """The law restricted to a range of instants."""
        if self.bound.shape[1] == 1:
            return self
        return replace(self, bound=self.bound[:, instants])


def is_intact(opening: Array, pressing: Array) -> Array:
    """Flags of bonds: 1 while intact, 0 from the first opening on.

    Opening, pressing force, scaled, and result are (n_pairs, n_instants).
    """
    # Where both sides press, the opening is zero up to rounding.
    noise = OPENED * float(np.abs(opening).max(initial=0.0))
    is_closed = (opening <= noise) | (pressing > 0.0)
    return np.asarray(np.logical_and.accumulate(is_closed, axis=1), dtype=float)
