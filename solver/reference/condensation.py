"""A structure seen from its contacts: stiffness and load between the jumps of all pairs.

With J the jumps of the displacement (above minus below), the structure answers to contact forces
f by K u = F + J' f. A body that only contact holds makes K singular, so springs rho join the
pairs first and the laws take them out again: with K_r = K + J' rho J and C = J K_r^-1 J',

    S jump = f + q,    S = C^-1 - rho,    q = C^-1 J K_r^-1 F,

which holds for every rho > 0 and needs no more than that the structure, glued at its contacts,
is held. Jumps and forces are stacked as `Problem.sum_of_contact` says.

Three things are kept apart, as they may differ by any number of digits:

- The rigid motions a of bodies that contact alone holds: jump = y + Q a, with Q the jumps that they
  make, orthonormal. They cost no force, S Q = 0, so forces follow from the deformation y alone. It
  is chosen with Q' y = 0, which says that the forces are in equilibrium with the load, as
  Q' q is known exactly. With that S may be replaced by S + s Q Q', which is definite.
- What is in series with a jump, like a spring: it is no part of S.
- Jumps that depend on each other. Those that something in series tells apart follow from a `base`
  of the others; where contacts close a rigid ring, S takes them for independent, with a stiffness
  that ties them.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.linalg import lapack, solve_triangular
from scipy.sparse.linalg import splu

from solver.arrays import ROUNDING, Array, Indices
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force
from solver.reference.self_stress import base_of, self_stresses
from solver.reference.states import rules_of

LOOSE = 1e-14
"""Pivot, as a share of its diagonal entry, below which a structure counts as not held."""

SOFTEST = 1e-8
"""Spring at a pair, at least, as a share of the stiffest degree of freedom."""

LEFT_INSIDE = 4.0 * ROUNDING
"""Share of the forces that displacements make inside elements that rounding leaves of them."""

TIE = 1e3
"""Stiffness that ties jumps which depend on each other, in springs at a pair."""


class NoReferenceError(ValueError):
    """No reference can be found; the message says why."""


class NotHeldError(NoReferenceError):
    """The structure can move even where all its contacts are closed and stick."""


class TooLargeError(NoReferenceError):
    """There are more jumps than dense matrices of their size squared are worth."""


class Condensation:
    """The structure between its contacts.

    Jumps that follow from prescribed displacements alone are no unknowns: the forces there go
    into the supports.

    Attributes
    ----------
    moving
        Which jumps are unknown, shape (n_moving,), places in the stack.
    base, ties
        Which of these the others follow from, shape (n_base,), places among the unknown ones; and
        how, shape (n_moving, n_base).
    stiffness
        S + s Q Q' between the base, shape (n_base, n_base), symmetric, scaled.
    load
        q of it, shape (n_base, n_instants), scaled.
    springs
        rho of each, shape (n_base,), scaled.
    motions, gauge
        Rigid motions that no support holds, shape (n_dofs, n_motions), and the jumps Q of the base
        that they make, shape (n_base, n_motions).
    stresses, tie
        Where jumps of the base depend on each other: forces that move nothing, of shape
        (n_base, n_stresses), and the stiffness in S that keeps the jumps from coming apart along
        them, scaled.
    compliance
        In series with every jump, shape (n_forces,), scaled.
    given
        Jumps that prescribed displacements make, shape (n_forces, n_instants); final where a jump
        is not unknown.
    """

    def __init__(self, problem: Problem) -> None:
        fixed, prescribed = problem.prescribed
        free = np.setdiff1d(np.arange(problem.n_dofs), fixed)
        self._whole = assembled_stiffness(problem)
        self._force = external_force(problem)
        self._jumps = jumps(problem)
        self.compliance: Array = rules_of(problem).compliance
        self._fixed, self._prescribed, self._free = fixed, prescribed, free
        self.given: Array = self._jumps[:, fixed] @ prescribed
        own = self._jumps[:, free]
        self.moving: Indices = np.flatnonzero(np.diff(own.indptr))
        own, rigid = own[self.moving], self.compliance[self.moving] == 0.0
        self.base, self.ties = base_of(own, rigid)
        own, rigid = own[self.base], rigid[self.base]
        self.motions, self.gauge = _gauged(problem, self._jumps[self.moving[self.base]])
        self.stresses: Array = self_stresses(own, rigid)
        self._condense(own)

    def _condense(self, own: sparse.csr_array) -> None:
        """Factor once, and solve for the jumps and all instants together."""
        free = self._free
        stiffness = self._whole[free]
        load = self._force[free] - stiffness[:, self._fixed] @ self._prescribed
        stiffness = stiffness[:, free]
        diagonal = stiffness.diagonal()
        diagonal = np.maximum(diagonal, SOFTEST * diagonal.max(initial=0.0))
        self.springs: Array = 1.0 / (abs(own) @ (1.0 / diagonal))
        held = stiffness + own.T @ sparse.diags_array(self.springs) @ own
        n_own = len(self.base)
        patterns, course = _separated(load)
        sides = np.empty((len(free), n_own + patterns.shape[1]), order="F")
        sides[:, :n_own], sides[:, n_own:] = own.T.toarray(order="F"), patterns
        solved = _solve(sparse.csc_array(held), sides)
        self._answers, self._alone = solved[:, :n_own], solved[:, n_own:] @ course
        compliance, alone = own @ self._answers, own @ self._alone
        self.tie = TIE * float(self.springs.max(initial=0.0))
        compliance += self.stresses @ self.stresses.T / (self.tie or 1.0)
        inverse = _inverse(0.5 * (compliance + compliance.T))
        self.stiffness: Array = inverse - np.diag(self.springs)
        self.load: Array = inverse @ alone + self.stiffness @ self._given_of_base
        if self.gauge.size:
            self._set_motions_apart()

    def _set_motions_apart(self) -> None:
        """Take from S what rounding makes rigid motions cost, and from q what it adds to loads."""
        gauge, stiffness = self.gauge, self.stiffness
        costs = stiffness @ gauge
        costs -= 0.5 * gauge @ (gauge.T @ costs)
        more = costs @ gauge.T
        size = float(np.diagonal(stiffness).mean())
        self.stiffness = stiffness - more - more.T + size * gauge @ gauge.T
        self.load += gauge @ (self.motions.T @ self._force - gauge.T @ self.load)

    @property
    def _given_of_base(self) -> Array:
        return np.asarray(self.given[self.moving[self.base]])

    @cached_property
    def shift(self) -> Array:
        """What prescribed displacements add to jumps beyond the base's, (n_moving, n_instants)."""
        return np.asarray(self.given[self.moving] - self.ties @ self._given_of_base)

    def deformation(self, strained: Array, force: Array) -> Array:
        """Give all displacements but for rigid motions, shape (n_dofs, n_instants), scaled.

        Parameters
        ----------
        strained
            Jumps y of the base, shape (n_base, n_instants), scaled.
        force
            Of the unknown jumps, shape (n_moving, n_instants), scaled.
        """
        found = np.empty_like(self._force)
        found[self._fixed] = self._prescribed
        springs = self.springs[:, None] * (strained - self._given_of_base)
        found[self._free] = self._alone + self._answers @ (self.ties.T @ force + springs)
        return found

    def jump(self, displacement: Array) -> Array:
        """Give the jumps of a displacement, shape (n_forces, n_instants)."""
        return np.asarray(self._jumps @ displacement)

    def unbalanced(self, deformation: Array, force: Array) -> Array:
        """Give the forces out of balance where nothing is prescribed, (n_free, n_instants).

        Parameters
        ----------
        deformation
            Displacement but for rigid motions, shape (n_dofs, n_instants), scaled.
        force
            Of all contacts, shape (n_forces, n_instants), scaled.
        """
        outer = self._force + self._jumps.T @ force
        return np.asarray((self._whole @ deformation - outer)[self._free])

    def rounding(self, deformation: Array, motion: Array) -> float:
        """Give what rounding alone may leave out of balance at any instant, scaled.

        The forces inside a slender body are far larger than what acts on it; and what they were
        once stays in the places where its contacts stick. How far a body has moved says where a
        spring ends, too.

        Parameters
        ----------
        deformation, motion
            Displacement but for rigid motions, and these, shape (n_dofs, n_instants), scaled.
        """
        inside = abs(self._whole) @ np.abs(deformation)
        opened = self.unit[:, None] * np.abs(self.jump(motion)) * (self.compliance > 0.0)[:, None]
        return LEFT_INSIDE * float(max(inside.max(initial=0.0), opened.max(initial=0.0)))

    @cached_property
    def unit(self) -> Array:
        """A stiffness of every jump and what is in series with it, shape (n_forces,), scaled."""
        found = np.ones(len(self.compliance))
        springs = abs(self.ties) @ self.springs
        found[self.moving] = springs / (1.0 + springs * self.compliance[self.moving])
        return found

    @cached_property
    def largest_force(self) -> float:
        """Largest force on any degree of freedom, of loads and of prescribed displacements."""
        pushed = self._whole[:, self._fixed] @ self._prescribed
        return float(max(np.abs(self._force).max(initial=0.0), np.abs(pushed).max(initial=0.0)))


