"""The discrete problem: matrices, traces, laws and macro bases, without options.

All values are scaled (see `Scales`). A boundary row is one displacement component of
one interface point of one substructure; an interface owns rows, and so does a
substructure. Fields on the boundary have shape (n_rows, n_instants), and those of one
instant are contiguous in memory (Fortran order), because the friction law walks through
time.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.arrays import Array, Indices, as_slice
from solver.cache import CACHE, content_of
from solver.checks import (
    INSTANTS,
    InstanceOf,
    MappingOf,
    Numbers,
    SequenceOf,
    check,
)
from solver.discrete.consistency import (
    check_cover,
    check_instants,
    check_names,
    check_prescribed,
)
from solver.discrete.contacts import Contacts
from solver.discrete.driven_friction import DrivenFriction, driven_contacts
from solver.discrete.drives import Drive
from solver.discrete.inside import Inside
from solver.discrete.no_reference import reason_against_reference
from solver.discrete.substructure import Scales, Substructure
from solver.laws import Contact, Interface
from solver.laws.interface import Glued, IncrementalForm, PrescribedRows


@dataclass(frozen=True)
class Problem:
    """A structure as an assembly of substructures and interfaces (paper, section 2).

    Attributes
    ----------
    interfaces
        All interfaces by name; together they own every boundary row once.
    positions
        Coordinates of the degrees of freedom of the whole structure, in m: shape
        (n_dofs,) along a rod, (n_dofs, 2) in the plane.
    instants
        Times, shape (n_instants,), in s.
    inside
        Nodes and elements inside condensed substructures; None where none is condensed.
    rest
        Displacement that the method may start from, scaled, shape (n_dofs, n_instants):
        that of a body which falls onto its support, or slides along it, as if it were
        rigid. None is zero.
    carried
        Displacement of the support that rods lie on, scaled, shape (n_dofs,
        n_instants), where it moves: all displacements of the problem are relative to
        it.
    has_short_joints
        Whether upright joints of bodies have no pair at their ends, so that these
        bodies carry less than rigid ones.
    order
        Names of all interfaces with friction, in the order in which their points and
        forces are stacked; by default that of `interfaces`.
    drives
        Loads and motions by the settings that give them, for messages only; empty for a
        problem without a scene.

    Raises
    ------
    RefusedError
        For rows or degrees of freedom that are not covered, fields of another shape,
        instants that do not increase, or prescribed displacements that contradict each
        other.
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
    order: tuple[str, ...] = ()
    drives: tuple[Drive, ...] = ()

    def __post_init__(self) -> None:
        check(
            self,
            substructures=SequenceOf(InstanceOf(Substructure)),
            interfaces=MappingOf(InstanceOf(Interface)),
            instants=INSTANTS,
            scales=InstanceOf(Scales),
            positions=Numbers(((None,), (None, 2))),
        )
        field = Numbers(((self.n_dofs, self.n_instants),))
        check(self, rest=field, carried=field)
        dofs = [part.dofs for part in self.substructures]
        rows = [part.rows for part in self.substructures]
        rows_of_laws = [law.rows for law in self.interfaces.values()]
        check_cover("substructures", "degree of freedom", self.n_dofs, dofs)
        check_cover("substructures", "row", self.n_rows, rows, once=True)
        check_cover("interfaces", "row", self.n_rows, rows_of_laws, once=True)
        check_names(self.contacts)
        check_instants(self.n_instants, self.interfaces, self.substructures)
        check_prescribed(self.prescribed_displacements, self.row_dofs)

    def with_drives(self, drives: tuple[Drive, ...]) -> Problem:
        """The same problem with drives; checks and cached properties stay valid."""
        driven = copy(self)
        object.__setattr__(driven, "drives", drives)
        return driven

    def absolute(self, displacement: Array) -> Array:
        """Absolute displacements: relative ones plus the motion of the support.

        Shape (n_dofs, n_instants) both, m.
        """
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
    def is_turn(self) -> NDArray[np.bool_]:
        """Mask of degrees of freedom that are turns of beams, in rad, shape (n_dofs,).

        All others are displacements.
        """
        if self.inside is None:
            return np.zeros(self.n_dofs, dtype=bool)
        return np.asarray(self.inside.directions[:, 2] != 0.0)

    @cached_property
    def direction(self) -> Array:
        """The paper's search direction k of every row, shape (n_rows,), scaled."""
        k = np.empty(self.n_rows)
        for part in self.substructures:
            k[part.rows] = part.elasticity.direction
        return k

    @cached_property
    def row_dofs(self) -> Indices:
        """Degree of freedom of the whole structure at every row, shape (n_rows,)."""
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
        # A basis divides by the weights, and a step may be as short as the smallest
        # number.
        return np.asarray(np.maximum(weights, np.finfo(float).eps))

    @cached_property
    def laws(self) -> list[Interface]:
        """Laws of all interfaces for the local stage; those of one kind are joined.

        Joined laws have no macro bases.
        """
        kinds: dict[type[Interface], list[Interface]] = {}
        for law in self.interfaces.values():
            if not isinstance(law, Contact):
                kinds.setdefault(type(law), []).append(law)
        joined: list[Interface] = [group.law for group in self.contacts.groups]
        for kind, laws in kinds.items():
            joined.extend(kind.join(laws))
        return joined

    @cached_property
    def incremental_forms(self) -> dict[str, IncrementalForm]:
        """Incremental forms of the interfaces that have one, by name."""
        forms = {name: law.incremental_form() for name, law in self.interfaces.items()}
        return {name: form for name, form in forms.items() if form is not None}

    @cached_property
    def user_laws(self) -> dict[str, Interface]:
        """Interfaces of users' laws without an incremental form, by name."""
        forms = self.incremental_forms
        return {name: law for name, law in self.interfaces.items() if name not in forms}

    @cached_property
    def prescribed_forces(self) -> list[PrescribedRows]:
        """Prescribed forces, interface by interface."""
        forms = self.incremental_forms.values()
        return [form.force for form in forms if form.force is not None]

    @cached_property
    def prescribed_displacements(self) -> list[PrescribedRows]:
        """Prescribed displacements, interface by interface."""
        forms = self.incremental_forms.values()
        return [form.displacement for form in forms if form.displacement is not None]

    @cached_property
    def is_held(self) -> NDArray[np.bool_]:
        """Mask of rows with a prescribed displacement, shape (n_rows,)."""
        return np.isin(self.row_dofs, self.prescribed[0])

    @cached_property
    def cuts(self) -> list[Glued]:
        """Rows of both sides of the glued cuts, interface by interface."""
        forms = self.incremental_forms.values()
        return [form.glued for form in forms if form.glued is not None]

    @cached_property
    def turns_at_cuts(self) -> Indices:
        """Rows of turns of beams on both sides of glued cuts, (n,)."""
        rows = [np.zeros(0, dtype=np.intp)]
        for cut in self.cuts:
            rows += [cut.first, cut.second]
        together = np.concatenate(rows)
        return np.asarray(together[self.is_turn[self.row_dofs[together]]])

    @cached_property
    def unknown_rows(self) -> tuple[slice | Indices, list[NDArray[np.bool_]]]:
        """Rows whose forces are unknown before a solution, and masks of their kinds.

        These are the rows of the bodies above at interfaces with friction, normal ones
        as a first and tangential ones as a second kind; and all rows of users' laws as
        a third. Where there are none of these, all rows are of the third kind. Empty
        kinds are left out; masks have the shape (n_sought,).
        """
        kind_of = np.full(self.n_rows, -1)
        for law in self.user_laws.values():
            kind_of[law.rows] = 2
        for law in self.contacts.laws.values():
            kind_of[law.tangent.above] = 1
            if law.normal is not None:
                kind_of[law.normal.component.above] = 0
        if np.all(kind_of < 0):
            kind_of[:] = 2
        rows = np.flatnonzero(kind_of >= 0)
        kinds = [kind_of[rows] == kind for kind in range(3)]
        return as_slice(rows), [kind for kind in kinds if kind.any()]

    @cached_property
    def no_reference(self) -> str:
        """Reason that the problem has no reference, with a remedy, or ""."""
        owners = np.empty(self.n_rows, dtype=np.intp)
        for number, part in enumerate(self.substructures):
            owners[part.rows] = number
        return reason_against_reference(
            self.interfaces, self.contacts, self.row_dofs, owners
        )

    @cached_property
    def friction(self) -> Contact:
        """The only interface with friction of a problem."""
        (contact,) = self.contacts.values()
        return contact

    @cached_property
    def contacts(self) -> Contacts:
        """The interfaces with friction, by name, in the order of stacked fields."""
        laws = {
            name: law
            for name, law in self.interfaces.items()
            if isinstance(law, Contact)
        }
        return Contacts(laws, self.order)

    @cached_property
    def has_start(self) -> bool:
        """Check whether sliders have initial positions other than zero."""
        laws = self.contacts.laws.values()
        return any(law.tangential.start is not None for law in laws)

    @cached_property
    def opens(self) -> bool:
        """Check whether any interface may open."""
        return any(law.opens for law in self.contacts.laws.values())

    @cached_property
    def macro(self) -> tuple[sparse.csr_array, Array]:
        """Macro basis of all interfaces, and macro forces of external loads, scaled.

        P, (n_rows, n_macro), and P^T F_d, (n_macro, n_instants) (paper, eq. 1;
        MATHEMATICS.md, 2).
        """
        laws = self.interfaces.values()
        parts = list(chain.from_iterable(law.macro_parts() for law in laws))
        bases = sparse.block_diag([sparse.coo_array(part.basis) for part in parts])
        rows = np.concatenate([part.rows for part in parts])[bases.coords[0]]
        loads = list[Array]()
        for part in parts:
            load = part.load
            if load is None:
                load = np.zeros((part.basis.shape[1], self.n_instants))
            loads.append(load)
        shape = self.n_rows, bases.shape[1]
        basis = sparse.csr_array((bases.data, (rows, bases.coords[1])), shape)
        return basis, np.concatenate(loads)

    @cached_property
    def mean_of_rows(self) -> sparse.csr_array:
        """Mean over the rows of each degree of freedom, shape (n_dofs, n_rows)."""
        places = self.row_dofs, np.arange(self.n_rows)
        shape = self.n_dofs, self.n_rows
        counts = np.bincount(self.row_dofs, minlength=self.n_dofs)
        shares = 1.0 / counts[self.row_dofs]
        return sparse.csr_array((shares, places), shape=shape)

    @cached_property
    def body_force_on_rows(self) -> Array | None:
        """Forces on the rows equivalent to all body forces, scaled, or None.

        Shape (n_rows, n_instants).
        """
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

        Shape (n_forces, n_rows): contact forces are stacked as `Contacts` says.
        """
        return self.contacts.sum_of_rows(self.n_rows)

    @cached_property
    def _driven(self) -> list[DrivenFriction]:
        """Friction of driven points of all interfaces (see `driven_friction`)."""
        largest = float(np.abs(self.prescribed[1]).max(initial=0.0))
        if self.carried is not None:
            largest = max(largest, float(np.abs(self.carried).max(initial=0.0)))
        return driven_contacts(self.contacts, self.row_dofs, self.prescribed, largest)

    def with_driven_friction(self, forces: Array, displacement: Array) -> Array:
        """Contact forces, with the friction of driven points from their law.

        At driven points prescribed displacements alone make the slip, so that no method
        finds friction there (see `solver.discrete.driven_friction`). All are scaled:
        forces stacked as by `sum_of_contact`, shape (n_forces, n_instants), and W of
        all rows, (n_rows, n_instants).
        """
        if not self._driven:
            return forces
        settled = forces.copy()
        for driven in self._driven:
            settled[driven.tangential] = driven.force(forces, displacement)
        return settled

    @cached_property
    def is_chain(self) -> bool:
        """Check whether the stiffness is tridiagonal in the degrees of freedom."""
        if not all(part.elasticity.is_tridiagonal for part in self.substructures):
            return False
        dofs = [part.dofs for part in self.substructures]
        steps = np.diff(np.concatenate(dofs))
        # From one substructure to the next any step will do.
        steps[np.cumsum([len(of_part) for of_part in dofs])[:-1] - 1] = 1
        return bool(np.all(steps == 1))

    @cached_property
    def rigid_motions(self) -> Array | None:
        """Independent rigid motions of bodies that no side holds, (n_dofs, n_motions).

        None without such motions, and along rods, where they cost no digits.
        """
        inside = self.inside
        if inside is None:
            return None
        fixed = self.prescribed[0]
        key = "motions", self.content_of_bodies, content_of(fixed)
        return CACHE.get(key, lambda: inside.rigid_motions(fixed))

    @cached_property
    def content_of_stiffness(self) -> bytes:
        """Digest of the data from which the stiffness of the structure is assembled."""
        operators = {
            id(part.elasticity): part.elasticity for part in self.substructures
        }
        numbers = {identity: number for number, identity in enumerate(operators)}
        of_parts = [numbers[id(part.elasticity)] for part in self.substructures]
        matrices = [operator.stiffness for operator in operators.values()]
        dofs = [part.dofs for part in self.substructures]
        return content_of(*matrices, np.array(of_parts), *dofs)

    @cached_property
    def content_of_bodies(self) -> bytes:
        """Digest of the positions of the bodies' degrees of freedom; b"" of rods."""
        inside = self.inside
        if inside is None:
            return b""
        # Turns of beams are not over the unit of length as positions are.
        unit = np.array([self.scales.displacement])
        bodies = inside.body_of_dofs
        return content_of(inside.positions, inside.directions, bodies, unit)

    @cached_property
    def prescribed(self) -> tuple[Indices, Array]:
        """Degrees of freedom of prescribed displacement, (n,), ascending, and values.

        Values are scaled, (n, n_instants).
        """
        rows = [np.zeros(0, dtype=np.intp)]
        values = [np.zeros((0, self.n_instants))]
        for given in self.prescribed_displacements:
            rows.append(given.rows)
            values.append(given.values)
        every = self.row_dofs[np.concatenate(rows)]
        dofs, first = np.unique(every, return_index=True)
        return dofs, np.concatenate(values)[first]

    @cached_property
    def held_dofs(self) -> dict[str, Indices]:
        """Degrees of freedom that interfaces of prescribed displacements hold, by name.

        A degree of freedom that several prescribe, as in a corner, is held by the first
        of them. Shape (n,) each.
        """
        held: dict[str, Indices] = {}
        before = np.zeros(0, dtype=np.intp)
        for name, form in self.incremental_forms.items():
            if form.displacement is not None:
                dofs = self.row_dofs[form.displacement.rows]
                held[name] = np.setdiff1d(dofs, before)
                before = np.concatenate([before, held[name]])
        return held


def is_unloaded(problem: Problem) -> bool:
    """Check whether loads, displacements and overlaps, and so the solution, are zero.

    A user's law without an incremental form may act, too.
    """
    laws = problem.contacts.laws.values()
    if problem.user_laws or any(law.is_moved for law in laws):
        return False
    given = problem.prescribed_forces + problem.prescribed_displacements
    forces = [part.body_force for part in problem.substructures]
    acts_on_rows = any(each.values.any() for each in given)
    acts_inside = any(force.any() for force in forces if force is not None)
    return not acts_on_rows and not acts_inside
