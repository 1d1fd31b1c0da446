"""Loads and motions that drive a structure, named by the settings that give them.

A person gives a load, while its path over time may be a preset: so a message on an
instant of a run gives the value of the load there, and the time beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.refusal import plain

LEAST_STEP = 1e-9
"""Largest step of a path that may be rounding, as a share of its largest value."""


@dataclass(frozen=True, eq=False)
class Drive:
    """A load or motion over time.

    Attributes
    ----------
    name
        Setting that scales the drive.
    unit
        SI unit of the values.
    values
        Values at the instants of a problem, shape (n_instants,), in the unit; before
        the first instant the value is 0.
    """

    name: str
    unit: str
    values: Array

    def during(self, instants: slice) -> Drive:
        """The drive restricted to a range of its instants."""
        return replace(self, values=self.values[instants])

    @property
    def largest(self) -> float:
        """Largest size of the values."""
        return float(np.abs(self.values).max(initial=0.0))

    def before(self, instant: int) -> float:
        """Value at the beginning of the step to an instant."""
        if instant:
            return float(self.values[instant - 1])
        return 0.0

    def changes(self, instant: int) -> bool:
        """Check whether the value changes in the step to an instant."""
        step = float(self.values[instant]) - self.before(instant)
        return abs(step) > LEAST_STEP * self.largest

    def falls(self, instant: int) -> bool:
        """Check whether the size of the value falls in the step to an instant."""
        return abs(float(self.values[instant])) < abs(self.before(instant))

    def describe(self, instant: int, share: float = 1.0) -> str:
        """Text of the value after a share of the step to an instant.

        With the load factor: the value over the largest one of the same sign.
        """
        before = self.before(instant)
        value = before + share * (float(self.values[instant]) - before)
        # A load factor of a reversed load is that of the reversed peak.
        sign = np.sign(value)
        largest = float((sign * self.values).max(initial=0.0))
        amount = f"{self.name} = {plain(float(f'{value:.4g}'))} {self.unit}".rstrip()
        if largest <= 0.0:
            return amount
        factor = plain(float(f"{abs(value) / largest:.3g}"))
        return f"{amount} ({factor} times its largest value)"


def describe_loads(drives: Sequence[Drive], instant: int) -> str:
    """Text of all drives that change in the step to an instant, with their values.

    Empty where no drive changes.
    """
    moving = [drive.describe(instant) for drive in drives if drive.changes(instant)]
    return " and ".join(moving)


def describe_limit(drives: Sequence[Drive], instant: int, share: float) -> str:
    """Text of the loads at a limit, after a share of the step to an instant.

    These are the loads after a share of the step to an instant: "beyond" those that
    grow, "below" those that fall. Where loads begin together and the share is zero, all
    of them are named with their values at the end of the step. Empty where no drive
    changes.
    """
    moving = [drive for drive in drives if drive.changes(instant)]
    # At the very beginning all loads are zero, and "beyond 0 N" would say nothing.
    from_nothing = not any(drive.before(instant) for drive in moving)
    if moving and from_nothing and share <= LEAST_STEP:
        return f"with {describe_loads(drives, instant)}"
    words = []
    for falls, preposition in ((False, "beyond"), (True, "below")):
        passed = [drive for drive in moving if drive.falls(instant) is falls]
        amounts = [drive.describe(instant, share) for drive in passed]
        if amounts:
            words.append(f"{preposition} {' and '.join(amounts)}")
    return " and ".join(words)
