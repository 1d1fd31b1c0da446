"""Search direction k of every boundary row, and its changes in a run."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array, read_only
from solver.checks import POSITIVE, check
from solver.discrete.problem import Problem
from solver.latin.iterate import Checkpoint, Iterate, KState
from solver.laws import Contact, RodStiffness

LOOK = 3
"""Iteration that shows whether bodies slip on each other anywhere. In the second,
points that will stick may still slip; of 33 stacks all that slip by more than next to
nothing showed it (measured).
"""
SOFTENING = 2.0
"""Smallest k, over the slope by which a friction of known bound falls with slip: with a
ratio below 1 the local stage has several solutions. Faults with friction_ratio 0.7 to
0.9: 1 % of the contact force takes 11 to 77 iterations, as many with 1.5 and 3, more
than 300 with 1.1 (measured).
"""


@dataclass(frozen=True)
class SearchDirection(ABC):
    """Rule for k, with a factor on it (MATHEMATICS.md, 5).

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
        """Search direction k of rows without the factor, shape (n_rows,), scaled."""

    def of(self, problem: Problem) -> Array:
        """Search direction k at the start, shape (n_rows,), scaled, read-only."""
        return read_only(self.scale * self.rule(problem))

    def begin(
        self,
        problem: Problem,
        start: Checkpoint | None,
        waves: float = math.inf,
        *,
        multiscale: bool = True,
    ) -> KState:
        """Search direction at the start of a run, or of a resumed run.

        `waves` is the length of the longest waves that a start from a coarser mesh
        leaves wrong, m, and `multiscale` says whether macro forces are balanced.
        """
        return KState(self.of(problem))

    def follow(self, iterate: Iterate, state: KState) -> KState:
        """Search direction after an iteration, for the next one."""
        return state


@dataclass(frozen=True)
class Paper(SearchDirection):
    """The paper's k: the stiffness of a substructure."""

    def rule(self, problem: Problem) -> Array:
        """Search direction k of rows without the factor, shape (n_rows,), scaled."""
        return problem.direction


@dataclass(frozen=True)
class Auto(SearchDirection):
    """Automatic k without tuning; larger between bodies that do not slip.

    A small k suits points that slip: there friction is known, and the position is
    sought. A point that has never slipped has its position from the start, and its
    force is sought, so a large k costs nothing. Where a point sticks after it has
    slipped, a large k would turn the error of its position into force: stacks of which
    13 % slip take more than 80 iterations to 1 % of the contact force with a large k,
    72 without (measured). So k changes only if nothing slips at all.

    The run then begins again, from zero. From its fields at that time, which the small
    k left apart from point to point, 1 % would take 22 to more than 120 iterations, and
    it takes 9 to 15 from zero (measured).
    """

    def rule(self, problem: Problem) -> Array:
        """Search direction k of rows without the factor, shape (n_rows,), scaled."""
        return automatic(problem)

    def begin(
        self,
        problem: Problem,
        start: Checkpoint | None,
        waves: float = math.inf,
        *,
        multiscale: bool = True,
    ) -> KState:
        """Search direction at the start, which may change between bodies only.

        In a run from the fields of another or from a coarser mesh, which are near, k
        stays.
        """
        k = self.scale * automatic(problem, waves=waves, multiscale=multiscale)
        laws = problem.contacts.laws.values()
        has_bodies = any(law.opens and not law.is_on_support for law in laws)
        is_near = start is not None or waves < math.inf
        return KState(read_only(k), is_final=is_near or not has_bodies)

    def follow(self, iterate: Iterate, state: KState) -> KState:
        """Search direction after an iteration, final after the third.

        k stays if any bodies slip on each other then.
        """
        count = state.count + 1
        if count < LOOK:
            return replace(state, count=count)
        if _slips_between_bodies(iterate):
            return KState(state.k)
        # The fields of the first k mislead: the run begins again, from zero.
        return KState(read_only(self.scale * automatic(iterate.problem, sticks=True)))


def _slips_between_bodies(iterate: Iterate) -> bool:
    """Check whether any bodies slip on each other in the local stage."""
    moved = iterate.local_displacement
    force = iterate.boundary_local_force
    for group in iterate.problem.contacts.groups:
        if not group.law.is_on_support:
            status = group.status(moved, force)
            if np.any(np.abs(status) == 1):
                return True
    return False


