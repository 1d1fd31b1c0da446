"""Friction of points whose slip prescribed displacements alone make.

At such a point only the sum of friction and reaction is determinate, and a method that
searches for both shares it out by its own parameters. While the point slips, its
friction is its bound against the slip. While it stands still, as at a clamp, it is per
area what the nearest point carries that is free to slip, as far as its own bound
allows: friction goes on evenly up to what holds a body, so that no half element of it
is missing there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from solver.arrays import ROUNDING, Array, Indices
from solver.laws import Component, Contact, Friction
from solver.laws.play import Play, follow


@dataclass(frozen=True, eq=False)
class DrivenFriction:
    """The friction of the driven points of one interface.

    Attributes
    ----------
    along
        Law of the driven points, a pair each; its component is that of all pairs.
    jump
        Tangential displacement over what is below, as it is prescribed, shape
        (n_points, n_instants), scaled.
    start
        Position of the sliders before the first instant, (n_points,), scaled.
    noise
        Growth of the jump that is but rounding, scaled.
    beside, share
        Place in a stack of contact forces of the friction of the nearest point that is
        free to slip, (n_points,), and area of a point over that one's; 0 without one.
    places, pressing
        Places in a stack of contact forces, (n_points,), of the friction forces and of
        the pressing ones; None for the latter where the pressure is known.
    normal_rows, gap
        Rows of the first pairs across, of one or both sides, and opening of the
        undeformed bodies, (n_points,), scaled, where the pressure is not known.
    """

    along: Friction
    jump: Array
    start: Array
    noise: float
    beside: Indices
    share: Array
    places: Indices
    pressing: Indices | None = None
    normal_rows: tuple[Indices, ...] = ()
    gap: Array | None = None

    def force(self, forces: Array, displacement: Array) -> Array:
        """Friction force on the body above, shape (n_points, n_instants), scaled.

        By all contact forces, (n_forces, n_instants), and W of all rows, (n_rows,
        n_instants), both scaled.
        """
        along = self.along
        slip = self._slip
        if self.pressing is None:
            pressing = None
        else:
            pressing = forces[self.pressing]
        opening = self._opening(displacement)
        if along.softness is not None:
            return self._on_springs(pressing, opening)
        bound = along.allowed(pressing, slip, opening)
        even = np.clip(self.share[:, None] * forces[self.beside], -bound, bound)
        return np.where(slip == 0.0, even, -bound * np.sign(slip))

    @cached_property
    def _slip(self) -> Array:
        """Growth of the jump from each instant to the next, as `jump`."""
        slip = np.diff(self.jump, axis=1, prepend=self.start[:, None])
        return np.where(np.abs(slip) > self.noise, slip, 0.0)

    def _opening(self, displacement: Array) -> Array | None:
        """Distance of the sides, as `jump`, where it may break a bond; else None."""
        if self.gap is None or not self.along.bound.any():
            return None
        above, *below = (displacement[rows] for rows in self.normal_rows)
        if below:
            jump = above - below[0]
        else:
            jump = above
        return np.asarray(jump + self.gap[:, None])

    def _on_springs(self, pressing: Array | None, opening: Array | None) -> Array:
        """Friction force where a spring is in series, which leaves no choice."""
        along = self.along
        assert along.softness is not None
        softness = along.softness[:, None]
        reach = softness * np.broadcast_to(
            along.without_slip(pressing, opening), self.jump.shape
        )
        if along.strength is None:
            n_points, n_instants = self.jump.shape
            slider = Play(n_points, n_instants, self.start)(self.jump, reach)
        else:
            slider = follow(self.jump, reach, along.strength)
        return np.asarray((slider - self.jump) / softness)


def driven_friction(
    law: Contact,
    places: tuple[slice, ...],
    row_dofs: Indices,
    prescribed: tuple[Indices, Array],
    largest: float,
) -> DrivenFriction | None:
    """The driven points of an interface; None where it has none.

    `places` are those of its components in a stack of contact forces, `row_dofs` the
    degrees of freedom of all rows, (n_rows,), and `prescribed` those whose displacement
    is, (n,), with their values, (n, n_instants), scaled. `largest` is the largest
    displacement that any of these values is a difference of, scaled.
    """
    dofs, values = prescribed
    _, pairs = np.unique(law.points, return_index=True)
    sides = [row_dofs[rows[pairs]] for rows in law.tangent.sides]
    is_driven: NDArray[np.bool_] = np.all([np.isin(own, dofs) for own in sides], axis=0)
    points = np.flatnonzero(is_driven)
    if not points.size:
        return None
    above, *below = (values[np.searchsorted(dofs, own[points])] for own in sides)
    own = law.tangential
    start = law.tangential.start
    nearest, share = _nearest_free(law, points)
    if own.cap is None:
        cap = None
    else:
        cap = law.by_point(own.cap)[points]
    if own.softness is None:
        softness = None
    else:
        softness = law.in_parallel(own.softness)[points]
    driven = DrivenFriction(
        along=replace(
            own,
            component=Component(*(rows[pairs[points]] for rows in law.tangent.sides)),
            bound=law.by_point(own.bound)[points],
            friction=law.mean_by_point(own.friction)[points],
            cap=cap,
            softness=softness,
            start=None,
        ),
        jump=above - below[0] if below else above,
        start=np.zeros(len(points))
        if start is None
        else law.mean_by_point(start)[points],
        noise=ROUNDING * largest,
        beside=places[-1].start + nearest,
        share=share,
        places=places[-1].start + points,
    )
    if law.normal is None:
        return driven
    return replace(
        driven,
        pressing=places[0].start + points,
        normal_rows=tuple(rows[pairs[points]] for rows in law.normal.component.sides),
        gap=law.mean_by_point(law.normal.gap)[points],
    )


def _nearest_free(law: Contact, points: Indices) -> tuple[Indices, Array]:
    """Nearest point beside each of the driven ones, and the ratio of their areas."""
    free = np.setdiff1d(np.arange(len(law.positions)), points)
    if not free.size:
        return points, np.zeros(len(points))
    away = np.abs(np.subtract.outer(law.positions[points], law.positions[free]))
    nearest = free[away.argmin(axis=1)]
    areas = law.by_point(law.weights)
    return nearest, areas[points] / areas[nearest]
