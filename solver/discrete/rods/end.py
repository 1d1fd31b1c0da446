"""Ends of rods as data: held, moved, on a spring, pulled, or free."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from solver.arrays import Array
from solver.checks import Number, Numbers, check
from solver.refusal import RefusedError

EndName = Literal["left", "right"]
SIDES = {"left": "support", "right": "load"}
"""Interfaces of the ends, by their side."""


@dataclass(frozen=True, eq=False)
class End:
    """Load or support at one end of every rod; without values the end is free.

    Attributes
    ----------
    force
        Axial force on the end, positive to the right, shape (n_instants,), N; None
        where the end is held.
    displacement
        Displacement of the support that holds the end, shape (n_instants,), m; None
        where the end is not held.
    spring
        Stiffness of the spring between the end and that support, N/m; infinite without
        a spring.

    Raises
    ------
    RefusedError
        For a force together with a displacement, a spring that is not stiffer than
        zero, or values that are not finite.
    """

    force: Array | None = None
    displacement: Array | None = None
    spring: float = np.inf

    def __post_init__(self) -> None:
        over_time = Numbers(((None,),))
        spring = Number(0.0, above=True, endless=True)
        check(self, spring=spring, force=over_time, displacement=over_time)
        if self.force is not None and self.displacement is not None:
            raise RefusedError(
                "End.force",
                "given, with a displacement",
                "either of them",
                "leave out the other",
            )

    @property
    def is_prescribed(self) -> bool:
        """Check whether the displacement of the end is prescribed."""
        return self.displacement is not None and bool(np.isinf(self.spring))

    @property
    def is_on_spring(self) -> bool:
        """Check whether a spring holds the end."""
        return self.displacement is not None and not np.isinf(self.spring)
