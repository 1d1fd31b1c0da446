"""A rival: incremental frictional contact on the sparse matrix of the whole structure.

Displacements of all bodies and forces of all contacts that touch are unknown, the
forces as Lagrange multipliers. Every Newton step factors that matrix anew with SuperLU,
and the states (stick, slip, open) follow from what it shows, as in
`solver.reference.newton` (Alart and Curnier 1991). Nothing is condensed. The friction
is Coulomb's, without compliance, bound or strength.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from solver.arrays import Array, Flags, Indices
from solver.discrete.problem import Problem
from solver.laws import OPEN
from solver.reference.assembly import assembled_stiffness, external_force, jumps
from solver.reference.rules import HELD, States, rules_of

ORDER = "MMD_AT_PLUS_A"
"""Of columns: on walls 5 % faster than COLAMD, with three quarters of its fill
(measured)."""
LIMIT = 60
LEAST = 1e-12
"""Newton steps of an instant; and what counts as rounding, as a share of the largest
load."""


@dataclass(frozen=True, eq=False)
class Found:
    """Result of an incremental solver.

    Attributes
    ----------
    displacement, contact_force
        As of `solver.reference.solution.Reference`, SI.
    solved
        Which instants are, shape (n_instants,).
    factors
        Matrices that were factored.
    """

    displacement: Array
    contact_force: Array
    solved: Flags
    factors: int


class SparseNewton:
    """The incremental solver of one problem."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._rules = rules_of(problem)
        self._fixed, self._prescribed = problem.prescribed
        self._free: Indices = np.setdiff1d(np.arange(problem.n_dofs), self._fixed)
        whole = assembled_stiffness(problem)
        all_jumps = jumps(problem)
        rows = whole[self._free]
        self._stiffness = sparse.csc_array(rows[:, self._free])
        self._load = (
            external_force(problem)[self._free]
            - rows[:, self._fixed] @ self._prescribed
        )
        self._jumps = sparse.csr_array(all_jumps[:, self._free])
        self._given = all_jumps[:, self._fixed] @ self._prescribed
        self._unit: Array = abs(all_jumps) @ whole.diagonal()
        moved = abs(self._jumps).T @ np.abs(self._given)
        self._size = max(
            np.abs(self._load).max(initial=0.0), np.abs(moved).max(initial=0.0)
        )
        self._rubs: Indices = np.flatnonzero(~self._rules.normal)
        self._states: States | None = None
        self._factor: SuperLU
        self.factors = 0

    def march(self) -> Found:
        """Solve instant by instant."""
        problem = self._problem
        rules = self._rules
        displacement = np.zeros((problem.n_dofs, problem.n_instants))
        force = np.zeros((len(rules.gap), problem.n_instants))
        solved = np.ones(problem.n_instants, dtype=bool)
        states = np.full(len(rules.gap), HELD, dtype=np.int8)
        jump = np.zeros_like(rules.gap)
        displacement[self._fixed] = self._prescribed
        for instant in range(problem.n_instants):
            given = self._given[:, instant]
            if not self._load[:, instant].any() and not given.any():
                continue
            found = self._instant(instant, states, jump)
            found = found or self._instant(instant, np.full_like(states, HELD), jump)
            if found is None:
                solved[instant] = False
                continue
            states, moved, force[:, instant] = found
            displacement[self._free, instant] = moved
            jump = self._jumps @ moved + given
        scales = problem.scales
        return Found(
            displacement * scales.displacement,
            force * scales.force,
            solved,
            self.factors,
        )

    def _instant(
        self, instant: int, states: States, before: Array
    ) -> tuple[States, Array, Array] | None:
        """States, displacements of what is free, (n_free,), and forces, (n_jumps,).

        None where the states cycle.
        """
        rules = self._rules
        seen = set[bytes]()
        held = np.where(rules.normal, -rules.gap, before)
        for _ in range(LIMIT):
            try:
                moved, force = self._solve(
                    states, self._load[:, instant], held, instant
                )
            except RuntimeError:  # a body hangs on nothing
                return None
            jump = self._jumps @ moved + self._given[:, instant]
            corrected = self._corrected(states, self._unit * (jump - held), force)
            if np.array_equal(corrected, states):
                return states, moved, force
            seen.add(states.tobytes())
            states = corrected
            if states.tobytes() in seen:
                break
        return None

    def _solve(
        self, states: States, load: Array, held: Array, instant: int
    ) -> tuple[Array, Array]:
        """Displacements, (n_free,), and forces, (n_jumps,), in some states.

        The linear system is factored anew where the states have changed.
        """
        rules = self._rules
        touching = np.flatnonzero(states == HELD)
        slips = np.abs(states) == 1
        drag = np.where(slips, -states * rules.friction, 0.0)[self._rubs]
        # What a held jump's force does: a normal one drags the friction of its own
        # point along.
        count = len(states)
        places = rules.partner[self._rubs], self._rubs
        carried = sparse.eye_array(count, format="csr")
        carried = sparse.csr_array(
            carried + sparse.coo_array((drag, places), (count, count))
        )
        if self._states is None or not np.array_equal(states, self._states):
            pulls = -(carried[touching] @ self._jumps).T
            matrix = [[self._stiffness, pulls], [self._jumps[touching], None]]
            self._factor = splu(
                sparse.block_array(matrix, format="csc"), permc_spec=ORDER
            )
            self._states = states
            self.factors += 1
        right = np.concatenate([load, (held - self._given[:, instant])[touching]])
        found = self._factor.solve(right)
        moved, pressed = np.split(found, [len(load)])
        return moved, carried[touching].T @ pressed

    def _corrected(self, states: States, moved: Array, force: Array) -> States:
        """States that jumps and forces call for;
        what is up to rounding calls for none.
        """
        rules = self._rules
        slack = LEAST * self._size
        held = states == HELD
        carries = np.where(held, force[rules.partner], -moved[rules.partner])
        most = np.maximum(rules.friction * carries, 0.0) + slack * held
        pulled = np.where(held, -force, moved)
        found = (pulled > most).view(np.int8) - (pulled < -most).view(np.int8)
        found = np.where(
            np.abs(states) == 1, states * (states * moved >= -slack), found
        )
        closed = np.where(held, force >= -slack, moved < -slack)
        found = np.where(rules.normal, np.where(closed, HELD, OPEN), found).astype(
            np.int8
        )
        found[self._rubs[found[rules.partner[self._rubs]] == OPEN]] = OPEN
        return found
