"""The incremental reference where contacts open or two sides rub: instant by instant, exact.

The structure is condensed onto the jumps of its contacts once, for all instants together. Then
every instant seeks the states of the jumps by a semismooth Newton method: solve the linear system
of the states (`solver.reference.states`, the bound of friction coupled to the normal force), and
correct the states by what it shows (Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991),
from the states of the instant before. Exact once they repeat. Where they cycle, following the
solution down from large pressure finds them for sure (`solver.reference.unloading`).

In time it is backward Euler on the jumps (Jean and Moreau), from rest at zero, as the laws of
LATIN: friction opposes the increment of the tangential jump.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import ROUNDING, Array
from solver.discrete.problem import Problem
from solver.laws import OPEN
from solver.laws.rules import Rules
from solver.reference.condensation import Condensation, TooLargeError
from solver.reference.contact_states import all_forces, states_at, status_of
from solver.reference.residual import unbalanced_of
from solver.reference.solution import Interrupted, Reference
from solver.reference.starts import Starts
from solver.reference.states import HELD, Response, Sides, States, rules_of
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
        jump, force = np.zeros((2, len(condensed.moving), problem.n_instants))
        ambiguous, reached = np.zeros((2, problem.n_instants), dtype=bool)
        for instant in range(problem.n_instants):
            if stop is not None and stop():
                raise Interrupted
            if most is not None and newton.response.solutions >= most:
                break
            jump[:, instant], force[:, instant] = newton(instant)
            ambiguous[instant] = newton.response.turned
            reached[instant] = True
        done = _Marched(jump, force, reached, ambiguous, newton.response.solutions)
        return self._judged(done, time.perf_counter() - start)

    def _judged(self, done: _Marched, seconds: float) -> Reference:
        """Give all fields, and how far they are from equilibrium and laws."""
        problem, condensed, rules = self._problem, self._condensed, self._rules
        displacement = condensed.displacement(done.jump, done.force)
        jumps = condensed.jump(displacement)
        forces = all_forces(condensed, rules, jumps, done.force)
        jumps = condensed.jump(displacement, forces)
        jumps[condensed.moving] = done.jump
        unbalanced = unbalanced_of(condensed, rules, displacement, forces)
        blurred = condensed.rounding(displacement)
        size = max(condensed.largest_force, float(np.abs(forces).max(initial=0.0)))
        residual = unbalanced / size if size > 0.0 else unbalanced
        converged = done.reached & (unbalanced <= max(CONVERGED * size, blurred))
        return Reference(
            problem=problem,
            displacement=displacement * problem.scales.displacement,
            contact_force=forces * problem.scales.force,
            status=status_of(rules, jumps, forces),
            residual=float(residual.max(initial=0.0)),
            unbalanced=float(unbalanced.max(initial=0.0)) * problem.scales.force,
            rounding=blurred * problem.scales.force,
            converged=converged,
            ambiguous=done.ambiguous & converged,
            steps=done.solutions,
            seconds=seconds,
        )


def jumps_in(problem: Problem) -> int:
    """Give the number of components of contact that `IncrementalContact` condenses."""
    laws = problem.rubbing.values()
    return sum(len(component.above) for law in laws for component in law.components)


class _Marched(NamedTuple):
    """What all instants came to: jump and force, shape (n, n_instants), and how each was found."""

    jump: Array
    force: Array
    reached: NDArray[np.bool_]
    ambiguous: NDArray[np.bool_]
    solutions: int


class _Solved(NamedTuple):
    """States of the jumps at an instant, with jump and force, shape (n,) each."""

    states: States
    jump: Array
    force: Array


class _Newton:
    """Finds jumps and forces of one instant after the other."""

    def __init__(
        self, condensed: Condensation, rules: Rules, rest: Array | None, guesses: States | None
    ) -> None:
        self.response = Response(condensed.stiffness, rules)
        self._condensed, self._rules = condensed, rules
        self._position, self._self_stress = np.zeros((2, len(rules.gap)))
        self._states: States = np.where(rules.smooth, OPEN, HELD).astype(np.int8)
        self._guesses, self._starts = guesses, Starts()
        if guesses is not None:
            guesses[rules.smooth] = OPEN
        self._at_rest: States | None = None
        if rest is not None:
            self._at_rest = states_at(condensed.jump(rest)[condensed.moving], rules)
        self._largest = float(np.abs(condensed.load).max(initial=0.0))

    def __call__(self, instant: int) -> tuple[Array, Array]:
        """Give jump and force, shape (n,) each.

        The forces that move nothing are the multipliers that keep dependent jumps together
        (method of multipliers: Bertsekas, Constrained Optimization, 1982, ch. 2).
        """
        condensed = self._condensed
        stresses, load = condensed.stresses, condensed.load[:, instant]
        if self._is_at_rest(instant):
            return self._position, np.zeros_like(self._position)
        done, from_guess = self.response.solutions, self._starts.from_guess
        for _ in range(PASSES):
            solved = self._solved(load - self._self_stress, instant)
            if solved is None:
                force = condensed.stiffness @ self._position - load + self._self_stress
                return self._position, force
            self._states, jump, force = solved
            alone = jump - condensed.compliance[condensed.moving] * force
            apart = stresses.T @ (alone - condensed.given[condensed.moving, instant])
            pull = condensed.tie * (stresses @ apart)
            if np.abs(pull).max(initial=0.0) <= TOGETHER * self._largest:
                break
            self._self_stress = self._self_stress + pull
        self._starts.took(self.response.solutions - done, from_guess=from_guess)
        self._position = jump
        return jump, force

    def _is_at_rest(self, instant: int) -> bool:
        """Tell whether nothing has acted yet: then nothing moves, though a free body might."""
        gap = self._rules.gap[self._rules.normal]
        return not self._condensed.load[:, : instant + 1].any() and bool(np.all(gap >= 0.0))

    def _sides(self, load: Array) -> Sides:
        rules = self._rules
        return Sides(load, rules.bound, np.where(rules.normal, -rules.gap, self._position))

    def _solved(self, load: Array, instant: int) -> _Solved | None:
        """Find the states under a load, jump and force, or None."""
        sides = self._sides(load)
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
        states = unload(self.response, self._rules, sides, self._position)
        return None if states is None else self._iterate(states, sides)

    def _iterate(self, states: States, sides: Sides) -> _Solved | None:
        """Seek the states from a guess, or give None where they cycle."""
        seen = set()
        for _ in range(NEWTON_LIMIT):
            jump, force = self.response(states, sides)
            corrected = self._corrected(states, jump, force)
            if np.array_equal(corrected, states):
                balanced = self.response.unbalanced <= CONVERGED * self._largest
                return _Solved(states, jump, force) if balanced else None
            seen.add(states.tobytes())
            states = corrected
            if states.tobytes() in seen:
                break
        return None

    def _corrected(self, states: States, jump: Array, force: Array) -> States:
        """Give the states that jump and force call for; what is up to rounding calls for none."""
        rules, unit = self._rules, self.response.unit
        slack = ROUNDING * float((unit * np.abs(jump)).max() + self._largest)
        moved = unit * (jump - np.where(rules.normal, -rules.gap, self._position))
        bound = rules.bounds(force)
        found = np.where(states == HELD, -np.sign(force) * (np.abs(force) > bound + slack), states)
        slips = np.abs(states) == 1
        found = np.where(slips, states * (states * moved >= -slack), found)
        # A contact that closes rubs as its overlap and its slip would have it.
        carried = rules.bound - rules.friction * np.minimum(moved[rules.partner], 0.0)
        found = np.where(states == OPEN, np.sign(moved) * (np.abs(moved) > carried), found)
        found[rules.smooth] = OPEN
        closed = np.where(states == HELD, force >= -slack, moved < -slack)
        found = np.where(rules.normal, np.where(closed, HELD, OPEN), found)
        found[(rules.friction > 0.0) & (found[rules.partner] == OPEN)] = OPEN
        return found.astype(np.int8)
