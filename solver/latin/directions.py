"""The search direction k of every boundary row, and how it may change in a run."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.indicators import behaviour_of
from solver.latin.iterate import Checkpoint, UpdateProgress, read_only
from solver.refusal import check_range

Fields = tuple[Array, Array]
"""W and F of the linear stage, shape (n_rows, n_instants) each, scaled."""

SOFTENING = 2.0
"""k at least, over the slope by which a friction of known bound falls with slip: below once the
slope the local stage has several solutions. Faults with friction_ratio 0.7 to 0.9: 1 % of the
contact force takes 11 to 77 iterations, as many with 1.5 and 3, more than 300 with 1.1 (measured).
"""
LOOK = 3
"""The iteration that tells whether bodies slip on each other anywhere. In the second one what will
stick may still slip, at a tenth of all points and instants; in the third none does where none does
in the end, and of 33 stacks all that slip at more than half a hundredth of points and instants
showed it (measured)."""
SETTLED, CALM = 0.1, 25
"""The status has settled when no larger share of all points and instants than this changed between
stick, slip forward and slip backward, so many iterations on end. Sooner, 1 % is reached later; at
a smaller share some loads wait past iteration 100."""
SLIDING = 0.3
"""Factor on the automatic k of a point that always slips; at a point that sticks for a share of the
instants, this to the power of the other share. Measured with Anderson acceleration: of 0.03, 0.1,
0.3 and 0.4 the one with the fewest iterations to 1e-6 of friction force; 0.1 takes more than no
update at all, and so does a k that is larger where points slip."""
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

    def is_due(self, progress: UpdateProgress) -> bool:
        """Whether the next iteration is to begin with `update`."""
        return False

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

    def is_due(self, progress: UpdateProgress) -> bool:
        """Whether the third iteration is done, and nothing slipped in it."""
        return progress.phase == "first" and progress.count == LOOK

    def observe(
        self, problem: Problem, progress: UpdateProgress, displacement: Array, incoming: Array
    ) -> UpdateProgress:
        """Progress, which ends in the third iteration if anything slips: then k stays."""
        if progress.phase != "first":
            return progress
        progress = replace(progress, count=progress.count + 1)
        if not self.is_due(progress):
            return progress
        force = progress.k[:, None] * (displacement - incoming)
        between = (group for group in problem.contact_groups if not group.law.is_on_support)
        slips = any(np.any(np.abs(group.status(displacement, force)) == 1) for group in between)
        return UpdateProgress("returned", progress.k) if slips else progress

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

    def is_due(self, progress: UpdateProgress) -> bool:
        """Whether the status has settled, or the new k has had its trial."""
        wait = {"first": CALM, "updated": TRIAL}.get(progress.phase)
        return wait is not None and progress.count >= wait

    def observe(
        self, problem: Problem, progress: UpdateProgress, displacement: Array, incoming: Array
    ) -> UpdateProgress:
        """Progress by what sticks and slips in a local stage, as `SearchDirection.observe`."""
        if progress.phase == "updated":
            return replace(progress, count=progress.count + 1)
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
        return replace(progress, status=status, count=progress.count + 1 if is_calm else 0)

    def update(
        self, problem: Problem, progress: UpdateProgress, fields: Fields
    ) -> tuple[UpdateProgress, Fields | None]:
        """Change k by the status, or judge such a change; as `SearchDirection.update`."""
        violation = behaviour_of(problem, *fields)
        if progress.status is not None:
            k = _profile(problem, progress)
            return UpdateProgress("updated", k, kept=fields, violation=violation), fields
        if violation < progress.violation:
            return replace(progress, count=0, kept=fields, violation=violation), None
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


def automatic(problem: Problem, *, sticks: bool = False) -> Array:
    """Search direction k of every row by a rule that needs no tuning, shape (n_rows,), scaled.

    It is that of bodies that slip on each other, or of bodies that nowhere do.

    Where bodies rub it is what `solver.laws.around` says, and where contact gives way before it
    slips that in series with its spring; elsewhere the paper's, times a factor. With the spring
    left out, 1e-6 of friction force takes 52 iterations of the bar instead of 16, and 73 of the
    strand instead of 15 (measured, geometric means over contact stiffnesses of 3 to 3000 and four
    load paths). Where friction softens it is more than the slope by which it falls.
    """
    laws = list(problem.rubbing.values())
    around = laws[0].around
    k = problem.direction * around.elsewhere
    for first, second in problem.cuts:
        k[first] *= around.on_cuts
        k[second] *= around.on_cuts
    # Rods on supports of their own slide all alike; of those beside each other one slides far.
    several = 1 if all(law.is_on_support for law in laws) else len(laws)
    parts = several / sliding_share(problem)
    for law in laws:
        law.around.choose(law, k, parts)
        if sticks:
            law.around.stick(law, k)
        if law.tangential.softens:
            for rows in law.tangent.sides:
                least = SOFTENING * len(law.tangent.sides) * law.tangential.steepest_fall
                k[rows] = np.maximum(k[rows], least)
        if law.tangential.softness is not None:
            softness = law.in_parallel(law.tangential.softness)[law.points] / law.shares
            for rows in law.tangent.sides:
                k[rows] /= 1.0 + softness * k[rows]
    return k


def sliding_share(problem: Problem) -> float:
    """Estimate the largest share of one frictional interface that ever slides.

    It is that load over all that friction can carry then, between two points and all: the load
    of one body over one interface, where there are several alike. Where displacements are
    prescribed the load is not known beforehand: on a rigid support all may slide; bodies that rub
    on each other carry no more than what the displacement alone makes of a rod, whose scaled
    stiffness is 1. Bodies on supports of their own are taken to slide all along.
    """
    first, *others = problem.rubbing.values()
    if others and all(law.is_on_support for law in problem.rubbing.values()):
        return 1.0
    capacity = first.tangential.bound.sum(axis=0)
    smallest = min(2.0 / len(first.positions), 1.0)
    load = np.zeros(problem.n_instants)
    for pulled in problem.given_forces:
        load += pulled.values.mean(axis=0)
    for moved in problem.given_displacements:
        if moved.values.any():
            if first.is_on_support:
                return 1.0
            load += moved.values.mean(axis=0)
    for part in problem.substructures:
        if part.body_force is not None:
            load += part.body_force.sum(axis=0)
    if not capacity.all():
        return 1.0
    return float(np.clip((np.abs(load) / capacity).max(), smallest, 1.0))
