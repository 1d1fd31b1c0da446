"""The states of one instant where contact alone holds bodies: springs hold them on the way.

Newton's method cycles from afar where bodies hang loose, as they may go anywhere. With springs at
all jumps that are relaxed where the last solution came to, none is loose: that is the proximal
point method (Rockafellar, SIAM J. Control Optim. 14, 1976). Its steps are short, and where they
come to rest the springs carry nothing. They are softened from step to step, until the states hold
without them. On walls of bricks that are moved so far that joints open this finds a solution at
every instant at which Newton's method alone finds none (solver/README.md, 6).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from solver.reference.condensation import Condensation
from solver.reference.linear_system import LinearSystem
from solver.reference.rules import InstantSolution, Sides, States

FIRST, SOFTEST, STIFFEST = 1e-2, 1e-8, 1e2
"""Springs, as shares of the stiffness of each jump alone."""
SOFTER, STIFFER = 0.5, 10.0
"""Factors on them after a step, and where Newton's method cycles in spite of them."""
STEPS = 60
"""Steps at most; up to 20 are seen where there is a solution."""
MOST_JUMPS = 4000
"""Jumps up to which it is tried: it keeps two more matrices of their size."""


def approach(
    condensed: Condensation,
    states: States,
    sides: Sides,
    seek: Callable[[LinearSystem, States, Sides], InstantSolution | None],
) -> Iterator[States]:
    """States of an instant that have come to rest, each nearer to those without springs.

    From those of the instant before, (n,), by Newton's method, `seek`. None where no body is loose,
    or there are too many jumps.
    """
    if not condensed.gauge.size or len(condensed.stiffness) > MOST_JUMPS:
        return
    alone, share = np.diagonal(condensed.stiffness), FIRST
    moved = np.zeros_like(sides.load)
    for _ in range(STEPS):
        springs = share * alone[:, None]
        held = condensed.elastic + np.diagflat(springs)
        sprung = LinearSystem(condensed, held, condensed.gauge[:, :0])
        pulled = replace(sides, load=sides.load + springs * moved)
        solved = seek(sprung, states, pulled)
        if solved is not None:
            before, states, moved = states, solved.states, solved.step.strained
            share = max(SOFTER * share, SOFTEST)
            if np.array_equal(states, before):
                yield states
        elif share < STIFFEST:
            share *= STIFFER
        else:
            return
