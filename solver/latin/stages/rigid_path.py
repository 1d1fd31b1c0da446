"""Path of the rigid bodies from one loading to another, from kink to kink.

The forces are piecewise linear in positions and loading: while no pair changes its
status, the bodies that stay in balance move along a line. At a kink one pair opens,
closes, slips or sticks, and the line continues in another direction. That may lead back
to smaller shares of the way, where no larger share has a balance near. A path that is
followed so ends at the other loading, or goes to infinity (Eaves and Scarf, Math. Oper.
Res. 1, 1976). Newton's steps may go round in a circle instead, as they do on thick
arches.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, Flags
from solver.latin.stages.rigid_forces import Loading, RigidForces, RigidState

HELD = 1e-10
"""Share of the springs at all rows that hold bodies along a path and in a step, so that
one in the air does not go too far."""
KINKS = 8
"""Largest number of kinks over that of the pairs: 197 paths of arches of any shape have
3.6 at most, and 1.1 in the mean (measured)."""


class BalancePath:
    """A path of bodies in balance.

    Its pairs change their statuses where a margin of theirs is zero: what the pair
    presses by, and what friction that holds it goes beyond its bound by, either way.
    Margins are stacked, shape (3 n_pairs,).

    Parameters
    ----------
    forces
        The forces.
    state
        State of one instant in balance, where the path begins.
    change
        Jumps and loads where the path ends, less those where it begins.
    """

    def __init__(self, forces: RigidForces, state: RigidState, change: Loading) -> None:
        self._forces = forces
        self._change = change
        self._n_pairs = len(state.overlap)
        self._position = state.position.copy()
        self._margins = self._in_margins(state.overlap, state.sticking)
        self._is_above: Flags = self._margins > 0.0

    def end(self) -> Array | None:
        """Position at the end of the path, (n_motions, 1); None without an end."""
        share = 0.0
        crossed = None
        for _ in range(KINKS * self._n_pairs):
            step, rates = self._direction()
            way = 1.0
            # The margin that was crossed may be one that is only followed backwards.
            if crossed is not None and self._is_above[crossed] != (rates[crossed] > 0):
                way = -1.0
            lengths = self._lengths(way * rates)
            crossed = int(lengths.argmin())
            length = lengths[crossed]
            if way > 0.0 and share + length >= 1.0:
                return self._position + (1.0 - share) * step
            if not np.isfinite(length):
                break
            share += way * length
            self._position += way * length * step
            self._margins += way * length * rates
            self._cross(crossed)
        return None

    def _direction(self) -> tuple[Array, Array]:
        """Step of positions and margins to the end of the path, if no status changes.

        Their shapes are (n_motions, 1) and (3 n_pairs,).
        """
        forces = self._forces
        size = self._n_pairs
        above, below = self._is_above[size:].reshape(2, size, 1)
        presses = self._is_above[:size, None]
        slips = presses * (above.astype(float) - below)
        pressing = presses * -self._change.jump[:size] / forces.across
        sticking = presses * -self._change.jump[size:] / forces.along
        rubbing = np.where(slips != 0.0, slips * forces.friction * pressing, sticking)
        pushed = forces.pushes(np.concatenate([pressing, rubbing]))
        factors = forces.factored(presses, slips, HELD)
        step = factors.solve(self._change.load + pushed)
        jump = forces.jumps(step) + self._change.jump
        return step, self._in_margins(-jump[:size], -jump[size:] / forces.along)

    def _in_margins(self, overlap: Array, sticking: Array) -> Array:
        """Margins of pressing, and of friction of sticking pairs, (n_pairs, 1).

        The bound of friction continues below zero where a pair is open, so that all
        margins are linear.
        """
        bound = self._forces.friction * overlap / self._forces.across
        margins = np.concatenate([overlap, sticking - bound, -sticking - bound])
        return np.asarray(margins[:, 0])

    def _lengths(self, rates: Array) -> Array:
        """Lengths of the path up to the zero of each margin, (3 n_pairs,).

        Infinite where it goes away from zero, and where an open pair would slip.
        """
        comes = (self._is_above == (rates < 0.0)) & (rates != 0.0)
        comes[self._n_pairs :] &= np.tile(self._is_above[: self._n_pairs], 2)
        lengths = np.full(len(rates), np.inf)
        np.divide(-self._margins, rates, out=lengths, where=comes)
        return np.asarray(np.maximum(lengths, 0.0))

    def _cross(self, crossed: int) -> None:
        """Change the status whose margin is zero.

        A pair that closes has no bound yet, so that it slips the way it is pulled.
        """
        size = self._n_pairs
        self._is_above[crossed] = not self._is_above[crossed]
        if crossed < size:
            own = slice(size + crossed, None, size)
            self._is_above[own] = self._margins[own] > 0.0
