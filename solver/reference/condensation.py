"""A structure seen from its contacts: stiffness and load between the jumps of all pairs.

With J the jumps of the displacement (above minus below), the structure answers to contact forces
f by K u = F + J' f. A body that only contact holds makes K singular, so springs rho join the
pairs first and the laws take them out again: with K_r = K + J' rho J and C = J K_r^-1 J',

    S jump = f + q,    S = C^-1 - rho,    q = C^-1 J K_r^-1 F,

which holds for every rho > 0 and needs no more than that the structure, glued at its contacts,
is held. Where contacts close a ring, jumps depend on each other; S takes them for independent, with
a stiffness that ties them. Jumps and forces are stacked as `Problem.sum_of_contact` says.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.linalg import lapack
from scipy.sparse.linalg import splu

from solver.arrays import ROUNDING, Array, Indices
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force
from solver.reference.self_stress import self_stresses
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
    stiffness
        S of them, shape (n_moving, n_moving), symmetric, scaled.
    load
        q of them, shape (n_moving, n_instants), scaled.
    springs
        rho of each, shape (n_moving,), scaled.
    stresses, tie
        Where jumps depend on each other: forces that move nothing, (n_moving, n_stresses), and the
        stiffness in S that keeps the jumps from coming apart along them, scaled.
    compliance
        In series with every jump, shape (n_forces,), scaled; S is of both together.
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
        self._condense(own[self.moving])

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
        n_own = len(self.moving)
        patterns, course = _separated(load)
        sides = np.empty((len(free), n_own + patterns.shape[1]), order="F")
        sides[:, :n_own], sides[:, n_own:] = own.T.toarray(order="F"), patterns
        solved = _solve(sparse.csc_array(held), sides)
        self._answers, self._alone = solved[:, :n_own], solved[:, n_own:] @ course
        compliance, alone = own @ self._answers, own @ self._alone
        in_series = self.compliance[self.moving]
        self.stresses: Array = self_stresses(own, in_series == 0.0)
        self.tie = TIE * float(self.springs.max(initial=0.0))
        compliance += self.stresses @ self.stresses.T / (self.tie or 1.0)
        if in_series.any():
            self.stiffness, load = self._in_series(compliance, alone, in_series)
        else:
            inverse = _inverse(0.5 * (compliance + compliance.T))
            self.stiffness, load = inverse - np.diag(self.springs), inverse @ alone
        self.load: Array = load + self.stiffness @ self.given[self.moving]

    def _in_series(self, compliance: Array, alone: Array, more: Array) -> tuple[Array, Array]:
        """Give S and C^-1 times the free jumps where a jump is longer by `more` times its force.

        With j = C (f + rho j) + a and p = j + c f: (C + (1 - C rho) c) f = (1 - C rho) p - a. This
        needs no inverse of C, so jumps with something in series may depend on each other.
        """
        rigid = np.eye(len(more)) - compliance * self.springs
        found = np.linalg.solve(compliance + rigid * more, np.column_stack([rigid, alone]))
        stiffness, load = found[:, : len(more)], found[:, len(more) :]
        return np.asarray(0.5 * (stiffness + stiffness.T)), np.asarray(load)

    def displacement(self, jump: Array, force: Array) -> Array:
        """Give all displacements from those of the contacts, shape (n_dofs, n_instants), scaled.

        Parameters
        ----------
        jump, force
            Of the unknown jumps, shape (n_moving, n_instants), scaled.
        """
        found = np.empty_like(self._force)
        found[self._fixed] = self._prescribed
        alone = jump - self.compliance[self.moving, None] * force
        springs = self.springs[:, None] * (alone - self.given[self.moving])
        found[self._free] = self._alone + self._answers @ (force + springs)
        return found

    def jump(self, displacement: Array, force: Array | None = None) -> Array:
        """Give the jumps of a displacement under contact forces, shape (n_forces, n_instants)."""
        found = np.asarray(self._jumps @ displacement)
        return found if force is None else found + self.compliance[:, None] * force

    def unbalanced(self, displacement: Array, force: Array) -> Array:
        """Give the forces out of balance where nothing is prescribed, (n_free, n_instants).

        Parameters
        ----------
        displacement
            Shape (n_dofs, n_instants), scaled.
        force
            Of all contacts, shape (n_forces, n_instants), scaled.
        """
        outer = self._force + self._jumps.T @ force
        return np.asarray((self._whole @ displacement - outer)[self._free])

    def rounding(self, displacement: Array) -> float:
        """Give what rounding alone may leave out of balance at any instant, scaled.

        The forces inside a slender body are far larger than what acts on it; and what they were
        once stays in the places where its contacts stick.
        """
        inside = abs(self._whole) @ np.abs(displacement)
        return LEFT_INSIDE * float(inside.max(initial=0.0))

    @cached_property
    def largest_force(self) -> float:
        """Largest force on any degree of freedom, of loads and of prescribed displacements."""
        pushed = self._whole[:, self._fixed] @ self._prescribed
        return float(max(np.abs(self._force).max(initial=0.0), np.abs(pushed).max(initial=0.0)))


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
