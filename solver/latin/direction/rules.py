"""The search direction k of every boundary row, at the start of a run."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.direction.changing import ChangingDirection
from solver.latin.direction.sticking import UntilNothingSlips
from solver.latin.iterate import Checkpoint, UpdateProgress
from solver.refusal import check_range

SOFTENING = 2.0
"""k at least, over the slope by which a friction of known bound falls with slip: below once the
slope the local stage has several solutions. Faults with friction_ratio 0.7 to 0.9: 1 % of the
contact force takes 77, 21, 18 and 11 iterations; 87, 21, 14 and 13 with 1.5, 81, 26, 20 and 9 with
3, and more than 300 with 1.1 or with half the slope (measured)."""


class ConstantDirection:
    """A search direction that stays what it is.

    Parameters
    ----------
    k
        Shape (n_rows,), scaled, read-only.
    """

    is_due = False
    course: UpdateProgress | None = None

    def __init__(self, k: Array) -> None:
        self.k = k

    def see(self, local_displacement: Array, incoming: Array) -> None:
        """Nothing depends on the local stage."""

    def turn(self, displacement: Array, force: Array) -> tuple[Array, Array] | None:
        """Nothing changes."""
        return None


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
        """Give k of every row without the factors, shape (n_rows,), scaled."""

    def of(self, problem: Problem) -> Array:
        """Give k of every row, shape (n_rows,), scaled, read-only."""
        return self._with_factors(problem, self.rule(problem))

    def _with_factors(self, problem: Problem, k: Array) -> Array:
        k = self.scale * k
        for law in problem.rubbing.values():
            for rows in law.tangent.sides:
                k[rows] *= self.along
            if law.normal is not None:
                for rows in law.normal.component.sides:
                    k[rows] *= self.across
        k = np.ascontiguousarray(k)
        k.flags.writeable = False
        return k

    def at_work(
        self, problem: Problem, start: Checkpoint | None
    ) -> ConstantDirection | ChangingDirection:
        """Give k of a problem to a run that goes on from a checkpoint, if from any."""
        return ConstantDirection(self.of(problem))


@dataclass(frozen=True)
class Paper(SearchDirection):
    """The paper's k: the stiffness of a substructure."""

    def rule(self, problem: Problem) -> Array:
        """Give k of every row without the factors, shape (n_rows,), scaled."""
        return problem.direction


@dataclass(frozen=True)
class Auto(SearchDirection):
    """The automatic k, which needs no tuning."""

    def rule(self, problem: Problem) -> Array:
        """Give k of every row without the factors, shape (n_rows,), scaled."""
        return automatic(problem)

    def at_work(
        self, problem: Problem, start: Checkpoint | None
    ) -> ConstantDirection | ChangingDirection:
        """Give k of a problem to a run; between bodies that nowhere slip it becomes larger.

        Not so in a run from the fields of another, which are near already.
        """
        k = self.of(problem)
        is_near = start is not None and start.course is None
        laws = problem.rubbing.values()
        if is_near or not any(law.opens and not law.is_on_support for law in laws):
            return ConstantDirection(k)
        stuck = self._with_factors(problem, automatic(problem, sticks=True))
        return UntilNothingSlips(problem, k, stuck, start.course if start else None)


def automatic(problem: Problem, *, sticks: bool = False) -> Array:
    """Give k of every row by a rule that needs no tuning, shape (n_rows,), scaled.

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
            softness = law.compliance[law.points] / law.shares
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
