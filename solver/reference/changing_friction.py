"""Contacts whose friction hardens or softens with slip: one instant after the other.

The bound (r + mu f_n) m(s) of a slip s is linear in slip and pressing force up to their product:
Newton's method takes it by its tangent, which adds its growth per slip to the stiffness where
contacts slip (solver/README.md, 14). Where friction softens an instant may have several solutions.
The one that goes on from the instant before is found by following it while the load of the instant
grows, in steps so small that between their ends no other branches off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.linalg import LinAlgError
from scipy.linalg import cholesky

from solver.arrays import Array, Indices
from solver.laws import OPEN
from solver.reference.condensation import Condensation
from solver.reference.newton import CONVERGED, NEWTON_LIMIT, Marched, Newton
from solver.reference.rules import HELD, Increment, Rules, Sides, States

SETTLED = 1e-12
"""Share of the largest force by which friction may differ from its law."""
SHORTEST = 2.0**-12
"""Share of the load of an instant within which the solution is lost, where it jumps."""
SLIDES = 100
"""Slips at most, each with the friction that the one before has left, up to the next solution."""


class Reached(NamedTuple):
    """A solution under a part of the load of an instant."""

    states: States
    step: Increment
    slip: Array


class NewtonWithChangingFriction(Newton):
    """Finds jumps and forces of one instant after the other."""

    def __init__(
        self,
        condensed: Condensation,
        rules: Rules,
        rest: Array | None,
        guesses: States | None,
        may_hold: Callable[[int], bool],
    ) -> None:
        super().__init__(condensed, rules, rest, guesses, may_hold)
        self._gone = np.zeros_like(rules.gap)
        self._softens = any(strength.slopes.min() < 0.0 for strength in rules.strengths)
        self._ties = None if len(condensed.base) == len(rules.gap) else condensed.ties.toarray()

    def __call__(self, instant: int) -> Marched:
        """What an instant adds, as `Newton`."""
        added = super().__call__(instant)
        self._gone += np.abs(added.slip)
        return added

    def _solved(self, sides: Sides, instant: int) -> tuple[States, Increment] | None:
        """Follow the solution from the instant before; where it is lost, look for any."""
        if self._is_lost and not self._may_hold(instant):
            return None
        begin = self._before(instant)
        still = np.zeros_like(sides.held)
        at = Reached(
            self._states,
            Increment(still, self._force[:, None], still[: len(sides.load)], still[:0]),
            np.zeros(len(still)),
        )
        known = [states for states in (self._guesses, self._at_rest) if states is not None]
        guesses = [states[:, instant] for states in known]
        share, length = 0.0, 1.0
        while share < 1.0:
            target = min(share + length, 1.0)
            following = self._follow(at, _between(begin, sides, target), guesses)
            if following is not None:
                at, share, length = following, target, 2.0 * length
            elif length > SHORTEST:
                length *= 0.25
            else:
                if self.jumps_at is None and self._softens:
                    self.jumps_at = instant
                may_hold = self._may_hold(instant)
                beyond = self._elsewhere(at, sides, guesses) if may_hold else None
                self._is_lost = self._is_lost or beyond is None
                return None if beyond is None else (beyond.states, beyond.step)
        return at.states, at.step

    def _before(self, instant: int) -> Sides:
        """Right sides under which nothing is added to the instant before."""
        rules, force = self._rules, self._force
        held = rules.compliance * force - np.where(rules.normal, self._opening, 0.0)
        bound = self._bound(max(instant - 1, 0))
        return Sides(-self.system.on_base(force)[:, None], bound, held[:, None])

    def _follow(self, at: Reached, sides: Sides, guesses: list[States]) -> Reached | None:
        """Go on to a larger share of the load, None where this may lead to another branch."""
        for states in (at.states, *guesses):
            reached = self._reach(states, at, sides)
            if reached is not None and self._goes_on(at, reached, sides):
                return reached
        return None

    def _elsewhere(self, at: Reached, sides: Sides, guesses: list[States]) -> Reached | None:
        """A stable solution beyond one that is lost, or None.

        With the friction that slip so far has left the next slip is larger, and so on up to the
        nearest solution; Newton's method is tried once the same contacts slip again. What the last
        friction alone comes to is the last resort.
        """
        for _ in range(SLIDES):
            left = self._rules.factor((self._gone + np.abs(at.slip))[:, None])
            slid = self._slid(left, sides, [at.states, *guesses])
            if slid is None:
                return None
            beyond = self._stable(slid, sides) if np.array_equal(slid.states, at.states) else None
            if beyond is not None:
                return beyond
            at = slid
        last = self._rules.factor(np.full((len(self._gone), 1), np.inf))
        slid = self._slid(last, sides, [at.states, *guesses])
        return None if slid is None else self._stable(slid, sides)

    def _stable(self, near: Reached, sides: Sides) -> Reached | None:
        """The solution near what is none yet, or None where it is not stable."""
        reached = self._reach(near.states, near, sides)
        is_stable = reached is not None and self._goes_on(reached, reached, sides)
        return reached if is_stable else None

    def _slid(self, factor: Array, sides: Sides, guesses: list[States]) -> Reached | None:
        """Solve with a given factor on friction, (n, 1), whatever slips; None without solution."""
        rules = replace(self._rules, friction=self._rules.friction * factor[:, 0])
        self.system.set_friction(rules.friction, np.zeros_like(rules.friction))
        given = replace(sides, bound=sides.bound * factor)
        solved = self._from_any(guesses, given) or self._unloaded(rules, given)
        return None if solved is None else Reached(*solved, self._slip_of(solved[1], sides))

    def _slip_of(self, step: Increment, sides: Sides) -> Array:
        """Slip of the tangential jumps in a step, shape (n,)."""
        return np.where(self._rules.normal, 0.0, (step.jump - sides.held)[:, 0])

    def _reach(self, states: States, begin: Reached, sides: Sides) -> Reached | None:
        """Seek states and slip, from those of a solution nearby; None without."""
        slip, force = begin.slip, begin.step.force[:, 0]
        pieces: list[bytes] = []
        for _ in range(NEWTON_LIMIT):
            slip = np.where(np.abs(states) == 1, np.maximum(states * slip, 0.0), 0.0)
            is_capped = self._carried(force, sides) > self._rules.cap
            segment = self._rules.segment(self._gone + slip)
            piece = states.tobytes() + segment.tobytes() + is_capped.tobytes()
            if piece in pieces and piece != pieces[-1]:  # of a cycle
                return None
            pieces.append(piece)
            tangent = self._linearised(slip, force, sides)
            step = self.system(states, tangent)
            corrected = self._corrected(states, step, tangent)
            moved, force = self._slip_of(step, sides), step.force[:, 0]
            if np.array_equal(corrected, states) and self._obeys(states, moved, force, sides):
                return Reached(states, step, moved)
            states, slip = corrected, moved
        return None

    def _linearised(self, slip: Array, force: Array, sides: Sides) -> Sides:
        """Set the tangent of the friction bound at slips (n,) >= 0; return what is left of it."""
        rules, most = self._rules, self._most(force, sides)
        grows = rules.growth(self._gone + slip) * most
        factor = rules.factor(self._gone + slip)
        is_capped = self._carried(force, sides) > rules.cap
        self.system.set_friction(np.where(is_capped, 0.0, rules.friction * factor), grows)
        bound = np.where(is_capped, rules.cap, sides.bound[:, 0]) * factor - grows * slip
        return replace(sides, bound=bound[:, None])

    def _carried(self, force: Array, sides: Sides) -> Array:
        """Friction force r + mu f_n, whatever the cap, shape (n,)."""
        rules = self._rules
        return sides.bound[:, 0] + np.maximum(rules.friction * force[rules.partner], 0.0)

    def _most(self, force: Array, sides: Sides) -> Array:
        """Largest friction force of surfaces that have not slipped yet, shape (n,)."""
        return np.minimum(self._carried(force, sides), self._rules.cap)

    def _obeys(self, states: States, slip: Array, force: Array, sides: Sides) -> bool:
        """Whether friction is what slip has left, not only by its tangent."""
        if self.system.unbalanced > CONVERGED * self._largest:
            return False
        slips = np.abs(states) == 1
        factor = self._rules.factor((self._gone + np.abs(slip))[:, None])[:, 0]
        wrong = np.abs(force + states * factor * self._most(force, sides))[slips]
        return bool(wrong.max(initial=0.0) <= SETTLED * max(self._largest, np.abs(force).max()))

    def _goes_on(self, at: Reached, reached: Reached, sides: Sides) -> bool:
        """Whether a solution is the one that another goes over into.

        So it is if the structure is stable however far the contacts that slip in either have
        softened on the way: then no other solution slips there alone.
        """
        begin, end = np.abs(at.slip), np.abs(reached.slip)
        slips = (np.abs(at.states) == 1) | (np.abs(reached.states) == 1)
        most = np.maximum(*(self._most(end.step.force[:, 0], sides) for end in (at, reached)))
        on_way = self._gone + np.minimum(begin, end), self._gone + np.maximum(begin, end)
        growth = np.where(slips, self._rules.lowest_growth(*on_way) * most, 0.0)
        if not np.any(growth < 0.0):
            return True
        is_open = (at.states == OPEN) & (reached.states == OPEN)
        sprung = self._rules.compliance > 0.0
        stiffness = 1.0 + growth * self._rules.compliance
        if np.any(stiffness <= 0.0):
            return False
        growth /= stiffness
        presses = sprung & (at.states == HELD) & (reached.states == HELD)
        growth[presses] += 1.0 / self._rules.compliance[presses]
        free = np.flatnonzero((slips | is_open | sprung)[self._condensed.base])
        try:
            cholesky(self._softened(growth, free), overwrite_a=True, check_finite=False)
        except LinAlgError:
            return False
        return True

    def _softened(self, growth: Array, free: Indices) -> Array:
        """Stiffness of some jumps of the base, (n_free, n_free), with that of each jump itself."""
        stiffness = self._condensed.elastic[np.ix_(free, free)]
        if self._ties is None:
            stiffness[np.diag_indices_from(stiffness)] += growth[self._condensed.base[free]]
            return stiffness
        tied = self._ties[:, free]
        return np.asarray(stiffness + tied.T @ (growth[:, None] * tied))


def _between(begin: Sides, end: Sides, share: float) -> Sides:
    """Right sides at a share of the way from some to others."""
    if share == 1.0:
        return end
    return Sides(
        begin.load + share * (end.load - begin.load),
        begin.bound + share * (end.bound - begin.bound),
        begin.held + share * (end.held - begin.held),
    )