def _gauged(problem: Problem, base: sparse.csr_array) -> tuple[Array, Array]:
    """Give rigid motions, and the jumps Q of the base that they make, orthonormal."""
    if problem.motions is None:
        return np.zeros((problem.n_dofs, 0)), np.zeros((base.shape[0], 0))
    _, size = np.linalg.qr(base @ problem.motions)
    steps = np.abs(np.diagonal(size))
    if len(steps) < size.shape[1] or steps.min() <= LOOSE * steps.max():
        raise NotHeldError(_NOT_HELD)
    # From the motions once more, so that what one does not move stays exactly where it is.
    motions = solve_triangular(size, problem.motions.T, trans="T").T
    return motions, np.asarray(base @ motions)


def jumps(problem: Problem) -> sparse.csr_array:
    """Give J, the jumps of all pairs, shape (n_forces, n_dofs)."""
    rows, columns, values, first = [], [], [], 0
    for law in problem.rubbing.values():
        points, pairs = np.unique(law.points, return_index=True)
        for component in law.components:
            for side, value in zip(component.sides, (1.0, -1.0), strict=False):
                rows.append(first + points)
                columns.append(problem.row_dofs[side[pairs]])
                values.append(np.full(len(points), value))
            first += len(law.positions)
    entries = np.concatenate(rows), np.concatenate(columns)
    return sparse.csr_array((np.concatenate(values), entries), shape=(first, problem.n_dofs))


