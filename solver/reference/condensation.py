"""A structure seen from its contacts: stiffness and load between the jumps of all pairs.

With J the jumps of the displacement (above minus below), the structure answers to
contact forces f by K u = F + J' f. Its displacement is u = T j + Z a
(`solver.reference.glued`): with jumps j, and a of the structure glued at its contacts.
So S jump = f + q (solver/README.md, 6), which needs no more than that the structure,
glued at its contacts, is held. Jumps and forces are stacked as `Problem.sum_of_contact`
says.

Three things are kept apart, as they may differ by any number of digits:

- The rigid motions a of bodies that contact alone holds: jump = y + Q a, with Q the jumps that they
  make, orthonormal. They cost no force, S Q = 0, so forces follow from the deformation
  y alone. It is chosen with Q' y = 0, which says that the forces are in equilibrium
  with the load, as Q' q is known exactly. With that S may be replaced by S + s Q Q',
  which is definite.
- What is in series with a jump, like a spring: it is no part of S.
- Jumps that depend on each other. Those that something in series tells apart follow from a `base`
  of the others; where contacts close a rigid ring, S takes them for independent, with a
  stiffness that ties them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import solve_triangular
from scipy.sparse.linalg import SuperLU

from solver.arrays import ROUNDING, Array, Indices, sparse_factor
from solver.discrete.problem import Problem
from solver.reference.assembly import (
    Interrupted,
    NoReferenceError,
    assembled_stiffness,
    external_force,
    jumps,
    separated,
)
from solver.reference.glued import base_of, from_jumps, self_stresses
from solver.reference.rules import rules_of

LOOSE = 1e-14
"""Pivot, as a share of its diagonal entry, below which a structure counts as not
held."""

SOFTEST = 1e-8
"""Spring at a pair, at least, as a share of the stiffest degree of freedom."""

LEFT_INSIDE = 4.0 * ROUNDING
"""Share of the forces that displacements make inside elements that rounding leaves of
them."""

BLURRED = 1e-5
"""Share of the forces up to which what is out of balance may be rounding: forces in
elements of slender bodies are 1e7 times those of contact."""

TIE = 1e3
"""Stiffness that ties jumps which depend on each other, in springs at a pair."""

BLOCK = 500
"""Columns of a dense matrix at a time, where more would fill the memory."""


class Condensation:
    """The structure between its contacts, without jumps that prescribed displacements make alone.

    `stop` is asked now and then while it is made; `Interrupted` is raised where it
    returns True.

    Attributes
    ----------
    moving
        Which jumps are unknown, shape (n_moving,), places in the stack.
    base, ties
        Which of these the others follow from, shape (n_base,), places among the unknown
        ones; and how, shape (n_moving, n_base).
    stiffness
        S + s Q Q' between the base, shape (n_base, n_base), symmetric, scaled.
    load
        q of it, shape (n_base, n_instants), scaled.
    springs
        Stiffness of a pair by what is next to it, of each, shape (n_base,), scaled.
    motions, gauge
        Rigid motions that no support holds, shape (n_dofs, n_motions), and the jumps Q
        of the base that they make, shape (n_base, n_motions).
    stresses, tie
        Where jumps of the base depend on each other: forces that move nothing, of shape
        (n_base, n_stresses), and the stiffness in S that keeps the jumps from coming
        apart along them, scaled.
    all_rules, rules
        What all jumps obey, and those that are unknown.
    given
        Jumps that prescribed displacements make, shape (n_forces, n_instants); final
        where a jump is not unknown.
    """

    def __init__(
        self, problem: Problem, stop: Callable[[], bool] | None = None
    ) -> None:
        fixed, prescribed = problem.prescribed
        free = np.setdiff1d(np.arange(problem.n_dofs), fixed)
        self._whole = assembled_stiffness(problem)
        self._force = external_force(problem)
        self._jumps = jumps(problem)
        self.all_rules = rules_of(problem)
        self._fixed = fixed
        self._prescribed = prescribed
        self._free = free
        self.given: Array = self._jumps[:, fixed] @ prescribed
        free_jumps = self._jumps[:, free]
        self.moving: Indices = np.flatnonzero(np.diff(free_jumps.indptr))
        self.rules = self.all_rules.kept(self.moving)
        free_jumps = free_jumps[self.moving]
        rigid = self.rules.compliance == 0.0
        self.base, self.ties = base_of(free_jumps, rigid)
        free_jumps = free_jumps[self.base]
        rigid = rigid[self.base]
        self.motions, self.gauge = _gauged(problem, self._jumps[self.moving[self.base]])
        self.stresses: Array = self_stresses(free_jumps, rigid)
        self._rings = np.flatnonzero(self.stresses.any(axis=1))
        self._condense(free_jumps, stop)

    def _condense(
        self, free_jumps: sparse.csr_array, stop: Callable[[], bool] | None
    ) -> None:
        """Factor the glued structure once, and take it out for all jumps and instants together."""
        free = self._free
        stiffness = self._whole[free]
        load = self._force[free] - stiffness[:, self._fixed] @ self._prescribed
        stiffness = stiffness[:, free]
        diagonal = stiffness.diagonal()
        diagonal = np.maximum(diagonal, SOFTEST * diagonal.max(initial=0.0))
        self.springs: Array = 1.0 / (abs(free_jumps) @ (1.0 / diagonal))
        self.tie = TIE * float(self.springs.max(initial=0.0))
        self._jumped, self._glued = from_jumps(free_jumps)
        strained = sparse.csr_array(stiffness @ self._jumped)
        self._pulled = sparse.csr_array(self._glued.T @ strained)
        self._factor = factored(
            sparse.csc_array(self._glued.T @ stiffness @ self._glued)
        )
        patterns, course = separated(load)
        self._alone = self._solved(self._glued.T @ patterns) @ course
        load = self._jumped.T @ load - self._pulled.T @ self._alone
        whole = (self._jumped.T @ strained).toarray(order="C")
        for columns in _blocks(len(whole)):
            if stop is not None and stop():
                raise Interrupted
            whole[:, columns] -= self._pulled.T @ self._solved(
                self._pulled[:, columns].toarray()
            )
        _symmetrise(whole)
        self._tie(whole)
        self.stiffness: Array = whole
        self.load: Array = self._balanced(load) + whole @ self._given_of_base
        if self.gauge.size:
            self._set_motions_apart()

    def _solved(self, sides: Array) -> Array:
        """Displacement of the glued structure under forces on it, shape (n_glued, ...)."""
        if len(sides):
            return np.asarray(self._factor.solve(sides))
        return sides

    def _balanced(self, forces: Array) -> Array:
        """Forces, or jumps, of the base without what moves nothing."""
        rings = self._rings
        stresses = self.stresses[self._rings]
        balanced = forces.copy()
        balanced[rings] -= stresses @ (stresses.T @ forces[rings])
        return balanced

    def _tie(self, stiffness: Array) -> None:
        """Tie jumps of the base that depend on others to them, in S."""
        rings = self._rings
        stresses = self.stresses[self._rings]
        stiffness[rings] -= stresses @ (stresses.T @ stiffness[rings])
        stiffness[:, rings] -= (stiffness[:, rings] @ stresses) @ stresses.T
        stiffness[np.ix_(rings, rings)] += self.tie * stresses @ stresses.T

    def _set_motions_apart(self) -> None:
        """Remove from S what rounding makes rigid motions cost, from q what it adds to loads."""
        gauge = self.gauge
        stiffness = self.stiffness
        costs = stiffness @ gauge
        costs -= 0.5 * gauge @ (gauge.T @ costs)
        size = float(np.diagonal(stiffness).mean())
        for rows in _blocks(len(stiffness)):
            more = costs[rows] @ gauge.T + gauge[rows] @ (costs - size * gauge).T
            stiffness[rows] -= more
        self.load += gauge @ (self.motions.T @ self._force - gauge.T @ self.load)

    @cached_property
    def elastic(self) -> Array:
        """S alone, (n_base, n_base): rigid motions cost nothing."""
        stiffness = self.stiffness
        gauge = self.gauge
        if not gauge.size:
            return stiffness
        # Each of these motions is held by a stiffness of its own.
        held = gauge * (gauge * (stiffness @ gauge)).sum(axis=0)
        return np.asarray(stiffness - held @ gauge.T)

    @property
    def _given_of_base(self) -> Array:
        return np.asarray(self.given[self.moving[self.base]])

    @cached_property
    def shift(self) -> Array:
        """What prescribed displacements add to jumps beyond the base's, (n_moving, n_instants)."""
        return np.asarray(self.given[self.moving] - self.ties @ self._given_of_base)

    def deformation(self, strained: Array) -> Array:
        """All displacements but for rigid motions, (n_dofs, n_instants), by jumps y of the base."""
        displacement = np.empty_like(self._force)
        displacement[self._fixed] = self._prescribed
        jumped = self._balanced(strained - self._given_of_base)
        glued = self._alone - self._solved(self._pulled @ jumped)
        displacement[self._free] = self._jumped @ jumped + self._glued @ glued
        return displacement

    def jump(self, displacement: Array) -> Array:
        """Jumps of a displacement, shape (n_forces, n_instants)."""
        return np.asarray(self._jumps @ displacement)

    def unbalanced(self, deformation: Array, force: Array) -> Array:
        """Forces out of balance where nothing is prescribed, (n_free, n_instants), scaled.

        By displacements without rigid motions, and the force of all contacts.
        """
        outer = self._force + self._jumps.T @ force
        return np.asarray((self._whole @ deformation - outer)[self._free])

    def rounding(self, deformation: Array, motion: Array, size: float) -> float:
        """Bound what rounding alone may leave out of balance at any instant, scaled.

        The forces inside a slender body are far larger than what acts on it. How far a
        body has moved says where a spring ends, too, and what closes: there rounding of
        the rigid motion deforms the body, by no more than a small share of the largest
        force, `size`.
        """
        inside = abs(self._whole) @ np.abs(deformation)
        moved = self.unit[:, None] * np.abs(self.jump(motion))
        sprung = moved[self.all_rules.compliance > 0.0]
        left = LEFT_INSIDE * max(inside.max(initial=0.0), sprung.max(initial=0.0))
        return float(
            max(left, min(LEFT_INSIDE * moved.max(initial=0.0), BLURRED * size))
        )

    @cached_property
    def unit(self) -> Array:
        """A stiffness of every jump and what is in series with it, shape (n_forces,), scaled."""
        unit = np.ones(len(self.all_rules.gap))
        springs = abs(self.ties) @ self.springs
        unit[self.moving] = springs / (1.0 + springs * self.rules.compliance)
        return unit

    @cached_property
    def largest_force(self) -> float:
        """Largest force on any degree of freedom, of loads and of prescribed displacements.

        Where there are none, the largest that closes bodies which overlap from the
        start.
        """
        pushed = self._whole[:, self._fixed] @ self._prescribed
        largest = max(
            np.abs(self._force).max(initial=0.0), np.abs(pushed).max(initial=0.0)
        )
        overlap = np.maximum(-self.all_rules.gap, 0.0)
        return float(largest or (self.unit * overlap).max(initial=0.0))


