"""The search direction k of every boundary row, and how it may change in a run."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array, read_only
from solver.checks import POSITIVE, check
from solver.discrete.problem import Problem
from solver.latin.iterate import Checkpoint, Iterate, UpdateProgress
from solver.laws import Bodies

LOOK = 3
"""The iteration that tells whether bodies slip on each other anywhere. In the second
what will stick may still slip; of 33 stacks all that slip by more than next to nothing
showed it (measured).
"""
SOFTENING = 2.0
"""k at least, over the slope by which a friction of known bound falls with slip: below
once the slope the local stage has several solutions. Faults with friction_ratio 0.7 to
0.9: 1 % of the contact force takes 11 to 77 iterations, as many with 1.5 and 3, more
than 300 with 1.1 (measured).
"""


@dataclass(frozen=True)
class SearchDirection(ABC):
    """A rule for k, and a factor on it (solver/README.md, 5).

    Attributes
    ----------
    scale
        Factor on k of all rows.

    Raises
    ------
    RefusedError
        For a factor that is not above zero.
    """

    scale: float = 1.0

    def __post_init__(self) -> None:
        check(self, scale=POSITIVE)

    @abstractmethod
    def rule(self, problem: Problem) -> Array:
        """Search direction k of every row without the factor, shape (n_rows,), scaled."""

    def of(self, problem: Problem) -> Array:
        """Search direction k of every row at the start, shape (n_rows,), scaled, read-only."""
        return read_only(self.scale * self.rule(problem))

    def begin(self, problem: Problem, start: Checkpoint | None) -> UpdateProgress:
        """Progress of a run from a checkpoint without any, or from none: k, and how it changes."""
        return UpdateProgress("returned", self.of(problem))

    def follow(self, iterate: Iterate, progress: UpdateProgress) -> UpdateProgress:
        """Progress after an iteration, with the k of the next."""
        return progress


@dataclass(frozen=True)
class Paper(SearchDirection):
    """The paper's k: the stiffness of a substructure."""

    def rule(self, problem: Problem) -> Array:
        """Search direction k of every row without the factor, shape (n_rows,), scaled."""
        return problem.direction


@dataclass(frozen=True)
class Auto(SearchDirection):
    """The automatic k, which needs no tuning; between bodies that nowhere slip it becomes larger.

    Small k is for what slips: there friction is known, and the place is sought. What
    has never slipped has its place from the start, so it loses nothing by a large k; it
    is the force that is sought. Where a point sticks after it has slipped, a large k
    would make force of all that its place is wrong by: stacks of which 13 % slip take
    more than 80 iterations to 1 % of the contact force with it, 72 without (measured).
    So k changes only if nothing slips at all.

    The run then begins anew. From its fields at that time, which the small k left apart
    from point to point, 22 to more than 120 iterations to 1 % follow, and 9 to 15 from
    zero (measured).
    """

    def rule(self, problem: Problem) -> Array:
        """Search direction k of every row without the factor, shape (n_rows,), scaled."""
        return automatic(problem)

    def begin(self, problem: Problem, start: Checkpoint | None) -> UpdateProgress:
        """Progress at the start; k stays in a run from the fields of another, which are near."""
        laws = problem.rubbing.values()
        may_stick = start is None and any(
            law.opens and not law.is_on_support for law in laws
        )
        return UpdateProgress("first" if may_stick else "returned", self.of(problem))

    def follow(self, iterate: Iterate, progress: UpdateProgress) -> UpdateProgress:
        """Progress, which ends in the third iteration: k stays if anything slips."""
        problem = iterate.problem
        if progress.count + 1 < LOOK:
            return replace(progress, count=progress.count + 1)
        local = iterate.local_displacement, iterate.boundary_local_force
        between = (
            group for group in problem.contact_groups if not group.law.is_on_support
        )
        if any(np.any(np.abs(group.status(*local)) == 1) for group in between):
            return UpdateProgress("returned", progress.k)
        k = read_only(self.scale * automatic(problem, sticks=True))
        zero = np.zeros_like(iterate.outgoing)
        return UpdateProgress("returned", k, fields=(zero, zero))


def automatic(problem: Problem, *, sticks: bool = False) -> Array:
    """Search direction k of every row by a rule that needs no tuning, shape (n_rows,), scaled.

    It is that of bodies that slip on each other, or of bodies that nowhere do.

    Where bodies rub it is what `solver.laws.stiffness` says, and where contact gives
    way before it slips that in series with its spring; elsewhere the paper's, times a
    factor. With the spring left out, 1e-6 of friction force takes 52 iterations of the
    bar instead of 16, and 73 of the strand instead of 15 (measured, geometric means
    over contact stiffnesses of 3 to 3000 and four load paths). Where friction softens
    it is more than the slope by which it falls.
    """
    laws = list(problem.rubbing.values())
    if not laws:
        return problem.direction
    around = laws[0].around
    k = problem.direction * around.elsewhere
    for first, second in problem.cuts:
        k[first] *= around.on_cuts
        k[second] *= around.on_cuts
    # Rods on supports of their own slide all alike; of those beside each other one
    # slides far.
    if all(law.is_on_support for law in laws):
        several = 1
    else:
        several = len(laws)
    parts = several / sliding_share(problem)
    for law in laws:
        law.around.choose(law, k, parts)
        if sticks and isinstance(law.around, Bodies):
            law.around.stick(law, k)
        if law.tangential.softens:
            for rows in law.tangent.sides:
                least = (
                    SOFTENING * len(law.tangent.sides) * law.tangential.steepest_fall
                )
                k[rows] = np.maximum(k[rows], least)
        if law.tangential.softness is not None:
            softness = law.in_parallel(law.tangential.softness)[law.points] / law.shares
            for rows in law.tangent.sides:
                k[rows] /= 1.0 + softness * k[rows]
    return k


def sliding_share(problem: Problem) -> float:
    """Estimate the largest share of one frictional interface that ever slides.

    It is that load over all that friction can carry then, between two points and all:
    the load of one body over one interface, where there are several alike. Where
    displacements are prescribed the load is not known beforehand: on a rigid support
    all may slide; bodies that rub on each other carry no more than what the
    displacement alone makes of a rod, whose scaled stiffness is 1. Bodies on supports
    of their own are taken to slide all along.
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
