"""What the iteration shows: read-only snapshots, whose fields are computed when looked at."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.contacts import ContactFields, contact_fields
from solver.discrete.problem import Problem
from solver.latin.indicators import behaviour_of, latin_indicator
from solver.reduction.basis import Modes, Reduction

CREEP = 1e-2
"""Share of the largest slip of an interface from which on a slip is one whatever the stages differ
by, so that an early iterate shows where it slips."""


@dataclass(frozen=True, eq=False)
class UpdateProgress:
    """How far the update of k has come.

    Attributes
    ----------
    phase
        Whether k is that of the start and may change ("first"), another ("updated"), or that of the
        start for good ("returned").
    k
        Search direction of the rows, shape (n_rows,).
    count
        First: iterations on end with hardly a change of status. Updated: iterations since the last
        trial.
    is_due
        Whether the next iteration begins with an update, or the judgement of one.
    status
        Contact status of the iteration before, shape (n_points, n_instants), where k follows it;
        None after the first phase, and before the first iteration.
    kept
        Updated: W and F of the linear stage at the last trial, shape (n_rows, n_instants) each.
    violation
        Updated: the k-free indicator of these.
    """

    phase: Literal["first", "updated", "returned"]
    k: Array
    count: int = 0
    is_due: bool = False
    status: NDArray[np.int8] | None = None
    kept: tuple[Array, Array] | None = None
    violation: float = np.inf


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """From where an iteration can go on: exactly, but for an acceleration, which begins anew.

    Attributes
    ----------
    number, seconds
        Iterations done and time taken so far.
    outgoing
        W + F/k of the linear stage, shape (n_rows, n_instants), scaled.
    reduction
        The separated bases that hold it, if any do.
    course
        How far the update of k has come; None where the fields are those of another run.
    """

    number: int
    seconds: float
    outgoing: Array
    reduction: Reduction | None = None
    course: UpdateProgress | None = None


@dataclass(frozen=True, eq=False)
class Iterate:
    """One LATIN iterate: the linear stage's s and the local stage's s^ that it came from.

    Properties without a leading "boundary" are SI fields of the whole structure.

    Attributes
    ----------
    number
        Iterations done, from 1.
    seconds
        Time that the method took so far, set-up included, looking excluded.
    k
        Search direction of the rows, shape (n_rows,), scaled.
    outgoing, incoming
        W + F/k and W - F/k of the linear stage, shape (n_rows, n_instants), scaled, read-only.
    local_displacement
        W^ of the local stage, same shape, bit by bit as the laws gave it.
    local_incoming
        W - F/k that the local stage read, which is its own W^ - F^/k.
    reduction
        The separated bases that hold the linear stage, if any do; of a certified solution those of
        the search that led to it, which hold less than it is.
    course
        How far the update of k has come.
    residual
        Of an iterate that is a certified solution (`solver.latin.certified`), its KKT residual
        relative to the contact force; None of all others.
    force
        F of such a one, shape (n_rows, n_instants), scaled: beside a body's rigid motion the digits
        of F/k may be lost.
    is_answer
        Whether such a one stands beside the iterates of a search that came to its own end, and so
        is no iteration.
    """

    number: int
    seconds: float
    problem: Problem
    k: Array
    outgoing: Array
    incoming: Array
    local_displacement: Array
    local_incoming: Array
    reduction: Reduction | None = None
    course: UpdateProgress | None = None
    residual: float | None = None
    force: Array | None = None
    is_answer: bool = False

    @property
    def iterations(self) -> int:
        """Iterations done; an answer beside them is none."""
        return self.number - self.is_answer

    @property
    def checkpoint(self) -> Checkpoint:
        """What is needed to go on from here."""
        bases = self.reduction if self.residual is None else None
        return Checkpoint(self.number, self.seconds, self.outgoing, bases, self.course)

    @property
    def bases(self) -> tuple[Modes, ...]:
        """Modes of every substructure, as `reduction`; none when the linear stage is full."""
        return self.reduction.modes if self.reduction else ()

    @property
    def boundary_displacement(self) -> Array:
        """W of the linear stage, shape (n_rows, n_instants), scaled."""
        return 0.5 * (self.outgoing + self.incoming)

    @property
    def boundary_force(self) -> Array:
        """F of the linear stage, shape (n_rows, n_instants), scaled."""
        if self.force is not None:
            return self.force
        return 0.5 * self.k[:, None] * (self.outgoing - self.incoming)

    @property
    def boundary_local_force(self) -> Array:
        """F^ of the local stage, shape (n_rows, n_instants), scaled."""
        if self.force is not None:
            return self.force
        return self.k[:, None] * (self.local_displacement - self.local_incoming)

    @cached_property
    def indicator(self) -> float:
        """LATIN indicator eta, a ratio of squares (paper, eq. 2)."""
        return latin_indicator(self)

    @cached_property
    def behaviour(self) -> float:
        """The k-free indicator (solver/README.md, 4)."""
        return behaviour_of(self.problem, self.boundary_displacement, self.boundary_force)

    @cached_property
    def displacement(self) -> Array:
        """Displacement of the linear stage, shape (n_dofs, n_instants), m; mean at cuts."""
        mean = self.problem.mean_of_rows @ self.boundary_displacement
        return np.asarray(mean) * self.problem.scales.displacement

    @cached_property
    def contact_force(self) -> Array:
        """Nodal forces of all interfaces with friction on the bodies above, linear stage, N.

        Shape (n_forces, n_instants), stacked as `Problem.sum_of_contact` says.
        """
        force = self.problem.sum_of_contact @ self.boundary_force
        return np.asarray(force) * self.problem.scales.force

    @property
    def friction_force(self) -> Array:
        """Nodal friction force on the body above, linear stage, (n_points, n_instants), N.

        Points of all interfaces with friction, one interface after the other.
        """
        places = self.problem.contact_places.values()
        if not self.problem.opens:
            return self.contact_force
        return np.concatenate([self.contact_force[own[-1]] for own in places])

    def contact(self, name: str) -> ContactFields:
        """One interface with friction: forces of the linear stage, status of the local one."""
        status = self.status[self.problem.contact_points[name]]
        moved = self.boundary_displacement
        return contact_fields(self.problem, name, self.contact_force, moved, status)

    @cached_property
    def status(self) -> NDArray[np.int8]:
        """Contact status of the local stage, shape (n_points, n_instants).

        -1 is slip backward, 0 stick, +1 slip forward, `OPEN` without contact. Points of all
        interfaces with friction, one interface after the other.
        """
        return self.status_with(np.full(len(self.problem.rubbing), CREEP))

    def status_with(self, creep: Array) -> NDArray[np.int8]:
        """Contact status, as `status`, with the `creep` of each interface, (n_interfaces,).

        A point that comes to rest goes on creeping in the local stage for a hundred iterations: by
        no more than both stages still differ by (measured). So what counts as slip is more than
        they differ by in any slip of the interface, though never more than `creep` times the
        largest. In a certified solution, where they agree, all that is more than rounding counts.
        Bar of 50 elements at its end, with the paper's options: all statuses are right; with
        rounding alone as the limit 23.5 % are wrong.
        """
        moved, force = self.local_displacement, self.boundary_local_force
        linear = self.boundary_displacement, self.boundary_force
        places = self.problem.contact_points.values()
        n_points = max(place.stop for place in places)
        status = np.empty((n_points, self.problem.n_instants), dtype=np.int8)
        for group in self.problem.contact_groups:
            slip = group.slip(moved, force)
            apart, far, normal = np.abs(slip - group.slip(*linear)), np.abs(slip), group.law.normal
            if normal is not None:
                touches = group.law.by_point(force[normal.component.above]) > 0.0
                far, apart = np.where(touches, far, 0.0), np.where(touches, apart, 0.0)
            still = creep[group.numbers] * group.largest(far)
            still = np.minimum(still, group.largest(apart))
            status[group.points] = group.status(moved, force, slip=slip, still=still)
        return status


def read_only(field: Array) -> Array:
    """The same field, which nobody can change any more."""
    field.flags.writeable = False
    return field
