"""The discrete problem: matrices, traces, laws and macro bases, without options.

All values are scaled (see `Scales`). A boundary row is one displacement component of
one interface point of one substructure; an interface owns rows, and so does a
substructure. Fields on the boundary have shape (n_rows, n_instants), and those of one
instant are contiguous in memory (Fortran order), because the friction law walks through
time.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from solver.arrays import Array, Indices, as_slice
from solver.checks import (
    ALIKE,
    INSTANTS,
    POSITIVE,
    Each,
    Named,
    Numbers,
    Part,
    check,
)
from solver.discrete.contacts import ContactGroup
from solver.discrete.driven_friction import DrivenFriction, driven_friction
from solver.discrete.drives import Drive
from solver.discrete.substructure import Substructure
from solver.laws import Contact, Interface, Strength
from solver.laws.interface import Glued, IncrementalForm, PrescribedRows
from solver.laws.play import PLAIN
from solver.refusal import RefusedError, Words

if TYPE_CHECKING:
    from solver.discrete.inside import Inside


@dataclass(frozen=True)
class Scales:
    """Units of scaled displacement, m, force, N, and time, s.

    With them the results of a method do not depend on the units of the input.
    """

    displacement: float
    force: float
    time: float

    def __post_init__(self) -> None:
        check(self, displacement=POSITIVE, force=POSITIVE, time=POSITIVE)


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
        that of a body which falls onto its support as if it were rigid. None is zero.
    carried
        Displacement of the support that rods lie on, scaled, shape (n_dofs,
        n_instants), where it moves: all displacements of the problem are relative to
        it.
    has_short_joints
        Whether upright joints of bodies have no pair at their ends, so that these
        bodies carry less than rigid ones.
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
    drives: tuple[Drive, ...] = ()

    def __post_init__(self) -> None:
        check(
            self,
            substructures=Each(Part(Substructure)),
            interfaces=Named(Part(Interface)),
            instants=INSTANTS,
            scales=Part(Scales),
            positions=Numbers(((None,), (None, 2))),
        )
        field = Numbers(((self.n_dofs, self.n_instants),))
        check(self, rest=field, carried=field)
        dofs = [part.dofs for part in self.substructures]
        rows = [part.rows for part in self.substructures]
        rows_of_laws = [law.rows for law in self.interfaces.values()]
        _check_cover("substructures", "degree of freedom", self.n_dofs, dofs)
        _check_cover("substructures", "row", self.n_rows, rows, once=True)
        _check_cover("interfaces", "row", self.n_rows, rows_of_laws, once=True)
        self._check_instants()
        self._check_prescribed()

    def _check_instants(self) -> None:
        """Refuse laws and body forces with values for another number of instants."""
        counts = {
            f"interfaces[{name!r}]": law.n_instants
            for name, law in self.interfaces.items()
        }
        for number, part in enumerate(self.substructures):
            if part.body_force is not None:
                counts[f"substructures[{number}].body_force"] = part.body_force.shape[1]
        for name, count in counts.items():
            if count not in (None, self.n_instants):
                allowed = f"as many as Problem.instants has, {self.n_instants}"
                shown = Words(f"of {count} instants")
                raise RefusedError(
                    f"Problem.{name}", shown, allowed, "give one value an instant"
                )

    def _check_prescribed(self) -> None:
        """Refuse displacements that differ at one degree of freedom."""
        given = self.given_displacements
        if len(given) < 2:
            return
        dofs = np.concatenate([self.row_dofs[each.rows] for each in given])
        values = np.concatenate([each.values for each in given])
        _, first, inverse = np.unique(dofs, return_index=True, return_inverse=True)
        differences = np.abs(values - values[first][inverse])
        largest = float(np.abs(values).max(initial=0.0))
        if float(differences.max(initial=0.0)) > ALIKE * largest:
            number = int(differences.max(axis=1).argmax())
            raise RefusedError(
                "Problem.interfaces",
                Words(f"two displacements of degree of freedom {dofs[number]}"),
                "one displacement of each",
                "prescribe it once, or both alike",
            )

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
    def direction(self) -> Array:
        """The paper's search direction k of every row, shape (n_rows,), scaled."""
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
        # A basis divides by the weights, and a step may be as short as the smallest
        # number.
        return np.asarray(np.maximum(weights, np.finfo(float).eps))

    @cached_property
    def laws(self) -> list[Interface]:
        """Laws of all interfaces for the local stage, alike ones joined to one.

        Joined laws have no macro bases.
        """
        kinds: dict[type[Interface], list[Interface]] = {}
        for name, law in self.interfaces.items():
            if name not in self.rubbing:
                kinds.setdefault(type(law), []).append(law)
        joined: list[Interface] = [group.law for group in self.contact_groups]
        for kind, laws in kinds.items():
            joined.extend(kind.together(laws))
        return joined

    @cached_property
    def contact_groups(self) -> list[ContactGroup]:
        """Groups of interfaces with friction that have the same kind of law."""
        laws = list(self.rubbing.values())
        alike = dict[Hashable, list[int]]()
        for number, (name, law) in enumerate(self.rubbing.items()):
            # A user's law may differ from others in more than its fields: it is a group
            # of its own.
            key = law.kind if name in self.incremental_forms else name
            alike.setdefault(key, []).append(number)
        return [ContactGroup(laws, numbers) for numbers in alike.values()]

    @cached_property
    def contact_points(self) -> dict[str, slice]:
        """Range of the points of each interface among those of all, by name."""
        ranges = dict[str, slice]()
        first = 0
        for name, law in self.rubbing.items():
            last = first + len(law.positions)
            ranges[name] = slice(first, last)
            first = last
        return ranges

    @cached_property
    def incremental_forms(self) -> dict[str, IncrementalForm]:
        """Incremental forms of the interfaces that have one, by name."""
        forms = {name: law.incremental_form() for name, law in self.interfaces.items()}
        return {name: form for name, form in forms.items() if form is not None}

    @cached_property
    def own_laws(self) -> dict[str, Interface]:
        """Interfaces of a user's law, without an incremental form, by name."""
        forms = self.incremental_forms
        return {name: law for name, law in self.interfaces.items() if name not in forms}

    @cached_property
    def given_forces(self) -> list[PrescribedRows]:
        """Forces that are prescribed, interface by interface."""
        forms = self.incremental_forms.values()
        return [form.force for form in forms if form.force is not None]

    @cached_property
    def given_displacements(self) -> list[PrescribedRows]:
        """Displacements that are prescribed, interface by interface."""
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
    def sought_rows(self) -> tuple[slice | Indices, list[NDArray[np.bool_]]]:
        """Rows whose forces only a solution gives, and masks of their kinds among them.

        These are the rows of the bodies above at interfaces with friction, normal ones
        as a first and tangential ones as a second kind; and all rows of users' laws as
        a third. Where there are none of these, all rows are of the third kind. Empty
        kinds are left out; masks have the shape (n_sought,).
        """
        kind_of = np.full(self.n_rows, -1)
        for law in self.own_laws.values():
            kind_of[law.rows] = 2
        for law in self.rubbing.values():
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
        """Reason that the problem has no incremental reference, with a remedy, or "".

        The incremental solvers read the incremental forms of all laws, one degree of
        freedom where rows are glued, and the mean of the pairs of a point: they would
        leave out anything else.
        """
        for name, law in self.own_laws.items():
            return (
                f'The law {type(law).__name__} of the interface "{name}" does not say '
                "how it enters the incremental problem, so that there is no reference: "
                f"{_OF_ONES_OWN}."
            )
        for name, form in self.incremental_forms.items():
            if form.contact is not None and form.contact is not self.interfaces[name]:
                return (
                    f'The interface "{name}" enters as a contact that it is not: '
                    f"{_OF_ONES_OWN}."
                )
        if not self.rubbing:
            return (
                "No interface is one of contact, so that there is nothing to solve "
                f"instant by instant: add a contact, or {_BY_ESTIMATE}."
            )
        if not self._is_glued_as_numbered:
            return (
                "Rows of one degree of freedom are not glued, or glued rows have two, "
                "so that no matrix of the whole structure says what holds: number them "
                f"alike, or {_BY_ESTIMATE}."
            )
        for name, contact in self.rubbing.items():
            if not self._has_points(contact):
                return (
                    f'Pairs of one point of the interface "{name}" differ in their '
                    "degrees of freedom, gap or friction: give each a point of its "
                    f"own, or {_BY_ESTIMATE}."
                )
        if len(self._strengths) > 1:
            return (
                "Slip changes friction otherwise on one interface than on another: "
                f"give all of them the same strength, or {_BY_ESTIMATE}."
            )
        return ""

    @property
    def _is_glued_as_numbered(self) -> bool:
        """Check whether just those rows share a degree of freedom that laws glue."""
        owner = np.empty(self.n_rows, dtype=np.intp)
        for number, part in enumerate(self.substructures):
            owner[part.rows] = number
        # All rows of one substructure at one degree of freedom are one node.
        keys = owner * self.n_dofs + self.row_dofs
        nodes, node_of_row = np.unique(keys, return_inverse=True)
        sides = np.concatenate([np.zeros((2, 0), dtype=np.intp), *self.cuts], axis=1)
        first, second = node_of_row[sides]
        ones = np.ones(len(first))
        links = sparse.coo_array((ones, (first, second)), shape=(len(nodes),) * 2)
        n_glued, glued = connected_components(links, directed=False)
        # Each group of glued nodes has one degree of freedom, and no other group has
        # it.
        dofs = nodes % self.n_dofs
        n_pairs = len(np.unique(glued * self.n_dofs + dofs))
        return bool(n_pairs == n_glued == len(np.unique(dofs)))

    def _has_points(self, law: Contact) -> bool:
        """Check whether pairs of one point agree in degrees of freedom, gap and mu."""
        if len(law.points) == len(law.positions):
            return True
        fields: list[NDArray[Any]] = [law.tangential.friction]
        for component in law.components:
            fields.extend([self.row_dofs[rows] for rows in component.sides])
        if law.normal is not None:
            fields.append(law.normal.gap)
        _, first = np.unique(law.points, return_index=True)
        same = first[law.points]
        return all(np.array_equal(field, field[same]) for field in fields)

    @property
    def _strengths(self) -> set[Strength]:
        """Slip-dependent factors of all interfaces on which there is any friction."""
        laws = [law.tangential for law in self.rubbing.values()]
        return {law.strength or PLAIN for law in laws if law.rubs}

    @cached_property
    def friction(self) -> Contact:
        """The interface with friction of a problem that has one only."""
        (contact,) = self.rubbing.values()
        return contact

    @cached_property
    def rubbing(self) -> dict[str, Contact]:
        """The interfaces with friction, by name."""
        return {
            name: law
            for name, law in self.interfaces.items()
            if isinstance(law, Contact)
        }

    @cached_property
    def surfaces(self) -> dict[str, Contact]:
        """The interfaces with friction that are surfaces, not springs, by name."""
        return {name: law for name, law in self.rubbing.items() if not law.is_spring}

    @cached_property
    def on_surfaces(self) -> NDArray[np.bool_]:
        """Mask of contact points that are on surfaces, shape (n_points,)."""
        laws = self.rubbing.values()
        is_surface = [not law.is_spring for law in laws]
        return np.repeat(is_surface, [len(law.positions) for law in laws])

    @cached_property
    def goes_on(self) -> bool:
        """Check whether sliders begin at given positions, not at rest."""
        return any(law.tangential.start is not None for law in self.rubbing.values())

    @cached_property
    def opens(self) -> bool:
        """Check whether any interface may open."""
        return any(law.opens for law in self.rubbing.values())

    @cached_property
    def macro(self) -> tuple[sparse.csr_array, Array]:
        """Macro basis of all interfaces, and the macro forces from outside, scaled.

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
        total = sparse.csr_array((np.ones(self.n_rows), places), shape=shape)
        counts = np.asarray(total.sum(axis=1)).ravel()
        inverse = sparse.diags_array(1.0 / np.maximum(counts, 1.0))
        return sparse.csr_array(inverse @ total)

    @cached_property
    def body_force_on_rows(self) -> Array | None:
        """Forces on the rows that do the work of all body forces, scaled, or None.

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

        Shape (n_forces, n_rows). The forces on the body above are stacked interface by
        interface: all normal forces, where it may open, and then all friction forces.
        """
        blocks = [sparse.csr_array((0, self.n_rows))]
        for law in self.rubbing.values():
            size = len(law.positions), self.n_rows
            ones = np.ones(len(law.points))
            blocks += [
                sparse.csr_array((ones, (law.points, component.above)), shape=size)
                for component in law.components
            ]
        return sparse.csr_array(sparse.vstack(blocks))

    @cached_property
    def contact_slices(self) -> dict[str, tuple[slice, ...]]:
        """Ranges of each interface's components in stacked contact forces, by name."""
        ranges = dict[str, tuple[slice, ...]]()
        first = 0
        for name, law in self.rubbing.items():
            size = len(law.positions)
            last = first + size * len(law.components)
            starts = range(first, last, size)
            ranges[name] = tuple([slice(start, start + size) for start in starts])
            first = last
        return ranges

    @cached_property
    def _driven(self) -> list[DrivenFriction]:
        """Friction of driven points, interface by interface (see `driven_friction`)."""
        largest = float(np.abs(self.prescribed[1]).max(initial=0.0))
        if self.carried is not None:
            largest = max(largest, float(np.abs(self.carried).max(initial=0.0)))
        found = list[DrivenFriction]()
        for name, law in self.rubbing.items():
            slices = self.contact_slices[name]
            driven = driven_friction(
                law, slices, self.row_dofs, self.prescribed, largest
            )
            if driven is not None:
                found.append(driven)
        return found

    def with_driven_friction(self, forces: Array, displacement: Array) -> Array:
        """Contact forces in which the friction of driven points is that of the law.

        At driven points prescribed displacements alone make the slip, so that no method
        finds friction there (see `solver.discrete.driven_friction`). All are scaled:
        forces stacked as by `sum_of_contact`, shape (n_forces, n_instants), and W of
        all rows, (n_rows, n_instants).
        """
        if not self._driven:
            return forces
        settled = forces.copy()
        for driven in self._driven:
            settled[driven.rubbing] = driven.force(forces, displacement)
        return settled

    @cached_property
    def is_chain(self) -> bool:
        """Check whether the stiffness is tridiagonal in the degrees of freedom."""
        operators = {
            id(part.elasticity): part.elasticity for part in self.substructures
        }
        for operator in operators.values():
            rows, columns = sparse.coo_array(operator.stiffness).coords
            if np.abs(rows - columns).max(initial=0) > 1:
                return False
        return all(np.all(np.diff(part.dofs) == 1) for part in self.substructures)

    @cached_property
    def motions(self) -> Array | None:
        """Independent rigid motions of bodies that no side holds, (n_dofs, n_motions).

        None without such motions, and along rods, where they cost no digits.
        """
        if self.inside is None:
            return None
        return self.inside.rigid_motions(self.prescribed[0])

    @property
    def is_loose(self) -> bool:
        """Check whether bodies can move though all contacts are closed and stick.

        False along rods, and beside a user's law, which may hold what it likes.
        """
        if self.inside is None or self.own_laws:
            return False
        bodies = self.inside.body_of_dofs
        ground = int(bodies.max()) + 1
        joined = [np.zeros((2, 0), dtype=np.intp)]
        jumps = list[tuple[Indices, Indices]]()
        for law in self.rubbing.values():
            pairs = self._pairs_that_hold(law)
            # Two points in contact leave no motion of one body beside the other.
            if law.opens and len(law.positions) > 1:
                with_ground = np.append(bodies, ground)
                joined += [with_ground[np.stack(pair)] for pair in pairs]
            else:
                jumps += pairs
        first, second = np.concatenate(joined, axis=1)
        size = ground + 1
        links = sparse.coo_array((np.ones(len(first)), (first, second)), (size, size))
        _, groups = connected_components(links, directed=False)
        group_of_dofs = groups[bodies]
        group_of_dofs[group_of_dofs == groups[ground]] = -1
        fixed, _ = self.prescribed
        return not self.inside.hold_still(group_of_dofs, fixed, jumps)

    def _pairs_that_hold(self, law: Contact) -> list[tuple[Indices, Indices]]:
        """Degrees of freedom above and below that a closed contact that sticks ties.

        Shape (n_pairs,) each, by components; -1 is a support. A spring ties one
        component.
        """
        components = law.components
        if law.is_spring:
            components = law.components[:1]
        pairs = list[tuple[Indices, Indices]]()
        for component in components:
            above = self.row_dofs[component.above]
            below = np.full_like(above, -1)
            if component.below is not None:
                below = self.row_dofs[component.below]
            pairs.append((above, below))
        return pairs

    @cached_property
    def prescribed(self) -> tuple[Indices, Array]:
        """Degrees of freedom of prescribed displacement, (n,), ascending, and values.

        Values are scaled, (n, n_instants).
        """
        rows = [np.zeros(0, dtype=np.intp)]
        values = [np.zeros((0, self.n_instants))]
        for given in self.given_displacements:
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


