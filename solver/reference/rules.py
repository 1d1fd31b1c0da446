"""What jumps of the displacement obey at one instant, and their states.

A normal jump is HELD at the gap, or OPEN without force. A tangential one is HELD where
it was, slips with s = -1 or +1 against the friction force -s (r + mu f_n), or is OPEN:
without force, as where the contact is open or there is no friction.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, Flags, Indices, in_rows
from solver.discrete.problem import Problem
from solver.laws import OPEN, Contact, Strength
from solver.laws.friction import is_intact
from solver.laws.play import PLAIN
from solver.reference.assembly import NoReferenceError

States = NDArray[np.int8]
HELD = 0
EXPECTED = 2.5
"""Systems that an instant takes from the states of the one before, until it is known:
the most on charts of the bar, where a guess from a neighbour takes 1 to 7, and one from
an iterate 1.7."""
OF_JUMPS = ("normal", "gap", "partner", "friction", "bound", "cap", "compliance")
"""Fields of rules that have a row for each jump."""


@dataclass(frozen=True, eq=False)
class Rules:
    """What the jumps obey, stacked as `Problem.sum_of_contact` says; (n,) each but for the bound.

    Attributes
    ----------
    normal
        Whether the jump is a normal one.
    gap
        Opening where it vanishes, scaled; 0 of tangential ones.
    partner
        Place of the normal jump whose force carries the friction; the own place without
        one.
    friction
        Coefficient mu, 0 of normal jumps.
    bound
        Friction force r that needs no normal force, scaled, shape (n, n_instants), or
        (n, 1) where it stays the same; 0 of normal jumps.
    cap
        Largest friction force before slip, scaled; infinite where there is none.
    compliance
        Displacement in series with the jump, per force, scaled; 0 where there is none.
        What is said of the jump is then said of the jump and it together.
    strength
        Factor on all bounds over accumulated slip, scaled.
    """

    normal: Flags
    gap: Array
    partner: Indices
    friction: Array
    bound: Array
    cap: Array
    compliance: Array
    strength: Strength = PLAIN

    @property
    def smooth(self) -> Flags:
        """Tangential jumps without friction."""
        return np.asarray(~self.normal & (self.friction == 0.0) & ~self.bounded)

    @cached_property
    def bounded(self) -> Flags:
        """Jumps whose friction ever needs no normal force."""
        return np.asarray(self.bound.any(axis=1))

    @cached_property
    def bonds(self) -> Indices:
        """Places of those among them whose contact may open, which ends that."""
        return np.flatnonzero(self.bounded & self.normal[self.partner])

    def kept(self, moving: Indices) -> Rules:
        """Rules of the unknown jumps; friction needs its normal force among them."""
        place = np.full(len(self.gap), -1)
        place[moving] = np.arange(len(moving))
        partner = place[self.partner[moving]]
        alone = partner < 0
        partner[alone] = np.flatnonzero(alone)
        own = {name: getattr(self, name)[moving] for name in OF_JUMPS}
        return replace(
            self, **own | {"partner": partner, "friction": own["friction"] * ~alone}
        )

    @cached_property
    def ages(self) -> bool:
        """Whether friction changes with slip anywhere."""
        return set(self.strength.factors) != {1.0}

    @cached_property
    def softens(self) -> bool:
        """Whether friction falls with slip anywhere."""
        return bool(self.strength.slopes.min() < 0.0)

    @cached_property
    def is_curved(self) -> bool:
        """Whether friction is not linear in pressing force and slip: it changes, or has a cap."""
        return self.ages or bool(np.isfinite(self.cap).any())

    def bound_at(self, instant: int) -> Array:
        """Friction force at an instant that needs no normal force, (n,)."""
        return np.asarray(self.bound[:, 0 if self.bound.shape[1] == 1 else instant])

    def states_at(self, jumps: Array) -> States:
        """States of a body that is where it would be if it were rigid, (n, n_instants)."""
        closed = (jumps + self.gap[:, None] <= 0.0)[self.partner]
        slip = np.sign(np.diff(jumps, axis=1, prepend=0.0))
        slip[self.normal] = HELD
        return np.where(closed, slip, OPEN).astype(np.int8)

    def before_slip(self, bound: Array, force: Array) -> Array:
        """Friction force r + mu f_n up to its cap, before slip changes it, (n, ...) all."""
        carried = self.friction * force[self.partner].T
        return np.asarray(np.minimum(bound.T + np.maximum(carried, 0.0), self.cap).T)

    def bounds(self, force: Array, slip: Array, opening: Array | None = None) -> Array:
        """Largest friction force, (n, n_instants), by force and slip per instant of all jumps.

        With their opening, where contact that opens breaks bonds.
        """
        bound = self.bound
        if opening is not None and self.bonds.size:
            bound = np.broadcast_to(bound, force.shape).copy()
            under = self.partner[self.bonds]
            bound[self.bonds] *= is_intact(opening[under], force[under])
        most = self.before_slip(bound, force)
        if self.ages:
            return most * self.strength(np.cumsum(np.abs(slip), axis=1))
        return most


def rules_of(problem: Problem) -> Rules:
    """Rules of all interfaces with friction, stacked as `Problem.sum_of_contact` says.

    Raises
    ------
    NoReferenceError
        If slip changes friction otherwise on one interface than on another.
    """
    strengths = set[Strength]()
    parts = list[Rules]()
    first = 0
    for law in problem.rubbing.values():
        parts += _components(law, first)
        first += len(law.components) * len(law.positions)
        if not parts[-1].smooth.all():
            strengths.add(law.tangential.strength or PLAIN)
    if len(strengths) > 1:
        raise NoReferenceError(problem.no_reference)
    stacked = {
        name: in_rows([getattr(part, name) for part in parts]) for name in OF_JUMPS
    }
    return Rules(**stacked, strength=next(iter(strengths), PLAIN))


def _components(law: Contact, first: int) -> list[Rules]:
    """Rules of one interface, component by component, from a place in the stack on."""
    size = len(law.positions)
    along = law.tangential
    none = np.zeros(size)
    no = np.zeros(size, dtype=bool)
    places = first + np.arange(size)
    endless = np.full(size, np.inf)
    soft = law.in_parallel(along.softness)
    bound = law.by_point(along.bound)
    friction = law.mean_by_point(along.friction)
    normal = []
    if law.normal is not None:
        across = law.in_parallel(law.normal.softness)
        gap = law.mean_by_point(law.normal.gap)
        normal = [Rules(~no, gap, places, none, none[:, None], endless, across)]
        # Without friction what is in series along changes nothing, and tells the jump
        # from others.
        soft = soft if bound.any() or friction.any() else across
    if along.cap is None:
        cap = endless
    else:
        cap = law.by_point(along.cap)
    return [*normal, Rules(no, none, places, friction, bound, cap, soft)]


@dataclass(frozen=True, eq=False)
class Sides:
    """Right sides of one instant.

    Attributes
    ----------
    load
        q of the step from the instant before, shape (n_base,).
    bound
        Friction force r that needs no normal force, shape (n,).
    held
        What held jumps come to in the step, shape (n,): minus the opening, or nothing;
        on top of the length before of what is in series.
    """

    load: Array
    bound: Array
    held: Array

    def towards(self, end: Sides, share: float) -> Sides:
        """Right sides at a share of the way to others."""
        if share == 1.0:
            return end
        return Sides(
            self.load + share * (end.load - self.load),
            self.bound + share * (end.bound - self.bound),
            self.held + share * (end.held - self.held),
        )


class Increment(NamedTuple):
    """What an instant adds to the one before, and the forces at its end, scaled.

    Jumps and forces are of all jumps, (n,), with the new length of what is in series,
    as `Sides.held`; then follow y of the base, (n_base,), and the rigid motions,
    (n_motions,).
    """

    jump: Array
    force: Array
    strained: Array
    motion: Array


class InstantSolution(NamedTuple):
    """States of an instant, what it adds, and slips (n,) of the jumps where friction changes."""

    states: States
    step: Increment
    slip: Array

    def guesses(self, known: Iterable[States]) -> list[InstantSolution]:
        """The solution, and the same with other states."""
        return [self, *(self._replace(states=states) for states in known)]


class Starts:
    """Where an instant begins: from a guess, or from the states of the instant before.

    From whichever has taken fewer linear systems an instant so far.
    """

    def __init__(self) -> None:
        # Systems and instants, from the guess and from the instant before.
        self._guess = [0.0, 0]
        self._before = [EXPECTED, 1]

    @property
    def from_guess(self) -> bool:
        """Whether to begin from the guess."""
        (guess, guessed) = self._guess
        (before, times) = self._before
        return guess * times <= before * guessed

    def took(self, systems: int, *, from_guess: bool) -> None:
        """Count what an instant took, and from where."""
        account = self._guess if from_guess else self._before
        account[0] += systems
        account[1] += 1