def automatic(
    problem: Problem,
    *,
    sticks: bool = False,
    waves: float = math.inf,
    multiscale: bool = True,
) -> Array:
    """Search direction k of every row by the automatic rule.

    Where bodies rub, k is that of `solver.laws.stiffness`, in series with the spring of
    a compliant contact; elsewhere it is the paper's k times a
    factor. With the spring left out, 1e-6 of friction force takes 52 iterations of the
    bar instead of 16, and 73 of the strand instead of 15 (measured, geometric means
    over contact stiffnesses of 3 to 3000 and four load paths). Where friction softens,
    k is larger than the slope by which it falls.

    Parameters
    ----------
    problem
        The problem to be solved.
    sticks
        Whether k is that of bodies that nowhere slip on each other, and not that of
        bodies that do.
    waves
        Length of the longest waves that are wrong, m.
    multiscale
        Whether macro forces are balanced in every iteration. Long waves that are wrong
        have to cross the cuts without them, and need a smaller k there.

    Returns
    -------
    k, shape (n_rows,), scaled.
    """
    laws = list(problem.contacts.laws.values())
    if not laws:
        return problem.direction
    stiffness_beside = laws[0].stiffness_beside
    k = problem.direction * stiffness_beside.elsewhere
    if multiscale or waves < math.inf:
        for first, second in problem.cuts:
            k[first] *= stiffness_beside.on_cuts
            k[second] *= stiffness_beside.on_cuts
    parts = _sliding_parts(problem)
    for law in laws:
        law.stiffness_beside.choose(law, k, parts, waves)
        if sticks and not isinstance(law.stiffness_beside, RodStiffness):
            law.stiffness_beside.choose_sticking(law, k)
        # The spring in series comes last, as it softens any k of the bodies.
        _raise_above_slope(law, k)
        _soften_by_contact(law, k)
    return k


def _sliding_parts(problem: Problem) -> float:
    """Number of sliding interfaces over the share of each that slides."""
    laws = problem.contacts.laws.values()
    # Rods on supports of their own slide all alike; of those beside each other one
    # slides far.
    if all(law.is_on_support for law in laws):
        several = 1
    else:
        several = len(problem.contacts)
    return several / sliding_share(problem)


def _raise_above_slope(law: Contact, k: Array) -> None:
    """Raise k, (n_rows,), in place, above the slope of a friction that softens."""
    if not law.tangential.softens:
        return
    sides = law.tangent.sides
    smallest = SOFTENING * len(sides) * law.tangential.steepest_fall
    for rows in sides:
        k[rows] = np.maximum(k[rows], smallest)


def _soften_by_contact(law: Contact, k: Array) -> None:
    """Put k, (n_rows,), in place, in series with the spring of a contact, if any."""
    if law.tangential.compliance is None:
        return
    compliance = law.in_parallel(law.tangential.compliance)[law.points] / law.shares
    for rows in law.tangent.sides:
        k[rows] /= 1.0 + compliance * k[rows]


def sliding_share(problem: Problem) -> float:
    """Estimate the largest share of one frictional interface that ever slides.

    The share is the load of one body over the friction that one interface can carry at
    the same time, and lies between that of two points and 1. Heat pushes as far forward
    at one place as backward at another, so the load is the largest of all forces
    together and of those along the body in either direction. Where displacements are
    prescribed the load is not known beforehand. On a rigid support all points may slide
    then. Bodies that rub on each other carry at most the force that the displacement
    makes of a rod, whose scaled stiffness is 1. Bodies on supports of their own count
    as sliding everywhere.
    """
    laws = problem.contacts.laws.values()
    if len(problem.contacts) > 1 and all(law.is_on_support for law in laws):
        return 1.0
    first = next(iter(problem.contacts.values()))
    # Interfaces are alike, so the first one represents all.
    capacity = first.tangential.bound.sum(axis=0)
    # Without friction at some instant all of an interface slides.
    if not capacity.all():
        return 1.0
    smallest = min(2.0 / len(first.positions), 1.0)
    load = np.zeros(problem.n_instants)
    for pulled in problem.prescribed_forces:
        load += pulled.values.mean(axis=0)
    for moved in problem.prescribed_displacements:
        if moved.values.any():
            if first.is_on_support:
                return 1.0
            load += moved.values.mean(axis=0)
    pushed = np.zeros((problem.n_dofs, problem.n_instants))
    for part in problem.substructures:
        if part.body_force is not None:
            np.add.at(pushed, part.dofs, part.body_force)
    forward = np.maximum(pushed, 0.0).sum(axis=0)
    backward = np.maximum(-pushed, 0.0).sum(axis=0)
    together = np.abs(load + forward - backward)
    load = np.maximum(together, np.maximum(forward, backward))
    return float(np.clip((load / capacity).max(), smallest, 1.0))
