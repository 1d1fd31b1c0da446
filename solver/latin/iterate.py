"""What the iteration shows: read-only snapshots, whose fields are computed when looked at."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.contact_fields import ContactFields, contact_fields
from solver.discrete.problem import Problem
from solver.reduction.basis import Modes, Reduction, ReferencePoints


@dataclass(frozen=True, eq=False)
class Course:
    """How far the update of k has come.

    Attributes
    ----------
    phase
        Whether k is still that of the start ("first"), on trial ("updated"), or that of the start
        for good ("returned").
    k
        Search direction of the rows, shape (n_rows,).
    count
        First: iterations on end with hardly a change of status. Updated: iterations since the last
        trial.
    status
        Contact status of the iteration before, shape (n_points, n_instants); None after the first
        phase, and before the first iteration.
    kept
        Updated: W and F of the linear stage at the last trial, shape (n_rows, n_instants) each.
    violation
        Updated: the k-free indicator of these.
    """

    phase: Literal["first", "updated", "returned"]
    k: Array
    count: int = 0
    status: NDArray[np.int8] | None = None
    kept: tuple[Array, Array] | None = None
    violation: float = np.inf


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """From where an iteration can go on exactly.

    Attributes
    ----------
    number, seconds
        Iterations done and time taken so far.
    outgoing
        W + F/k of the linear stage, shape (n_rows, n_instants), scaled.
    reduction
        The separated bases that hold it, if any do.
    references
        Where a reduced local stage evaluates the laws, if there is one.
    history
        The states before, oldest first, that an acceleration remembers.
    memory
        What it counts: states seen, differences, and the smallest residual.
    course
        Of the update of k, if there is one.
    """

    number: int
    seconds: float
    outgoing: Array
    reduction: Reduction | None = None
    references: ReferencePoints | None = None
    history: tuple[Array, ...] = ()
    memory: tuple[int, int, float] | None = None
    course: Course | None = None

    @property
    def nbytes(self) -> int:
        """Bytes that it keeps, though others may share them."""
        kept = self.course.kept if self.course else None
        return self.outgoing.nbytes * (1 + len(self.history) + len(kept or ()))


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
        The separated bases that hold the linear stage, if any do.
    references
        Where a reduced local stage evaluates the laws, if there is one.
    local_error
        Relative distance of what the reduced local stage rebuilt from what the laws say
        everywhere, in the norm of the search direction; 0 where they were evaluated everywhere.
    history, memory, course
        Of an acceleration and of the update of k, as in `Checkpoint`.
    residual
        Of an iterate that is a certified solution (`solver.latin.status_step`), its KKT residual
        relative to the contact force; None of all others.
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
    references: ReferencePoints | None = None
    local_error: float = 0.0
    history: tuple[Array, ...] = ()
    memory: tuple[int, int, float] | None = None
    course: Course | None = None
    residual: float | None = None

    @property
    def checkpoint(self) -> Checkpoint:
        """What is needed to go on from here.

        Raises
        ------
        ValueError
            If the run was told that nobody would.
        """
        if self.memory is not None and self.memory[0] and not self.history:
            raise ValueError("an accelerated run has checkpoints if it is made resumable")
        return Checkpoint(
            self.number,
            self.seconds,
            self.outgoing,
            self.reduction,
            self.references,
            self.history,
            self.memory,
            self.course,
        )

    @property
    def bases(self) -> tuple[Modes, ...]:
        """Modes of every substructure; none when the linear stage is full."""
        return self.reduction.modes if self.reduction else ()

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
    def displacement(self) -> Array:
        """Displacement of the linear stage, shape (n_dofs, n_instants), m; mean at cuts."""
        found = self.problem.mean_of_rows @ self.boundary_displacement
        return np.asarray(found) * self.problem.scales.displacement

    @cached_property
    def contact_force(self) -> Array:
        """Nodal forces of all interfaces with friction on the bodies above, linear stage, N.

        Shape (n_forces, n_instants), stacked as `Problem.sum_of_contact` says.
        """
        found = self.problem.sum_of_contact @ self.boundary_force
        return np.asarray(found) * self.problem.scales.force

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
        """Show one interface with friction: forces of the linear stage, status of the local one."""
        law = self.problem.rubbing[name]
        return contact_fields(
            self.problem,
            name,
            self.contact_force,
            self.boundary_displacement,
            law.status(self.local_displacement, self.boundary_local_force),
        )

    @cached_property
    def status(self) -> NDArray[np.int8]:
        """Contact status of the local stage, shape (n_points, n_instants), as in `Friction.status`.

        Points of all interfaces with friction, one interface after the other.
        """
        reads = any(law.reads_force for law in self.problem.rubbing.values())
        force = self.boundary_local_force if reads else None
        return contact_status(self.problem, self.local_displacement, force)


def contact_status(
    problem: Problem, displacement: Array, force: Array | None = None
) -> NDArray[np.int8]:
    """Give the contact status, as `Iterate.status`, of W^ and F^ of all rows."""
    laws = problem.rubbing.values()
    return np.concatenate([law.status(displacement, force) for law in laws])
