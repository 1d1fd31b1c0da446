"""Interfaces of one law as arrays: slip and contact status of their points."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import RESIDUE, Array, Indices
from solver.laws import OPEN, Contact

NO_SLIP = 1e-9
"""Largest slip of a point that counts as stuck, over the largest displacement."""


class Stacked(NamedTuple):
    """A law of contact, with the indices of its interfaces in the stacked fields.

    Attributes
    ----------
    law
        Law of one interface, or of several.
    numbers
        Indices of its interfaces among all those with friction, shape (n_interfaces,).
    points
        Indices of its points among those of all, shape (n_points,).
    forces
        Indices of the forces of its points among all contact forces, component by
        component, (n_points,) each.
    """

    law: Contact
    numbers: Indices
    points: Indices
    forces: tuple[Indices, ...]


class ContactGroup:
    """Interfaces of one law as concatenated arrays: a wall of bricks has thousands.

    Attributes
    ----------
    law
        Law of all of them; without macro basis if they are several.
    numbers
        Indices of the interfaces among all those with friction, shape (n_interfaces,).
    points
        Numbers of their points among those of all interfaces with friction, shape
        (n_points,).
    """

    def __init__(self, stacks: Sequence[Stacked]) -> None:
        if len(stacks) == 1:
            self.law = stacks[0].law
        else:
            self.law = Contact.concatenated([stack.law for stack in stacks])
        self.numbers: Indices = np.concatenate([stack.numbers for stack in stacks])
        self.points: Indices = np.concatenate([stack.points for stack in stacks])
        self._sizes = np.concatenate([stack.law.sizes for stack in stacks])

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
            largest_force = float(np.abs(force).max())
            largest = max(float(np.abs(displacement).max()), largest_force)
        else:
            largest = self._largest_displacement(displacement)
        threshold = np.maximum(NO_SLIP * largest, still)
        of_interfaces = np.broadcast_to(threshold, len(self.numbers))
        status = np.sign(slip).astype(np.int8)
        status[np.abs(slip) <= of_interfaces[self.interfaces, None]] = 0
        if law.normal is not None and force is not None:
            normal = law.by_point(force[law.normal.component.above])
            tangential = law.by_point(np.abs(force[law.tangent.above]))
            least = RESIDUE * largest_force
            status[~carries(normal, tangential, least)] = OPEN
        return status

    def _largest_displacement(self, displacement: Array) -> Array:
        """Largest tangential displacement per interface, (n_interfaces,), scaled."""
        largest = np.zeros(len(self.numbers))
        interfaces = self.interfaces[self.law.points]
        for rows in self.law.tangent.sides:
            moved = np.abs(displacement[rows]).max(axis=1)
            np.maximum.at(largest, interfaces, moved)
        return largest


def carries(
    normal: Array, tangential: Array, least: Array | float
) -> NDArray[np.bool_]:
    """Mask of points of contact that carry more than rounding errors.

    Where bodies come apart, or begin to touch, rounding presses at some points. A bond
    that nothing presses carries friction. Pressing and friction forces have the same
    shape, (n_points, n_instants); forces up to `least`, (n_points, 1) or one for all,
    may be rounding.
    """
    return np.asarray((normal > least) | ((normal > 0.0) & (tangential > least)))
