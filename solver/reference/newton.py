"""Newton's method for the states of one instant of frictional contact.

Solve the linear system of the states (`solver.reference.linear_system`, the bound of
friction coupled to the normal force), and correct the states by what it shows (Alart
and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991). Exact once they repeat. The
bound (r + mu f_n) g(s) of a slip s is taken by its tangent, which adds its growth per
slip to the stiffness where contacts slip (solver/README.md, 14).

From afar the states may cycle, above all where bodies hang loose, as they may go
anywhere. With springs at all jumps that are relaxed where the last solution came to,
none is loose: that is the proximal point method (Rockafellar, SIAM J. Control Optim.
14, 1976). Its steps are short, and where they come to rest the springs carry nothing.
They are softened from step to step, until the states hold without them
(solver/README.md, 6).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import cholesky, eigh

from solver.arrays import ROUNDING, Array, Flags, Indices
from solver.laws import OPEN
from solver.reference.condensation import Condensation
from solver.reference.linear_system import LinearSystem
from solver.reference.rules import HELD, Increment, InstantSolution, Sides, States

NEWTON_LIMIT = 30
"""Newton steps from one guess of the states; more than a dozen means that they
cycle."""
CONVERGED = 1e-9
"""Relative KKT residual up to which an instant counts as solved, where rounding allows
it."""
SETTLED = 1e-12
"""Share of the largest force by which friction may differ from its law."""
FIRST = 1e-2
SOFTEST = 1e-8
STIFFEST = 1e2
"""Springs, as shares of the stiffness of each jump alone."""
SOFTER = 0.5
STIFFER = 10.0
"""Factors on them after a step, and where Newton's method cycles in spite of them."""
STEPS = 60
"""Steps at most; up to 20 are seen where there is a solution."""
MOST_JUMPS = 4000
"""Jumps up to which springs are tried: that keeps two more matrices of their size."""
_HELD = np.int8(HELD)
_OPEN = np.int8(OPEN)


