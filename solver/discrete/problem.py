"""The discrete problem: matrices, traces, laws and macro bases; no options and no state.

Everything here is scaled (see `Scales`). A boundary row is one displacement component of one
interface point as one substructure sees it; an interface owns rows, and so does a substructure.
Fields on the boundary have shape (n_rows, n_instants), and those of one instant are contiguous in
memory (Fortran order), because the friction law walks through time.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.arrays import Array, Indices, as_slice
from solver.discrete.contacts import ContactGroup
from solver.discrete.driven_friction import DrivenFriction, driven_friction
from solver.discrete.drives import Drive
from solver.discrete.substructure import Substructure
from solver.laws import Contact, Dirichlet, Interface, Neumann, Perfect

if TYPE_CHECKING:
    from solver.discrete.plane_parts import Inside


@dataclass(frozen=True)
class Scales:
    """One scaled unit of each, in m, N and s, so that no method sees the size of a pascal."""

    displacement: float
    force: float
    time: float


@dataclass(frozen=True)
class Problem:
    """A structure as an assembly of substructures and interfaces (paper, section 2).

    Attributes
    ----------
    interfaces
        All interfaces by name; together they own every boundary row once.
    positions
        Coordinates of the degrees of freedom of the whole structure, in m: shape (n_dofs,) along a
        rod, (n_dofs, 2) in the plane.
    instants
        Shape (n_instants,), in s.
    inside
        What the degrees of freedom do not show, where substructures are condensed; else None.
    rest
        Displacement that the method may start from, scaled, shape (n_dofs, n_instants): that of a
        body which falls onto its support as if it were rigid. None is no displacement.
    carried
        Displacement of the support that rods lie on, scaled, shape (n_dofs, n_instants), where it
        moves: all displacements of the problem are seen from it.
    has_short_joints
        Whether upright joints of bodies have no pair at their ends, so that these bodies carry
        less than rigid ones.
    drives
        Loads and motions by the settings that give them, for words alone; none of a problem that
        is no scene's.
    """

    substructures: tuple[Substructure, ...]
    interfaces: Mapping[str, Interface]
    positions: Array
    instants: Array
    scales: Scales
    inside: Inside | None = None
    rest: Array | None = None
    carried: Array | None = None
    has_short_joints: bool = False
    drives: tuple[Drive, ...] = ()

    def at_rest(self, displacement: Array) -> Array:
        """Displacements as who stands beside sees them, (n_dofs, n_instants), m."""
        if self.carried is None:
            return displacement
        return displacement + self.carried * self.scales.displacement

    @cached_property
    def n_rows(self) -> int:
        """Number of boundary rows."""
        return sum(len(part.rows) for part in self.substructures)

    @property
    def n_instants(self) -> int:
        """Number of instants."""
        return len(self.instants)

    @property
    def n_dofs(self) -> int:
        """Number of degrees of freedom of the whole structure."""
        return len(self.positions)

    @cached_property
    def direction(self) -> Array:
        """The paper's search direction k of every row, shape (n_rows,)."""
        k = np.empty(self.n_rows)
        for part in self.substructures:
            k[part.rows] = part.elasticity.direction
        return k

    @cached_property
    def row_dofs(self) -> Indices:
        """Degree of freedom of the whole structure under every row, shape (n_rows,)."""
        dofs = np.empty(self.n_rows, dtype=np.intp)
        for part in self.substructures:
            dofs[part.rows] = part.dofs[part.elasticity.trace]
        return dofs

    @cached_property
    def time_weights(self) -> Array:
        """Trapezoidal weights of the instants, shape (n_instants,), scaled."""
        if self.n_instants == 1:
            return np.ones(1)
        halves = 0.5 * (np.diff(self.instants) / self.scales.time)
        weights = np.append(halves, 0.0) + np.insert(halves, 0, 0.0)
        # A basis divides by them: a step may be as short as the smallest number.
        return np.asarray(np.maximum(weights, np.finfo(float).eps))

    @cached_property
    def laws(self) -> list[Interface]:
        """All interfaces, those of one kind that may be treated as one joined: no macro bases."""
        kinds: dict[type[Interface], list[Interface]] = {}
        for law in self.interfaces.values():
            if not isinstance(law, Contact):
                kinds.setdefault(type(law), []).append(law)
        others = [law for kind, laws in kinds.items() for law in kind.together(laws)]
        return [*(group.law for group in self.contact_groups), *others]

    @cached_property
    def contact_groups(self) -> list[ContactGroup]:
        """Interfaces with friction, those of one law as one."""
        every, alike = list(self.rubbing.values()), dict[Hashable, list[int]]()
        for number, law in enumerate(every):
            alike.setdefault(law.kind, []).append(number)
        return [ContactGroup(every, numbers) for numbers in alike.values()]

    @cached_property
    def contact_points(self) -> dict[str, slice]:
        """Where the points of each interface stand among those of all, by name."""
        ends = np.cumsum([0, *(len(law.positions) for law in self.rubbing.values())]).tolist()
        return {name: slice(*span) for name, span in zip(self.rubbing, pairwise(ends), strict=True)}

    @cached_property
    def given_forces(self) -> list[Neumann]:
        """Interfaces whose force is prescribed."""
        return [law for law in self.interfaces.values() if isinstance(law, Neumann)]

    @cached_property
    def given_displacements(self) -> list[Dirichlet]:
        """Interfaces whose displacement is prescribed."""
        return [law for law in self.interfaces.values() if isinstance(law, Dirichlet)]

    @cached_property
    def is_held(self) -> NDArray[np.bool_]:
        """At which rows a displacement is prescribed, shape (n_rows,)."""
        return np.isin(self.row_dofs, self.prescribed[0])

    @cached_property
    def cuts(self) -> list[tuple[Indices, Indices]]:
        """Rows of both sides of the glued cuts, interface by interface."""
        glued = [law for law in self.interfaces.values() if isinstance(law, Perfect)]
        return [(law.first, law.second) for law in glued]

    @cached_property
    def rubbing_rows(self) -> tuple[slice | Indices, NDArray[np.bool_]]:
        """Rows of all components of the bodies above at interfaces with friction.

        And which of them are along the normal of their interface.
        """
        is_normal = np.zeros(self.n_rows, dtype=bool)
        laws = self.rubbing.values()
        for law in laws:
            if law.normal is not None:
                is_normal[law.normal.component.above] = True
        rows = np.unique(np.concatenate([one.above for law in laws for one in law.components]))
        return as_slice(rows), is_normal[rows]

    @cached_property
    def friction(self) -> Contact:
        """The interface with friction, where it is the only one."""
        (contact,) = self.rubbing.values()
        return contact

    @cached_property
    def rubbing(self) -> dict[str, Contact]:
        """The interfaces with friction, by name."""
        return {name: law for name, law in self.interfaces.items() if isinstance(law, Contact)}

    @cached_property
    def surfaces(self) -> dict[str, Contact]:
        """The interfaces with friction along which bodies touch, by name: springs are none."""
        return {name: law for name, law in self.rubbing.items() if not law.is_spring}

    @cached_property
    def on_surfaces(self) -> NDArray[np.bool_]:
        """Which points of all interfaces with friction are on surfaces, shape (n_points,)."""
        laws = self.rubbing.values()
        return np.repeat([not law.is_spring for law in laws], [len(law.positions) for law in laws])

    @cached_property
    def opens(self) -> bool:
        """Whether any interface may open."""
        return any(law.opens for law in self.rubbing.values())

    @cached_property
    def macro(self) -> tuple[sparse.csr_array, Array]:
        """Macro basis of all interfaces whose macro forces are in equilibrium, and their load.

        P, (n_rows, n_macro), and P^T F_d, (n_macro, n_instants) (paper, eq. 1; README, 2).
        """
        parts = [part for law in self.interfaces.values() for part in law.macro_parts()]
        bases = sparse.block_diag([sparse.coo_array(part.basis) for part in parts])
        rows = np.concatenate([part.rows for part in parts])[bases.coords[0]]
        loads = [
            np.zeros((part.basis.shape[1], self.n_instants)) if part.load is None else part.load
            for part in parts
        ]
        shape = self.n_rows, bases.shape[1]
        basis = sparse.csr_array((bases.data, (rows, bases.coords[1])), shape)
        return basis, np.concatenate(loads)

    @cached_property
    def mean_of_rows(self) -> sparse.csr_array:
        """Mean over the rows of each degree of freedom, shape (n_dofs, n_rows)."""
        total = sparse.csr_array(
            (np.ones(self.n_rows), (self.row_dofs, np.arange(self.n_rows))),
            shape=(self.n_dofs, self.n_rows),
        )
        counts = np.asarray(total.sum(axis=1)).ravel()
        return sparse.csr_array(sparse.diags_array(1.0 / np.maximum(counts, 1.0)) @ total)

    @cached_property
    def body_force_on_rows(self) -> Array | None:
        """Forces on the rows that do the work of all body forces, (n_rows, n_instants); or None."""
        if all(part.body_force is None for part in self.substructures):
            return None
        whole = np.zeros((self.n_dofs, self.n_instants))
        for part in self.substructures:
            if part.body_force is not None:
                whole[part.dofs] += part.body_force
        return np.asfortranarray(self.mean_of_rows.T @ whole)

    @cached_property
    def sum_of_contact(self) -> sparse.csr_array:
        """Sum over the rows of each point and component of interfaces with friction.

        Shape (n_forces, n_rows). The forces on the body above are stacked interface by interface:
        all normal forces, where it may open, and then all friction forces.
        """
        blocks = [
            sparse.csr_array(
                (np.ones(len(law.points)), (law.points, component.above)),
                shape=(len(law.positions), self.n_rows),
            )
            for law in self.rubbing.values()
            for component in law.components
        ]
        return sparse.csr_array(sparse.vstack(blocks))

    @cached_property
    def contact_places(self) -> dict[str, tuple[slice, ...]]:
        """Where the components of each interface stand in a stack of contact forces, by name."""
        places, first = {}, 0
        for name, law in self.rubbing.items():
            size, last = len(law.positions), first + len(law.positions) * len(law.components)
            places[name] = tuple(slice(start, start + size) for start in range(first, last, size))
            first = last
        return places

    @cached_property
    def _driven(self) -> list[DrivenFriction]:
        """Points whose slip prescribed displacements alone make, interface by interface."""
        given = [self.prescribed[1], np.zeros(1) if self.carried is None else self.carried]
        largest = max(float(np.abs(values).max(initial=0.0)) for values in given)
        each = (
            driven_friction(law, self.contact_places[name], self.row_dofs, self.prescribed, largest)
            for name, law in self.rubbing.items()
        )
        return [driven for driven in each if driven is not None]

    def with_driven_friction(self, forces: Array, displacement: Array) -> Array:
        """Contact forces whose friction is as the law says where it cannot be found.

        That is where prescribed displacements alone make the slip, see
        `solver.discrete.driven_friction`. All are scaled: forces stacked as `sum_of_contact` says,
        shape (n_forces, n_instants), and W of all rows, (n_rows, n_instants).
        """
        if not self._driven:
            return forces
        settled = forces.copy()
        for driven in self._driven:
            settled[driven.places] = driven.force(forces, displacement)
        return settled

    @cached_property
    def motions(self) -> Array | None:
        """Rigid motions of bodies that no side holds, shape (n_dofs, n_motions), independent.

        None where there are none, or where no digits are lost beside them, along rods.
        """
        return None if self.inside is None else self.inside.rigid_motions(self.prescribed[0])

    @cached_property
    def prescribed(self) -> tuple[Indices, Array]:
        """Degrees of freedom with prescribed displacement, (n,), and values, (n, n_instants)."""
        given = self.given_displacements
        rows = np.concatenate([np.zeros(0, dtype=np.intp), *(part.rows for part in given)])
        values = [np.zeros((0, self.n_instants)), *(part.values for part in given)]
        dofs, first = np.unique(self.row_dofs[rows], return_index=True)
        return dofs, np.concatenate(values)[first]

    @cached_property
    def held_dofs(self) -> dict[str, Indices]:
        """Degrees of freedom that each interface of prescribed displacements holds, by its name.

        One that several prescribe, as in a corner, is held by the first of them.
        """
        held: dict[str, Indices] = {}
        before = np.zeros(0, dtype=np.intp)
        for name, law in self.interfaces.items():
            if isinstance(law, Dirichlet):
                held[name] = np.setdiff1d(self.row_dofs[law.rows], before)
                before = np.concatenate([before, held[name]])
        return held


def nothing_acts(problem: Problem) -> bool:
    """Whether all that is given is zero: loads, displacements, overlaps; so is the answer."""
    if any(law.acts for law in problem.interfaces.values()):
        return False
    forces = (part.body_force for part in problem.substructures if part.body_force is not None)
    return not any(force.any() for force in forces)
