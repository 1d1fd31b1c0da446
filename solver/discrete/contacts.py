"""Interfaces with friction: the order of their stacked fields, and their fields."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.arrays import Array, Indices, as_slice, in_rows, ones_at
from solver.discrete.contact_groups import ContactGroup, Stacked
from solver.laws import Contact


class Contacts(Mapping[str, Contact]):
    """Interfaces with friction by name: the law of each, made when it is asked for.

    Points of all interfaces are stacked one interface after the other. So are contact
    forces, those on the body above: of each interface all normal forces, where it may
    open, and then all friction forces.

    Attributes
    ----------
    laws
        Laws by their names in `Problem.interfaces`; one may hold on many interfaces.
    names
        Names of all interfaces, in the order in which they are stacked.
    """

    def __init__(self, laws: Mapping[str, Contact], order: Sequence[str] = ()) -> None:
        self.laws = laws
        self._owners = dict[str, tuple[Contact, int]]()
        for key, law in laws.items():
            for number, name in enumerate(law.names or (key,)):
                self._owners[name] = (law, number)
        self.names = tuple(order or self._owners)
        self._made = dict[str, Contact]()

    def __getitem__(self, name: str) -> Contact:
        """Law of one interface."""
        if name not in self._made:
            law, number = self._owners[name]
            self._made[name] = law.interface(number)
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        """Names of all interfaces, in the order in which they are stacked."""
        return iter(self.names)

    def __len__(self) -> int:
        """Number of interfaces."""
        return len(self.names)

    def __contains__(self, name: object) -> bool:
        """Check whether an interface has this name."""
        return name in self._owners

    @property
    def names_of_laws(self) -> list[str]:
        """Names of all interfaces, law by law."""
        names = list[str]()
        for key, law in self.laws.items():
            names.extend(law.names or (key,))
        return names

    @cached_property
    def number_of(self) -> dict[str, int]:
        """Index of each interface in the order in which they are stacked."""
        return {name: number for number, name in enumerate(self.names)}

    @cached_property
    def stacks(self) -> list[Stacked]:
        """Laws, with the indices of their interfaces, points and forces among all."""
        first_points = np.cumsum(self.sizes) - self.sizes
        n_forces = self.sizes * self._n_components
        first_forces = np.cumsum(n_forces) - n_forces
        stacks = []
        for key, law in self.laws.items():
            numbers = np.array([self.number_of[name] for name in law.names or (key,)])
            sizes = law.sizes
            # Indices of the points of each interface within it.
            within = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
            firsts = np.repeat(first_forces[numbers], sizes) + within
            steps = np.repeat(sizes, sizes)
            components = range(len(law.components))
            stacked = Stacked(
                law=law,
                numbers=numbers,
                points=np.repeat(first_points[numbers], sizes) + within,
                forces=tuple([firsts + number * steps for number in components]),
            )
            stacks.append(stacked)
        return stacks

    @cached_property
    def sizes(self) -> Indices:
        """Number of points of each interface, shape (n_interfaces,)."""
        owners = [self._owners[name] for name in self.names]
        sizes = [law.sizes[number] for law, number in owners]
        return np.array(sizes, dtype=np.intp)

    @cached_property
    def _n_components(self) -> Indices:
        """Number of components of each interface, shape (n_interfaces,)."""
        owners = [self._owners[name] for name in self.names]
        return np.array([len(law.components) for law, _ in owners], dtype=np.intp)

    @property
    def n_points(self) -> int:
        """Number of points of all interfaces."""
        return int(self.sizes.sum())

    @property
    def n_forces(self) -> int:
        """Number of contact forces of all interfaces."""
        return int(self.sizes @ self._n_components)

    @cached_property
    def points(self) -> dict[str, slice]:
        """Range of the points of each interface among those of all, by name."""
        ends = np.cumsum([0, *self.sizes]).tolist()
        ranges = [slice(first, last) for first, last in pairwise(ends)]
        return dict(zip(self.names, ranges, strict=True))

    @cached_property
    def forces(self) -> dict[str, tuple[slice, ...]]:
        """Ranges of each interface's components in stacked contact forces, by name."""
        ranges = dict[str, tuple[slice, ...]]()
        first = 0
        sizes = self.sizes.tolist()
        counts = self._n_components.tolist()
        for name, size, count in zip(self.names, sizes, counts, strict=True):
            last = first + size * count
            starts = range(first, last, size)
            ranges[name] = tuple([slice(start, start + size) for start in starts])
            first = last
        return ranges

    @cached_property
    def groups(self) -> list[ContactGroup]:
        """Groups of interfaces that have the same kind of law."""
        alike = dict[Hashable, list[Stacked]]()
        for number, stacked in enumerate(self.stacks):
            law = stacked.law
            # A user's law may differ from others in more than its fields: it is a group
            # of its own.
            key = number if law.incremental_form() is None else law.kind
            alike.setdefault(key, []).append(stacked)
        return [ContactGroup(stacks) for stacks in alike.values()]

    @cached_property
    def surfaces(self) -> list[str]:
        """Names of the interfaces that are surfaces, not springs."""
        return [name for name in self.names if not self._owners[name][0].is_spring]

    @cached_property
    def on_surfaces(self) -> NDArray[np.bool_]:
        """Mask of contact points that are on surfaces, shape (n_points,)."""
        is_surface = np.ones(self.n_points, dtype=bool)
        for stacked in self.stacks:
            is_surface[stacked.points] = not stacked.law.is_spring
        return is_surface

    @cached_property
    def copies(self) -> Array:
        """Number of points for which each point stands, shape (n_points,).

        It is 1 but where a wire represents its layer.
        """
        copies = np.ones(self.n_points)
        for stacked in self.stacks:
            copies[stacked.points] = stacked.law.copies
        return copies

    def sum_of_rows(self, n_rows: int) -> sparse.csr_array:
        """Sum over the rows of each point and component, shape (n_forces, n_rows)."""
        forces = [np.zeros(0, dtype=np.intp)]
        rows = [np.zeros(0, dtype=np.intp)]
        for law, _, _, of_components in self.stacks:
            for numbers, component in zip(of_components, law.components, strict=True):
                forces.append(numbers[law.points])
                rows.append(component.above)
        shape = self.n_forces, n_rows
        return ones_at(np.concatenate(forces), np.concatenate(rows), shape)

    def of_points(self, fields: Sequence[NDArray[Any]]) -> NDArray[Any]:
        """Stack fields of the points of each of `stacks`, (n_points, ...).

        Fields that do not change with time have a single column; so has the result if
        none of them changes.
        """
        numbers = np.concatenate([stacked.points for stacked in self.stacks])
        return in_rows(fields)[np.argsort(numbers)]

    def fields(
        self, force: Array, displacement: Array, status: NDArray[np.int8], scale: float
    ) -> dict[str, ContactFields]:
        """Fields of each interface by name, from those of the whole structure.

        `force` has all contact forces, (n_forces, n_instants), N; `displacement` is W
        of all rows, (n_rows, n_instants), scaled, and `scale` its unit, m; `status` is
        that of all points, (n_points, n_instants).
        """
        fields = dict[str, ContactFields]()
        for stacked in self.stacks:
            law = stacked.law
            whole = _fields_of(stacked, force, displacement, status, scale)
            for number, (points, _) in zip(stacked.numbers, law.ranges, strict=True):
                fields[self.names[number]] = whole.at(points)
        return fields


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

    def at(self, points: slice) -> ContactFields:
        """Fields restricted to a range of the points."""
        if self.normal_force is None or self.opening is None:
            normal_force = None
            opening = None
        else:
            normal_force = self.normal_force[points]
            opening = self.opening[points]
        return ContactFields(
            normal_force=normal_force,
            tangential_force=self.tangential_force[points],
            opening=opening,
            slip=self.slip[points],
            status=self.status[points],
        )


def _fields_of(
    stacked: Stacked,
    force: Array,
    displacement: Array,
    status: NDArray[np.int8],
    scale: float,
) -> ContactFields:
    """Fields of all interfaces of one law, as `Contacts.fields`."""
    law, _, points, forces = stacked
    jumps = [
        law.mean_by_point(component.jump(displacement)) * scale
        for component in law.components
    ]
    normal_force = None
    opening = None
    if law.normal is not None:
        gap = law.mean_by_point(law.normal.gap[:, None]) * scale
        normal_force = force[as_slice(forces[0])]
        opening = jumps[0] + gap
    return ContactFields(
        normal_force=normal_force,
        tangential_force=force[as_slice(forces[-1])],
        opening=opening,
        slip=law.slip_ratio * jumps[-1],
        status=status[as_slice(points)],
    )
