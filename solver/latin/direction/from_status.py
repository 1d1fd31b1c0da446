"""A search direction k that follows what sticks and slips (solver/README.md, 5)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, read_only
from solver.checks import Part, check
from solver.discrete.problem import Problem
from solver.latin.direction.directions import Auto, SearchDirection, automatic
from solver.latin.indicators import behaviour_of
from solver.latin.iterate import Checkpoint, Iterate, UpdateProgress

SETTLED = 0.1
CALM = 25
"""The status has settled when no larger share of all points and instants than this
changed, so many iterations on end. Sooner, 1 % is reached later; at a smaller share
some loads wait past 100."""
SLIDING = 0.3
"""Factor on the automatic k of a point that always slips; at one that sticks for a
share of the instants, this to the power of the other share. With 0.1 it is worse than
no update (measured)."""
TRIAL = 20
"""Iterations after which the new k must have made the k-free indicator smaller, again
and again."""


@dataclass(frozen=True)
class FromStatus:
    """A search direction that follows the contact status, once that has settled.

    k(x, t) in separated form: a profile in x from the status, constant in t. A slipping
    point carries its bound whatever its place, so the small k that leaves its place
    free is the better one; at a point that never slips any k serves. The profile
    multiplies the automatic k, whatever k was before. It is constant in time, so each
    substructure keeps one operator for all instants.

    It never diverges where the constant k converges: at every `TRIAL` iterations the
    k-free indicator of W and F must be below that of the trial before, the update being
    the first. Otherwise the run goes back to W, F of that trial and to the old k, and
    stays there.

    Attributes
    ----------
    first
        The search direction until then.
    """

    first: SearchDirection = Auto()

    def __post_init__(self) -> None:
        check(self, first=Part(SearchDirection))

    @property
    def scale(self) -> float:
        """Factor on k of all rows."""
        return self.first.scale

    def of(self, problem: Problem) -> Array:
        """Search direction k of every row at the start, shape (n_rows,), scaled, read-only."""
        return self.first.of(problem)

    def begin(self, problem: Problem, start: Checkpoint | None) -> UpdateProgress:
        """As `SearchDirection.begin`; without contact there is no status to follow."""
        return UpdateProgress(
            "first" if problem.rubbing else "returned", self.of(problem)
        )

    def follow(self, iterate: Iterate, progress: UpdateProgress) -> UpdateProgress:
        """Progress by what sticks and slips in the local stage, or by what an update has made."""
        problem = iterate.problem
        status = None
        count = progress.count + 1
        is_calm = True
        if progress.phase == "first":
            status = _crept(iterate)
            before = progress.status
            is_calm = before is not None and float(np.mean(status != before)) <= SETTLED
        if not is_calm or count < (TRIAL if status is None else CALM):
            return replace(progress, status=status, count=count if is_calm else 0)
        moved = iterate.boundary_displacement
        fields = moved, iterate.k[:, None] * (iterate.outgoing - moved)
        if status is None:
            k = progress.k
        else:
            k = _profile(problem, status)
        violation = behaviour_of(problem, *fields)
        if status is not None or violation < progress.violation:
            return UpdateProgress("updated", k, fields=fields, violation=violation)
        return UpdateProgress("returned", self.of(problem), fields=progress.fields)


def _crept(iterate: Iterate) -> NDArray[np.int8]:
    """Contact status of the local stage, (n_points, n_instants): what creeps has not settled."""
    groups = iterate.problem.contact_groups
    moved = iterate.local_displacement
    force = None
    if any(group.law.tangential.softness is not None for group in groups):
        # A point that gives way moves while it sticks: its force tells whether it
        # slips.
        force = iterate.boundary_local_force
    n_points = sum(len(group.points) for group in groups)
    status = np.empty((n_points, moved.shape[1]), dtype=np.int8)
    for group in groups:
        status[group.points] = group.status(moved, force)
    return status


def _profile(problem: Problem, status: NDArray[np.int8]) -> Array:
    """The automatic k, smaller where points slip, shape (n_rows,)."""
    share = np.count_nonzero(status, axis=1) / status.shape[1]
    k = automatic(problem)
    for name, law in problem.rubbing.items():
        for rows in law.tangent.sides:
            k[rows] *= SLIDING ** share[problem.contact_points[name]][law.points]
    return read_only(k)
