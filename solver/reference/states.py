"""States of the jumps of frictional contacts at one instant, and what is given of them.

Every jump has a state. A normal one is HELD at the gap, or OPEN without force. A tangential one is
HELD where it was, slips with s = -1 or +1 against the friction force -s (r + mu f_n), or is OPEN:
without force, as where the contact is open or there is no friction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array

States = NDArray[np.int8]
HELD = 0


@dataclass(frozen=True, eq=False)
class Sides:
    """Right sides of one instant; columns, where there are several, are solved together.

    Attributes
    ----------
    load
        q of the step from the instant before, shape (n_base, ...).
    bound
        Friction force r that needs no normal force, shape (n, ...).
    held
        What held jumps come to in the step, shape (n, ...): minus the opening, or nothing; on top
        of the length before of what is in series.
    """

    load: Array
    bound: Array
    held: Array


class Increment(NamedTuple):
    """What an instant adds to the one before, and the forces at its end.

    Attributes
    ----------
    jump
        Of all jumps, with the new length of what is in series, shape (n, ...); as `Sides.held`.
    force
        Of all jumps, same shape.
    strained, motion
        Of y of the base, shape (n_base, ...), and of the rigid motions a, (n_motions, ...).
    """

    jump: Array
    force: Array
    strained: Array
    motion: Array
