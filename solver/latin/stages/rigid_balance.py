"""Balance of rigid bodies on the springs of the search direction, at one instant.

Bodies are rigid, and k is a spring at every row: a contact presses or is open, and
sticks or slips at mu times what presses it. The positions of the bodies at which their
forces balance all loads are a zero of a piecewise linear function, which Newton's
method on the statuses finds (Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92,
1991). A step ends where the forces do no more work along it: without friction that is
the least energy, which always falls.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.arrays import Array, Flags
from solver.latin.stages.rigid_stiffness import BandStiffness, RigidContacts

BALANCED = 1e-9
"""Largest unbalanced force, over the largest load of a body, in balance."""
STEPS = 25
"""Largest number of linear systems from one start; most instants take one to three
(measured)."""
TRIALS = 30
"""Largest number of trials of how far a step goes."""
TOO_FAR = 1e-2
"""Work against a step at its end, over that along it at its start, up to which the step
does not go too far."""
HELD = 1e-10, 1e-6, 1e-4
"""Shares of the springs at all rows that hold bodies in a step, so that one in the air
does not go too far; each is tried where those before it lead nowhere."""
ROUNDS = 20
"""Largest number of rounds with known bounds of friction, which are tried at last. Of
136 arches of any shape 96 % reach 1 % of the contact force within 60 iterations, and 77
% without these rounds (measured)."""
CLOSE = 1e-2
"""Unbalanced force, as in `BALANCED`, from which Newton's method takes over again."""


class Loading(NamedTuple):
    """Jumps and loads of an instant; all scaled.

    Attributes
    ----------
    jump
        Jumps across and along the pairs where no body moves, shape (2 n_pairs,).
    load
        Forces along the motions there, but for those of contacts, shape (n_motions,).
    sliders
        Positions of the sliders at the instant before, shape (n_pairs,).
    """

    jump: Array
    load: Array
    sliders: Array


class RigidState(NamedTuple):
    """Position of all bodies, and the forces there; all scaled.

    Attributes
    ----------
    position
        Rigid motions, shape (n_motions,).
    unbalanced
        Sum of all forces along the motions, shape (n_motions,).
    sliders
        Positions of the sliders, shape (n_pairs,).
    presses, slips
        Whether each pair presses, and the sign of its friction if it slips, else 0,
        shape (n_pairs,).
    bound
        Largest friction forces, shape (n_pairs,).
    has_known_bound
        Whether these were given, and do not follow what presses.
    error
        Largest unbalanced force, over the largest load of a body.
    """

    position: Array
    unbalanced: Array
    sliders: Array
    presses: Flags
    slips: Array
    bound: Array
    has_known_bound: bool
    error: float


