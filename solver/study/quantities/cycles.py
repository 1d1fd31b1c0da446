"""A run cut into the cycles of its load: what each takes and leaves, and what becomes of slip.

Cycles go from one turning point of a load to the next but one, so that the way there
from rest is none of them. Slip ceases, dies out, goes to and fro, or goes on one way
(J. R. Barber, Frictional systems subjected to oscillating loads, Ann. Solid Struct.
Mech. 2, 2011). A word is said only where the last three cycles have earned it
(solver/README.md, 15).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from solver.arrays import Array
from solver.latin import Iterate
from solver.laws import Contact
from solver.settings.scene import Settings

SMALLEST_SWING = 0.05
"""Share of the whole range that a path must turn back by to begin another half
cycle."""
NO_SWING = 1e-9
"""Share of its size by which rounding lets a path that stands still swing."""
LAST = 3
"""Cycles from which one tells what becomes of slip, whatever came before them."""
REPEATED = 1e-3
"""Share of its range by which a load may differ from a cycle to the next."""
ALIKE = 0.02
"""Share by which the slip of the last cycles may differ where it counts as the same."""
ONE_WAY = 0.05
"""Share of the slip of a cycle that is left at its end, from which on a point goes one
way."""
DIES = 0.9
"""Slip of a cycle over that of the one before, up to which it dies, if it tends to
nothing."""
TENDS = 0.1
"""Slip that it may tend to, as a share of that two cycles ago, to count as nothing."""
Word = Literal[
    "elastic shakedown", "shakedown with slip that dies", "steady slip", "ratcheting"
]


def slips_of(iterate: Iterate) -> Iterator[tuple[Contact, Array, Array]]:
    """Interfaces with friction, the slip of their pairs, m, and the work it takes, J.

    Both from each instant to the next, shape (n_pairs, n_instants), and both of the
    local stage, whose laws hold at every iterate. A point slips at the bound of the
    instant that it slips to. Springs do not rub.
    """
    scales = iterate.problem.scales
    moved = iterate.local_displacement
    force = iterate.boundary_local_force
    for law in iterate.problem.surfaces.values():
        slip = np.diff(law.tangential.slider(moved, force), axis=1, prepend=0.0)
        slip *= law.slip_ratio * scales.displacement
        yield law, slip, force[law.tangent.above] * slip * -scales.force


@dataclass(frozen=True, eq=False)
class LoadCycles:
    """A run, cycle by cycle.

    Attributes
    ----------
    ends
        Instants at which they begin, and the last one ends, n_cycles + 1 of them.
    slip, net, work
        Of every point in each, shape (n_points, n_cycles): slip to and fro added up
        while it is in contact, m; how much farther it stands at the end, m; what
        friction takes, J, of all points that it stands for.
    before
        Slip before the first, as `slip`, shape (n_points,), m.
    is_repeated
        Whether everything that acts is the same in the last three of them, or in all of
        fewer.
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
        """What friction takes in each, shape (n_cycles,), J."""
        return np.asarray(self.work.sum(axis=0))


def cycles_of(settings: Settings, iterate: Iterate) -> LoadCycles:
    """Cycles of an iterate; points stand interface by interface."""
    ends = ends_of(settings)
    slips = []
    works = []
    for law, slip, work in slips_of(iterate):
        slips.append(law.mean_by_point(slip))
        works.append(law.copies * law.by_point(work))
    slip = np.concatenate(slips)
    work = np.concatenate(works)
    status = iterate.status[iterate.problem.on_surfaces]
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


def ends_of(settings: Settings) -> list[int]:
    """Instants at which the cycles of a load begin, and the last one ends.

    Of several loads that which turns back most often counts, the first of equals. Fewer
    than two instants are no cycle.
    """
    turns = max(
        (turning_points(path) for path in _paths(settings)), key=len, default=[]
    )
    return turns[::2]


def cycles_in(settings: Settings) -> int:
    """Number of cycles of a load."""
    return max(len(ends_of(settings)) - 1, 0)


