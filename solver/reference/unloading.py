"""The sure way to the states of one instant: follow the solution from large pressure downwards.

Press all contacts together with lambda d and raise all known friction bounds by lambda d, with
some d > 0. For large lambda everything is held. Between two changes of state jump and force are
linear in lambda, and at a change one contact takes up its next state and lambda goes on, up or
down. No state is met twice, so the walk ends, and where S is positive definite it can only end at
lambda = 0: with no load but d the only solution is that nothing moves, whatever the friction, so
the walk cannot come back from where it started. (This is Lemke's method, for the complementarity
problem of plane friction: Klarbring, Ingenieur-Archiv 56, 1986; Cottle, Pang and Stone, The Linear
Complementarity Problem, 1992, ch. 4.) If S is only semi-definite, lambda may grow for ever: then
there is no solution within reach.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.laws import OPEN
from solver.reference.linear_system import LinearSystem
from solver.reference.rules import HELD, Rules, Sides, States

CHANGES = 30
"""Changes of state for each jump, at most; 11 are the most seen, with mu = 10."""
FEW = 200
"""Jumps up to which a walk may be so long; of more it does the same work at most, as a change costs
with the square of their number: walls of 2000 jumps take 100 s otherwise, in vain (measured)."""
FLAT = 1e-12
"""Slope, as a share of the largest, that is none."""


def unload(system: LinearSystem, rules: Rules, sides: Sides) -> States | None:
    """States that solve an instant, of one column, or None where the walk goes off to infinity."""
    walk, size = _PathFollower(system, rules, sides), len(rules.gap)
    for _ in range(int(CHANGES * size * min(1.0, (FEW / size) ** 2))):
        arrives = walk.step()
        if arrives is not None:
            return walk.states if arrives else None
    return None


class _PathFollower:
    """Where the walk is: states, lambda (`_level`), and whether it goes up or down."""

    def __init__(self, system: LinearSystem, rules: Rules, sides: Sides) -> None:
        self._system, self._rules = system, rules
        # An even d would let contacts of a symmetric structure change together, and the walk lose
        # its way; multiples of the golden ratio spread it, alike in every run.
        size = len(rules.gap)
        spread = 1.0 + np.arange(1, size + 1) * (0.5 * (np.sqrt(5.0) - 1.0)) % 1.0
        raised = ~rules.normal & rules.bounded
        pressed = system.on_base(np.where(rules.normal, -spread, 0.0))
        self._sides = Sides(
            np.column_stack([sides.load, pressed]),
            np.column_stack([sides.bound, np.where(raised, spread, 0.0)]),
            np.column_stack([sides.held, np.zeros(size)]),
        )
        self.states = np.where(rules.smooth, OPEN, HELD).astype(np.int8)
        self._level, self._way = np.inf, -1.0
        self._changed: tuple[int, int] | None = None

    def step(self) -> bool | None:
        """Go on to the next change of state: None, or whether it ends at lambda = 0 before it."""
        jump, force, *_ = self._system(self.states, self._sides)
        room, slope = self._room(jump, force)
        slope[np.abs(slope) <= FLAT * np.abs(slope).max(initial=0.0)] = 0.0
        if self._changed is not None:
            self._way = float(np.sign(slope[self._changed]))
        if self._system.singular or self._way == 0.0:
            return False
        ending = slope * self._way < 0.0
        levels = np.full(room.shape, self._way * np.inf)
        levels[ending] = -room[ending] / slope[ending]
        levels *= self._way
        place, side = (int(one) for one in np.unravel_index(levels.argmin(), levels.shape))
        level = self._way * max(float(levels[place, side]), self._way * self._level)
        if self._way < 0.0 and level <= 0.0:
            return True
        if not np.isfinite(level):
            return False
        self._level = level
        moved = jump - self._sides.held
        self._change(place, side, moved[:, 0] + level * moved[:, 1])
        return None

    def _room(self, jump: Array, force: Array) -> tuple[Array, Array]:
        """What has to stay positive at lambda = 0, and its slope, (n, 2): a held point has two."""
        rules, states = self._rules, self.states
        room = np.full((2, len(states), 2), np.inf)
        room[1] = 0.0
        moved = (self._system.unit * (jump - self._sides.held)).T
        bound = self._sides.bound.T + rules.friction * force[rules.partner].T
        held, opened = rules.normal & (states == HELD), rules.normal & (states == OPEN)
        stuck, slips = ~rules.normal & (states == HELD), np.abs(states) == 1
        force = force.T
        room[:, held, 0] = force[:, held]
        room[:, opened, 0] = moved[:, opened]
        room[:, stuck, 0] = (bound - force)[:, stuck]
        room[:, stuck, 1] = (bound + force)[:, stuck]
        room[:, slips, 0] = (states * moved)[:, slips]
        return room[0], room[1]

    def _change(self, place: int, side: int, moved: Array) -> None:
        """Set the next state of a jump, and remember what has to grow from zero now."""
        rules, states = self._rules, self.states
        self._changed = place, 0
        if not rules.normal[place]:
            if states[place] == HELD:
                states[place] = -1 if side == 0 else 1
            else:
                self._changed = place, int(states[place] == 1)
                states[place] = HELD
            return
        opens = states[place] == HELD
        states[place] = OPEN if opens else HELD
        for rubbing in np.flatnonzero((rules.partner == place) & (rules.friction > 0.0)):
            way = 1 if moved[rubbing] >= 0.0 else -1
            states[rubbing] = OPEN if opens else way
