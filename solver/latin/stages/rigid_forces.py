"""Forces on rigid bodies on the springs of the search direction, at some instants.

k is a spring at every row: a contact presses or is open, and sticks or slips at mu
times what presses it. The forces are piecewise linear in the positions of the bodies.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.arrays import Array, Flags, Indices
from solver.latin.stages.rigid_stiffness import (
    BandFactors,
    BandStiffness,
    Product,
    RigidContacts,
)
from solver.laws.play import Play

TRIALS = 30
"""Largest number of trials of how far a step goes."""
TOO_FAR = 0.1
"""Work against a step at its end, over that along it at its start, up to which the step
does not go too far. With 0.01 an arch of 31 voussoirs takes 1.9 times as many trials
and a third more steps, with 0.5 a fifth more steps (measured)."""


class Loading(NamedTuple):
    """Jumps and loads of some instants; all scaled.

    Attributes
    ----------
    jump
        Jumps across and along the pairs where no body moves, shape (2 n_pairs,
        n_instants).
    load
        Forces along the motions there, but for those of contacts, shape (n_motions,
        n_instants).
    """

    jump: Array
    load: Array

    def part(self, instants: slice) -> Loading:
        """The loading of some of the instants."""
        return Loading(self.jump[:, instants], self.load[:, instants])

    def since(self, before: Loading) -> Loading:
        """Changes of jumps and loads from an earlier loading."""
        return Loading(self.jump - before.jump, self.load - before.load)


class RigidState(NamedTuple):
    """Positions of all bodies at some instants, and the forces there; all scaled.

    Attributes
    ----------
    position
        Rigid motions, shape (n_motions, n_instants).
    unbalanced
        Sum of all forces along the motions, shape (n_motions, n_instants).
    before, sliders
        Positions of the sliders at the instant before each, and at each, shape
        (n_pairs, n_instants).
    overlap
        What each pair presses by, or negative, shape (n_pairs, n_instants).
    sticking
        Friction that would hold each pair where it was, shape (n_pairs, n_instants).
    presses, slips
        Whether each pair presses, and the sign of its friction if it slips, else 0,
        shape (n_pairs, n_instants).
    error
        Largest unbalanced force, over the largest load of a body, (n_instants,).
    """

    position: Array
    unbalanced: Array
    before: Array
    sliders: Array
    overlap: Array
    sticking: Array
    presses: Flags
    slips: Array
    error: Array

    def part(self, instants: slice | Indices) -> RigidState:
        """The state at some of the instants."""
        return RigidState(
            position=self.position[:, instants],
            unbalanced=self.unbalanced[:, instants],
            before=self.before[:, instants],
            sliders=self.sliders[:, instants],
            overlap=self.overlap[:, instants],
            sticking=self.sticking[:, instants],
            presses=self.presses[:, instants],
            slips=self.slips[:, instants],
            error=self.error[instants],
        )


class RigidForces:
    """Forces on rigid bodies, their stiffness, and lengths of steps.

    Parameters
    ----------
    contacts
        The contacts.
    stiffness
        Stiffness of springs that neither open nor slip, (n_motions, n_motions), scaled.
    holding
        Stiffness of springs at all rows against each motion, (n_motions,), scaled.
    load_size
        Largest load of a body, scaled. Contact forces are no measure: bodies that have
        gone astray have large ones.
    start
        Positions of the sliders before the first instant, (n_pairs,), scaled.
    n_instants
        Number of all instants.

    Attributes
    ----------
    load_size
        As above.
    jumps, pushes
        Products with the jumps of `contacts`, and with their transpose.
    across, along
        Compliance of the springs across and along each pair, shape (n_pairs, 1).
    friction
        Coefficient of friction of each pair, shape (n_pairs, 1).
    """

    def __init__(
        self,
        contacts: RigidContacts,
        stiffness: sparse.csr_array,
        holding: Array,
        load_size: float,
        start: Array,
        n_instants: int,
    ) -> None:
        size = len(contacts.gap)
        self._n_pairs = size
        self._gap = contacts.gap[:, None]
        self._start = start[:, None]
        self._play = Play(size, n_instants, start)
        self._band = BandStiffness(contacts, stiffness, holding)
        both = sparse.vstack([contacts.jumps, stiffness])
        self._jumps_and_springs = Product(sparse.csr_array(both))
        self.load_size = load_size
        self.jumps = Product(contacts.jumps)
        self.pushes = Product(sparse.csr_array(contacts.jumps.T))
        self.across = contacts.compliance[:size, None]
        self.along = contacts.compliance[size:, None]
        self.friction = contacts.friction[:, None]

    def at(
        self,
        position: Array,
        loading: Loading,
        before: Array | None = None,
    ) -> RigidState:
        """State where the bodies are at a position, (n_motions, n_instants).

        `before` are the sliders at the instant before each, (n_pairs, n_instants);
        without them instants are all, and friction continues from one to the next.
        """
        size = self._n_pairs
        moved = self._jumps_and_springs(position)
        jump = loading.jump + moved[: 2 * size]
        along = jump[size:]
        overlap = -self._gap - jump[:size]
        pressing = np.maximum(overlap, 0.0) / self.across
        bound = self.friction * pressing
        if before is None:
            after = self._play(along, self.along * bound)
            before = np.concatenate([self._start, after[:, :-1]], axis=1)
        sticking = (before - along) / self.along
        friction = np.minimum(np.maximum(sticking, -bound), bound)
        pushed = self.pushes(np.concatenate([pressing, friction]))
        unbalanced = loading.load - moved[2 * size :] + pushed
        return RigidState(
            position=position,
            unbalanced=unbalanced,
            before=before,
            sliders=along + self.along * friction,
            overlap=overlap,
            sticking=sticking,
            presses=overlap > 0.0,
            slips=np.sign(sticking) * (np.abs(sticking) > bound),
            error=np.abs(unbalanced).max(axis=0) / self.load_size,
        )

    def factored(self, presses: Flags, slips: Array, held: float) -> BandFactors:
        """Factors of the stiffness where no status changes.

        `presses` and `slips` are those of a `RigidState`; a share `held` of the springs
        at all rows holds every motion.
        """
        pressing = presses / self.across
        sticking = (presses & (slips == 0.0)) / self.along
        rubbing = slips * self.friction * pressing
        return self._band.factored(np.concatenate([pressing, sticking, rubbing]), held)

    def moved(
        self, state: RigidState, step: Array, moves: Array, loading: Loading
    ) -> RigidState:
        """State after a step, shortened to where the forces stop working along it.

        Parameters
        ----------
        state, loading
            The state before, and the loading, at the same instants.
        step
            Step of the positions, shape (n_motions, n_instants).
        moves
            What the sliders at the instant before each move by in a whole step, shape
            (n_pairs, n_instants).
        """
        whole = self.at(state.position + step, loading, state.before + moves)
        work = _work(state.unbalanced, step)
        end_work = _work(whole.unbalanced, step)
        goes_too_far = (work > 0.0) & (end_work < -TOO_FAR * work)
        if not goes_too_far.any():
            return whole
        some = np.flatnonzero(goes_too_far)
        share = np.ones(step.shape[1])
        share[some] = self._share(
            state.part(some), step[:, some], moves[:, some], end_work[some]
        )
        position = state.position + share * step
        return self.at(position, loading, state.before + share * moves)

    def _share(
        self, state: RigidState, step: Array, moves: Array, end_work: Array
    ) -> Array:
        """Share of a step at which forces stop working along it, (n_instants,).

        State, step and moves are as in `moved`; the step goes too far: at its end
        forces do the work `end_work` along it, which is negative, (n_instants,).
        """
        changes = self._jumps_and_springs(step)
        contacts = changes[: 2 * self._n_pairs]

        def of_contacts(share: Array) -> Array:
            """Work of the contacts along the step after shares of it, (n_instants,)."""
            return _work(self._contact_forces(state, contacts, moves, share), contacts)

        begin = np.zeros(step.shape[1])
        end = np.ones_like(begin)
        work = _work(state.unbalanced, step)
        enough = TOO_FAR * work
        # Loads and springs that neither open nor slip work linearly.
        constant = work - of_contacts(begin)
        slope = _work(changes[2 * self._n_pairs :], step)
        share = end
        is_sought = np.ones(len(end), dtype=bool)
        # Regula falsi; the work at an end that stays is halved (Illinois).
        for _ in range(TRIALS):
            between = begin + (end - begin) * work / (work - end_work)
            share = np.where(is_sought, between, share)
            work_there = constant - share * slope + of_contacts(share)
            is_sought &= np.abs(work_there) > enough
            if not is_sought.any():
                break
            is_short = work_there > 0.0
            begin = np.where(is_short, share, begin)
            end = np.where(is_short, end, share)
            work = np.where(is_short, work_there, 0.5 * work)
            end_work = np.where(is_short, 0.5 * end_work, work_there)
        return share

    def _contact_forces(
        self, state: RigidState, changes: Array, moves: Array, share: Array
    ) -> Array:
        """Forces across and along the pairs after shares of a step.

        The jumps change by `changes` in a whole step; forces and changes have the shape
        (2 n_pairs, n_instants).
        """
        across = changes[: self._n_pairs]
        along = changes[self._n_pairs :]
        pressing = np.maximum(state.overlap - share * across, 0.0) / self.across
        bound = self.friction * pressing
        sticking = state.sticking + share * (moves - along) / self.along
        friction = np.minimum(np.maximum(sticking, -bound), bound)
        return np.concatenate([pressing, friction])


def _work(force: Array, step: Array) -> Array:
    """Work of forces along a step, both (n, n_instants), shape (n_instants,)."""
    return np.asarray(np.einsum("ij,ij->j", force, step))
