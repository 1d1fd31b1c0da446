"""States of the jumps of frictional contacts: what they say of an instant, and what says them.

Every jump has a state. A normal one is HELD at the gap, or OPEN without force. A tangential one is
HELD where it was, slips with s = -1 or +1 against the friction force -s (r + mu f_n), or is OPEN:
without force, as where the contact is open or there is no friction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.laws import OPEN
from solver.reference.rules import Rules
from solver.reference.solution import States

HELD = 0
EXPECTED = 2.5
"""Systems that an instant takes from the states of the one before, until it is known: the most on
charts of the bar, where a guess from a neighbour takes 1 to 7, and one from an iterate 1.7."""


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


class Starts:
    """Where an instant begins: from a guess, or from the states of the instant before.

    From whichever has taken fewer linear systems an instant so far.
    """

    def __init__(self) -> None:
        # Systems and instants, from the guess and from the instant before.
        self._guess, self._before = [0.0, 0], [EXPECTED, 1]

    @property
    def from_guess(self) -> bool:
        """Whether to begin from the guess."""
        (guess, guessed), (before, times) = self._guess, self._before
        return guess * times <= before * guessed

    def took(self, systems: int, *, from_guess: bool) -> None:
        """Count what an instant took, and from where."""
        account = self._guess if from_guess else self._before
        account[0] += systems
        account[1] += 1


def states_at(jumps: Array, rules: Rules) -> States:
    """States of a body that is where it would be if it were rigid, (n, n_instants)."""
    closed = (jumps + rules.gap[:, None] <= 0.0)[rules.partner]
    slip = np.sign(np.diff(jumps, axis=1, prepend=0.0))
    slip[rules.normal] = HELD
    return np.where(closed, slip, OPEN).astype(np.int8)