def _check_cover(
    owners: str, what: str, count: int, parts: list[Indices], *, once: bool = False
) -> None:
    """Refuse parts that do not have all numbers from 0 to `count` - 1.

    With `once`, refuse numbers that occur more than once, too.
    """
    numbers = np.concatenate([np.zeros(0, dtype=np.intp), *parts])
    largest = int(numbers.max(initial=-1))
    times = np.bincount(numbers, minlength=count)
    if once:
        wrong = times != 1
    else:
        wrong = times == 0
    if largest < count and not wrong.any():
        return
    if largest >= count:
        number = largest
    else:
        number = int(np.argmax(wrong))
    how_often = "at least once"
    if once:
        how_often = "once"
    allowed = f"each {what} from 0 to {count - 1} {how_often}"
    shown = Words(f"{what} {number}, {times[number]} times")
    raise RefusedError(f"Problem.{owners}", shown, allowed, "number them anew")


def nothing_acts(problem: Problem) -> bool:
    """Check whether loads, displacements and overlaps are zero, and so the answer.

    A user's law without an incremental form may act, too.
    """
    if problem.own_laws or any(law.is_moved for law in problem.rubbing.values()):
        return False
    given = problem.given_forces + problem.given_displacements
    forces = [part.body_force for part in problem.substructures]
    acts_on_rows = any(each.values.any() for each in given)
    acts_inside = any(force.any() for force in forces if force is not None)
    return not acts_on_rows and not acts_inside


_BY_ESTIMATE = "judge the run by its estimate alone"
_OF_ONES_OWN = f"define its incremental_form, or {_BY_ESTIMATE}"