class Balance:
    """Balance of the forces on rigid bodies, ready for all instants.

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
    """

    def __init__(
        self,
        contacts: RigidContacts,
        stiffness: sparse.csr_array,
        holding: Array,
        load_size: float,
    ) -> None:
        self._contacts = contacts
        # One product for both: of matrices as small as these a call costs most.
        self._of_position = sparse.csr_array(sparse.vstack([contacts.jumps, stiffness]))
        self._pushes = sparse.csr_array(contacts.jumps.T)
        self._n_pairs = len(contacts.gap)
        self._load_size = load_size
        self._band = BandStiffness(contacts, stiffness, holding)

    def settled(
        self, loading: Loading, near: Array | None, before: Array
    ) -> RigidState:
        """State in which the forces balance, or the nearest to that which is found.

        `near` is a position that may be near it, `before` that of the instant before,
        from which the first step is taken with all pairs stuck; (n_motions,) both.
        """
        tried = []
        if near is not None:
            tried.append(self._from(self.at(near, loading), loading, HELD[0]))
            if tried[0].error <= BALANCED:
                return tried[0]
        start = self.at(before, loading)
        glued = start._replace(
            presses=np.ones_like(start.presses), slips=np.zeros_like(start.slips)
        )
        stuck = self._moved(start, self._step(glued, HELD[0]), loading)
        for held in HELD:
            state = self._from(stuck, loading, held)
            tried.append(state)
            if state.error <= BALANCED:
                break
        best = min(tried, key=lambda state: state.error)
        if best.error <= BALANCED:
            return best
        return self._by_known_bounds(stuck, loading, best)

    def _by_known_bounds(
        self, state: RigidState, loading: Loading, best: RigidState
    ) -> RigidState:
        """State found by rounds in which the bounds of friction are known.

        These are bounds of the round before. With them the balance is the least of a
        convex energy, which the steps always reach. The rounds begin at a state; `best`
        is the best one so far, which is returned if no round is better.
        """
        for _ in range(ROUNDS):
            known = self.at(state.position, loading, state.bound)
            state = self.at(self._from(known, loading, HELD[1]).position, loading)
            if state.error <= CLOSE:
                state = self._from(state, loading, HELD[0])
            if state.error < best.error:
                best = state
            if best.error <= BALANCED:
                break
        return best

    def _from(self, state: RigidState, loading: Loading, held: float) -> RigidState:
        """The best state on the way that Newton's method takes from a first one.

        `held` is the share of springs that hold bodies, as in `HELD`.
        """
        best = state
        for _ in range(STEPS):
            if state.error <= BALANCED:
                return state
            state = self._moved(state, self._step(state, held), loading)
            if state.error < best.error:
                best = state
        return best

    def _step(self, state: RigidState, held: float) -> Array:
        """Step to where forces balance if no status changes, shape (n_motions,).

        `held` is as in `_from`.
        """
        contacts = self._contacts
        pressing = state.presses / contacts.compliance[: self._n_pairs]
        sticks = state.presses & (state.slips == 0.0)
        rubbing = state.slips * contacts.friction * pressing
        if state.has_known_bound:
            sticks = (state.bound > 0.0) & (state.slips == 0.0)
            rubbing = np.zeros_like(rubbing)
        sticking = sticks / contacts.compliance[self._n_pairs :]
        stiffnesses = np.concatenate([pressing, sticking, rubbing])
        return self._band.solve(stiffnesses, state.unbalanced, held)

    def _moved(self, state: RigidState, step: Array, loading: Loading) -> RigidState:
        """State after a step, or after the part of it along which the forces work."""
        work = float(state.unbalanced @ step)
        known = None
        if state.has_known_bound:
            known = state.bound
        after = self.at(state.position + step, loading, known)
        end_work = float(after.unbalanced @ step)
        enough = TOO_FAR * abs(work)
        if work <= 0.0 or end_work >= -enough:
            return after
        # Regula falsi; the work at an end that stays is halved (Illinois).
        begin = 0.0
        end = 1.0
        for _ in range(TRIALS):
            share = begin + (end - begin) * work / (work - end_work)
            after = self.at(state.position + share * step, loading, known)
            work_there = float(after.unbalanced @ step)
            if abs(work_there) <= enough:
                break
            if work_there > 0.0:
                begin = share
                work = work_there
                end_work *= 0.5
            else:
                end = share
                end_work = work_there
                work *= 0.5
        return after

    def at(
        self, position: Array, loading: Loading, known_bound: Array | None = None
    ) -> RigidState:
        """Forces where the bodies are at a position, (n_motions,).

        `known_bound` is that of friction, (n_pairs,), where it does not follow what
        presses.
        """
        contacts = self._contacts
        size = self._n_pairs
        of_position = self._of_position @ position
        jump = loading.jump + of_position[: 2 * size]
        along = jump[size:]
        soft = contacts.compliance[size:]
        overlap = -contacts.gap - jump[:size]
        pressing = np.maximum(overlap, 0.0) / contacts.compliance[:size]
        sticking = (loading.sliders - along) / soft
        bound = known_bound
        if bound is None:
            bound = contacts.friction * pressing
        friction = np.minimum(np.maximum(sticking, -bound), bound)
        pushed = self._pushes @ np.concatenate([pressing, friction])
        unbalanced = loading.load - of_position[2 * size :] + pushed
        return RigidState(
            position=position,
            unbalanced=unbalanced,
            sliders=along + soft * friction,
            presses=overlap > 0.0,
            slips=np.sign(sticking) * (np.abs(sticking) > bound),
            bound=bound,
            has_known_bound=known_bound is not None,
            error=float(np.abs(unbalanced).max()) / self._load_size,
        )
