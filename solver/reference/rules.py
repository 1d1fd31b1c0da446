"""Contact rules of the jumps at one instant, and the states of the jumps.

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
from solver.laws import OPEN, Contact, SlipFactor
from solver.laws.friction import is_intact
from solver.laws.play import PLAIN
from solver.reference.assembly import NoReferenceError

States = NDArray[np.int8]
HELD = 0
EXPECTED_SYSTEMS = 2.5
"""Systems that an instant is expected to take from the states of the instant before,
until it is known: the largest number on charts of the bar, where a guess from a
neighbour takes 1 to 7, and a guess from an iterate 1.7."""
OF_JUMPS = (
    "normal",
    "gap",
    "partner",
    "friction",
    "bound",
    "cap",
    "compliance",
)
"""Fields of rules that have a row for each jump."""


@dataclass(frozen=True, eq=False)
class Rules:
    """Contact rules of all jumps, in the order of `Problem.sum_of_contact`.

    Attributes
    ----------
    normal
        Which jumps are normal ones, shape (n,).
    gap
        Opening where the jump vanishes, shape (n,), scaled; 0 of tangential jumps.
    partner
        Place of the normal jump whose force carries the friction, shape (n,); the place
        of the jump itself where there is none.
    friction
        Coefficient mu, shape (n,); 0 of normal jumps.
    bound
        Friction force r that needs no normal force, scaled, shape (n, n_instants), or
        (n, 1) where it stays the same; 0 of normal jumps.
    cap
        Largest friction force before slip, shape (n,), scaled; infinite where there is
        none.
    compliance
        Displacement in series with the jump, per force, shape (n,), scaled; 0 where
        there is none. The other rules then hold for the sum of the jump and of this
        displacement.
    slip_factor
        Factor on all bounds over accumulated slip, scaled.
    """

    normal: Flags
    gap: Array
    partner: Indices
    friction: Array
    bound: Array
    cap: Array
    compliance: Array
    slip_factor: SlipFactor = PLAIN

    @property
    def is_frictionless(self) -> Flags:
        """Mask of tangential jumps without friction, shape (n,)."""
        return np.asarray(~self.normal & (self.friction == 0.0) & ~self.bounded)

    @cached_property
    def bounded(self) -> Flags:
        """Mask of jumps with friction without a normal force at some instant, (n,)."""
        return np.asarray(self.bound.any(axis=1))

    @cached_property
    def bonds(self) -> Indices:
        """Indices of jumps whose bound ends when their contact opens, (n_bonds,)."""
        return np.flatnonzero(self.bounded & self.normal[self.partner])

    def kept(self, moving: Indices) -> Rules:
        """Rules of the unknown jumps, by their indices, shape (n_moving,).

        Friction whose normal force is not among theirs has no coefficient.
        """
        # Numbers among the unknown jumps, by numbers among all.
        places = np.full(len(self.gap), -1)
        places[moving] = np.arange(len(moving))
        partner = places[self.partner[moving]]
        alone = partner < 0
        partner[alone] = np.flatnonzero(alone)
        fields = {name: getattr(self, name)[moving] for name in OF_JUMPS}
        fields["partner"] = partner
        fields["friction"] = fields["friction"] * ~alone
        return replace(self, **fields)

    @cached_property
    def changes_with_slip(self) -> bool:
        """Check whether friction changes with slip anywhere."""
        return set(self.slip_factor.factors) != {1.0}

    @cached_property
    def softens(self) -> bool:
        """Check whether friction falls with slip anywhere."""
        return bool(self.slip_factor.slopes.min() < 0.0)

    @cached_property
    def is_nonlinear(self) -> bool:
        """Check whether friction is nonlinear in pressing force or slip."""
        return self.changes_with_slip or bool(np.isfinite(self.cap).any())

    def bound_at(self, instant: int) -> Array:
        """Friction force without normal force at an instant, (n,), scaled."""
        if self.bound.shape[1] == 1:
            return np.asarray(self.bound[:, 0])
        return np.asarray(self.bound[:, instant])

    def states_at(self, jumps: Array) -> States:
        """States of contacts for jumps of rigid bodies.

        Jumps and states have the shape (n, n_instants); jumps are scaled.
        """
        closed = (jumps + self.gap[:, None] <= 0.0)[self.partner]
        slip = np.sign(np.diff(jumps, axis=1, prepend=0.0))
        slip[self.normal] = HELD
        return np.where(closed, slip, OPEN).astype(np.int8)

    def before_slip(self, bound: Array, force: Array) -> Array:
        """Friction bound min(r + mu f_n, cap), before slip changes it, (n,), scaled.

        The bound r, the forces of all jumps and the result have the shape (n,) or
        (n, n_instants), scaled.
        """
        carried = self.friction * force[self.partner].T
        return np.asarray(np.minimum(bound.T + np.maximum(carried, 0.0), self.cap).T)

    def bounds(self, force: Array, slip: Array, opening: Array | None = None) -> Array:
        """Friction bound at all instants, shape (n, n_instants), scaled.

        Parameters
        ----------
        force, slip
            Force of every jump, and its slip in every instant, shape (n, n_instants),
            scaled.
        opening
            Opening of every jump, same shape, where contact that opens breaks bonds.
        """
        bound = self.bound
        # Most structures have no bonds: then the bound is not copied.
        if opening is not None and self.bonds.size:
            bound = np.broadcast_to(bound, force.shape).copy()
            under = self.partner[self.bonds]
            bound[self.bonds] *= is_intact(opening[under], force[under])
        bound = self.before_slip(bound, force)
        if self.changes_with_slip:
            return bound * self.slip_factor(np.cumsum(np.abs(slip), axis=1))
        return bound


def rules_of(problem: Problem) -> Rules:
    """Rules of all interfaces with friction, in the order of `Problem.sum_of_contact`.

    Raises
    ------
    NoReferenceError
        If slip changes friction otherwise on one interface than on another.
    """
    slip_factors = set[SlipFactor]()
    parts = list[Rules]()
    places = list[Indices]()
    for law, _, _, forces in problem.contacts.stacks:
        parts += _components(law, forces[0])
        places += forces
        if not parts[-1].is_frictionless.all():
            # Without friction it does not matter how slip would change it.
            slip_factors.add(law.tangential.slip_factor or PLAIN)
    if len(slip_factors) > 1:
        raise NoReferenceError(problem.no_reference)
    order = np.argsort(np.concatenate(places))
    stacked = {}
    for name in OF_JUMPS:
        rows = in_rows([getattr(part, name) for part in parts])
        stacked[name] = rows[order]
    return Rules(**stacked, slip_factor=next(iter(slip_factors), PLAIN))


def _components(law: Contact, places: Indices) -> list[Rules]:
    """Rules of the components of a law, by the indices of partners, (n_points,).

    The normal component, which is the first, is the partner of both.
    """
    size = len(law.positions)
    along = law.tangential
    zeros = np.zeros(size)
    endless = np.full(size, np.inf)
    is_normal = np.ones(size, dtype=bool)
    bound = law.by_point(along.bound)
    friction = law.mean_by_point(along.friction)
    compliance = law.in_parallel(along.compliance)
    cap = endless
    if along.cap is not None:
        cap = law.by_point(along.cap)
    rules = []
    if law.normal is not None:
        normal = Rules(
            normal=is_normal,
            gap=law.mean_by_point(law.normal.gap),
            partner=places,
            friction=zeros,
            bound=zeros[:, None],
            cap=endless,
            compliance=law.in_parallel(law.normal.compliance),
        )
        rules.append(normal)
        # Without friction the spring in series along changes nothing, and tells the
        # jump from others.
        rubs = (bound > 0.0).any(axis=1) | (friction > 0.0)
        compliance = np.where(
            law.spread_to_interfaces(rubs), compliance, normal.compliance
        )
    tangential = Rules(
        normal=~is_normal,
        gap=zeros,
        partner=places,
        friction=friction,
        bound=bound,
        cap=cap,
        compliance=compliance,
    )
    rules.append(tangential)
    return rules


@dataclass(frozen=True, eq=False)
class RightSides:
    """Right-hand sides of one instant, scaled.

    Attributes
    ----------
    load
        q of the step from the instant before, shape (n_base,).
    bound
        Friction force r that needs no normal force, shape (n,).
    held
        Increment of a jump that is held, shape (n,): minus the opening of a normal
        jump, 0 of a tangential one; with the spring in series, its length before is
        added.
    """

    load: Array
    bound: Array
    held: Array

    def towards(self, end: RightSides, share: float) -> RightSides:
        """Interpolate to other right-hand sides: these at a share of 0, others at 1."""
        if share == 1.0:
            return end
        return RightSides(
            self.load + share * (end.load - self.load),
            self.bound + share * (end.bound - self.bound),
            self.held + share * (end.held - self.held),
        )


class Increment(NamedTuple):
    """Increments of an instant over the instant before, and the forces at its end.

    Attributes
    ----------
    jump
        Increments of all jumps, with the new length of the spring in series, as
        `RightSides.held`, shape (n,), scaled.
    force
        Forces of all jumps at the end, shape (n,), scaled.
    strained
        Increment of y of the base, shape (n_base,), scaled.
    motion
        Increments of the rigid motions, shape (n_motions,), scaled.
    """

    jump: Array
    force: Array
    strained: Array
    motion: Array


class InstantSolution(NamedTuple):
    """Solution of an instant: states, increments and slips.

    Attributes
    ----------
    states
        States of all jumps, shape (n,).
    step
        Increments over the instant before.
    slip
        Slips of the instant, shape (n,), scaled; read where friction is not linear.
    """

    states: States
    step: Increment
    slip: Array

    def guesses(self, known: Iterable[States]) -> list[InstantSolution]:
        """The solution, and copies with other states, (n,) each, as guesses."""
        copies = [self._replace(states=states) for states in known]
        return [self, *copies]


class Starts:
    """Choice of the initial states of an instant: a guess, or the instant before.

    The choice is the start that has taken fewer linear systems an instant so far.
    """

    def __init__(self) -> None:
        self._systems_from_guess = 0.0
        self._instants_from_guess = 0
        self._systems_from_before = EXPECTED_SYSTEMS
        self._instants_from_before = 1

    @property
    def from_guess(self) -> bool:
        """Start from the guess rather than from the instant before."""
        guess = self._systems_from_guess * self._instants_from_before
        before = self._systems_from_before * self._instants_from_guess
        return guess <= before

    def took(self, systems: int, *, from_guess: bool) -> None:
        """Count the linear systems of an instant that started from the guess or not."""
        if from_guess:
            self._systems_from_guess += systems
            self._instants_from_guess += 1
        else:
            self._systems_from_before += systems
            self._instants_from_before += 1
