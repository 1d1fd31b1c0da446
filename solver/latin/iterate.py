"""Iterates: read-only snapshots of the iteration, with fields computed on demand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, read_only
from solver.discrete.contacts import ContactFields
from solver.discrete.problem import Problem
from solver.latin.indicators import ratio, violation_of
from solver.reduction.basis import SharedBasis

CREEP = 1e-2
"""Share of the largest slip of an interface from which on a point counts as slipping,
however far the stages are apart, so that an early iterate shows where it slips."""


@dataclass(frozen=True, eq=False)
class KState:
    """Search direction of the next iteration, and whether it may still change.

    Attributes
    ----------
    k
        Search direction of the next iteration, shape (n_rows,), scaled. If it is
        another one than before, that iteration begins from zero.
    is_final
        Whether k stays.
    count
        Iterations done while k may change.
    """

    k: Array
    is_final: bool = True
    count: int = 0


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """State from which an iteration is resumed exactly, except its acceleration.

    An acceleration begins again.

    Attributes
    ----------
    number, seconds
        Iterations done, and their time, s.
    outgoing
        W + F/k of the linear stage, shape (n_rows, n_instants), scaled.
    bases
        Separated bases that hold it, one per substructure; empty for full fields.
    k_state
        Search direction, and its state; None where the fields are those of another run.
    """

    number: int
    seconds: float
    outgoing: Array
    bases: tuple[SharedBasis, ...] = ()
    k_state: KState | None = None


@dataclass(frozen=True, eq=False)
class Iterate:
    """LATIN iterate: s of the linear stage, and s^ of the local stage before.

    Properties whose names do not begin with "boundary" are SI fields of the whole
    structure.

    Attributes
    ----------
    number, seconds
        Iterations done, and time that the method took so far, set-up included, without
        the time of its consumer, s.
    k
        Search direction of the rows, shape (n_rows,), scaled.
    outgoing, incoming
        W + F/k and W - F/k of the linear stage, shape (n_rows, n_instants), scaled,
        read-only.
    local_displacement
        W^ of the local stage, same shape, equal to the bit to the result of the laws.
    local_incoming
        W - F/k that the local stage read, which is its own W^ - F^/k, same shape.
    bases
        Separated bases that hold the linear stage, one per substructure; empty for full
        fields.
    k_state
        Search direction of the next iteration, and its state.
    """

    number: int
    seconds: float
    problem: Problem
    k: Array
    outgoing: Array
    incoming: Array
    local_displacement: Array
    local_incoming: Array
    bases: tuple[SharedBasis, ...] = ()
    k_state: KState | None = None

    @property
    def iterations(self) -> int:
        """Number of iterations done."""
        return self.number

    @property
    def checkpoint(self) -> Checkpoint:
        """State from which the iteration can be resumed."""
        k_state = self.k_state
        if k_state is not None and k_state.k is not self.k:
            zero = read_only(np.zeros_like(self.outgoing))
            return Checkpoint(self.number, self.seconds, zero, k_state=k_state)
        return Checkpoint(self.number, self.seconds, self.outgoing, self.bases, k_state)

    @property
    def boundary_displacement(self) -> Array:
        """W of the linear stage, shape (n_rows, n_instants), scaled."""
        return 0.5 * (self.outgoing + self.incoming)

    @property
    def boundary_force(self) -> Array:
        """F of the linear stage, shape (n_rows, n_instants), scaled."""
        return 0.5 * self.k[:, None] * (self.outgoing - self.incoming)

    @property
    def boundary_local_force(self) -> Array:
        """F^ of the local stage, shape (n_rows, n_instants), scaled."""
        return self.k[:, None] * (self.local_displacement - self.local_incoming)

    @cached_property
    def indicator(self) -> float:
        """LATIN indicator eta: relative squared distance of both stages (paper, eq. 2).

        With ||s||^2 = integral of k W^2 + F^2/k = 1/2 integral of k [(W + F/k)^2 + (W -
        F/k)^2]. Zero when both stages are zero.
        """

        def weighted(field: Array) -> float:
            return float(self.k @ (field * field @ weights))

        weights = self.problem.time_weights
        # W + F/k and W - F/k are at hand, so no force is computed for the norm.
        local_outgoing = 2.0 * self.local_displacement - self.local_incoming
        distance = weighted(self.outgoing - local_outgoing)
        distance += weighted(self.incoming - self.local_incoming)
        size = weighted(self.outgoing) + weighted(self.incoming)
        size += weighted(local_outgoing) + weighted(self.local_incoming)
        return ratio(2.0 * distance, size)

    @cached_property
    def violation(self) -> float:
        """The k-free indicator (MATHEMATICS.md, 4)."""
        return violation_of(
            self.problem, self.boundary_displacement, self.boundary_force
        )

    @cached_property
    def displacement(self) -> Array:
        """Displacement of the linear stage, shape (n_dofs, n_instants), m.

        At cuts it is the mean of both sides.
        """
        mean = self.problem.mean_of_rows @ self.boundary_displacement
        return np.asarray(mean) * self.problem.scales.displacement

    @cached_property
    def contact_force(self) -> Array:
        """Nodal forces of interfaces with friction on the bodies above, linear stage.

        Shape (n_forces, n_instants), N, stacked as `Problem.sum_of_contact` says.
        Friction is that of the law where only its sum with a reaction can be found.
        """
        force = np.asarray(self.problem.sum_of_contact @ self.boundary_force)
        force = self.problem.with_driven_friction(force, self.boundary_displacement)
        return force * self.problem.scales.force

    @property
    def friction_force(self) -> Array:
        """Nodal friction force on the body above, linear stage.

        Shape (n_points, n_instants), N: points of all interfaces with friction, one
        interface after the other.
        """
        contacts = self.problem.contacts
        force = np.empty((contacts.n_points, self.problem.n_instants))
        for stacked in contacts.stacks:
            # The tangential component is the last one.
            force[stacked.points] = self.contact_force[stacked.forces[-1]]
        return force

    def contact(self, name: str) -> ContactFields:
        """Fields of an interface with friction, with the status of the local stage."""
        return self.contacts[name]

    @cached_property
    def contacts(self) -> dict[str, ContactFields]:
        """Fields of all interfaces with friction, by name."""
        return self.problem.contacts.fields(
            self.contact_force,
            self.boundary_displacement,
            self.status,
            self.problem.scales.displacement,
        )

    @cached_property
    def status(self) -> NDArray[np.int8]:
        """Contact status of the local stage, shape (n_points, n_instants).

        -1 is slip backward, 0 stick, +1 slip forward, `OPEN` without contact. Points of
        all interfaces with friction, one interface after the other.
        """
        return self.status_above(CREEP)

    def status_above(self, creep: Array | float) -> NDArray[np.int8]:
        """Contact status of the local stage, as `status`, with a limit on creep.

        A point that comes to rest continues creeping in the local stage for a hundred
        iterations, by no more than the distance of both stages (measured). So a slip
        counts if it is larger than the largest distance of the stages in any slip of
        the interface, or than `creep` times the largest slip, shape (n_interfaces,) or
        one for all. In a certified solution the stages agree, and all slip beyond
        rounding counts.

        Bar of 50 elements at its end, with the paper's options: all statuses are right;
        with rounding alone as the limit 23.5 % are wrong.
        """
        moved = self.local_displacement
        force = self.boundary_local_force
        linear_moved = self.boundary_displacement
        linear_force = self.boundary_force
        contacts = self.problem.contacts
        creep = np.broadcast_to(creep, len(contacts))
        status = np.empty((contacts.n_points, moved.shape[1]), dtype=np.int8)
        for group in contacts.groups:
            slip = group.slip(moved, force)
            distance = np.abs(slip - group.slip(linear_moved, linear_force))
            size = np.abs(slip)
            normal = group.law.normal
            if normal is not None:
                # An open point moves freely, and is no measure of slip.
                touches = group.law.by_point(force[normal.component.above]) > 0.0
                size = np.where(touches, size, 0.0)
                distance = np.where(touches, distance, 0.0)
            # The smaller one: an early iterate has distant stages, a late one little
            # slip left.
            still = np.minimum(
                creep[group.numbers] * group.largest(size), group.largest(distance)
            )
            status[group.points] = group.status(moved, force, slip=slip, still=still)
        return status
