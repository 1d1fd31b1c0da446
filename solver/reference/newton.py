"""Newton's method for the states of one instant of frictional contact.

Solve the linear system of the states (`solver.reference.linear_system`, the bound of friction
coupled to the normal force), and correct the states by what it shows (Alart and Curnier, Comput.
Methods Appl. Mech. Eng. 92, 1991). Exact once they repeat. The bound (r + mu f_n) g(s) of a slip s
is taken by its tangent, which adds its growth per slip to the stiffness where contacts slip
(solver/README.md, 14).

From afar the states may cycle, above all where bodies hang loose, as they may go anywhere. With
springs at all jumps that are relaxed where the last solution came to, none is loose: that is the
proximal point method (Rockafellar, SIAM J. Control Optim. 14, 1976). Its steps are short, and where
they come to rest the springs carry nothing. They are softened from step to step, until the states
hold without them (solver/README.md, 6).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import cholesky

from solver.arrays import ROUNDING, Array, Flags, Indices
from solver.laws import OPEN
from solver.reference.condensation import Condensation
from solver.reference.linear_system import LinearSystem
from solver.reference.rules import HELD, Increment, InstantSolution, Sides, States

NEWTON_LIMIT = 30
"""Newton steps from one guess of the states; more than a dozen means that they cycle."""
CONVERGED = 1e-9
"""Relative KKT residual up to which an instant counts as solved, where rounding allows it."""
SETTLED = 1e-12
"""Share of the largest force by which friction may differ from its law."""
FIRST, SOFTEST, STIFFEST = 1e-2, 1e-8, 1e2
"""Springs, as shares of the stiffness of each jump alone."""
SOFTER, STIFFER = 0.5, 10.0
"""Factors on them after a step, and where Newton's method cycles in spite of them."""
STEPS = 60
"""Steps at most; up to 20 are seen where there is a solution."""
MOST_JUMPS = 4000
"""Jumps up to which springs are tried: that keeps two more matrices of their size."""
_HELD, _OPEN = np.int8(HELD), np.int8(OPEN)


