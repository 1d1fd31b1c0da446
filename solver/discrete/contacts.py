"""Interfaces with friction: groups of one law, and the fields of one interface."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, Indices
from solver.laws import OPEN, Contact

if TYPE_CHECKING:
    from solver.discrete.problem import Problem

NO_SLIP = 1e-9
"""Largest slip of a point that counts as stuck, over the largest displacement."""


class ContactGroup:
    """Interfaces of one law, concatenated, as a wall of bricks has thousands.

    Attributes
    ----------
    law
        Law of all of them; without macro basis if they are several.
    numbers
        Numbers of the interfaces among all those with friction, ascending, shape
        (n_interfaces,).
    points
        Numbers of their points among those of all interfaces with friction, shape
        (n_points,).
    """

    def __init__(self, laws: list[Contact], numbers: list[int]) -> None:
        sizes = [len(law.positions) for law in laws]
        firsts = np.cumsum([0, *sizes])
        if len(numbers) == 1:
            self.law = laws[numbers[0]]
        else:
            self.law = Contact.concatenated([laws[number] for number in numbers])
        self.numbers: Indices = np.array(numbers)
        self._sizes = [sizes[number] for number in numbers]
        self.points: Indices = np.concatenate(
            [np.arange(firsts[number], firsts[number + 1]) for number in numbers]
        )

    @cached_property
    def interfaces(self) -> Indices:
        """Interface of every point, as its index in `numbers`, shape (n_points,)."""
        return np.repeat(np.arange(len(self.numbers)), self._sizes)

    def largest(self, values: Array) -> Array:
        """Largest of values, (n_points, n_instants), per interface, (n_interfaces,)."""
        starts = np.cumsum([0, *self._sizes[:-1]])
        return np.asarray(np.maximum.reduceat(values.max(axis=1), starts))

    def sums(self, values: Array) -> Array:
        """Sums of values of pairs, (n_pairs,), per interface, (n_interfaces,)."""
        pairs = self.interfaces[self.law.points]
        return np.asarray(np.bincount(pairs, values, len(self.numbers)), dtype=float)

    def slip(self, displacement: Array, force: Array | None) -> Array:
        """Slip of every point up to each instant, (n_points, n_instants), scaled.

        Increments; that of a point is the sum over its pairs. `displacement` and
        `force` are those of all rows, shape (n_rows, n_instants), scaled.
        """
        law = self.law
        start = self.law.tangential.start
        before: Array | float = 0.0
        if start is not None:
            before = law.by_point(start)[:, None]
        moved = law.by_point(law.tangential.slider(displacement, force))
        return np.diff(moved, axis=1, prepend=before)

    def status(
        self,
        displacement: Array,
        force: Array | None = None,
        *,
        slip: Array | None = None,
        still: Array | float = 0.0,
    ) -> NDArray[np.int8]:
        """Contact status of a local stage, shape (n_points, n_instants).

        A point that is stuck, or just at its bound, may move by rounding, which does
        not count as slip.

        `displacement` and `force` are W^ and F^ of all rows, (n_rows, n_instants),
        scaled; the force tells where contact is open. `slip`, (n_points, n_instants),
        is taken as it is if given. `still` is the largest slip, scaled, of a point that
        counts as stuck, beside rounding: of each interface, (n_interfaces,), or one.
        """
        law = self.law
        if slip is None:
            slip = self.slip(displacement, force)
        largest: Array | float
        if law.normal is not None and force is not None:
            # A stuck contact moves by rounding alone; but a scaled structure's
            # compliance is 1.
            largest = max(float(np.abs(displacement).max()), float(np.abs(force).max()))
        else:
            largest = self._largest_displacement(displacement)
        threshold = np.maximum(NO_SLIP * largest, still)
        of_interfaces = np.broadcast_to(threshold, len(self.numbers))
        status = np.sign(slip).astype(np.int8)
        status[np.abs(slip) <= of_interfaces[self.interfaces, None]] = 0
        if law.normal is not None and force is not None:
            status[law.by_point(force[law.normal.component.above]) <= 0.0] = OPEN
        return status

    def _largest_displacement(self, displacement: Array) -> Array:
        """Largest tangential displacement per interface, (n_interfaces,), scaled."""
        largest = np.zeros(len(self.numbers))
        interfaces = self.interfaces[self.law.points]
        for rows in self.law.tangent.sides:
            moved = np.abs(displacement[rows]).max(axis=1)
            np.maximum.at(largest, interfaces, moved)
        return largest


@dataclass(frozen=True, eq=False)
class ContactFields:
    """Fields of one interface on its points, SI, shape (n_points, n_instants) each.

    Attributes
    ----------
    normal_force
        Pressing force on the body above, positive, N; None where the bound is known.
    tangential_force
        Friction force on the body above, N.
    opening
        Distance of the two sides, m; None where the bound is known.
    slip
        Tangential displacement of the body above relative to the body, its image, or
        the support below, m: its changes in time are the slip increments.
    status
        -1 is slip backward, 0 stick, +1 slip forward, `OPEN` without contact.
    """

    normal_force: Array | None
    tangential_force: Array
    opening: Array | None
    slip: Array
    status: NDArray[np.int8]


def contact_fields(
    problem: Problem,
    name: str,
    force: Array,
    displacement: Array,
    status: NDArray[np.int8],
) -> ContactFields:
    """Fields of one interface, from those of the whole structure.

    `force` has all contact forces as `Problem.sum_of_contact` stacks them, (n_forces,
    n_instants), N; `displacement` is W of all rows, (n_rows, n_instants), scaled;
    `status` is that of the interface's points, (n_points, n_instants).
    """
    law = problem.rubbing[name]
    places = problem.contact_slices[name]
    scale = problem.scales.displacement
    jumps = [
        law.mean_by_point(component.jump(displacement)) * scale
        for component in law.components
    ]
    slip = law.slip_ratio * jumps[-1]
    if law.normal is None:
        return ContactFields(
            normal_force=None,
            tangential_force=force[places[0]],
            opening=None,
            slip=slip,
            status=status,
        )
    gap = law.mean_by_point(law.normal.gap[:, None]) * scale
    return ContactFields(
        normal_force=force[places[0]],
        tangential_force=force[places[1]],
        opening=jumps[0] + gap,
        slip=slip,
        status=status,
    )