def _gauged(problem: Problem, base: sparse.csr_array) -> tuple[Array, Array]:
    """Rigid motions, and the jumps Q of the base that they make, orthonormal."""
    if problem.motions is None:
        return np.zeros((problem.n_dofs, 0)), np.zeros((base.shape[0], 0))
    _, size = np.linalg.qr(base @ problem.motions)
    steps = np.abs(np.diagonal(size))
    if len(steps) < size.shape[1] or steps.min() <= LOOSE * steps.max():
        raise NoReferenceError(_NOT_HELD)
    # From the motions once more, so that what one does not move stays exactly where it
    # is.
    motions = solve_triangular(size, problem.motions.T, trans="T").T
    return motions, np.asarray(base @ motions)


def factored(matrix: sparse.csc_array) -> SuperLU:
    """Factor a stiffness, (n, n); NoReferenceError where something moves that costs no force."""
    try:
        factor = sparse_factor(
            matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except LinAlgError as trouble:
        raise NoReferenceError(_NOT_HELD) from trouble
    pivots = factor.U.diagonal()
    if np.any(pivots <= LOOSE * matrix.diagonal()[np.argsort(factor.perm_c)]):
        raise NoReferenceError(_NOT_HELD)
    return factor


def _blocks(size: int) -> list[slice]:
    """Slices of as many columns, or rows, as are taken at a time."""
    return [slice(first, first + BLOCK) for first in range(0, size, BLOCK)]


def _symmetrise(matrix: Array) -> None:
    """Replace a square matrix by the mean of it and its transpose."""
    for rows in _blocks(len(matrix)):
        others = slice(rows.start, None)
        mean = matrix[rows, others] + matrix[others, rows].T
        mean *= 0.5
        matrix[rows, others] = mean
        matrix[others, rows] = mean.T


_NOT_HELD = (
    "The structure can move as a whole even where all its contacts are closed and stick: "
    "prescribe displacements on a side, or add a support."
)
