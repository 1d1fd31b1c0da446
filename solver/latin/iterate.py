"""What the iteration shows: read-only snapshots, whose fields are computed when looked at."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, read_only
from solver.discrete.contacts import ContactFields, contact_fields
from solver.discrete.problem import Problem
from solver.latin.indicators import behaviour_of, contact_status, latin_indicator
from solver.reduction.basis import SharedBasis


@dataclass(frozen=True, eq=False)
class UpdateProgress:
    """How far the update of k has come, and the k of the next iteration, shape (n_rows,).

    Attributes
    ----------
    phase
        Whether k is that of the start and may change ("first"), another on trial
        ("updated"), or stays as it is ("returned").
    count
        First: iterations on end with hardly a change of status. Updated: iterations
        since the last trial.
    status
        Contact status of the last iteration, shape (n_points, n_instants), where k
        follows it.
    fields, violation
        W and F of the linear stage at the last trial, shape (n_rows, n_instants) each,
        from where the next iteration goes on if its k is another; and the k-free
        indicator of these.
    """

    phase: Literal["first", "updated", "returned"]
    k: Array
    count: int = 0
    status: NDArray[np.int8] | None = None
    fields: tuple[Array, ...] = ()
    violation: float = np.inf


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """From where an iteration can go on: exactly, but for an acceleration, which begins anew.

    Attributes
    ----------
    outgoing, bases
        W + F/k of the linear stage, shape (n_rows, n_instants), scaled, and the bases
        that hold it, if any do.
    course
        How far the update of k has come; None where the fields are those of another
        run.
    """

    number: int
    seconds: float
    outgoing: Array
    bases: tuple[SharedBasis, ...] = ()
    course: UpdateProgress | None = None


@dataclass(frozen=True, eq=False)
class Iterate:
    """One LATIN iterate: the linear stage's s and the local stage's s^ that it came from.

    Properties without a leading "boundary" are SI fields of the whole structure.

    Attributes
    ----------
    number, seconds
        Iterations done, and time that the method took so far, set-up included, looking
        excluded.
    k
        Search direction of the rows, shape (n_rows,), scaled.
    outgoing, incoming
        W + F/k and W - F/k of the linear stage, shape (n_rows, n_instants), scaled,
        read-only.
    local_displacement
        W^ of the local stage, same shape, bit by bit as the laws gave it.
    local_incoming
        W - F/k that the local stage read, which is its own W^ - F^/k.
    bases
        The separated bases that hold the linear stage, one per substructure, if any do;
        of a certified solution those of the search that led to it, which hold less than
        it is.
    course
        How far the update of k has come, with the k of the next iteration.
    residual
        Of an iterate that is a certified solution (`solver.latin.end.certified`), its
        KKT residual relative to the contact force; None of all others.
    force
        F of such a one, shape (n_rows, n_instants), scaled: beside a body's rigid
        motion the digits of F/k may be lost.
    is_answer
        Whether such a one stands beside the iterates of a search that came to its own
        end, and so is no iteration.
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
        new = self.course
        if new is not None and new.k is not self.k:
            displacement, force = new.fields
            outgoing = read_only(displacement + force / new.k[:, None])
            return Checkpoint(self.number, self.seconds, outgoing, course=new)
        if self.residual is None:
            bases = self.bases
        else:
            bases = ()
        return Checkpoint(self.number, self.seconds, self.outgoing, bases, self.course)

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
        return behaviour_of(
            self.problem, self.boundary_displacement, self.boundary_force
        )

    @cached_property
    def displacement(self) -> Array:
        """Displacement of the linear stage, shape (n_dofs, n_instants), m; mean at cuts."""
        mean = self.problem.mean_of_rows @ self.boundary_displacement
        return np.asarray(mean) * self.problem.scales.displacement

    @cached_property
    def contact_force(self) -> Array:
        """Nodal forces of all interfaces with friction on the bodies above, linear stage, N.

        Shape (n_forces, n_instants), stacked as `Problem.sum_of_contact` says; friction
        is as the law says where only its sum with a reaction can be found.
        """
        force = np.asarray(self.problem.sum_of_contact @ self.boundary_force)
        force = self.problem.with_driven_friction(force, self.boundary_displacement)
        return force * self.problem.scales.force

    @property
    def friction_force(self) -> Array:
        """Nodal friction force on the body above, linear stage, (n_points, n_instants), N.

        Points of all interfaces with friction, one interface after the other.
        """
        places = [own[-1] for own in self.problem.contact_places.values()]
        nothing = np.zeros((0, self.problem.n_instants))
        return np.concatenate([nothing, *(self.contact_force[own] for own in places)])

    def contact(self, name: str) -> ContactFields:
        """One interface with friction: forces of the linear stage, status of the local one."""
        status = self.status[self.problem.contact_points[name]]
        moved = self.boundary_displacement
        return contact_fields(self.problem, name, self.contact_force, moved, status)

    @cached_property
    def status(self) -> NDArray[np.int8]:
        """Contact status of the local stage, shape (n_points, n_instants).

        -1 is slip backward, 0 stick, +1 slip forward, `OPEN` without contact. Points of
        all interfaces with friction, one interface after the other.
        """
        return contact_status(self)
