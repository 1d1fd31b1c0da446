"""Friction of driven points: prescribed displacements determine their slip.

At a driven point only the sum of friction and reaction is determinate, and a method
that searches for both shares it out by its own parameters. While the point slips, its
friction is its bound against the slip. While it stands still, as at a clamp, its
friction per area is that of the nearest point that is free to slip, as far as its own
bound allows: so friction continues evenly up to the clamp of a body, and that of the
last half element is not missing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from solver.arrays import ROUNDING, Array, Indices
from solver.discrete.contacts import Contacts
from solver.laws import Component, Contact, Friction
from solver.laws.play import Play, follow


@dataclass(frozen=True, eq=False)
class DrivenFriction:
    """Friction of the driven points of one interface.

    Attributes
    ----------
    along
        Friction law of the driven points, one pair each; its component has the rows of
        these pairs.
    jump
        Tangential displacement over what is below, as it is prescribed, shape
        (n_points, n_instants), scaled.
    start
        Position of the sliders before the first instant, (n_points,), scaled.
    noise
        Largest growth of the jump that may be rounding, scaled.
    beside, share
        Index, in stacked contact forces, of the friction of the nearest point that is
        free to slip, (n_points,), and area of a point over the area of that point; 0
        if no point is free.
    tangential, normal
        Indices of the friction forces, and of the normal forces, in stacked contact
        forces, (n_points,); `normal` is None where the pressure is known.
    normal_rows, gap
        Normal rows of the first pairs, of one or both sides, (n_points,) each, and
        opening of the undeformed bodies, (n_points,), scaled, where the pressure is not
        known.
    """

    along: Friction
    jump: Array
    start: Array
    noise: float
    beside: Indices
    share: Array
    tangential: Indices
    normal: Indices | None = None
    normal_rows: tuple[Indices, ...] = ()
    gap: Array | None = None

    def force(self, forces: Array, displacement: Array) -> Array:
        """Friction force on the body above, shape (n_points, n_instants), scaled.

        `forces` are all contact forces, (n_forces, n_instants), `displacement` is W of
        all rows, (n_rows, n_instants), both scaled.
        """
        pressing = None
        if self.normal is not None:
            pressing = forces[self.normal]
        opening = self._opening(displacement)
        if self.along.compliance is not None:
            return self._on_springs(pressing, opening)
        slip = self._slip
        bound = self.along.bound_after_slip(pressing, slip, opening)
        # A clamped point has what its neighbour has per area, within its own bound.
        even = np.clip(self.share[:, None] * forces[self.beside], -bound, bound)
        return np.where(slip == 0.0, even, -bound * np.sign(slip))

    @cached_property
    def _slip(self) -> Array:
        """Growth of the jump up to each instant, (n_points, n_instants), scaled."""
        slip = np.diff(self.jump, axis=1, prepend=self.start[:, None])
        return np.where(np.abs(slip) > self.noise, slip, 0.0)

    def _opening(self, displacement: Array) -> Array | None:
        """Opening, (n_points, n_instants), scaled; None for laws without bonds."""
        if self.gap is None or not self.along.bound.any():
            return None
        jump = _difference([displacement[rows] for rows in self.normal_rows])
        return np.asarray(jump + self.gap[:, None])

    def _on_springs(self, pressing: Array | None, opening: Array | None) -> Array:
        """Friction force where springs in series are compressed, (n_points, n).

        Parameters and force are (n_points, n_instants), scaled.
        """
        along = self.along
        assert along.compliance is not None
        compliance = along.compliance[:, None]
        bound = along.bound_before_slip(pressing, opening)
        slack = compliance * np.broadcast_to(bound, self.jump.shape)
        if along.slip_factor is None:
            n_points, n_instants = self.jump.shape
            slider = Play(n_points, n_instants, self.start)(self.jump, slack)
        else:
            slider = follow(self.jump, slack, along.slip_factor)
        return np.asarray((slider - self.jump) / compliance)


def driven_contacts(
    contacts: Contacts,
    row_dofs: Indices,
    prescribed: tuple[Indices, Array],
    largest: float,
) -> list[DrivenFriction]:
    """Friction of driven points of all interfaces; parameters as `driven_friction`."""
    is_held = np.isin(row_dofs, prescribed[0])
    numbers = [np.zeros(0, dtype=np.intp)]
    for stacked in contacts.stacks:
        law = stacked.law
        pairs = np.logical_and.reduce([is_held[rows] for rows in law.tangent.sides])
        numbers.append(stacked.numbers[np.unique(law.interface_of_pairs[pairs])])
    found = list[DrivenFriction]()
    for number in np.sort(np.concatenate(numbers)):
        name = contacts.names[number]
        driven = driven_friction(
            contacts[name], contacts.forces[name], row_dofs, prescribed, largest
        )
        if driven is not None:
            found.append(driven)
    return found


def driven_friction(
    law: Contact,
    slices: tuple[slice, ...],
    row_dofs: Indices,
    prescribed: tuple[Indices, Array],
    largest: float,
) -> DrivenFriction | None:
    """Friction of the driven points of an interface; None without driven points.

    `slices` are the slices of its components in a stack of contact forces, `row_dofs`
    the degrees of freedom of all rows, (n_rows,), and `prescribed` those whose
    displacement is, (n,), with their values, (n, n_instants), scaled. `largest` is the
    largest displacement that any of these values is a difference of, scaled.
    """
    dofs, values = prescribed
    # The first pair of a point represents all of them.
    _, pairs = np.unique(law.points, return_index=True)
    sides = [row_dofs[rows[pairs]] for rows in law.tangent.sides]
    is_driven: NDArray[np.bool_] = np.all(
        [np.isin(side, dofs) for side in sides], axis=0
    )
    points = np.flatnonzero(is_driven)
    if not points.size:
        return None
    moved = [values[np.searchsorted(dofs, side[points])] for side in sides]
    start = np.zeros(len(points))
    if law.tangential.start is not None:
        start = law.mean_by_point(law.tangential.start)[points]
    nearest, share = _nearest_free(law, points)
    driven = DrivenFriction(
        along=_law_of_points(law, points, pairs[points]),
        jump=_difference(moved),
        start=start,
        noise=ROUNDING * largest,
        beside=slices[-1].start + nearest,
        share=share,
        tangential=slices[-1].start + points,
    )
    if law.normal is None:
        return driven
    normal_sides = law.normal.component.sides
    return replace(
        driven,
        normal=slices[0].start + points,
        normal_rows=tuple([rows[pairs[points]] for rows in normal_sides]),
        gap=law.mean_by_point(law.normal.gap)[points],
    )


def _difference(sides: list[Array]) -> Array:
    """Field above minus field below, (n_points, n_instants); or of the only side."""
    if len(sides) == 1:
        return sides[0]
    above, below = sides
    return np.asarray(above - below)


def _law_of_points(law: Contact, points: Indices, pairs: Indices) -> Friction:
    """Friction law of some points, of which each has one pair; (n_points,) both."""
    friction = law.tangential
    cap = None
    if friction.cap is not None:
        cap = law.by_point(friction.cap)[points]
    compliance = None
    if friction.compliance is not None:
        compliance = law.in_parallel(friction.compliance)[points]
    sides = [rows[pairs] for rows in law.tangent.sides]
    return replace(
        friction,
        component=Component(*sides),
        bound=law.by_point(friction.bound)[points],
        friction=law.mean_by_point(friction.friction)[points],
        cap=cap,
        compliance=compliance,
        start=None,
    )


def _nearest_free(law: Contact, points: Indices) -> tuple[Indices, Array]:
    """Nearest free point beside each driven one, and the ratio of their areas.

    Shape (n_points,) all; the ratio is 0 where no point is free.
    """
    free = np.setdiff1d(np.arange(len(law.positions)), points)
    if not free.size:
        return points, np.zeros(len(points))
    distances = np.abs(np.subtract.outer(law.positions[points], law.positions[free]))
    nearest = free[distances.argmin(axis=1)]
    areas = law.by_point(law.weights)
    return nearest, areas[points] / areas[nearest]
