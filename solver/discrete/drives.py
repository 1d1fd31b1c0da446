"""Loads and motions that drive a structure, named by the settings that give them.

A person gives a load, and its path over time may be a preset that nobody drew: where a
run tells at which point of its path something happens, it tells the load, and the time
beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.refusal import plain

LEAST_STEP = 1e-9
"""Share of its largest value by which rounding alone may change a path."""


@dataclass(frozen=True, eq=False)
class Drive:
    """A load or motion over time.

    Attributes
    ----------
    name
        Setting by which it becomes larger or smaller.
    unit
        SI unit of the values.
    values
        At the instants of a problem, shape (n_instants,); before the first there is
        nothing.
    """

    name: str
    unit: str
    values: Array

    def during(self, some: slice) -> Drive:
        """The drive at some of its instants alone."""
        return replace(self, values=self.values[some])

    @property
    def largest(self) -> float:
        """Largest size of the values."""
        return float(np.abs(self.values).max(initial=0.0))

    def before(self, instant: int) -> float:
        """Value from which the step to an instant begins."""
        if instant:
            return float(self.values[instant - 1])
        return 0.0

    def changes(self, instant: int) -> bool:
        """Whether it changes in the step to an instant."""
        step = float(self.values[instant]) - self.before(instant)
        return abs(step) > LEAST_STEP * self.largest

    def falls(self, instant: int) -> bool:
        """Whether its size falls in the step to an instant."""
        return abs(float(self.values[instant])) < abs(self.before(instant))

    def at(self, instant: int, share: float = 1.0) -> str:
        """Words on the value after a share of the step to an instant.

        They have the load factor too: that on the largest value of the same sign.
        """
        before = self.before(instant)
        value = before + share * (float(self.values[instant]) - before)
        way = np.sign(value)
        largest = float((way * self.values).max(initial=0.0))
        amount = f"{self.name} = {plain(float(f'{value:.4g}'))} {self.unit}".rstrip()
        if largest <= 0.0:
            return amount
        factor = plain(float(f"{abs(value) / largest:.3g}"))
        return f"{amount} ({factor} times its largest value)"


def loads_at(drives: Sequence[Drive], instant: int, share: float = 1.0) -> str:
    """Words on what drives after a share of the step to an instant.

    Empty where nothing changes.
    """
    moving = [drive.at(instant, share) for drive in drives if drive.changes(instant)]
    return " and ".join(moving)


def beyond(drives: Sequence[Drive], instant: int, share: float) -> str:
    """Words on the loads past which something happens.

    They are those after a share of the step to an instant. What falls is passed
    downwards; of loads that act together from nothing on, no share may be carried.
    Empty where nothing changes.
    """
    moving = [drive for drive in drives if drive.changes(instant)]
    from_nothing = not any(drive.before(instant) for drive in moving)
    if moving and from_nothing and share <= LEAST_STEP:
        return f"with {loads_at(drives, instant)}"
    words = []
    for falls, way in ((False, "beyond"), (True, "below")):
        passed = [drive for drive in moving if drive.falls(instant) is falls]
        amounts = [drive.at(instant, share) for drive in passed]
        if amounts:
            words.append(f"{way} {' and '.join(amounts)}")
    return " and ".join(words)
