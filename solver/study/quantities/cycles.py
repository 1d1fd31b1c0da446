"""A run cut into the cycles of its load: what each of them takes, and what it leaves behind.

Cycles go from one turning point of a load to the next but one, so that the way there from rest is
none of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from solver.arrays import Array
from solver.latin import Iterate
from solver.scenes import structure_of
from solver.settings import Settings
from solver.study.quantities.slips import slips_of

SMALLEST_SWING = 0.05
"""Share of the whole range that a path must turn back by to begin another half cycle."""
NO_SWING = 1e-9
"""Share of its size by which rounding lets a path that stands still swing."""
LAST = 3
"""Cycles from which one tells what becomes of slip, whatever came before them."""
REPEATED = 1e-3
"""Share of its range by which a load may differ from a cycle to the next."""


@dataclass(frozen=True, eq=False)
class LoadCycles:
    """A run, cycle by cycle.

    Attributes
    ----------
    ends
        Instants at which they begin, and the last one ends, n_cycles + 1 of them.
    energy
        What friction takes in each, shape (n_cycles,), J.
    slip
        That of every point in each, all to and fro added up while it is in contact, shape
        (n_points, n_cycles), m.
    net
        How much farther a point stands at the end of each, same shape, m.
    work
        What friction takes at every point in each, same shape, J.
    before
        Slip before the first, as `slip`, shape (n_points,), m.
    is_repeated
        Whether everything that acts is the same in the last three of them, or in all of fewer.
    """

    ends: list[int]
    energy: Array
    slip: Array
    net: Array
    work: Array
    before: Array
    is_repeated: bool

    def __len__(self) -> int:
        return len(self.energy)


def cycles_of(settings: Settings, iterate: Iterate) -> LoadCycles:
    """Cut an iterate into the cycles of its load; points stand interface by interface."""
    ends = ends_of(settings)
    slips, works = [], []
    for law, slip, work in slips_of(iterate):
        slips.append(law.mean_by_point(slip))
        works.append(law.by_point(work))
    slip, work = np.concatenate(slips), np.concatenate(works)
    rubbed = np.where(np.abs(iterate.status) == 1, np.abs(slip), 0.0)
    first = ends[0] if ends else iterate.problem.n_instants - 1
    works_of_cycles = _summed(work, ends)
    return LoadCycles(
        ends=ends,
        energy=works_of_cycles.sum(axis=0),
        slip=_summed(rubbed, ends),
        net=_summed(slip, ends),
        work=works_of_cycles,
        before=rubbed[:, : first + 1].sum(axis=1),
        is_repeated=_is_repeated(settings, ends),
    )


def ends_of(settings: Settings) -> list[int]:
    """Find the instants at which the cycles of a load begin, and the last one ends.

    Of several loads that which turns back most often counts, the first of equals. Fewer than two
    instants are no cycle.
    """
    turns = max((turning_points(path) for path in _paths(settings)), key=len, default=[])
    return turns[::2]


def cycles_in(settings: Settings) -> int:
    """Count the cycles of a load."""
    return max(len(ends_of(settings)) - 1, 0)


def turning_points(path: Array) -> list[int]:
    """Find where a path turns back by more than a small swing, and its end if it is as far out.

    Parameters
    ----------
    path
        Shape (n_instants,).

    Returns
    -------
    Indices, the first of each extreme that is held.
    """
    least = max(SMALLEST_SWING * float(np.ptp(path)), NO_SWING * float(np.abs(path).max()))
    found: list[int] = []
    outmost, way = 0, 0.0
    for place, value in enumerate(path):
        if way == 0.0:
            outmost = place
            if abs(value - path[0]) > least:
                way = math.copysign(1.0, value - path[0])
        elif way * (value - path[outmost]) > 0.0:
            outmost = place
        elif way * (path[outmost] - value) > least:
            found.append(outmost)
            outmost, way = place, -way
    is_closed = len(found) > 1 and way * (path[found[-2]] - path[outmost]) <= least
    return [*found, outmost] if is_closed else found


def _paths(settings: Settings) -> Iterator[Array]:
    """Give what acts over time; of what varies along a side, the place that changes most."""
    described = structure_of(settings).described()
    if described.tilt is not None:
        yield described.tilt
    for act in described.acts:
        values = np.atleast_2d(act.values)
        yield values[np.ptp(values, axis=1).argmax()]


def _is_repeated(settings: Settings, ends: list[int]) -> bool:
    """Tell whether all that acts begins the last cycles alike, and reaches as far in them."""
    for path in _paths(settings):
        parts = [path[a : b + 1] for a, b in pairwise(ends[-LAST - 1 :])]
        seen = np.array([[one[0], one[-1], one.min(), one.max()] for one in parts])
        if len(seen) and np.ptp(seen, axis=0).max() > REPEATED * np.ptp(path):
            return False
    return True


def _summed(values: Array, ends: list[int]) -> Array:
    """Add up what belongs to the instants of each cycle, shape (..., n_cycles)."""
    parts = [values[..., a + 1 : b + 1].sum(axis=-1) for a, b in pairwise(ends)]
    return np.stack(parts, axis=-1) if parts else np.zeros((*values.shape[:-1], 0))
