"""One instant of frictional contact after the other, each from the states of the one before.

A semismooth Newton method seeks the states of the jumps: solve the linear system of the states
(`solver.reference.linear_system`, the bound of friction coupled to the normal force), and correct
the states by what it shows (Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991). Exact
once they repeat. Where they cycle, springs lead loose bodies home (`solver.reference.proximal`), or
following the solution down from large pressure finds it (`solver.reference.unloading`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from solver.arrays import ROUNDING, Array, Indices, at_instant
from solver.laws import OPEN
from solver.reference.condensation import Condensation
from solver.reference.linear_system import LinearSystem
from solver.reference.proximal import Solved, approach
from solver.reference.rules import HELD, Increment, Rules, Sides, Starts, States, states_at
from solver.reference.unloading import unload

NEWTON_LIMIT = 30
"""Newton steps from one guess of the states; more than a dozen means that they cycle."""
CONVERGED = 1e-9
"""Relative KKT residual up to which an instant counts as solved, where rounding allows it."""
PASSES = 30
"""Times at most that an instant is solved to keep dependent jumps together."""
TOGETHER = 1e-10
"""Force that still ties dependent jumps, as a share of the largest load."""
_HELD, _OPEN = np.int8(HELD), np.int8(OPEN)


class Marched(NamedTuple):
    """What every instant adds: slip, force in all, y of the base, motion; (n, n_instants) each."""

    slip: Array
    force: Array
    strained: Array
    motion: Array


class Newton:
    """Jumps and forces of one instant after the other.

    From what rules say of the condensed structure; `rest` is a displacement from which contacts may
    be guessed, (n_dofs, n_instants), and `guesses` are states to try, (n, n_instants). `may_hold`
    says whether there may be an equilibrium at an instant, where none is found at once.

    Attributes
    ----------
    jumps_at
        First instant at which no solution goes on from the one before; None while all do.
    """

    jumps_at: int | None = None

    def __init__(
        self,
        condensed: Condensation,
        rules: Rules,
        rest: Array | None,
        guesses: States | None,
        may_hold: Callable[[int], bool],
    ) -> None:
        self.system = LinearSystem(condensed, rules, condensed.stiffness, condensed.gauge)
        self._may_hold, self._is_lost = may_hold, False
        self._condensed, self._rules = condensed, rules
        self._opening, self._force = rules.gap.copy(), np.zeros_like(rules.gap)
        n_base, n_motions = condensed.gauge.shape
        self._strained, self._motion = np.zeros(n_base), np.zeros(n_motions)
        self._load, self._shift = np.zeros(n_base), np.zeros_like(rules.gap)
        self._states: States = np.where(rules.smooth, OPEN, HELD).astype(np.int8)
        self._guesses, self._starts = guesses, Starts()
        self._smooth: Indices = np.flatnonzero(rules.smooth)
        self._rubs: Indices = np.union1d(np.flatnonzero(rules.friction > 0.0), rules.bonds)
        self._carry: Indices = rules.partner[self._rubs]
        if guesses is not None:
            guesses[self._smooth] = OPEN
        self._at_rest: States | None = None
        if rest is not None:
            self._at_rest = states_at(condensed.jump(rest)[condensed.moving], rules)
        self._largest = float(np.abs(condensed.load).max(initial=0.0))
        self._intact = np.ones_like(rules.gap)
        has_acted = np.logical_or.accumulate(condensed.load.any(axis=0))
        # Nothing has acted yet: then nothing moves, though a free body might.
        self._is_at_rest = ~has_acted & bool(np.all(rules.gap[rules.normal] >= 0.0))

    def __call__(self, instant: int) -> Marched:
        """What an instant adds.

        The forces that move nothing are the multipliers that keep dependent jumps together
        (method of multipliers: Bertsekas, Constrained Optimization, 1982, ch. 2).
        """
        condensed, rules = self._condensed, self._rules
        if self._is_at_rest[instant]:
            still = self._force, self._force, self._strained, self._motion
            return Marched(*map(np.zeros_like, still))
        load = condensed.load[:, instant] - self._load - self.system.on_base(self._force)
        before = rules.compliance * self._force - condensed.shift[:, instant] + self._shift
        held = before - np.where(rules.normal, self._opening, 0.0)
        sides = Sides(load[:, None], self._bound(instant), held[:, None])
        step = self._together(sides, instant)
        self._load, self._shift = condensed.load[:, instant], condensed.shift[:, instant]
        slip, self._force = step.jump[:, 0] - before, step.force[:, 0]
        self._opening += slip
        self._strained += step.strained[:, 0]
        self._motion += step.motion[:, 0]
        opened = self._states[rules.partner[rules.bonds]] == OPEN
        self._intact[rules.bonds[opened]] = 0.0
        return Marched(slip, self._force, step.strained[:, 0], step.motion[:, 0])

    def _bound(self, instant: int) -> Array:
        """Friction force that needs no pressing one, where no bond is broken yet, (n, 1)."""
        return at_instant(self._rules.bound, instant) * self._intact[:, None]

    def _together(self, sides: Sides, instant: int) -> Increment:
        """Solve an instant until jumps that depend on each other are together."""
        condensed, stresses = self._condensed, self._condensed.stresses
        done, from_guess = self.system.solutions, self._starts.from_guess
        for _ in range(PASSES):
            solved = self._solved(sides, instant)
            if solved is None:
                # All contacts stay where they are.
                held = sides.held + (self._rules.normal * self._opening)[:, None]
                return self.system(np.full_like(self._states, HELD), replace(sides, held=held))
            self._states, step = solved
            if not stresses.size:
                break
            given = condensed.given[condensed.moving[condensed.base], instant]
            moved = self._strained + condensed.gauge @ self._motion - given
            moved += step.strained[:, 0] + condensed.gauge @ step.motion[:, 0]
            pull = condensed.tie * (stresses @ (stresses.T @ moved))
            if np.abs(pull).max(initial=0.0) <= TOGETHER * self._largest:
                break
            sides = replace(sides, load=sides.load - pull[:, None])
        self._starts.took(self.system.solutions - done, from_guess=from_guess)
        return step

    def _solved(self, sides: Sides, instant: int) -> Solved | None:
        """Find the states of the jumps and the step, or None."""
        guesses = [self._states]
        if self._guesses is not None:
            guesses.insert(0 if self._starts.from_guess else 1, self._guesses[:, instant])
        if self._at_rest is not None:
            # A body that falls, rolls or slides a long way touches elsewhere than one instant
            # before, or slips as a whole.
            guesses.append(self._at_rest[:, instant])
        solved = self._from_any(guesses, sides)
        if solved is None and not self._is_lost and self._may_hold(instant):
            solved = self._approached(sides) or self._unloaded(self._rules, sides)
        self._is_lost = self._is_lost or solved is None
        return solved

    def _from_any(self, guesses: Iterable[States], sides: Sides) -> Solved | None:
        """Find states and step from the first guess that leads to them, or None."""
        solutions = (self._iterate(states, sides) for states in guesses)
        return next((solved for solved in solutions if solved is not None), None)

    def _approached(self, sides: Sides) -> Solved | None:
        """Find states and step while springs hold bodies that are loose, or None."""
        if not self._condensed.gauge.size:
            return None
        steps = approach(self._condensed, self._rules, self._states, sides, self._seek)
        return self._from_any(steps, sides)

    def _unloaded(self, rules: Rules, sides: Sides) -> Solved | None:
        """Find states and step from large pressure on, or None."""
        states = unload(self.system, rules, sides)
        return None if states is None else self._iterate(states, sides)

    def _iterate(self, states: States, sides: Sides) -> Solved | None:
        """Seek the states from a guess, or None where they cycle."""
        return self._seek(self.system, states, sides)

    def _seek(self, system: LinearSystem, states: States, sides: Sides) -> Solved | None:
        seen = set()
        for _ in range(NEWTON_LIMIT):
            step = system(states, sides)
            # Those with springs count, too.
            self.system.solutions += system is not self.system
            corrected = self._corrected(states, step, sides)
            if np.array_equal(corrected, states):
                slack, _ = self._rounding(states, step)
                balanced = system.unbalanced <= max(CONVERGED * self._largest, slack)
                return (states, step) if balanced else None
            seen.add(states.tobytes())
            states = corrected
            if states.tobytes() in seen:
                break
        return None

    def _rounding(self, states: States, step: Increment) -> tuple[float, Array]:
        """Force that rounding may make anywhere; and of a jump that is not held, (n,) or (1,).

        A held jump is the deformation less the rigid motion: rounding of that makes forces at all.
        """
        inside = self.system.inside(self._strained + step.strained[:, 0])
        slack = ROUNDING * (inside + self._largest)
        blur = self.system.blur(step.motion)
        is_stiff = (states == HELD) & (self._rules.compliance == 0.0)
        return slack + float((blur * is_stiff).max(initial=0.0)), slack + blur

    def _corrected(self, states: States, step: Increment, sides: Sides) -> States:
        """States that jump and force call for; what is up to rounding calls for none."""
        rules, system, force = self._rules, self.system, step.force[:, 0]
        moved = (system.unit * (step.jump - sides.held))[:, 0]
        slack, blur = self._rounding(states, step)
        held = states == HELD
        # A contact that closes rubs as its overlap and its slip would have it.
        carries = np.where(held, force[rules.partner], -moved[rules.partner])
        most = sides.bound[:, 0] + np.maximum(system.friction * carries, 0.0) + slack * held
        pulled = np.where(held, -force, moved)
        corrected = (pulled > most).view(np.int8) - (pulled < -most).view(np.int8)
        corrected = np.where(np.abs(states) == 1, states * (states * moved >= -blur), corrected)
        corrected[self._smooth] = OPEN
        closed = np.where(held, force >= -slack, moved < -blur)
        corrected = np.where(rules.normal, np.where(closed, _HELD, _OPEN), corrected)
        corrected[self._rubs[corrected[self._carry] == OPEN]] = OPEN
        return corrected