class Newton:
    """Newton's method from one solution to another.

    Attributes
    ----------
    system
        The linear system of the states.
    gone, strained
        Accumulated slip of all jumps, shape (n,), and y of the base, shape (n_base,), at the
        instant before: whoever marches through time keeps them.
    largest
        Largest force of the load on a jump, scaled.
    """

    def __init__(self, condensed: Condensation) -> None:
        self.system = LinearSystem(condensed, condensed.stiffness, condensed.gauge)
        self._condensed, self._rules = condensed, condensed.rules
        rules = self._rules
        self.gone, self.strained = np.zeros_like(rules.gap), np.zeros(len(condensed.base))
        self._smooth: Indices = np.flatnonzero(rules.smooth)
        self._rubs: Indices = np.union1d(np.flatnonzero(rules.friction > 0.0), rules.bonds)
        self._carry: Indices = rules.partner[self._rubs]
        self.largest = float(np.abs(condensed.load).max(initial=0.0))

    def with_friction_left(self, factor: Array) -> Newton:
        """The same method for a friction that slip has changed by a factor, and changes no more."""
        changed = copy(self)
        changed._rules = self._rules.without_slip(factor)
        self.system.set_friction(changed._rules.friction, np.zeros_like(factor))
        return changed

    def follow(
        self, at: InstantSolution, sides: Sides, guesses: Iterable[States]
    ) -> InstantSolution | None:
        """Go on to other right sides, None where no guess leads there or to another branch."""
        for states in guesses:
            reached = self.seek(self.system, states, sides, at)
            if reached and (not self._rules.softens or self._goes_on(at, reached, sides)):
                return reached
        return None

    def approach(self, at: InstantSolution, sides: Sides) -> Iterator[States]:
        """States that have come to rest with softer and softer springs, from those of a solution.

        None where there are too many jumps.
        """
        condensed, states, share = self._condensed, at.states, FIRST
        if len(condensed.stiffness) > MOST_JUMPS:
            return
        alone, moved = np.diagonal(condensed.stiffness), np.zeros_like(sides.load)
        for _ in range(STEPS):
            springs = share * alone
            held = condensed.elastic + np.diagflat(springs)
            sprung = LinearSystem(condensed, held, condensed.gauge[:, :0])
            pulled = replace(sides, load=sides.load + springs * moved)
            solved = self.seek(sprung, states, pulled, at)
            if solved is not None:
                before, states, moved = states, solved.states, solved.step.strained
                share = max(SOFTER * share, SOFTEST)
                if np.array_equal(states, before):
                    yield states
            elif share < STIFFEST:
                share *= STIFFER
            else:
                return

    def stable(self, near: InstantSolution, sides: Sides) -> InstantSolution | None:
        """The solution near what is none yet, or None where it is not stable."""
        reached = self.seek(self.system, near.states, sides, near)
        return reached if reached and self._goes_on(reached, reached, sides) else None

    def seek(
        self, system: LinearSystem, states: States, sides: Sides, near: InstantSolution
    ) -> InstantSolution | None:
        """Seek states and slip, from those of a solution nearby; None where they cycle."""
        rules, slip, force = self._rules, near.slip, near.step.force
        pieces: list[bytes] = []
        for _ in range(NEWTON_LIMIT):
            tangent, piece = sides, states.tobytes()
            if rules.is_curved:
                slip = np.where(np.abs(states) == 1, np.maximum(states * slip, 0.0), 0.0)
                tangent, is_capped = self._linearised(slip, force, sides)
                piece += rules.strength.segment(self.gone + slip).tobytes() + is_capped.tobytes()
            if piece in pieces and not (rules.is_curved and piece == pieces[-1]):
                return None
            pieces.append(piece)
            step = system(states, tangent)
            # Those with springs count, too.
            self.system.solutions += system is not self.system
            corrected = self._corrected(states, step, tangent)
            if self._condensed.rules.is_curved:
                slip = np.where(rules.normal, 0.0, step.jump - sides.held)
            force, reached = step.force, InstantSolution(states, step, slip)
            if np.array_equal(corrected, states) and self._obeys(system, reached, sides):
                return reached
            states = corrected
        return None

    def _linearised(self, slip: Array, force: Array, sides: Sides) -> tuple[Sides, Flags]:
        """Set the tangent of the friction bound at slips (n,) >= 0; return what is left of it.

        And where it is capped.
        """
        rules, most = self._rules, self._rules.before_slip(sides.bound, force)
        is_capped, factor = most >= rules.cap, rules.strength(self.gone + slip)
        grows = rules.strength.slope(self.gone + slip) * most
        self.system.set_friction(np.where(is_capped, 0.0, rules.friction * factor), grows)
        bound = np.where(is_capped, rules.cap, sides.bound) * factor - grows * slip
        return replace(sides, bound=bound), is_capped

    def _obeys(self, system: LinearSystem, at: InstantSolution, sides: Sides) -> bool:
        """Whether forces balance, and friction is what slip has left, not only by its tangent."""
        slack, _ = self._rounding(at.states, at.step)
        if system.unbalanced > max(CONVERGED * self.largest, slack):
            return False
        rules, force = self._rules, at.step.force
        if not rules.is_curved:
            return True
        most = rules.before_slip(sides.bound, force)
        wrong = np.abs(force + at.states * rules.strength(self.gone + np.abs(at.slip)) * most)
        largest = max(self.largest, np.abs(force).max())
        return bool(wrong[np.abs(at.states) == 1].max(initial=0.0) <= SETTLED * largest)

    def _goes_on(self, at: InstantSolution, reached: InstantSolution, sides: Sides) -> bool:
        """Whether a solution is the one that another goes over into.

        So it is if the structure is stable however far the contacts that slip in either have
        softened on the way, whatever else slips: then no other solution slips there alone.
        """
        rules, condensed = self._rules, self._condensed
        begin, end = np.abs(at.slip), np.abs(reached.slip)
        carried = [rules.before_slip(sides.bound, one.step.force) for one in (at, reached)]
        on_way = self.gone + np.minimum(begin, end), self.gone + np.maximum(begin, end)
        slips = (np.abs(at.states) == 1) | (np.abs(reached.states) == 1)
        growth = np.where(slips, rules.strength.lowest_slope(*on_way) * np.maximum(*carried), 0.0)
        if not np.any(growth < 0.0):
            return True
        sprung = rules.compliance > 0.0
        stiffness = 1.0 + growth * rules.compliance
        if np.any(stiffness <= 0.0):
            return False
        growth /= stiffness
        presses = sprung & (at.states == HELD) & (reached.states == HELD)
        growth[presses] += 1.0 / rules.compliance[presses]
        is_free = slips | (at.states == OPEN) & (reached.states == OPEN) | sprung
        free = np.flatnonzero(is_free[condensed.base])
        tied = condensed.ties[:, free]
        softened = condensed.elastic[np.ix_(free, free)]
        softened += tied.T @ sparse.diags_array(growth) @ tied
        try:
            cholesky(softened, overwrite_a=True, check_finite=False)
        except LinAlgError:
            return False
        return True

    def _rounding(self, states: States, step: Increment) -> tuple[float, Array]:
        """Force that rounding may make anywhere; and of a jump that is not held, (n,) or (1,).

        A held jump is the deformation less the rigid motion: rounding of that makes forces at all.
        """
        inside = self.system.inside(self.strained + step.strained)
        slack = ROUNDING * (inside + self.largest)
        blur = self.system.blur(step.motion)
        is_stiff = (states == HELD) & (self._rules.compliance == 0.0)
        return slack + float((blur * is_stiff).max(initial=0.0)), slack + blur

    def _corrected(self, states: States, step: Increment, sides: Sides) -> States:
        """States that jump and force call for; what is up to rounding calls for none."""
        rules, system, force = self._rules, self.system, step.force
        moved = system.unit * (step.jump - sides.held)
        slack, blur = self._rounding(states, step)
        held = states == HELD
        # A contact that closes rubs as its overlap and its slip would have it.
        carries = np.where(held, force[rules.partner], -moved[rules.partner])
        most = sides.bound + np.maximum(system.friction * carries, 0.0) + slack * held
        pulled = np.where(held, -force, moved)
        corrected = (pulled > most).view(np.int8) - (pulled < -most).view(np.int8)
        corrected = np.where(np.abs(states) == 1, states * (states * moved >= -blur), corrected)
        corrected[self._smooth] = OPEN
        closed = np.where(held, force >= -slack, moved < -blur)
        corrected = np.where(rules.normal, np.where(closed, _HELD, _OPEN), corrected)
        corrected[self._rubs[corrected[self._carry] == OPEN]] = OPEN
        return corrected
