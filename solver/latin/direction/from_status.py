"""Search direction k that follows the contact status (MATHEMATICS.md, 5)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, read_only
from solver.checks import InstanceOf, check
from solver.discrete.problem import Problem
from solver.latin.direction.directions import Auto, SearchDirection, automatic
from solver.latin.indicators import violation_of
from solver.latin.iterate import Checkpoint, Iterate, UpdateProgress

SETTLED = 0.1
"""Largest share of all points and instants whose status may change in an iteration
while it counts as settled; at a smaller share some loads wait past 100 iterations."""
CALM = 25
"""Successive iterations with so few changes after which the status has settled; with
fewer, 1 % is reached later."""
SLIDING = 0.3
"""Factor on the automatic k of a point that always slips; for a point that slips for a
share of the instants, this factor to the power of the share. With 0.1 the update is
worse than none (measured)."""
TRIAL = 20
"""Iterations between two trials, in each of which the k-free indicator must be smaller
than in the one before."""


@dataclass(frozen=True)
class FromStatus:
    """Search direction that follows the contact status once it no longer changes.

    k(x, t) has a separated form: a profile in x from the status, constant in t. A
    slipping point carries its bound whatever its position, so the small k that leaves
    its position free is the better one; at a point that never slips any k serves. The
    profile multiplies the automatic k, whatever k was before. It is constant in time,
    so each substructure keeps one operator for all instants.

    The iteration never diverges where the constant k converges: at every `TRIAL`
    iterations the k-free indicator of W and F must be below that of the trial before,
    the update being the first. Otherwise the run goes back to W and F of that trial and
    to the old k, and stays there.

    It is for a k that does not suit, as the paper's: 1 % of the contact force takes 53
    iterations of the rope instead of 178, 47 of the strand instead of 381, 98 of the
    layers and 87 of the bundle instead of more than 400. The automatic k leaves nothing
    to gain: no default run comes there sooner, and that of the belt takes 127
    iterations instead of 42 (measured).

    Attributes
    ----------
    first
        Search direction until the status has settled.
    """

    first: SearchDirection = Auto()

    def __post_init__(self) -> None:
        check(self, first=InstanceOf(SearchDirection))

    @property
    def scale(self) -> float:
        """Factor on k of all rows."""
        return self.first.scale

    def of(self, problem: Problem) -> Array:
        """Search direction k at the start, shape (n_rows,), scaled, read-only."""
        return self.first.of(problem)

    def begin(
        self, problem: Problem, start: Checkpoint | None, waves: float = math.inf
    ) -> UpdateProgress:
        """State of the k update at the start; without contact k stays."""
        if problem.contacts:
            return UpdateProgress("first", self.of(problem))
        return UpdateProgress("returned", self.of(problem))

    def follow(self, iterate: Iterate, progress: UpdateProgress) -> UpdateProgress:
        """State of the k update after an iteration, with the next iteration's k."""
        if progress.state == "first":
            return self._until_settled(iterate, progress)
        return self._on_trial(iterate, progress)

    def _until_settled(
        self, iterate: Iterate, progress: UpdateProgress
    ) -> UpdateProgress:
        """State of the first k: updated once the status no longer changes."""
        status = _crept(iterate)
        before = progress.status
        count = 0
        if before is not None and float(np.mean(status != before)) <= SETTLED:
            count = progress.count + 1
        if count < CALM:
            return replace(progress, status=status, count=count)
        fields = _fields(iterate)
        # W and F do not depend on k, so they are what the run continues from, or back
        # to.
        k = _profile(iterate.problem, status)
        violation = violation_of(iterate.problem, *fields)
        return UpdateProgress("updated", k, fields=fields, violation=violation)

    def _on_trial(self, iterate: Iterate, progress: UpdateProgress) -> UpdateProgress:
        """State of an updated k: kept while the violation of the laws falls."""
        count = progress.count + 1
        if count < TRIAL:
            return replace(progress, status=None, count=count)
        fields = _fields(iterate)
        violation = violation_of(iterate.problem, *fields)
        if violation < progress.violation:
            return UpdateProgress(
                "updated", progress.k, fields=fields, violation=violation
            )
        return UpdateProgress(
            "returned", self.of(iterate.problem), fields=progress.fields
        )


def _fields(iterate: Iterate) -> tuple[Array, Array]:
    """W and F of the linear stage, shape (n_rows, n_instants) each, scaled."""
    displacement = iterate.boundary_displacement
    return displacement, iterate.k[:, None] * (iterate.outgoing - displacement)


def _crept(iterate: Iterate) -> NDArray[np.int8]:
    """Contact status of the local stage, in which creep counts as slip.

    Shape (n_points, n_instants). A point that creeps has not settled.
    """
    groups = iterate.problem.contacts.groups
    moved = iterate.local_displacement
    force = None
    if any(group.law.tangential.compliance is not None for group in groups):
        # A compliant point moves while it sticks: its force tells whether it
        # slips.
        force = iterate.boundary_local_force
    n_points = iterate.problem.contacts.n_points
    status = np.empty((n_points, moved.shape[1]), dtype=np.int8)
    for group in groups:
        status[group.points] = group.status(moved, force)
    return status


def _profile(problem: Problem, status: NDArray[np.int8]) -> Array:
    """Automatic k, smaller where points slip, shape (n_rows,), scaled, read-only.

    `status` has shape (n_points, n_instants).
    """
    # Stick is 0, so nonzero statuses are slip, or open contact.
    share = np.count_nonzero(status, axis=1) / status.shape[1]
    k = automatic(problem)
    for law, _, points, _ in problem.contacts.stacks:
        for rows in law.tangent.sides:
            k[rows] *= SLIDING ** share[points][law.points]
    return read_only(k)