def instants_of(settings: Settings, number: float | None = None) -> slice | None:
    """Instants of a cycle after its beginning, cycles counted from 1; all without a number.

    None where there are fewer cycles.
    """
    if number is None:
        return slice(None)
    ends = ends_of(settings)
    last = int(number)
    if last < len(ends):
        return slice(ends[last - 1] + 1, ends[last] + 1)
    return None


def turning_points(path: Array) -> list[int]:
    """Instants at which a path turns back by more than a small swing, and its end if as far out.

    Of each extreme that is held the first counts.
    """
    least = max(
        SMALLEST_SWING * float(np.ptp(path)), NO_SWING * float(np.abs(path).max())
    )
    extremes: list[int] = []
    outmost = 0
    way = 0.0
    for place, value in enumerate(path):
        if way == 0.0:
            outmost = place
            if abs(value - path[0]) > least:
                way = math.copysign(1.0, value - path[0])
        elif way * (value - path[outmost]) > 0.0:
            outmost = place
        elif way * (path[outmost] - value) > least:
            extremes.append(outmost)
            outmost = place
            way = -way
    is_closed = (
        len(extremes) > 1 and way * (path[extremes[-2]] - path[outmost]) <= least
    )
    if is_closed:
        return [*extremes, outmost]
    return extremes


def _paths(settings: Settings) -> Iterator[Array]:
    """What acts over time; of what varies along a side, the place that changes most."""
    described = settings.structure().described()
    if described.tilt is not None:
        yield described.tilt
    for act in described.acts:
        values = np.atleast_2d(act.values)
        yield values[np.ptp(values, axis=1).argmax()]


def _is_repeated(settings: Settings, ends: list[int]) -> bool:
    """Whether all that acts begins the last cycles alike, and reaches as far in them."""
    for path in _paths(settings):
        parts = [path[a : b + 1] for a, b in pairwise(ends[-LAST - 1 :])]
        seen = np.array([[part[0], part[-1], part.min(), part.max()] for part in parts])
        if len(seen) and np.ptp(seen, axis=0).max() > REPEATED * np.ptp(path):
            return False
    return True


def _summed(values: Array, ends: list[int]) -> Array:
    """Sums over the instants of each cycle, shape (..., n_cycles)."""
    parts = [values[..., a + 1 : b + 1].sum(axis=-1) for a, b in pairwise(ends)]
    if parts:
        return np.stack(parts, axis=-1)
    return np.zeros((*values.shape[:-1], 0))


def fate_of(cycles: LoadCycles) -> Word | None:
    """What becomes of slip, in a word.

    None where that is not settled: with fewer than three cycles, cycles that are not
    alike, slip that still changes, or no slip ever.
    """
    if len(cycles) < LAST or not cycles.is_repeated or not cycles.slip.size:
        return None
    most = cycles.slip.max(axis=0)
    if not most.any() and not cycles.before.any():
        return None
    if not most[-1]:
        return "elastic shakedown"
    net = cycles.net[np.abs(cycles.net[:, -1]).argmax()]
    if np.abs(net[-1]) > ONE_WAY * most[-1] and _settled(net[None]):
        return "ratcheting"
    if most[-1] <= DIES * most[-2] and _limit(most[-3:]) <= TENDS * most[-3]:
        return "shakedown with slip that dies"
    if _settled(cycles.slip):
        return "steady slip"
    return None


def _settled(values: Array) -> bool:
    """Whether values of points, (n_points, n_cycles), are the same in the last cycles."""
    last = values[:, -LAST:]
    return bool(np.ptp(last, axis=1).max() <= ALIKE * np.abs(last[:, -1]).max())


def _limit(values: Array) -> float:
    """Limit of three values of a geometric sequence (Aitken); infinite if they grow."""
    first, second, third = map(float, values)
    bend = first + third - 2.0 * second
    if bend > 0.0:
        return (first * third - second**2) / bend
    return np.inf
