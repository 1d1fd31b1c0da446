"""The incremental reference where contacts open or two sides rub: instant by instant, exact.

The structure is condensed onto the jumps of its contacts once, for all instants together. Then
every instant seeks the states of the jumps by a semismooth Newton method: solve the linear system
of the states (`solver.reference.response`, the bound of friction coupled to the normal force), and
correct the states by what it shows (Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991),
from the states of the instant before. Exact once they repeat. Where they cycle, following the
solution down from large pressure finds them for sure (`solver.reference.unloading`).

In time it is backward Euler on the jumps (Jean and Moreau), from rest at zero, as the laws of
LATIN: friction opposes the increment of the tangential jump.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import ROUNDING, Array
from solver.discrete.problem import Problem
from solver.laws import OPEN
from solver.laws.rules import Rules
from solver.reference.condensation import Condensation, TooLargeError
from solver.reference.contact_states import all_forces, states_at, status_of
from solver.reference.residual import Shown, unbalanced_of
from solver.reference.response import Response
from solver.reference.solution import Interrupted, Reference
from solver.reference.starts import Starts
from solver.reference.states import HELD, Sides, States, Step, rules_of
from solver.reference.unloading import unload

NEWTON_LIMIT = 30
"""Newton steps from one guess of the states; more than a dozen means that they cycle."""
MOST_JUMPS = 5000
"""Jumps up to which there is a reference: its time grows with their cube (8 s for 1900, measured),
and it keeps a few dense matrices of their size."""
CONVERGED = 1e-9
"""Relative KKT residual up to which an instant counts as solved, where rounding allows it."""
PASSES = 30
"""Times at most that an instant is solved to keep dependent jumps together."""
TOGETHER = 1e-10
"""Force that still ties dependent jumps, as a share of the largest load."""


class IncrementalContact:
    """The incremental solver of any interfaces with friction, ready to march through time.

    Friction may have several solutions for a large mu, or none where contact alone holds a body.
    Where several exist one of them is found, and `ambiguous` if that shows; where none is found,
    `converged` is False, and the contacts stay where they were, by forces that break the laws.

    Where the normal jump is prescribed, contact shares its force with the support in any way: it
    is taken as zero, and so is the friction there. Where the tangential jump is, friction opposes
    its motion; at rest it is taken as zero.

    Parameters
    ----------
    problem
        A structure with any number of interfaces with friction.

    Raises
    ------
    TooLargeError
        If there are more than `MOST_JUMPS` jumps.
    NotHeldError
        If the structure can move with all contacts closed and stuck.
    """

    def __init__(self, problem: Problem) -> None:
        n_jumps = jumps_in(problem)
        if n_jumps > MOST_JUMPS:
            raise TooLargeError(
                f"a reference would condense {n_jumps} components of contact (at most "
                f"{MOST_JUMPS}); take fewer elements, layers or wires to have one"
            )
        self._problem = problem
        self._condensed, self._rules = Condensation(problem), rules_of(problem)

    def march(
        self,
        guess: States | None = None,
        most: int | None = None,
        stop: Callable[[], bool] | None = None,
    ) -> Reference:
        """Solve instant by instant.

        Parameters
        ----------
        guess
            States from which an instant starts, stacked as `Problem.sum_of_contact` says, shape
            (n_forces, n_instants), unless those of the instant before turn out to be better.
        most
            Linear systems to solve; the instants that are not reached then do not move, and are
            not `converged`.
        stop
            Called once per instant.

        Raises
        ------
        Interrupted
            As soon as `stop` gives True.
        """
        start = time.perf_counter()
        problem, condensed, rules = self._problem, self._condensed, self._rules
        own = rules.kept(condensed.moving)
        guesses = None if guess is None else guess[condensed.moving]
        newton = _Newton(condensed, own, problem.rest, guesses)
        size, n_instants = len(condensed.moving), problem.n_instants
        done = _Marched(
            np.zeros((size, n_instants)),
            np.zeros((size, n_instants)),
            np.zeros((len(condensed.base), n_instants)),
            np.zeros((condensed.gauge.shape[1], n_instants)),
        )
        ambiguous, reached = np.zeros((2, n_instants), dtype=bool)
        for instant in range(n_instants):
            if stop is not None and stop():
                raise Interrupted
            if most is not None and newton.response.solutions >= most:
                break
            for field, values in zip(done, newton(instant), strict=True):
                field[:, instant] = values
            ambiguous[instant] = newton.response.turned
            reached[instant] = True
        found = self._judged(done, reached)
        return replace(
            found,
            ambiguous=ambiguous & found.converged,
            steps=newton.response.solutions,
            seconds=time.perf_counter() - start,
        )

    def _judged(self, done: _Marched, reached: NDArray[np.bool_]) -> Reference:
        """Give all fields, and how far they are from equilibrium and laws."""
        problem, condensed, rules = self._problem, self._condensed, self._rules
        motion = np.cumsum(done.motion, axis=1)
        deformation = condensed.deformation(np.cumsum(done.strained, axis=1), done.force)
        rigid = condensed.motions @ motion
        moved = condensed.jump(deformation)
        forces = all_forces(condensed, rules, moved, done.force)
        moved += rules.compliance[:, None] * forces
        slip = np.diff(moved, axis=1, prepend=0.0)
        slip += condensed.jump(condensed.motions @ done.motion)
        opening = moved + condensed.jump(rigid) + rules.gap[:, None]
        unbalanced = unbalanced_of(condensed, rules, Shown(deformation, forces, opening, slip))
        slip[condensed.moving] = done.slip
        blurred = condensed.rounding(deformation, rigid)
        size = max(condensed.largest_force, float(np.abs(forces).max(initial=0.0)))
        residual = unbalanced / size if size > 0.0 else unbalanced
        scales = problem.scales
        return Reference(
            problem=problem,
            displacement=(deformation + rigid) * scales.displacement,
            deformation=deformation * scales.displacement,
            contact_force=forces * scales.force,
            status=status_of(rules, slip, forces),
            residual=float(residual.max(initial=0.0)),
            unbalanced=float(unbalanced.max(initial=0.0)) * scales.force,
            rounding=blurred * scales.force,
            converged=reached & (unbalanced <= max(CONVERGED * size, blurred)),
            ambiguous=np.zeros_like(reached),
            steps=0,
            seconds=0.0,
        )


def jumps_in(problem: Problem) -> int:
    """Give the number of components of contact that `IncrementalContact` condenses."""
    laws = problem.rubbing.values()
    return sum(len(component.above) for law in laws for component in law.components)


class _Marched(NamedTuple):
    """What every instant adds: slip, force in all, y of the base, motion; (n, n_instants) each."""

    slip: Array
    force: Array
    strained: Array
    motion: Array


class _Newton:
    """Finds jumps and forces of one instant after the other."""

    def __init__(
        self, condensed: Condensation, rules: Rules, rest: Array | None, guesses: States | None
    ) -> None:
        self.response = Response(condensed, rules)
        self._condensed, self._rules = condensed, rules
        self._opening, self._force = rules.gap.copy(), np.zeros_like(rules.gap)
        self._strained, self._motion = (
            np.zeros(len(condensed.base)),
            np.zeros(condensed.gauge.shape[1]),
        )
        self._load, self._shift = np.zeros(len(condensed.base)), np.zeros_like(rules.gap)
        self._states: States = np.where(rules.smooth, OPEN, HELD).astype(np.int8)
        self._guesses, self._starts = guesses, Starts()
        if guesses is not None:
            guesses[rules.smooth] = OPEN
        self._at_rest: States | None = None
        if rest is not None:
            self._at_rest = states_at(condensed.jump(rest)[condensed.moving], rules)
        self._largest = float(np.abs(condensed.load).max(initial=0.0))

    def __call__(self, instant: int) -> _Marched:
        """Give what an instant adds.

        The forces that move nothing are the multipliers that keep dependent jumps together
        (method of multipliers: Bertsekas, Constrained Optimization, 1982, ch. 2).
        """
        condensed, rules = self._condensed, self._rules
        if self._is_at_rest(instant):
            still = self._force, self._force, self._strained, self._motion
            return _Marched(*map(np.zeros_like, still))
        load = condensed.load[:, instant] - self._load - self.response.on_base(self._force)
        before = rules.compliance * self._force - condensed.shift[:, instant] + self._shift
        held = before - np.where(rules.normal, self._opening, 0.0)
        sides = Sides(load[:, None], rules.bound[:, None], held[:, None])
        step = self._together(sides, instant)
        self._load, self._shift = condensed.load[:, instant], condensed.shift[:, instant]
        slip, self._force = step.jump[:, 0] - before, step.force[:, 0]
        self._opening += slip
        self._strained += step.strained[:, 0]
        self._motion += step.motion[:, 0]
        return _Marched(slip, self._force, step.strained[:, 0], step.motion[:, 0])

    def _together(self, sides: Sides, instant: int) -> Step:
        """Solve an instant until jumps that depend on each other are together."""
        condensed, stresses = self._condensed, self._condensed.stresses
        done, from_guess = self.response.solutions, self._starts.from_guess
        for _ in range(PASSES):
            solved = self._solved(sides, instant)
            if solved is None:
                return self.response(np.full_like(self._states, HELD), self._stays(sides))
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
        self._starts.took(self.response.solutions - done, from_guess=from_guess)
        return step

    def _stays(self, sides: Sides) -> Sides:
        normal = self._rules.normal[:, None]
        return replace(sides, held=sides.held + np.where(normal, self._opening[:, None], 0.0))

    def _is_at_rest(self, instant: int) -> bool:
        """Tell whether nothing has acted yet: then nothing moves, though a free body might."""
        gap = self._rules.gap[self._rules.normal]
        return not self._condensed.load[:, : instant + 1].any() and bool(np.all(gap >= 0.0))

    def _solved(self, sides: Sides, instant: int) -> tuple[States, Step] | None:
        """Find the states of the jumps and the step, or None."""
        guesses = [self._states]
        if self._guesses is not None:
            guesses.insert(0 if self._starts.from_guess else 1, self._guesses[:, instant])
        if self._at_rest is not None:
            # A body that falls, rolls or slides a long way touches elsewhere than one instant
            # before, or slips as a whole.
            guesses.append(self._at_rest[:, instant])
        for guess in guesses:
            found = self._iterate(guess, sides)
            if found is not None:
                return found
        states = unload(self.response, self._rules, sides)
        return None if states is None else self._iterate(states, sides)

    def _iterate(self, states: States, sides: Sides) -> tuple[States, Step] | None:
        """Seek the states from a guess, or give None where they cycle."""
        seen = set()
        for _ in range(NEWTON_LIMIT):
            step = self.response(states, sides)
            corrected = self._corrected(states, step, sides)
            if np.array_equal(corrected, states):
                balanced = self.response.unbalanced <= CONVERGED * self._largest
                return (states, step) if balanced else None
            seen.add(states.tobytes())
            states = corrected
            if states.tobytes() in seen:
                break
        return None

    def _corrected(self, states: States, step: Step, sides: Sides) -> States:
        """Give the states that jump and force call for; what is up to rounding calls for none."""
        rules, response, force = self._rules, self.response, step.force[:, 0]
        inside = response.inside(self._strained + step.strained[:, 0])
        slack = ROUNDING * (inside + self._largest)
        moved = (response.unit * (step.jump - sides.held))[:, 0]
        blur = slack + response.blur(step.motion)
        bound = rules.bounds(force)
        found = np.where(states == HELD, -np.sign(force) * (np.abs(force) > bound + slack), states)
        slips = np.abs(states) == 1
        found = np.where(slips, states * (states * moved >= -blur), found)
        # A contact that closes rubs as its overlap and its slip would have it.
        carried = rules.bound - rules.friction * np.minimum(moved[rules.partner], 0.0)
        found = np.where(states == OPEN, np.sign(moved) * (np.abs(moved) > carried), found)
        found[rules.smooth] = OPEN
        closed = np.where(states == HELD, force >= -slack, moved < -blur)
        found = np.where(rules.normal, np.where(closed, HELD, OPEN), found)
        found[(rules.friction > 0.0) & (found[rules.partner] == OPEN)] = OPEN
        return found.astype(np.int8)