class Newton:
    """Newton's method from one solution to another.

    Attributes
    ----------
    system
        The linear system of the states.
    gone, strained
        Accumulated slip of all jumps, shape (n,), and y of the base, shape (n_base,),
        at the instant before: whoever marches through time keeps them.
    largest
        Largest force of the load on a jump, scaled.
    """

    def __init__(
        self, condensed: Condensation, stop: Callable[[], bool] | None = None
    ) -> None:
        self.system = LinearSystem(
            condensed, condensed.stiffness, condensed.gauge, stop
        )
        self._condensed = condensed
        self._rules = condensed.rules
        rules = self._rules
        self.gone = np.zeros_like(rules.gap)
        self.strained = np.zeros(len(condensed.base))
        self._smooth: Indices = np.flatnonzero(rules.smooth)
        self._rubs: Indices = np.union1d(
            np.flatnonzero(rules.friction > 0.0), rules.bonds
        )
        self._carry: Indices = rules.partner[self._rubs]
        self.largest = float(np.abs(condensed.load).max(initial=0.0))
        # Slips that say how far friction has fallen, where it falls no further.
        self._fallen: Array | None = None

    def with_friction_left(self, slip: Array) -> Newton:
        """The same method for friction that has fallen as after slips (n,) >= 0, and falls no more.

        Where it rises with slip it goes on to rise.
        """
        changed = copy(self)
        changed._fallen = slip
        return changed

    @property
    def _softens(self) -> bool:
        """Whether friction falls with slip anywhere."""
        return self._fallen is None and self._rules.softens

    def _factor(self, slip: Array) -> Array:
        """Factor that slips (n,) >= 0 make of the friction bound."""
        strength = self._rules.strength
        if self._fallen is None:
            return strength(self.gone + slip)
        fallen = self.gone + self._fallen
        return (
            strength(fallen) - strength.rise(fallen) + strength.rise(self.gone + slip)
        )

    def _slope(self, slip: Array) -> Array:
        """Growth of that factor per further slip, shape (n,)."""
        slope = self._rules.strength.slope(self.gone + slip)
        if self._fallen is None:
            return slope
        return np.maximum(slope, 0.0)

    def follow(
        self, at: InstantSolution, sides: Sides, guesses: Iterable[InstantSolution]
    ) -> InstantSolution | None:
        """Go on to other right sides, None where no guess leads there or to another branch."""
        for guess in guesses:
            reached = self.seek(self.system, guess, sides)
            if reached and (not self._softens or self._goes_on(at, reached, sides)):
                return reached
        return None

    def approach(self, at: InstantSolution, sides: Sides) -> Iterator[InstantSolution]:
        """Solutions with softer and softer springs, whose states have come to rest.

        The first is sought from a solution. None where there are too many jumps.
        """
        condensed = self._condensed
        share = FIRST
        if len(condensed.stiffness) > MOST_JUMPS:
            return
        alone = np.diagonal(condensed.stiffness)
        moved = np.zeros_like(sides.load)
        for _ in range(STEPS):
            springs = share * alone
            held = condensed.elastic + np.diagflat(springs)
            sprung = LinearSystem(
                condensed, held, condensed.gauge[:, :0], self.system.stop
            )
            pulled = replace(sides, load=sides.load + springs * moved)
            solved = self.seek(sprung, at, pulled)
            if solved is not None:
                before = at
                at = solved
                moved = solved.step.strained
                share = max(SOFTER * share, SOFTEST)
                if np.array_equal(at.states, before.states):
                    yield at
            elif share < STIFFEST:
                share *= STIFFER
            else:
                return

    def near(self, at: InstantSolution, sides: Sides) -> InstantSolution | None:
        """The solution near what is none yet, stable or not; None where none is."""
        return self.seek(self.system, at, sides)

    def is_stable(self, at: InstantSolution, sides: Sides) -> bool:
        """Whether no slip of a solution costs less than it gains."""
        return self._goes_on(at, at, sides)

    def leave(self, at: InstantSolution, sides: Sides) -> InstantSolution:
        """What a solution that is not stable begins to go over into, when it is disturbed.

        It slips on along the motion that costs least, until half of what stops a
        contact.
        """
        rules = self._rules
        growth, free = self._growth(at, at, sides)
        motion = np.zeros(len(self._condensed.base))
        if growth is not None:
            softened = self._softened(growth, free)
            _, vectors = eigh(softened, subset_by_index=[0, 0], check_finite=False)
            motion[free] = vectors[:, 0]
        else:
            motion[free] = rules.compliance[self._condensed.base[free]] > 0.0
        way = self._condensed.ties @ motion * at.states
        way[np.abs(at.states) != 1] = 0.0
        slip = np.abs(at.slip)
        turns = way < 0.0
        if turns.all() or not (way > 0.0).any():
            way = -way
            turns = way < 0.0
        length = float((slip[turns] / -way[turns]).min(initial=np.inf))
        if not np.isfinite(length):
            length = float(slip.max() / way.max())
        return at._replace(slip=at.states * np.maximum(slip + 0.5 * length * way, 0.0))

    def seek(
        self, system: LinearSystem, guess: InstantSolution, sides: Sides
    ) -> InstantSolution | None:
        """Seek states and slip, from those of a guess; None where they cycle."""
        rules = self._rules
        states = guess.states
        slip = guess.slip
        force = guess.step.force
        pieces: list[bytes] = []
        for _ in range(NEWTON_LIMIT):
            tangent = sides
            piece = states.tobytes()
            if rules.is_curved:
                slip = np.where(
                    np.abs(states) == 1, np.maximum(states * slip, 0.0), 0.0
                )
                tangent, is_capped = self._linearised(system, slip, force, sides)
                piece += (
                    rules.strength.segment(self.gone + slip).tobytes()
                    + is_capped.tobytes()
                )
            if piece in pieces and not (rules.is_curved and piece == pieces[-1]):
                return None
            pieces.append(piece)
            step = system(states, tangent)
            # Those with springs count, too.
            self.system.solutions += system is not self.system
            corrected = self._corrected(states, step, tangent, system.friction)
            if self._condensed.rules.is_curved:
                slip = np.where(rules.normal, 0.0, step.jump - sides.held)
            force = step.force
            reached = InstantSolution(states, step, slip)
            if np.array_equal(corrected, states) and self._obeys(
                system, reached, sides
            ):
                return reached
            states = corrected
        return None

    def _linearised(
        self, system: LinearSystem, slip: Array, force: Array, sides: Sides
    ) -> tuple[Sides, Flags]:
        """Set the tangent of the friction bound at slips (n,) >= 0; return what is left of it.

        And where it is capped.
        """
        rules = self._rules
        most = self._rules.before_slip(sides.bound, force)
        is_capped = most >= rules.cap
        factor = self._factor(slip)
        grows = self._slope(slip) * most
        system.set_friction(np.where(is_capped, 0.0, rules.friction * factor), grows)
        bound = np.where(is_capped, rules.cap, sides.bound) * factor - grows * slip
        return replace(sides, bound=bound), is_capped

    def _obeys(self, system: LinearSystem, at: InstantSolution, sides: Sides) -> bool:
        """Whether forces balance, and friction is what slip has left, not only by its tangent.

        What sticks carries no more: its cap was that of the step before.
        """
        slack, _ = self._rounding(at.states, at.step)
        if system.unbalanced > max(CONVERGED * self.largest, slack):
            return False
        rules = self._rules
        force = at.step.force
        if not rules.is_curved:
            return True
        most = rules.before_slip(sides.bound, force)
        most = self._factor(np.abs(at.slip)) * most
        sticks = (at.states == HELD) & ~rules.normal
        excess = np.where(sticks, np.abs(force) - most - slack, 0.0)
        wrong = np.where(
            np.abs(at.states) == 1, np.abs(force + at.states * most), excess
        )
        largest = max(self.largest, np.abs(force).max())
        return bool(wrong.max(initial=0.0) <= SETTLED * largest)

    def _goes_on(
        self, at: InstantSolution, reached: InstantSolution, sides: Sides
    ) -> bool:
        """Whether a solution is the one that another goes over into.

        So it is if the structure is stable however far the contacts that slip in either
        have softened on the way, whatever else slips: then no other solution slips
        there alone.
        """
        growth, free = self._growth(at, reached, sides)
        if growth is None:
            return False
        if not len(free):
            return True
        try:
            cholesky(self._softened(growth, free), overwrite_a=True, check_finite=False)
        except LinAlgError:
            return False
        return True

    def _growth(
        self, at: InstantSolution, reached: InstantSolution, sides: Sides
    ) -> tuple[Array | None, Indices]:
        """Stiffness of contacts, (n,), as far as they soften between two solutions.

        And the places in the base of what moves, (n_free,); none where nothing softens.
        None where a spring in series snaps by itself; then the places are those of such
        springs.
        """
        rules = self._rules
        condensed = self._condensed
        begin = np.abs(at.slip)
        end = np.abs(reached.slip)
        carried = [
            rules.before_slip(sides.bound, one.step.force) for one in (at, reached)
        ]
        on_way = self.gone + np.minimum(begin, end), self.gone + np.maximum(begin, end)
        slips = (np.abs(at.states) == 1) | (np.abs(reached.states) == 1)
        growth = np.where(
            slips, rules.strength.lowest_slope(*on_way) * np.maximum(*carried), 0.0
        )
        if not np.any(growth < 0.0):
            return growth, np.zeros(0, dtype=np.intp)
        sprung = rules.compliance > 0.0
        stiffness = 1.0 + growth * rules.compliance
        if np.any(stiffness <= 0.0):
            return None, np.flatnonzero(stiffness[condensed.base] <= 0.0)
        growth /= stiffness
        presses = sprung & (at.states == HELD) & (reached.states == HELD)
        growth[presses] += 1.0 / rules.compliance[presses]
        is_free = slips | (at.states == OPEN) & (reached.states == OPEN) | sprung
        return growth, np.flatnonzero(is_free[condensed.base])

    def _softened(self, growth: Array, free: Indices) -> Array:
        """Stiffness of the structure and its contacts at some places of the base, (n, n)."""
        tied = self._condensed.ties[:, free]
        softened = self._condensed.elastic[np.ix_(free, free)]
        softened += tied.T @ sparse.diags_array(growth) @ tied
        return np.asarray(softened)

    def _rounding(self, states: States, step: Increment) -> tuple[float, Array]:
        """Force that rounding may make anywhere; and of a jump that is not held, (n,) or (1,).

        A held jump is the deformation less the rigid motion: rounding of that makes
        forces at all.
        """
        inside = self.system.inside(self.strained + step.strained)
        slack = ROUNDING * (inside + self.largest)
        blur = self.system.blur(step.motion)
        is_stiff = (states == HELD) & (self._rules.compliance == 0.0)
        return slack + float((blur * is_stiff).max(initial=0.0)), slack + blur

    def _corrected(
        self, states: States, step: Increment, sides: Sides, friction: Array
    ) -> States:
        """States that jump and force call for; what is up to rounding calls for none."""
        rules = self._rules
        system = self.system
        force = step.force
        moved = system.unit * (step.jump - sides.held)
        slack, blur = self._rounding(states, step)
        held = states == HELD
        # A contact that closes rubs as its overlap and its slip would have it.
        carries = np.where(held, force[rules.partner], -moved[rules.partner])
        most = sides.bound + np.maximum(friction * carries, 0.0) + slack * held
        pulled = np.where(held, -force, moved)
        corrected = (pulled > most).view(np.int8) - (pulled < -most).view(np.int8)
        corrected = np.where(
            np.abs(states) == 1, states * (states * moved >= -blur), corrected
        )
        corrected[self._smooth] = OPEN
        closed = np.where(held, force >= -slack, moved < -blur)
        corrected = np.where(rules.normal, np.where(closed, _HELD, _OPEN), corrected)
        corrected[self._rubs[corrected[self._carry] == OPEN]] = OPEN
        return corrected
