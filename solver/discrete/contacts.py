"""Interfaces with friction: alike ones treated as one, and what each shows, point by point."""

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
"""Slip, as a share of the largest displacement, up to which a point counts as stuck."""


class ContactGroup:
    """Interfaces with one law, put one after the other: a wall of bricks has thousands.

    The `law` is that of all of them, without macro basis if they are several. They have
    `numbers` among all interfaces with friction, ascending, shape (n_interfaces,), and
    their points have places among those of all, `points`, shape (n_points,).
    """

    def __init__(self, laws: list[Contact], numbers: list[int]) -> None:
        own = [laws[number] for number in numbers]
        firsts = np.cumsum([0, *(len(law.positions) for law in laws)])
        if len(own) == 1:
            self.law = own[0]
        else:
            self.law = Contact.concatenated(own)
        self.numbers: Indices = np.array(numbers)
        self._sizes = [len(law.positions) for law in own]
        self.points: Indices = np.concatenate(
            [np.arange(firsts[number], firsts[number + 1]) for number in numbers]
        )

    @cached_property
    def interfaces(self) -> Indices:
        """Place in `numbers` of the interface of every point, shape (n_points,)."""
        return np.repeat(np.arange(len(self.numbers)), self._sizes)

    def largest(self, values: Array) -> Array:
        """Largest value at any point and instant of each interface, shape (n_interfaces,)."""
        starts = np.cumsum([0, *self._sizes[:-1]])
        return np.asarray(np.maximum.reduceat(values.max(axis=1), starts))

    def sums(self, values: Array) -> Array:
        """Sums of values of the pairs, shape (n_pairs,), over each interface, (n_interfaces,)."""
        pairs = self.interfaces[self.law.points]
        return np.asarray(np.bincount(pairs, values, len(self.numbers)), dtype=float)

    def slip(self, displacement: Array, force: Array | None) -> Array:
        """Slip of every point at every instant, (n_points, n_instants): the sum of its pairs'.

        `displacement` and `force` are those of all rows, shape (n_rows, n_instants),
        scaled.
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

        A point that is stuck, or just at its bound, may move by rounding, which is not
        called slip.

        From W^ and F^ of all rows, (n_rows, n_instants), F^ where the status shows in
        forces, and the slip if it is known. `still` is slip up to which a point counts
        as stuck, beside what is rounding, scaled: of each interface, (n_interfaces,),
        or of all.
        """
        law = self.law
        if slip is None:
            slip = self.slip(displacement, force)
        else:
            slip = slip
        largest: Array | float
        if law.normal is not None and force is not None:
            # A stuck contact moves by rounding alone; but a scaled structure's
            # compliance is 1.
            largest = max(float(np.abs(displacement).max()), float(np.abs(force).max()))
        else:
            largest = np.zeros(len(self.numbers))
            for rows in law.tangent.sides:
                moved = np.abs(displacement[rows]).max(axis=1)
                np.maximum.at(largest, self.interfaces[law.points], moved)
        least = np.broadcast_to(np.maximum(NO_SLIP * largest, still), len(self.numbers))
        status = np.sign(slip).astype(np.int8)
        status[np.abs(slip) <= least[self.interfaces, None]] = 0
        if law.normal is not None and force is not None:
            status[law.by_point(force[law.normal.component.above]) <= 0.0] = OPEN
        return status


@dataclass(frozen=True, eq=False)
class ContactFields:
    """Fields of one interface on its points, SI, shape (n_points, n_instants) each.

    Attributes
    ----------
    normal_force, tangential_force
        Pressing force on the body above, positive, N, None where the bound is known;
        and friction.
    opening
        Distance of the two sides, m; None where the bound is known.
    slip
        Tangential displacement of the body above over what is below, m; it says how far
        a point has come, so its changes in time are the slip. That below may be the
        image of the body.
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
    """Fields of one interface, out of those of a whole structure.

    `force` is stacked as `Problem.sum_of_contact` says, (n_forces, n_instants), N; W is
    that of all rows, `displacement`, scaled, (n_rows, n_instants).
    """
    law = problem.rubbing[name]
    places = problem.contact_places[name]
    scale = problem.scales.displacement
    jumps = [
        law.mean_by_point(one.jump(displacement)) * scale for one in law.components
    ]
    slip = law.slip_ratio * jumps[-1]
    if law.normal is None:
        return ContactFields(None, force[places[0]], None, slip, status)
    gap = law.mean_by_point(law.normal.gap[:, None]) * scale
    return ContactFields(
        force[places[0]], force[places[1]], jumps[0] + gap, slip, status
    )
