"""What becomes of slip under a load that repeats itself, in one word, with the numbers for it.

Slip ceases, dies out, goes to and fro, or goes on one way (J. R. Barber, Frictional systems
subjected to oscillating loads, Ann. Solid Struct. Mech. 2, 2011). A word is said only where the
last three cycles have earned it (solver/README.md, 15).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from solver.arrays import Array
from solver.study.quantities.cycles import LAST, LoadCycles

Word = Literal["elastic shakedown", "shakedown with slip that dies", "steady slip", "ratcheting"]
ALIKE = 0.02
"""Share by which the slip of the last cycles may differ where it counts as the same."""
ONE_WAY = 0.05
"""Share of the slip of a cycle that is left at its end, from which on a point goes one way."""
DIES = 0.9
"""Slip of a cycle over that of the one before, up to which it dies, if it tends to nothing."""
TENDS = 0.1
"""Slip that it may tend to, as a share of that two cycles ago, to count as nothing."""


@dataclass(frozen=True)
class Fate:
    """What becomes of slip.

    Attributes
    ----------
    word
        For it.
    since
        First cycle from which on nothing slips, from 1; None where slip goes on.
    slip
        Largest slip of any point in the last cycle, m.
    ratio
        The same over that of the cycle before; NaN where nothing slipped then.
    net
        Slip that the last cycle leaves, at the point where it leaves most, m.
    energy
        What friction takes in the last cycle, J.
    """

    word: Word
    since: int | None
    slip: float
    ratio: float
    net: float
    energy: float


def fate_of(cycles: LoadCycles) -> Fate | None:
    """Say what becomes of slip.

    None where that is not settled: with fewer than three cycles, cycles that are not alike, slip
    that still changes, or no slip ever.
    """
    if len(cycles) < LAST or not cycles.is_repeated or not cycles.slip.size:
        return None
    most = cycles.slip.max(axis=0)
    if not most.any() and not cycles.before.any():
        return None
    since = _last_begun(most == 0.0)
    word = "elastic shakedown" if since is not None else _word(cycles, most)
    if word is None:
        return None
    ratio = most[-1] / most[-2] if most[-2] else np.nan
    place = np.abs(cycles.net[:, -1]).argmax()
    net, energy = cycles.net[place, -1], cycles.energy[-1]
    return Fate(word, since, float(most[-1]), float(ratio), float(net), float(energy))


def _word(cycles: LoadCycles, most: Array) -> Word | None:
    """Name slip that goes on in the last cycle."""
    net = cycles.net[np.abs(cycles.net[:, -1]).argmax()]
    if np.abs(net[-1]) > ONE_WAY * most[-1] and _settled(net[None]):
        return "ratcheting"
    if most[-1] <= DIES * most[-2] and _limit(most[-3:]) <= TENDS * most[-3]:
        return "shakedown with slip that dies"
    if _settled(cycles.slip):
        return "steady slip"
    return None


def _settled(values: Array) -> bool:
    """Tell whether values of points, (n_points, n_cycles), are the same in the last cycles."""
    last = values[:, -LAST:]
    return bool(np.ptp(last, axis=1).max() <= ALIKE * np.abs(last[:, -1]).max())


def _limit(values: Array) -> float:
    """Extrapolate three values as those of a geometric sequence (Aitken); infinite if they grow."""
    first, second, third = (float(one) for one in values)
    bend = first + third - 2.0 * second
    return (first * third - second**2) / bend if bend > 0.0 else np.inf


def _last_begun(holds: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> int | None:
    """Give the first cycle, from 1, from which on something holds; None if not in the last."""
    others = np.flatnonzero(~holds)
    first = int(others[-1]) + 2 if len(others) else 1
    return first if first <= len(holds) else None
