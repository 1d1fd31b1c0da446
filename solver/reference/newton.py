"""Newton's method for the states of one instant of frictional contact.

Each step solves the linear system of the states (`solver.reference.linear_system`, the
friction bound coupled to the normal force), and corrects the states by the jumps and
forces of its solution (Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991).
The solution is exact once the states repeat. The bound (r + mu f_n) g(s) of a slip s is
taken by its tangent, which adds its growth per slip to the stiffness where contacts
slip (MATHEMATICS.md, 14).

From a distant guess the states may cycle, above all where bodies are held by contact
alone, as they may move without limit. With springs at all jumps, relaxed at the last
solution, every body is held: that is the proximal point method (Rockafellar, SIAM J.
Control Optim. 14, 1976). Its steps are short, and where they come to rest the springs
carry nothing. The springs are softened from step to step, until the states hold without
them (MATHEMATICS.md, 6).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from solver.arrays import ROUNDING, Array, Flags, Indices
from solver.laws import OPEN
from solver.reference.assembly import never
from solver.reference.condensation import Condensation
from solver.reference.friction_over_slip import FrictionOverSlip
from solver.reference.linear_system import LinearSystem
from solver.reference.rules import HELD, Increment, InstantSolution, RightSides, States
from solver.reference.soft_system import system_of
from solver.reference.stable_solutions import Stability

FEWEST_STEPS = 30
"""Newton steps that every guess of the states may take; a guess of more jumps may take
one for each. Cycles of a dozen jumps may be longer than the way to a solution."""
SINGULAR_STEPS = 5
"""Largest number of Newton steps whose states leave a body free to move: they wander,
and cost several times as much as others. A loose wall on settling ground takes 9 s of
the processor with it, 14 s with 10, 34 s without (measured)."""
STEPS_ON_A_PIECE = 30
"""Largest number of Newton steps on one piece of nonlinear laws; up to 6 are seen where
there is a solution."""
CONVERGED = 1e-9
"""Relative KKT residual up to which an instant counts as solved, where rounding allows
it."""
FRICTION_TOLERANCE = 1e-12
"""Share of the largest force by which friction may differ from its law."""
FIRST_SPRING = 1e-2
SOFTEST_SPRING = 1e-8
STIFFEST_SPRING = 1e2
"""Springs, as shares of the stiffness of each jump alone."""
SOFTENING = 0.5
STIFFENING = 10.0
"""Factors on the springs after a step, and where Newton's method cycles in spite of
them."""
SPRING_STEPS = 60
"""Largest number of steps with springs; up to 20 are seen where there is a solution."""
MOST_JUMPS = 4000
"""Jumps up to which springs are tried, which need two more matrices of their size."""
_HELD = np.int8(HELD)
_OPEN = np.int8(OPEN)


class Newton:
    """Newton's method for the states of an instant, from a solution of another.

    Attributes
    ----------
    system
        The linear system of the states.
    friction_law
        Friction of all jumps over their slips in the instant.
    stability
        Stability of solutions; friction falls there as its law says.
    strained
        y of the base at the instant before, shape (n_base,), scaled; the march through
        time updates it, and the slip that friction has accumulated.
    largest_load
        Largest force of the load on a jump, scaled.
    """

    def __init__(
        self, condensed: Condensation, stop: Callable[[], bool] = never
    ) -> None:
        self.system = system_of(condensed, stop)
        self._condensed = condensed
        self._rules = condensed.rules
        rules = self._rules
        self.friction_law = FrictionOverSlip(rules)
        self.stability = Stability(condensed, self.friction_law)
        self.strained = np.zeros(len(condensed.base))
        self._frictionless: Indices = np.flatnonzero(rules.is_frictionless)
        # Jumps whose friction ends where their contact opens, and its normal jumps.
        self._carried: Indices = np.union1d(
            np.flatnonzero(rules.friction > 0.0), rules.bonds
        )
        self._carriers: Indices = rules.partner[self._carried]
        self.largest_load = float(np.abs(condensed.load).max(initial=0.0))

    def with_friction_left(self, slip: Array) -> Newton:
        """The same method, with the friction after slips, (n,), scaled."""
        changed = copy(self)
        changed.friction_law = self.friction_law.left_after(slip)
        return changed

    def follow(
        self,
        at: InstantSolution,
        right_sides: RightSides,
        guesses: Iterable[InstantSolution],
    ) -> InstantSolution | None:
        """Follow a solution to other right-hand sides.

        None where no guess leads to a solution, or only to one of another branch.
        """
        for guess in guesses:
            reached = self.seek(self.system, guess, right_sides)
            if reached is None:
                continue
            if not self.friction_law.softens:
                return reached
            if self.stability.continues(at, reached, right_sides):
                return reached
        return None

    def approach(
        self, at: InstantSolution, right_sides: RightSides
    ) -> Iterator[InstantSolution]:
        """Yield solutions with ever softer springs at the jumps.

        The first is sought from a solution. Nothing is yielded where there are too many
        jumps, and none twice on one piece of the laws, from where Newton's steps go the
        same way: bodies that fall stay on one, whatever the springs.
        """
        condensed = self._condensed
        share = FIRST_SPRING
        if len(condensed.stiffness) > MOST_JUMPS:
            return
        # Springs are relaxed at the deformation that the step before has come to.
        relaxed = np.zeros_like(right_sides.load)
        tried = b""
        for _ in range(SPRING_STEPS):
            springs = share * np.diagonal(condensed.stiffness)
            # A spring at its relaxed length pulls with nothing, so at rest it changes
            # no solution.
            pulled = replace(right_sides, load=right_sides.load + springs * relaxed)
            solved = self.seek(self._with_springs(springs), at, pulled)
            if solved is not None:
                before = at
                at = solved
                relaxed = solved.step.strained
                share = max(SOFTENING * share, SOFTEST_SPRING)
                piece = self._piece(at.states, at.slip)
                repeats = np.array_equal(at.states, before.states)
                if repeats and piece != tried:
                    tried = piece
                    yield at
            elif share < STIFFEST_SPRING:
                share *= STIFFENING
            else:
                return

    def _piece(self, states: States, slip: Array) -> bytes:
        """Key of the smooth piece of the laws at states and slips.

        Both have the shape (n,).
        """
        piece = states.tobytes()
        if self._rules.is_nonlinear:
            piece += self.friction_law.segment(slip).tobytes()
        return piece

    def _with_springs(self, springs: Array) -> LinearSystem:
        """The linear system with springs at the jumps of the base, (n_base,)."""
        condensed = self._condensed
        stiffness = condensed.stiffness + np.diagflat(springs)
        no_motions = condensed.gauge[:, :0]
        return LinearSystem(condensed, stiffness, no_motions, self.system.stop)

    def seek(
        self, system: LinearSystem, guess: InstantSolution, right_sides: RightSides
    ) -> InstantSolution | None:
        """Seek states and slips from those of a guess; None if the states cycle.

        The solution need not be stable, and the guess need not be a solution.

        A front of slip, like that along a belt, may move by a jump a step. States that
        leave bodies free mostly wander: springs hold these at less cost.
        """
        rules = self._rules
        states, step, slip = guess
        force = step.force
        pieces: list[bytes] = []
        n_singular = 0
        for _ in range(max(FEWEST_STEPS, len(states))):
            tangent_sides = right_sides
            if rules.is_nonlinear:
                slip = _slip_of_states(states, slip)
            piece = self._piece(states, slip)
            if rules.is_nonlinear:
                tangent = self.friction_law.tangent(right_sides.bound, force, slip)
                system.set_friction(tangent.coefficient, tangent.growth)
                tangent_sides = replace(right_sides, bound=tangent.constant)
                piece += tangent.is_capped.tobytes()
            if _cycles(pieces, piece, is_nonlinear=rules.is_nonlinear):
                return None
            pieces.append(piece)
            step = system(states, tangent_sides)
            # Systems with springs cost as much as others, and are counted with them.
            if system is not self.system:
                self.system.solutions += 1
            n_singular += system.is_singular
            if n_singular > SINGULAR_STEPS:
                return None
            rounding = self._rounding(states, step)
            corrected = self._corrected(
                states, step, tangent_sides, system.friction, rounding
            )
            if rules.is_nonlinear:
                slip = np.where(rules.normal, 0.0, step.jump - right_sides.held)
            force = step.force
            reached = InstantSolution(states, step, slip)
            if np.array_equal(corrected, states):
                if self._obeys(system, reached, right_sides, rounding[0]):
                    return reached
            states = corrected
        return None

    def _obeys(
        self,
        system: LinearSystem,
        at: InstantSolution,
        right_sides: RightSides,
        slack: float,
    ) -> bool:
        """Check whether forces balance, and friction obeys its law, not the tangent.

        Sticking points may not carry more than the cap either, as the cap that the
        states were corrected by was that of the step before. The slack is a force that
        rounding may make, scaled.
        """
        if system.unbalanced > max(CONVERGED * self.largest_load, slack):
            return False
        rules = self._rules
        if not rules.is_nonlinear:
            return True
        force = at.step.force
        bound = self.friction_law.bound(right_sides.bound, force, np.abs(at.slip))
        sticks = (at.states == HELD) & ~rules.normal
        slips = np.abs(at.states) == 1
        excess = np.where(sticks, np.abs(force) - bound - slack, 0.0)
        violation = np.where(slips, np.abs(force + at.states * bound), excess)
        largest = max(self.largest_load, np.abs(force).max())
        return bool(violation.max(initial=0.0) <= FRICTION_TOLERANCE * largest)

    def _rounding(self, states: States, step: Increment) -> tuple[float, Array]:
        """Bounds on forces by rounding, scaled.

        A held jump is the deformation less the rigid motion, whose rounding makes
        forces at every jump. A deformation that is undone leaves the rounding of both
        ways.

        Returns
        -------
        The force at any jump; and at a jump that is not held, shape (n,) or (1,).
        """
        inside = self.system.largest_force(
            np.abs(self.strained) + np.abs(step.strained)
        )
        slack = ROUNDING * (inside + self.largest_load)
        blur = self.system.blur(step.motion)
        is_stiff = (states == HELD) & (self._rules.compliance == 0.0)
        return slack + float((blur * is_stiff).max(initial=0.0)), slack + blur

    def _corrected(
        self,
        states: States,
        step: Increment,
        right_sides: RightSides,
        friction: Array,
        rounding: tuple[float, Array],
    ) -> States:
        """States that follow from jumps and forces, unless a change may be rounding.

        `friction` is the coefficient mu of every jump, shape (n,), and `rounding` what
        `_rounding` returns.
        """
        held = states == HELD
        force = step.force
        slack, blur = rounding
        # Distance from where the jump would be held, times a stiffness: a force.
        moved = self.system.unit * (step.jump - right_sides.held)
        limit = self._slip_limit(held, force, moved, friction, right_sides.bound)
        limit += slack * held
        # A point slips on until it turns back; others slip where the limit is passed.
        corrected = _beyond(np.where(held, -force, moved), limit)
        goes_on = states * (states * moved >= -blur)
        corrected = np.where(np.abs(states) == 1, goes_on, corrected)
        corrected[self._frictionless] = OPEN
        closed = np.where(held, force >= -slack, moved < -blur)
        normal = np.where(closed, _HELD, _OPEN)
        corrected = np.where(self._rules.normal, normal, corrected)
        corrected[self._carried[corrected[self._carriers] == OPEN]] = OPEN
        return corrected

    def _slip_limit(
        self, held: Flags, force: Array, moved: Array, friction: Array, bound: Array
    ) -> Array:
        """Friction force at which a point starts to slip, scaled; all have shape (n,).

        A contact that closes has no force yet: it rubs by its overlap, in `moved`.
        """
        partner = self._rules.partner
        pressing = np.where(held, force[partner], -moved[partner])
        return np.asarray(bound + np.maximum(friction * pressing, 0.0))


def _cycles(pieces: Sequence[bytes], piece: bytes, *, is_nonlinear: bool) -> bool:
    """Check whether Newton's steps cycle between pieces of the laws.

    On one piece a linear problem comes to rest in one step, and a nonlinear one may
    take several.
    """
    stays = is_nonlinear and pieces[-1:] == [piece]
    visits = pieces.count(piece)
    return visits == STEPS_ON_A_PIECE or (visits > 0 and not stays)


def _slip_of_states(states: States, slip: Array) -> Array:
    """Sizes of slips in the directions of their states, shape (n,), scaled."""
    return np.where(np.abs(states) == 1, np.maximum(states * slip, 0.0), 0.0)


def _beyond(pull: Array, limit: Array) -> States:
    """Signs of pulls beyond their limit, else 0; all of shape (n,)."""
    return (pull > limit).view(np.int8) - (pull < -limit).view(np.int8)
