"""The search direction k of every boundary row, and how it may change in a run."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.automatic_k import automatic
from solver.latin.indicators import behaviour_of
from solver.latin.iterate import Checkpoint, UpdateProgress, read_only
from solver.refusal import check_range

Fields = tuple[Array, Array]
"""W and F of the linear stage, shape (n_rows, n_instants) each, scaled."""

LOOK = 3
"""The iteration that tells whether bodies slip on each other anywhere. In the second what will
stick may still slip; of 33 stacks all that slip by more than next to nothing showed it (measured).
"""
SETTLED, CALM = 0.1, 25
"""The status has settled when no larger share of all points and instants than this changed, so many
iterations on end. Sooner, 1 % is reached later; at a smaller share some loads wait past 100."""
SLIDING = 0.3
"""Factor on the automatic k of a point that always slips; at one that sticks for a share of the
instants, this to the power of the other share. With 0.1 it is worse than no update (measured)."""
TRIAL = 20
"""Iterations after which the new k must have made the k-free indicator smaller, again and again."""


@dataclass(frozen=True)
class SearchDirection(ABC):
    """A rule for k, and factors on it (solver/README.md, 5).

    Attributes
    ----------
    scale
        Factor on k of all rows.
    along, across
        Further factors on k of contacts, of tangential and of normal components.

    Raises
    ------
    RefusedError
        For a factor that is not above zero.
    """

    scale: float = 1.0
    along: float = 1.0
    across: float = 1.0

    def __post_init__(self) -> None:
        for name in ("scale", "along", "across"):
            check_range(self, name, 0.0, np.inf, above=True)

    @abstractmethod
    def rule(self, problem: Problem) -> Array:
        """Search direction k of every row without the factors, shape (n_rows,), scaled."""

    def of(self, problem: Problem) -> Array:
        """Search direction k of every row at the start, shape (n_rows,), scaled, read-only."""
        return self._with_factors(problem, self.rule(problem))

    def begin(self, problem: Problem, start: Checkpoint | None) -> UpdateProgress:
        """Progress of a run that goes on from a checkpoint, if from any: k, and how it changes."""
        return UpdateProgress("returned", self.of(problem))

    def observe(
        self, problem: Problem, progress: UpdateProgress, displacement: Array, incoming: Array
    ) -> UpdateProgress:
        """Progress after a local stage: its W^, and W - F/k that it read, (n_rows, n_instants)."""
        return progress

    def update(
        self, problem: Problem, progress: UpdateProgress, fields: Fields
    ) -> tuple[UpdateProgress, Fields | None]:
        """How k changes, and where it does the fields to go on from."""
        return progress, None

    def _with_factors(self, problem: Problem, k: Array) -> Array:
        k = self.scale * k
        for law in problem.rubbing.values():
            for rows in law.tangent.sides:
                k[rows] *= self.along
            if law.normal is not None:
                for rows in law.normal.component.sides:
                    k[rows] *= self.across
        return read_only(np.ascontiguousarray(k))


@dataclass(frozen=True)
class Paper(SearchDirection):
    """The paper's k: the stiffness of a substructure."""

    def rule(self, problem: Problem) -> Array:
        """Search direction k of every row without the factors, shape (n_rows,), scaled."""
        return problem.direction


@dataclass(frozen=True)
class Auto(SearchDirection):
    """The automatic k, which needs no tuning; between bodies that nowhere slip it becomes larger.

    Small k is for what slips: there friction is known, and the place is sought. What has never
    slipped has its place from the start, so it loses nothing by a large k; it is the force that is
    sought. Where a point sticks after it has slipped, a large k would make force of all that its
    place is wrong by: stacks of which 13 % slip take more than 80 iterations to 1 % of the contact
    force with it, 72 without (measured). So k changes only if nothing slips at all.

    The run then begins anew. From its fields at that time, which the small k left apart from point
    to point, 22 to more than 120 iterations to 1 % follow, and 9 to 15 from zero (measured).
    """

    def rule(self, problem: Problem) -> Array:
        """Search direction k of every row without the factors, shape (n_rows,), scaled."""
        return automatic(problem)

    def begin(self, problem: Problem, start: Checkpoint | None) -> UpdateProgress:
        """Progress at the start; k stays in a run from the fields of another, which are near."""
        if start is not None and start.course is not None:
            return start.course
        laws = problem.rubbing.values()
        may_stick = start is None and any(law.opens and not law.is_on_support for law in laws)
        return UpdateProgress("first" if may_stick else "returned", self.of(problem))

    def observe(
        self, problem: Problem, progress: UpdateProgress, displacement: Array, incoming: Array
    ) -> UpdateProgress:
        """Progress, which ends in the third iteration if anything slips: then k stays."""
        if progress.phase != "first":
            return progress
        progress = replace(progress, count=progress.count + 1)
        if progress.count < LOOK:
            return progress
        force = progress.k[:, None] * (displacement - incoming)
        between = (group for group in problem.contact_groups if not group.law.is_on_support)
        slips = any(np.any(np.abs(group.status(displacement, force)) == 1) for group in between)
        return UpdateProgress("returned", progress.k) if slips else replace(progress, is_due=True)

    def update(
        self, problem: Problem, progress: UpdateProgress, fields: Fields
    ) -> tuple[UpdateProgress, Fields]:
        """Change k to that of bodies that stick, and begin anew from zero."""
        k = self._with_factors(problem, automatic(problem, sticks=True))
        displacement, force = fields
        return UpdateProgress("updated", k), (np.zeros_like(displacement), np.zeros_like(force))


