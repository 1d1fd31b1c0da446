"""Units of scaled displacements, forces and times."""

from __future__ import annotations

from dataclasses import dataclass

from solver.checks import POSITIVE, check


@dataclass(frozen=True)
class Scales:
    """Units of scaled displacement, m, force, N, and time, s.

    With them the results of a method do not depend on the units of the input.
    """

    displacement: float
    force: float
    time: float

    def __post_init__(self) -> None:
        check(self, displacement=POSITIVE, force=POSITIVE, time=POSITIVE)
