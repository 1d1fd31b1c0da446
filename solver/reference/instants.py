"""Frictional contact over time: each instant starts from the states before.

Where friction softens an instant may have several solutions. The solution that
continues the instant before is followed while the load of the instant grows, in steps
so small that no other solution branches off between their ends
(`solver.reference.branches`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from solver.arrays import Array
from solver.laws import OPEN
from solver.reference.assembly import never
from solver.reference.branches import SHORTEST_PART, beyond, followed
from solver.reference.condensation import Condensation
from solver.reference.newton import Newton
from solver.reference.rules import (
    HELD,
    Increment,
    InstantSolution,
    RightSides,
    Starts,
    States,
)

PASSES = 30
"""Largest number of solutions of an instant that keep dependent jumps together."""
TOGETHER = 1e-10
"""Force that still ties dependent jumps, as a share of the largest load."""
SHORT_PART = 2.0**-4
"""Share of the load of an instant within which the solution is lost where friction does
not change with slip: smaller parts rarely find more."""


class Instants:
    """Jumps and forces of a condensed structure, instant by instant.

    Attributes
    ----------
    system
        The linear system of the states.
    jumps_at
        First instant at which no solution continues the instant before; None while one
        always does.
    has_others
        Another solution of the last instant was met, which is not stable.
    is_stuck
        No solution of the last instant was found: all contacts stay where they were.
    """

    jumps_at: int | None = None
    has_others = False
    is_stuck = False

    def __init__(
        self,
        condensed: Condensation,
        rest: Array | None,
        guess: States | None,
        may_hold: Callable[[int], bool],
        stop: Callable[[], bool] = never,
    ) -> None:
        """Start from rest at zero.

        Parameters
        ----------
        condensed
            The structure between its contacts.
        rest
            Displacement by which contacts may be guessed, shape (n_dofs, n_instants),
            scaled.
        guess
            States to try, shape (n, n_instants).
        may_hold
            Function that says whether there may be an equilibrium at an instant, where
            none is found at once.
        stop
            As that of `LinearSystem`.
        """
        self._newton = Newton(condensed, stop)
        rules = condensed.rules
        self.system = self._newton.system
        self._may_hold = may_hold
        self._is_lost = False
        self._condensed = condensed
        self._rules = rules
        self._opening = rules.gap.copy()
        self._force = np.zeros_like(rules.gap)
        self._load = np.zeros_like(self._newton.strained)
        self._shift = np.zeros_like(rules.gap)
        self._motion = np.zeros(condensed.gauge.shape[1])
        # 1 where the friction of a bond is left, 0 where its contact has opened.
        self._intact = np.ones_like(rules.gap)
        self._states: States = np.where(rules.is_frictionless, OPEN, HELD).astype(
            np.int8
        )
        self._starts = Starts()
        self._has_guess = guess is not None
        self._guesses: list[States] = []
        if guess is not None:
            states = np.where(rules.is_frictionless[:, None], OPEN, guess)
            self._guesses.append(states.astype(np.int8))
        if rest is not None:
            jumps = condensed.jump(rest)[condensed.moving]
            self._guesses.append(rules.states_at(jumps))
        has_acted = np.logical_or.accumulate(condensed.load.any(axis=0))
        # Nothing has acted yet: then nothing moves, though a free body might.
        self._is_at_rest = ~has_acted & bool(np.all(rules.gap[rules.normal] >= 0.0))

    def __call__(self, instant: int) -> Increment:
        """Solve an instant; return its increments, and slip or opening of each jump.

        The forces that move nothing are the multipliers that keep dependent jumps
        together (method of multipliers: Bertsekas, Constrained Optimization, 1982, ch.
        2).
        """
        condensed = self._condensed
        rules = self._rules
        self.has_others = False
        self.is_stuck = False
        if self._is_at_rest[instant]:
            return self._nothing()
        load = (
            condensed.load[:, instant] - self._load - self.system.on_base(self._force)
        )
        # Length before of the spring in series with each jump.
        before = (
            rules.compliance * self._force - condensed.shift[:, instant] + self._shift
        )
        held = before - np.where(rules.normal, self._opening, 0.0)
        step = self._together(RightSides(load, self._bound(instant), held), instant)
        # Only now, as the step was from the load and the shift before.
        self._load = condensed.load[:, instant]
        self._shift = condensed.shift[:, instant]
        step = step._replace(jump=step.jump - before)
        self._move(step)
        return step

    def _nothing(self) -> Increment:
        """Increments of an instant at which nothing moves."""
        return Increment(
            jump=np.zeros_like(self._force),
            force=np.zeros_like(self._force),
            strained=np.zeros_like(self._newton.strained),
            motion=np.zeros_like(self._motion),
        )

    def _move(self, step: Increment) -> None:
        """Add the increments of an instant, with the slips, to the totals."""
        rules = self._rules
        self._force = step.force
        self._opening += step.jump
        self._newton.friction_law.accumulate(step.jump)
        self._newton.strained += step.strained
        self._motion += step.motion
        # A bond that has opened once carries no friction any more.
        opened = self._states[rules.partner[rules.bonds]] == OPEN
        self._intact[rules.bonds[opened]] = 0.0

    def _bound(self, instant: int) -> Array:
        """Friction force without normal force, (n,): zero for broken bonds."""
        return self._rules.bound_at(instant) * self._intact

    def _together(self, right_sides: RightSides, instant: int) -> Increment:
        """Solve an instant such that dependent jumps are consistent."""
        done = self.system.solutions
        from_guess = self._starts.from_guess
        for _ in range(PASSES):
            solved = self._solved(right_sides, instant)
            if solved is None:
                return self._stuck(right_sides)
            self._states, step, _ = solved
            # Without rings there is nothing to pull together.
            if not self._condensed.stresses.size:
                break
            pull = self._pull_together(step, instant)
            if np.abs(pull).max(initial=0.0) <= TOGETHER * self._newton.largest_load:
                break
            right_sides = replace(right_sides, load=right_sides.load - pull)
        self._starts.took(self.system.solutions - done, from_guess=from_guess)
        return step

    def _stuck(self, right_sides: RightSides) -> Increment:
        """Increments if all contacts keep their positions."""
        held = right_sides.held + self._rules.normal * self._opening
        states = np.full_like(self._states, HELD)
        return self.system(states, replace(right_sides, held=held))

    def _pull_together(self, step: Increment, instant: int) -> Array:
        """Forces that bring inconsistent dependent jumps together, (n_base,)."""
        condensed = self._condensed
        stresses = condensed.stresses
        given = condensed.given[condensed.moving[condensed.base], instant]
        moved = self._newton.strained + condensed.gauge @ self._motion - given
        moved += step.strained + condensed.gauge @ step.motion
        return np.asarray(condensed.tie * (stresses @ (stresses.T @ moved)))

    def _solved(self, right_sides: RightSides, instant: int) -> InstantSolution | None:
        """Find states and increments of an instant; None without a solution."""
        rules = self._rules
        newton = self._newton
        # A body that falls, rolls or slides a long way touches elsewhere than one
        # instant before, or slips as a whole.
        known = [states[:, instant] for states in self._guesses]
        still = np.zeros_like(right_sides.held)
        nothing = Increment(
            still, self._force, still[: len(right_sides.load)], still[:0]
        )
        begin = InstantSolution(self._states, nothing, still)
        guesses = begin.guesses(known)
        # Where there may be several solutions, the states of the instant before come
        # first.
        if self._has_guess and self._starts.from_guess and not rules.is_nonlinear:
            guesses[:2] = guesses[1::-1]
        solved = newton.follow(begin, right_sides, guesses)
        # After a lost instant the start is uncertain: no costly search is tried.
        if solved is None and not self._is_lost:
            solved = self._searched(begin, right_sides, known, instant)
        self.is_stuck = solved is None
        self._is_lost = self._is_lost or self.is_stuck
        return solved

    def _searched(
        self,
        begin: InstantSolution,
        right_sides: RightSides,
        known: list[States],
        instant: int,
    ) -> InstantSolution | None:
        """Seek an instant that no guess leads to; None without a solution.

        Where friction does not change with slip, a costly search is for instants at
        which there may be an equilibrium; a whole step may miss what small ones follow.
        `known` are states to try, shape (n,) each.
        """
        if not self._rules.is_nonlinear:
            if not self._may_hold(instant):
                return None
            approach = self._newton.approach(begin, right_sides)
            solved = self._newton.follow(begin, right_sides, approach)
            if solved is not None:
                return solved
        return self._in_parts(begin, right_sides, known, instant)

    def _in_parts(
        self,
        at: InstantSolution,
        right_sides: RightSides,
        known: list[States],
        instant: int,
    ) -> InstantSolution | None:
        """Follow the solution of the instant before; if it is lost, seek another.

        `known` are states to try, shape (n,) each.
        """
        rules = self._rules
        force = self._force
        held = rules.compliance * force - np.where(rules.normal, self._opening, 0.0)
        # With these right-hand sides all increments are zero.
        pulled = -self.system.on_base(force)
        begin = RightSides(pulled, self._bound(max(instant - 1, 0)), held)
        shortest = SHORT_PART
        if rules.is_nonlinear:
            shortest = SHORTEST_PART
        at, share = followed(
            lambda _: self._newton, at, (begin, right_sides), known, shortest
        )
        if share == 1.0:
            return at
        # Only friction that falls with slip lets the structure snap.
        if self.jumps_at is None and rules.softens:
            self.jumps_at = instant
        # Where friction does not change with slip softer springs have been tried.
        if not rules.is_nonlinear or not self._may_hold(instant):
            return None
        if not rules.softens:
            newton = self._newton
            return newton.follow(at, right_sides, newton.approach(at, right_sides))
        further = (begin.towards(right_sides, share), right_sides)
        found, meets_others = beyond(self._newton, rules, at, further, known)
        self.has_others = self.has_others or meets_others
        return found