@dataclass(frozen=True)
class FromStatus:
    """A search direction that follows the contact status, once that has settled.

    k(x, t) in separated form: a profile in x from the status, constant in t. A slipping point
    carries its bound whatever its place, so the small k that leaves its place free is the better
    one; at a point that never slips any k serves. The profile multiplies the automatic k, whatever
    k was before. It is constant in time, so each substructure keeps one operator for all instants.

    It never diverges where the constant k converges: at every `TRIAL` iterations the k-free
    indicator of W and F must be below that of the trial before, the update being the first.
    Otherwise the run goes back to W, F of that trial and to the old k, and stays there.

    Attributes
    ----------
    first
        The search direction until then.
    """

    first: SearchDirection = Auto()

    @property
    def scale(self) -> float:
        """Factor on k of all rows."""
        return self.first.scale

    def of(self, problem: Problem) -> Array:
        """Search direction k of every row at the start, shape (n_rows,), scaled, read-only."""
        return self.first.of(problem)

    def begin(self, problem: Problem, start: Checkpoint | None) -> UpdateProgress:
        """As `SearchDirection.begin`."""
        progress = start.course if start else None
        return progress or UpdateProgress("first", self.of(problem))

    def observe(
        self, problem: Problem, progress: UpdateProgress, displacement: Array, incoming: Array
    ) -> UpdateProgress:
        """Progress by what sticks and slips in a local stage, as `SearchDirection.observe`."""
        if progress.phase == "updated":
            count = progress.count + 1
            return replace(progress, count=count, is_due=count >= TRIAL)
        if progress.phase != "first":
            return progress
        groups, force = problem.contact_groups, None
        if any(group.law.tangential.softness is not None for group in groups):
            # A point that gives way moves while it sticks: its force tells whether it slips.
            force = progress.k[:, None] * (displacement - incoming)
        # Creep counts as slip: what still changes has not settled.
        n_points = sum(len(group.points) for group in groups)
        status = np.empty((n_points, displacement.shape[1]), dtype=np.int8)
        for group in groups:
            status[group.points] = group.status(displacement, force)
        before = progress.status
        is_calm = before is not None and float(np.mean(status != before)) <= SETTLED
        count = progress.count + 1 if is_calm else 0
        return replace(progress, status=status, count=count, is_due=count >= CALM)

    def update(
        self, problem: Problem, progress: UpdateProgress, fields: Fields
    ) -> tuple[UpdateProgress, Fields | None]:
        """Change k by the status, or judge such a change; as `SearchDirection.update`."""
        violation = behaviour_of(problem, *fields)
        if progress.status is not None:
            k = _profile(problem, progress)
            return UpdateProgress("updated", k, kept=fields, violation=violation), fields
        if violation < progress.violation:
            return UpdateProgress("updated", progress.k, kept=fields, violation=violation), None
        return UpdateProgress("returned", self.of(problem)), progress.kept


def _profile(problem: Problem, progress: UpdateProgress) -> Array:
    """The automatic k, smaller where points slip, shape (n_rows,)."""
    assert progress.status is not None
    share = np.count_nonzero(progress.status, axis=1) / progress.status.shape[1]
    k, first = automatic(problem), 0
    for law in problem.rubbing.values():
        for rows in law.tangent.sides:
            k[rows] *= SLIDING ** share[first + law.points]
        first += len(law.positions)
    return read_only(k)
