"""Balance of rigid bodies on the springs of the search direction.

The positions of the bodies at which their forces balance all loads are a zero of a
piecewise linear function, which Newton's method on the statuses of the contacts finds
(Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991). A step ends where the
forces do no more work along it: without friction that is the least energy, which always
falls. Near the balance all instants take a step together, with the sliders that it
moves; elsewhere it is found instant by instant. Where steps lead nowhere bodies are
followed on their way from the instant before (`solver.latin.stages.rigid_path`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Array
from solver.latin.stages.rigid_forces import Loading, RigidForces, RigidState
from solver.latin.stages.rigid_path import HELD, BalancePath

BALANCED = 1e-9
"""Largest unbalanced force, over the largest load of a body, in balance."""
ROUNDED = 64.0 * float(np.finfo(float).eps)
"""Rounding of the jumps of a body over the way that it goes: what unbalances stiff
springs counts for nothing. A side that moves by 0.1 m leaves a quarter of that
(measured)."""
STEPS = 25
"""Largest number of linear systems from one start; most instants take one to three
(measured)."""
NEAR = 1.0
"""Unbalanced force, as in `BALANCED`, up to which all instants take steps together."""
STEPS_TOGETHER = 6
"""Largest number of these steps; most iterations take two, each in half the time of
steps of all instants, one by one (measured)."""
FIRM = 1e-6
"""Larger share of these springs than `HELD`, where the first step is taken with all
pairs stuck: 138 arches of any shape take a tenth less time than with three shares in
turn (measured)."""


class Balance:
    """Balance of the forces on rigid bodies.

    Parameters
    ----------
    forces
        The forces.
    reach
        Largest way that a side goes, scaled.

    Attributes
    ----------
    enough
        Largest unbalanced force, over the largest load of a body, in balance.
    """

    def __init__(self, forces: RigidForces, reach: float) -> None:
        self._forces = forces
        compliance = min(forces.across.min(), forces.along.min())
        rounding = ROUNDED * reach / (compliance * forces.load_size)
        self.enough = max(BALANCED, float(rounding))

    def solve_together(self, loading: Loading) -> RigidState:
        """State after common Newton steps of all instants, if they converge.

        Forces may be out of balance at some instants.
        """
        forces = self._forces
        state = forces.at(np.zeros_like(loading.load), loading)
        # A NaN is not near, either.
        if not state.error.max() <= NEAR:
            return state
        for _ in range(STEPS_TOGETHER):
            is_wrong = ~(state.error <= self.enough)
            if not is_wrong.any():
                break
            rest = slice(int(np.argmax(is_wrong)), None)
            position = state.position.copy()
            position[:, rest] = self._stepped_together(
                state.part(rest), loading.part(rest)
            )
            state = forces.at(position, loading)
        return state

    def _stepped_together(self, state: RigidState, loading: Loading) -> Array:
        """Positions after a common step of all instants, (n_motions, n_instants).

        Sliders at the instant before each move, too: a pair that sticks keeps its
        slider, others take it along.
        """
        forces = self._forces
        size = len(state.presses)
        factors = forces.factored(state.presses, state.slips, HELD)
        sticks = state.presses & (state.slips == 0.0)
        pulling = sticks / forces.along
        # How far a slipping pair lags behind, over how much further it presses.
        lagging = state.slips * (state.presses / forces.across)
        lagging *= forces.friction * forces.along
        step = np.empty_like(state.position)
        moves = np.empty_like(state.sliders)
        moved = np.zeros(size)
        pull = np.zeros((2 * size, 1))
        for instant in range(step.shape[1]):
            moves[:, instant] = moved
            pull[size:, 0] = pulling[:, instant] * moved
            right = state.unbalanced[:, instant]
            if pull.any():
                right = right + forces.pushes(pull)[:, 0]
            step[:, instant] = factors.solve_at(instant, right)
            jump = forces.jumps(step[:, instant, None])[:, 0]
            carried = jump[size:] - lagging[:, instant] * jump[:size]
            moved = np.where(sticks[:, instant], moved, carried)
        return forces.moved(state, step, moves, loading).position

    def solve_instant(
        self,
        loading: Loading,
        sliders: Array,
        guesses: Sequence[Array],
        before: Array,
        last: tuple[Loading, Array] | None,
    ) -> RigidState:
        """State of one instant in balance, or the nearest to balance that is found.

        Parameters
        ----------
        loading
            The loading of the instant.
        sliders
            Sliders at the instant before, shape (n_pairs, 1), scaled.
        guesses
            Positions that may be near the balance, shape (n_motions, 1) each, scaled.
        before
            Position at the instant before, of the same shape. From there the first step
            is taken with all pairs stuck, if no guess is near.
        last
            Loading of the instant before, and position in balance with it, shape
            (n_motions, 1), scaled; None for the first instant.
        """
        forces = self._forces
        tried = []
        if guesses:
            starts = [forces.at(guess, loading, sliders) for guess in guesses]
            tried.append(self._newton(_best(starts), loading, HELD))
            if tried[0].error <= self.enough:
                return tried[0]
        start = forces.at(before, loading, sliders)
        glued = start._replace(
            presses=np.ones_like(start.presses), slips=np.zeros_like(start.slips)
        )
        stuck = self._stepped(glued, loading, HELD)
        tried.append(self._newton(stuck, loading, FIRM))
        if tried[-1].error <= self.enough:
            return tried[-1]
        if last is not None:
            tried.append(self._follow_path(last, loading, sliders))
        return _best(tried)

    def _follow_path(
        self, last: tuple[Loading, Array], loading: Loading, sliders: Array
    ) -> RigidState:
        """State at the end of the path from the instant before, or nearest to it."""
        forces = self._forces
        before, position = last
        begin = forces.at(position, before, sliders)
        end = None
        # From where nothing presses all pairs would change their statuses at once.
        if begin.presses.any():
            end = BalancePath(forces, begin, loading.since(before)).end()
        if end is None:
            return forces.at(position, loading, sliders)
        # A path of many kinks ends near the balance, up to rounding.
        return self._newton(forces.at(end, loading, sliders), loading, HELD)

    def _newton(self, state: RigidState, loading: Loading, held: float) -> RigidState:
        """The best state among the steps of Newton's method from a first one.

        `held` is the share of springs that hold bodies, as in `HELD`.
        """
        best = state
        for _ in range(STEPS):
            if state.error <= self.enough:
                return state
            state = self._stepped(state, loading, held)
            best = _best([best, state])
        return best

    def _stepped(self, state: RigidState, loading: Loading, held: float) -> RigidState:
        """State after a Newton step: forces balance if no status changes.

        `held` is as in `_from`.
        """
        step = self._forces.factored(state.presses, state.slips, held).solve(
            state.unbalanced
        )
        return self._forces.moved(state, step, np.zeros_like(state.before), loading)


def _best(states: Sequence[RigidState]) -> RigidState:
    """The state, of several of one instant, that is nearest to balance."""
    return min(states, key=lambda state: float(state.error[0]))
