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
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import cholesky, eigh

from solver.arrays import ROUNDING, Array, Flags, Indices
from solver.laws import OPEN
from solver.reference.condensation import Condensation
from solver.reference.linear_system import LinearSystem
from solver.reference.rules import HELD, Increment, InstantSolution, Sides, States
from solver.reference.soft_system import system_of

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
    """Newton's method from one solution to another.

    Attributes
    ----------
    system
        The linear system of the states.
    accumulated_slip, strained
        Accumulated slip of all jumps, shape (n,), and y of the base, shape (n_base,),
        at the instant before, scaled; the march through time updates both.
    largest_load
        Largest force of the load on a jump, scaled.
    """

    def __init__(
        self, condensed: Condensation, stop: Callable[[], bool] | None = None
    ) -> None:
        self.system = system_of(condensed, stop)
        self._condensed = condensed
        self._rules = condensed.rules
        rules = self._rules
        self.accumulated_slip = np.zeros_like(rules.gap)
        self.strained = np.zeros(len(condensed.base))
        self._frictionless: Indices = np.flatnonzero(rules.is_frictionless)
        # Jumps whose friction ends where their contact opens, and its normal jumps.
        self._carried: Indices = np.union1d(
            np.flatnonzero(rules.friction > 0.0), rules.bonds
        )
        self._carriers: Indices = rules.partner[self._carried]
        self.largest_load = float(np.abs(condensed.load).max(initial=0.0))
        # Slips that say how far friction has fallen, where it falls no further.
        self._fallen: Array | None = None

    def with_friction_left(self, slip: Array) -> Newton:
        """The same method, with friction that falls up to given slips and no further.

        Where friction rises with slip it goes on to rise.

        Parameters
        ----------
        slip
            Slips of the instant up to which friction falls, shape (n,), scaled;
            non-negative.
        """
        changed = copy(self)
        changed._fallen = slip
        return changed

    @property
    def _softens(self) -> bool:
        """Friction falls with slip somewhere."""
        return self._fallen is None and self._rules.softens

    def _factor(self, slip: Array) -> Array:
        """Factor on the friction bound at slips >= 0 of the instant, both (n,)."""
        slip_factor = self._rules.slip_factor
        if self._fallen is None:
            return slip_factor(self.accumulated_slip + slip)
        # The fall is that up to the given slip, the rise that up to the slip itself.
        fallen = self.accumulated_slip + self._fallen
        return (
            slip_factor(fallen)
            - slip_factor.rise(fallen)
            + slip_factor.rise(self.accumulated_slip + slip)
        )

    def _slope(self, slip: Array) -> Array:
        """Growth of the factor per further slip at slips >= 0, both (n,)."""
        slope = self._rules.slip_factor.slope(self.accumulated_slip + slip)
        if self._fallen is None:
            return slope
        return np.maximum(slope, 0.0)

    def follow(
        self, at: InstantSolution, sides: Sides, guesses: Iterable[InstantSolution]
    ) -> InstantSolution | None:
        """Follow a solution to other right sides.

        None where no guess leads to a solution, or only to one of another branch.
        """
        for guess in guesses:
            reached = self.seek(self.system, guess, sides)
            if reached is None:
                continue
            if not self._softens or self._goes_on(at, reached, sides):
                return reached
        return None

    def approach(self, at: InstantSolution, sides: Sides) -> Iterator[InstantSolution]:
        """Yield solutions with softer and softer springs, whose states repeat.

        The first is sought from a solution. Nothing is yielded where there are too many
        jumps, and none twice on one piece of the laws, from where Newton's steps go the
        same way: bodies that fall stay on one, whatever the springs.
        """
        condensed = self._condensed
        share = FIRST_SPRING
        if len(condensed.stiffness) > MOST_JUMPS:
            return
        # Springs are relaxed at the deformation that the step before has come to.
        relaxed = np.zeros_like(sides.load)
        tried = b""
        for _ in range(SPRING_STEPS):
            springs = share * np.diagonal(condensed.stiffness)
            # A spring at its relaxed length pulls with nothing, so at rest it changes
            # no solution.
            pulled = replace(sides, load=sides.load + springs * relaxed)
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
        """Key of a piece of the laws, on which they are smooth, at states and slips.

        Both have the shape (n,).
        """
        piece = states.tobytes()
        if self._rules.is_nonlinear:
            slips = self.accumulated_slip + np.abs(slip)
            piece += self._rules.slip_factor.segment(slips).tobytes()
        return piece

    def _with_springs(self, springs: Array) -> LinearSystem:
        """The linear system with springs at the jumps of the base, (n_base,)."""
        condensed = self._condensed
        stiffness = condensed.stiffness + np.diagflat(springs)
        no_motions = condensed.gauge[:, :0]
        return LinearSystem(condensed, stiffness, no_motions, self.system.stop)

    def near(self, at: InstantSolution, sides: Sides) -> InstantSolution | None:
        """Seek a solution, stable or not, from fields that need not be one."""
        return self.seek(self.system, at, sides)

    def is_stable(self, at: InstantSolution, sides: Sides) -> bool:
        """Check that no further slip of a solution costs less than it gains."""
        return self._goes_on(at, at, sides)

    def leave(self, at: InstantSolution, sides: Sides) -> InstantSolution:
        """Disturb a solution that is not stable, in the direction that it gives way.

        All points that slip go on along the motion that costs least, until half of the
        slip after which the first of them would stop.
        """
        growth, free = self._growth(at, at, sides)
        direction = self._weakest_direction(at, growth, free)
        slip = np.abs(at.slip)
        # An eigenvector has no sign: it is taken such that some points slip on.
        turns = direction < 0.0
        if turns.all() or not (direction > 0.0).any():
            direction = -direction
            turns = direction < 0.0
        length = float((slip[turns] / -direction[turns]).min(initial=np.inf))
        if not np.isfinite(length):
            length = float(slip.max() / direction.max())
        further = np.maximum(slip + 0.5 * length * direction, 0.0)
        return at._replace(slip=further * at.states)

    def _weakest_direction(
        self, at: InstantSolution, growth: Array | None, free: Indices
    ) -> Array:
        """Slip per jump, along its friction, in the motion that costs least, (n,).

        Growth and places are those of `_growth`.
        """
        condensed = self._condensed
        motion = np.zeros(len(condensed.base))
        if growth is None:
            motion[free] = self._rules.compliance[condensed.base[free]] > 0.0
        else:
            # The lowest eigenvalue is the softest motion: the way down from a ridge.
            softened = self._softened(growth, free)
            _, vectors = eigh(softened, subset_by_index=[0, 0], check_finite=False)
            motion[free] = vectors[:, 0]
        direction = condensed.ties @ motion * at.states
        direction[np.abs(at.states) != 1] = 0.0
        return np.asarray(direction)

    def seek(
        self, system: LinearSystem, guess: InstantSolution, sides: Sides
    ) -> InstantSolution | None:
        """Seek states and slips from those of a guess; None where the states cycle.

        A front of slip, like that along a belt, may move by a jump a step. States that
        leave bodies free mostly wander: springs hold these at less cost.
        """
        rules = self._rules
        states, step, slip = guess
        force = step.force
        pieces: list[bytes] = []
        n_singular = 0
        for _ in range(max(FEWEST_STEPS, len(states))):
            tangent = sides
            if rules.is_nonlinear:
                slip = _slip_of_states(states, slip)
            piece = self._piece(states, slip)
            if rules.is_nonlinear:
                tangent, is_capped = self._linearised(system, slip, force, sides)
                piece += is_capped.tobytes()
            if _cycles(pieces, piece, is_nonlinear=rules.is_nonlinear):
                return None
            pieces.append(piece)
            step = system(states, tangent)
            # Systems with springs cost as much as others, and are counted with them.
            if system is not self.system:
                self.system.solutions += 1
            n_singular += system.is_singular
            if n_singular > SINGULAR_STEPS:
                return None
            rounding = self._rounding(states, step)
            corrected = self._corrected(
                states, step, tangent, system.friction, rounding
            )
            if rules.is_nonlinear:
                slip = np.where(rules.normal, 0.0, step.jump - sides.held)
            force = step.force
            reached = InstantSolution(states, step, slip)
            if np.array_equal(corrected, states):
                if self._obeys(system, reached, sides, rounding[0]):
                    return reached
            states = corrected
        return None

    def _linearised(
        self, system: LinearSystem, slip: Array, force: Array, sides: Sides
    ) -> tuple[Sides, Flags]:
        """Replace the friction bound by its tangent at slips and forces, (n,) each.

        Returns
        -------
        Right sides with the constant part of the tangent, whose other parts `system`
        gets; and at which jumps the bound is capped, shape (n,).
        """
        rules = self._rules
        bound = rules.before_slip(sides.bound, force)
        is_capped = bound >= rules.cap
        factor = self._factor(slip)
        growth = self._slope(slip) * bound
        system.set_friction(np.where(is_capped, 0.0, rules.friction * factor), growth)
        # What of the tangent depends neither on the normal force nor on the slip.
        constant = np.where(is_capped, rules.cap, sides.bound) * factor - growth * slip
        return replace(sides, bound=constant), is_capped

    def _obeys(
        self, system: LinearSystem, at: InstantSolution, sides: Sides, slack: float
    ) -> bool:
        """Check that forces balance and friction obeys its law, not only the tangent.

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
        bound = rules.before_slip(sides.bound, force)
        bound = self._factor(np.abs(at.slip)) * bound
        sticks = (at.states == HELD) & ~rules.normal
        slips = np.abs(at.states) == 1
        excess = np.where(sticks, np.abs(force) - bound - slack, 0.0)
        violation = np.where(slips, np.abs(force + at.states * bound), excess)
        largest = max(self.largest_load, np.abs(force).max())
        return bool(violation.max(initial=0.0) <= FRICTION_TOLERANCE * largest)

    def _goes_on(
        self, at: InstantSolution, reached: InstantSolution, sides: Sides
    ) -> bool:
        """Check that a solution continues the branch of another.

        The solution does if the structure is stable however far the contacts that slip
        in either have softened in between, whatever else slips: then no other solution
        slips there alone.
        """
        growth, free = self._growth(at, reached, sides)
        if growth is None:
            return False
        if not len(free):
            return True
        try:
            # Cholesky's factors exist exactly where the matrix is positive definite.
            cholesky(self._softened(growth, free), overwrite_a=True, check_finite=False)
        except LinAlgError:
            return False
        return True

    def _growth(
        self, at: InstantSolution, reached: InstantSolution, sides: Sides
    ) -> tuple[Array | None, Indices]:
        """Stiffness of contacts, as far as they soften between two solutions, scaled.

        Returns
        -------
        The stiffness, shape (n,), and the places in the base of the jumps that may
        move, shape (n_free,); no places where nothing softens. The stiffness is None
        where a spring in series snaps by itself: the places are then those of such
        springs.
        """
        rules = self._rules
        base = self._condensed.base
        slips = (np.abs(at.states) == 1) | (np.abs(reached.states) == 1)
        slopes = self._lowest_slopes(at, reached, sides)
        growth = np.where(slips, slopes, 0.0)
        # Stiffness without softening is positive, so the solution is the only one
        # nearby.
        if not np.any(growth < 0.0):
            return growth, np.zeros(0, dtype=np.intp)
        # A contact and a spring in series with it share the motion.
        sprung = rules.compliance > 0.0
        stiffness = 1.0 + growth * rules.compliance
        if np.any(stiffness <= 0.0):
            return None, np.flatnonzero(stiffness[base] <= 0.0)
        growth /= stiffness
        stays_held = sprung & (at.states == HELD) & (reached.states == HELD)
        growth[stays_held] += 1.0 / rules.compliance[stays_held]
        stays_open = (at.states == OPEN) & (reached.states == OPEN)
        is_free = slips | stays_open | sprung
        return growth, np.flatnonzero(is_free[base])

    def _lowest_slopes(
        self, at: InstantSolution, reached: InstantSolution, sides: Sides
    ) -> Array:
        """Lowest growth of the friction force per slip between two solutions, (n,)."""
        rules = self._rules
        begin = np.abs(at.slip)
        end = np.abs(reached.slip)
        slope = rules.slip_factor.lowest_slope(
            self.accumulated_slip + np.minimum(begin, end),
            self.accumulated_slip + np.maximum(begin, end),
        )
        before = rules.before_slip(sides.bound, at.step.force)
        after = rules.before_slip(sides.bound, reached.step.force)
        return np.asarray(slope * np.maximum(before, after))

    def _softened(self, growth: Array, free: Indices) -> Array:
        """Stiffness of structure and contacts at places of the base, (n_free, n_free).

        `growth` is the stiffness of the contacts, shape (n,), scaled, and `free` are
        the places, shape (n_free,).
        """
        tied = self._condensed.ties[:, free]
        softened = self._condensed.stiffness[np.ix_(free, free)]
        softened += tied.T @ sparse.diags_array(growth) @ tied
        return np.asarray(softened)

    def _rounding(self, states: States, step: Increment) -> tuple[float, Array]:
        """Forces that rounding may make, scaled.

        A held jump is the deformation less the rigid motion, whose rounding makes
        forces at every jump. A deformation that is undone leaves the rounding of both
        ways.

        Returns
        -------
        The force at any jump; and at a jump that is not held, shape (n,) or (1,).
        """
        inside = self.system.inside(np.abs(self.strained) + np.abs(step.strained))
        slack = ROUNDING * (inside + self.largest_load)
        blur = self.system.blur(step.motion)
        is_stiff = (states == HELD) & (self._rules.compliance == 0.0)
        return slack + float((blur * is_stiff).max(initial=0.0)), slack + blur

    def _corrected(
        self,
        states: States,
        step: Increment,
        sides: Sides,
        friction: Array,
        rounding: tuple[float, Array],
    ) -> States:
        """States that follow from jumps and forces; rounding changes none of them.

        `friction` is the coefficient mu of every jump, shape (n,), and `rounding` what
        `_rounding` returns.
        """
        held = states == HELD
        force = step.force
        slack, blur = rounding
        # Distance from where the jump would be held, times a stiffness: a force.
        moved = self.system.unit * (step.jump - sides.held)
        limit = self._slip_limit(held, force, moved, friction, sides.bound)
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
    """Check whether steps that were on some pieces of the laws cycle on the next.

    On one piece a linear problem comes to rest in one step, and a nonlinear one may
    take several.
    """
    stays = is_nonlinear and pieces[-1:] == [piece]
    visits = pieces.count(piece)
    return visits == STEPS_ON_A_PIECE or (visits > 0 and not stays)


def _slip_of_states(states: States, slip: Array) -> Array:
    """Slips in the directions of their states, without signs, shape (n,), scaled."""
    return np.where(np.abs(states) == 1, np.maximum(states * slip, 0.0), 0.0)


def _beyond(pull: Array, limit: Array) -> States:
    """Signs of pulls where they are beyond their limit, else 0; all of shape (n,)."""
    return (pull > limit).view(np.int8) - (pull < -limit).view(np.int8)