def _separated(load: Array) -> tuple[Array, Array]:
    """Write loads, (n, n_instants), as patterns (n, rank) times courses, exact up to rounding.

    A structure has few patterns of load, and instants many: so there is less to solve for. Where
    it has many patterns, every instant counts as one.
    """
    patterns, rest = np.zeros((0, len(load))), load.copy()
    smallest = float(np.finfo(float).eps * np.abs(load).max(initial=0.0))
    while len(patterns) < load.shape[1] // 2:
        largest = int(np.abs(rest).max(axis=0, initial=0.0).argmax())
        pattern = rest[:, largest] - patterns.T @ (patterns @ rest[:, largest])
        if np.abs(pattern).max(initial=0.0) <= smallest:
            return patterns.T, patterns @ load
        pattern /= np.linalg.norm(pattern)
        patterns = np.vstack([patterns, pattern])
        rest -= pattern[:, None] * (pattern @ rest)
    return load, np.eye(load.shape[1])


def _solve(matrix: sparse.csc_array, sides: Array) -> Array:
    try:
        factor = splu(
            matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as trouble:
        raise NotHeldError(_NOT_HELD) from trouble
    pivots = factor.U.diagonal()
    if np.any(pivots <= LOOSE * matrix.diagonal()[np.argsort(factor.perm_c)]):
        raise NotHeldError(_NOT_HELD)
    return np.asarray(factor.solve(sides))


_NOT_HELD = (
    "The structure can move as a whole even where all its contacts are closed and stick: "
    "prescribe displacements on a side, or add a support."
)


def _inverse(compliance: Array) -> Array:
    factor, trouble = lapack.dpotrf(compliance)
    if trouble:
        raise NotHeldError(_NOT_HELD)
    upper = np.triu(lapack.dpotri(factor)[0])
    return np.asarray(upper + np.triu(upper, 1).T)
