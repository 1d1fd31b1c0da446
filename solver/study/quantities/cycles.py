"""Cycles of a load: energy and slip of each cycle, and the long-term fate of slip.

A cycle goes from one turning point of a load to the next but one, so that the first
loading from rest is not part of a cycle. Slip ceases, dies out, goes to and fro, or
continues in one direction (J. R. Barber, Frictional systems subjected to oscillating
loads, Ann. Solid Struct. Mech. 2, 2011). The fate is told only where the last three
cycles agree on it (MATHEMATICS.md, 15).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from solver.arrays import RESIDUE, Array
from solver.discrete.contact_groups import Stacked
from solver.latin import Iterate
from solver.settings.scene import Settings

SMALLEST_SWING = 0.05
"""Share of its range by which a path must turn back to begin another half cycle."""
NO_SWING = 1e-9
"""Share of its size by which a constant path may swing from rounding."""
LAST = 3
"""Number of last cycles that tell the fate of slip, whatever came before them."""
REPEATED = 1e-3
"""Share of its range by which a repeated load may differ from one cycle to the next."""
ALIKE = 0.02
"""Relative difference up to which the slip of the last cycles counts as equal."""
ONE_WAY = 0.05
"""Share of the slip of a cycle left at its end from which on a point ratchets."""
DIES = 0.9
"""Slip of a cycle over that of the cycle before up to which slip may be dying out."""
TENDS = 0.1
"""Limit of dying slip that counts as zero, as a share of the slip two cycles ago."""
Word = Literal[
    "elastic shakedown", "shakedown with slip that dies", "steady slip", "ratcheting"
]


def slips_of(iterate: Iterate) -> Iterator[tuple[Stacked, Array, Array]]:
    """Laws of contact, with slip of their pairs, m, and friction work, J.

    Slip and work are increments since the instant before, shape (n_pairs, n_instants).
    They are those of the local stage, whose laws hold at every iterate. A point slips
    at the friction bound of the later instant. Springs do not rub.
    """
    scales = iterate.problem.scales
    displacement = iterate.local_displacement
    force = iterate.boundary_local_force
    least_force = RESIDUE * float(np.abs(force).max(initial=0.0))
    for stacked in iterate.problem.contacts.stacks:
        law = stacked.law
        if law.is_spring:
            continue
        # Slip is the motion of the slider, without the elastic part.
        slider = law.tangential.slider(displacement, force)
        slip = np.diff(slider, axis=1, prepend=0.0)
        # What sticks moves by rounding, which takes no energy and leaves no slip.
        moved = [np.abs(displacement[rows]).max() for rows in law.tangent.sides]
        slip[np.abs(slip) <= RESIDUE * max(moved)] = 0.0
        # On its image a body moves by half of the slip.
        slip *= law.slip_ratio * scales.displacement
        # Nor does what slides take energy where rounding alone presses it.
        friction = force[law.tangent.above]
        friction = np.where(np.abs(friction) <= least_force, 0.0, friction)
        yield stacked, slip, friction * slip * -scales.force


@dataclass(frozen=True, eq=False)
class LoadCycles:
    """Slip and friction work of a run in each cycle.

    Attributes
    ----------
    ends
        Instants at which the cycles begin, and at which the last one ends: n_cycles + 1
        of them.
    slip
        Slip to and fro of each point, added up over a cycle while the point is in
        contact, shape (n_points, n_cycles), m.
    net
        Slip of each point from the beginning to the end of a cycle, same shape, m.
    work
        Friction work of each point in a cycle, times the number of points that it
        represents, same shape, J.
    before
        Slip to and fro of each point before the first cycle, shape (n_points,), m.
    is_repeated
        Whether all loads are the same in the last three cycles, or in all cycles where
        there are fewer.
    """

    ends: list[int]
    slip: Array
    net: Array
    work: Array
    before: Array
    is_repeated: bool

    def __len__(self) -> int:
        return len(self.energy)

    @property
    def energy(self) -> Array:
        """Energy dissipated in each cycle, shape (n_cycles,), J."""
        return np.asarray(self.work.sum(axis=0))


def cycles_of(settings: Settings, iterate: Iterate) -> LoadCycles:
    """Cycles of an iterate; points of all interfaces, one after another."""
    ends = cycle_ends(settings)
    contacts = iterate.problem.contacts
    slip = np.zeros((contacts.n_points, iterate.problem.n_instants))
    work = np.zeros_like(slip)
    for stacked, increments, works in slips_of(iterate):
        law = stacked.law
        slip[stacked.points] = law.mean_by_point(increments)
        work[stacked.points] = law.copies * law.by_point(works)
    slip = slip[contacts.on_surfaces]
    work = work[contacts.on_surfaces]
    status = iterate.status[contacts.on_surfaces]
    # An open point moves without friction.
    rubbed = np.where(np.abs(status) == 1, np.abs(slip), 0.0)
    if ends:
        first = ends[0]
    else:
        first = iterate.problem.n_instants - 1
    return LoadCycles(
        ends=ends,
        slip=_summed(rubbed, ends),
        net=_summed(slip, ends),
        work=_summed(work, ends),
        before=rubbed[:, : first + 1].sum(axis=1),
        is_repeated=_is_repeated(settings, ends),
    )


def cycle_ends(settings: Settings) -> list[int]:
    """Instants at which the cycles of a load begin, and the end of the last one.

    Of several loads the one with the most turning points counts, the first of equals.
    Fewer than two instants are no cycle.
    """
    turns = [turning_points(path) for path in loads_over_time(settings)]
    return max(turns, key=len, default=[])[::2]


def n_cycles_of(settings: Settings) -> int:
    """Number of cycles of a load."""
    return max(len(cycle_ends(settings)) - 1, 0)


def instants_of_cycle(settings: Settings, number: float | None = None) -> slice | None:
    """Instants of a cycle, without its first; all instants if `number` is None.

    Cycles are counted from 1. None where the load has fewer cycles.
    """
    if number is None:
        return slice(None)
    ends = cycle_ends(settings)
    last = int(number)
    if last < len(ends):
        return slice(ends[last - 1] + 1, ends[last] + 1)
    return None


def turning_points(path: Array) -> list[int]:
    """Instants at which a path, shape (n_instants,), reverses.

    Swings below `SMALLEST_SWING` are ignored. The last extreme counts, too, if it is as
    far out as the one two before it. Where an extreme value is held, its first instant
    counts.
    """
    swing = max(
        SMALLEST_SWING * float(np.ptp(path)), NO_SWING * float(np.abs(path).max())
    )
    turns: list[int] = []
    extreme = 0
    direction = 0.0
    for instant, value in enumerate(path):
        # The first direction counts once the path has left its start.
        if direction == 0.0:
            extreme = instant
            if abs(value - path[0]) > swing:
                direction = math.copysign(1.0, value - path[0])
        elif direction * (value - path[extreme]) > 0.0:
            extreme = instant
        elif direction * (path[extreme] - value) > swing:
            turns.append(extreme)
            extreme = instant
            direction = -direction
    # A path that ends on a last extreme ends with a whole cycle.
    if len(turns) > 1 and direction * (path[turns[-2]] - path[extreme]) <= swing:
        turns.append(extreme)
    return turns


def loads_over_time(settings: Settings) -> Iterator[Array]:
    """Loads over time, shape (n_instants,) each, in their units.

    Of a load that varies along a side, the point counts at which it changes most.
    """
    description = settings.structure().description()
    if description.tilt is not None:
        yield description.tilt
    for act in description.acts:
        values = np.atleast_2d(act.values)
        yield values[np.ptp(values, axis=1).argmax()]


def _is_repeated(settings: Settings, ends: list[int]) -> bool:
    """Check whether all loads have equal ends and peaks in the last cycles."""
    for path in loads_over_time(settings):
        parts = [path[a : b + 1] for a, b in pairwise(ends[-LAST - 1 :])]
        # Ends and extremes: what happens between them does not change the fate of slip.
        marks = [[part[0], part[-1], part.min(), part.max()] for part in parts]
        # A constant load, as a weight on a slope that tilts, swings from rounding.
        swing = max(REPEATED * np.ptp(path), NO_SWING * np.abs(path).max())
        if marks and np.ptp(marks, axis=0).max() > swing:
            return False
    return True


def _summed(values: Array, ends: list[int]) -> Array:
    """Sums over the instants of each cycle, shape (..., n_cycles).

    The values have shape (..., n_instants).
    """
    parts = [values[..., a + 1 : b + 1].sum(axis=-1) for a, b in pairwise(ends)]
    if parts:
        return np.stack(parts, axis=-1)
    return np.zeros((*values.shape[:-1], 0))


def fate_of(cycles: LoadCycles) -> Word | None:
    """Long-term behaviour of slip; None if undecided.

    The fate is not settled with fewer than three cycles, with cycles that are not
    alike, with slip that still changes, or without any slip.
    """
    if len(cycles) < LAST or not cycles.is_repeated or not cycles.slip.size:
        return None
    largest = cycles.slip.max(axis=0)
    if not largest.any() and not cycles.before.any():
        return None
    if not largest[-1]:
        return "elastic shakedown"
    # The point that is farthest on at the end of the last cycle.
    net = cycles.net[np.abs(cycles.net[:, -1]).argmax()]
    if np.abs(net[-1]) > ONE_WAY * largest[-1] and _settled(net[None]):
        return "ratcheting"
    # Slip that falls may still tend to a steady size: the limit decides.
    is_falling = largest[-1] <= DIES * largest[-2]
    if is_falling and _limit(largest[-3:]) <= TENDS * largest[-3]:
        return "shakedown with slip that dies"
    if _settled(cycles.slip):
        return "steady slip"
    return None


def _settled(values: Array) -> bool:
    """Check whether values, (n_points, n_cycles), are equal in the last cycles."""
    last = values[:, -LAST:]
    return bool(np.ptp(last, axis=1).max() <= ALIKE * np.abs(last[:, -1]).max())


def _limit(values: Array) -> float:
    """Limit of a geometric sequence of three values, shape (3,) (Aitken).

    Infinite if the sequence does not level off.
    """
    first, second, third = map(float, values)
    curvature = first + third - 2.0 * second
    if curvature > 0.0:
        return (first * third - second**2) / curvature
    return np.inf
