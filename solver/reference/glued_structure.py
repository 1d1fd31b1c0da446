"""The structure glued at its contacts, which is independent of friction and loads.

It has the stiffness S of all jumps (`solver.reference.condensation`). Three parts are
kept apart, as they may differ by any number of digits:

- The rigid motions a of bodies that contact alone holds: jump = y + Q a, with Q the
  jumps that they make, orthonormal. They cost no force, S Q = 0, so forces follow from
  the deformation y alone. The deformation is chosen with Q' y = 0, which says that the
  forces are in equilibrium with the load, as Q' q is known exactly.
- A compliance in series with a jump, like a spring: it is no part of S.
- Jumps that depend on each other. If they have a compliance in series they follow from
  a `base` of the others; where contacts close a rigid ring, S takes them for
  independent, with a stiffness that ties them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import solve_triangular
from scipy.sparse.linalg import SuperLU

from solver.arrays import Array, Flags, Indices, read_only, sparse_factor
from solver.discrete.problem import Problem
from solver.reference.assembly import Interrupted, NoReferenceError
from solver.reference.glued import base_of, from_jumps, self_stresses

LOOSE = 1e-14
"""Pivot, as a share of its diagonal entry, below which a structure counts as not
held."""

SOFTEST = 1e-8
"""Smallest spring at a pair, as a share of the stiffest degree of freedom."""

TIE = 1e3
"""Stiffness that ties jumps which depend on each other, in springs at a pair."""

OF_ENTRY = 12
"""Memory of an entry of a sparse matrix, with its place, B."""

BLOCK = 500
"""Columns of a dense matrix that are taken at a time: more would fill the memory."""


class GluedStructure:
    """Stiffness of the jumps, and motions of the structure glued at its contacts.

    It is kept between runs (`solver.cache`).

    Parameters
    ----------
    problem
        The problem: its degrees of freedom that are free, and its rigid motions.
    stiffness
        Stiffness of the whole structure, shape (n_dofs, n_dofs), scaled.
    jumps
        J of the unknown jumps, shape (n_moving, n_dofs).
    rigid
        Whether a jump has nothing in series, shape (n_moving,).
    given
        Jumps that prescribed displacements make, shape (n_moving, n_instants), scaled.
    stop
        Asked now and then whether to give up.

    Attributes
    ----------
    base, ties, stiffness, springs, motions, gauge, stresses, tie
        As of `Condensation`.
    jumped, glued
        Displacements by jumps of the base, T, and of the glued structure, Z, of the
        free degrees of freedom (`solver.reference.glued`).
    pulled
        Forces on the glued structure by jumps, shape (n_glued, n_base), scaled.
    given
        Jumps of the base that prescribed displacements make, (n_base, n_instants).
    given_force
        S times these jumps, same shape, scaled.
    """

    def __init__(
        self,
        problem: Problem,
        stiffness: sparse.csr_array,
        jumps: sparse.csr_array,
        rigid: Flags,
        given: Array,
        stop: Callable[[], bool],
    ) -> None:
        free = free_dofs(problem)
        free_jumps = jumps[:, free]
        self.base, self.ties = base_of(free_jumps, rigid)
        free_jumps = free_jumps[self.base]
        self.motions, self.gauge = _gauged(problem, jumps[self.base])
        self.stresses: Array = self_stresses(free_jumps, rigid[self.base])
        self._rings = np.flatnonzero(self.stresses.any(axis=1))
        stiffness = stiffness[free][:, free]
        diagonal = stiffness.diagonal()
        # A bare degree of freedom would make a pair infinitely soft.
        diagonal = np.maximum(diagonal, SOFTEST * diagonal.max(initial=0.0))
        self.springs: Array = 1.0 / (abs(free_jumps) @ (1.0 / diagonal))
        self.tie = TIE * float(self.springs.max(initial=0.0))
        self.jumped, self.glued = from_jumps(free_jumps)
        strained = sparse.csr_array(stiffness @ self.jumped)
        self.pulled = sparse.csr_array(self.glued.T @ strained)
        self._factor = factored(sparse.csc_array(self.glued.T @ stiffness @ self.glued))
        # The difference of two matrices that are nearly equal: rounding makes it
        # unsymmetric, and moves jumps that depend on each other.
        condensed = (self.jumped.T @ strained).toarray(order="C")
        self._subtract_glued(condensed, stop)
        _symmetrise(condensed)
        self._tie(condensed)
        self.stiffness: Array = condensed
        self.given: Array = np.asarray(given[self.base])
        self.given_force: Array = condensed @ self.given
        if self.gauge.size:
            self._set_motions_apart()
        read_only(self.stiffness)

    @property
    def nbytes(self) -> int:
        """Memory of the dense arrays, B."""
        dense = [self.stiffness, self.motions, self.gauge, self.stresses]
        dense += [self.given, self.given_force]
        entries: int = self._factor.nnz + self.pulled.nnz
        return sum(field.nbytes for field in dense) + OF_ENTRY * entries

    def _subtract_glued(self, condensed: Array, stop: Callable[[], bool]) -> None:
        """Subtract the reaction of the glued structure, in place, (n_base, n_base)."""
        for columns in _blocks(len(condensed)):
            if stop():
                raise Interrupted
            pulled = self.pulled[:, columns].toarray()
            condensed[:, columns] -= self.pulled.T @ self.solved(pulled)

    def solved(self, forces: Array) -> Array:
        """Displacement of the glued structure under forces on it, (n_glued, n) each."""
        if len(forces):
            return np.asarray(self._factor.solve(forces))
        return forces

    def balanced(self, forces: Array) -> Array:
        """Forces or jumps of the base, projected off self-stresses.

        Both have the shape (n_base, n_instants).
        """
        rings = self._rings
        stresses = self.stresses[self._rings]
        balanced = forces.copy()
        balanced[rings] -= stresses @ (stresses.T @ forces[rings])
        return balanced

    def _tie(self, stiffness: Array) -> None:
        """Add stiffness to dependent jumps of the base, in S (n_base, n_base)."""
        rings = self._rings
        stresses = self.stresses[self._rings]
        stiffness[rings] -= stresses @ (stresses.T @ stiffness[rings])
        stiffness[:, rings] -= (stiffness[:, rings] @ stresses) @ stresses.T
        stiffness[np.ix_(rings, rings)] += self.tie * stresses @ stresses.T

    def _set_motions_apart(self) -> None:
        """Remove rounding errors of rigid motions from S, in place."""
        gauge = self.gauge
        stiffness = self.stiffness
        costs = stiffness @ gauge
        # Half of Q Q' S Q Q' each time, as rows and columns both subtract it.
        costs -= 0.5 * gauge @ (gauge.T @ costs)
        for rows in _blocks(len(stiffness)):
            excess = costs[rows] @ gauge.T + gauge[rows] @ costs.T
            stiffness[rows] -= excess


def free_dofs(problem: Problem) -> Indices:
    """Degrees of freedom without prescribed displacement, ascending, (n_free,)."""
    fixed, _ = problem.prescribed
    return np.setdiff1d(np.arange(problem.n_dofs), fixed)


def _gauged(problem: Problem, base: sparse.csr_array) -> tuple[Array, Array]:
    """Rigid motions, and the orthonormal jumps Q of the base that they make.

    With the jumps of the base by displacements, shape (n_base, n_dofs).

    Returns
    -------
    The motions, shape (n_dofs, n_motions), and their jumps, shape (n_base, n_motions).
    """
    if problem.rigid_motions is None:
        return np.zeros((problem.n_dofs, 0)), np.zeros((base.shape[0], 0))
    _, size = np.linalg.qr(base @ problem.rigid_motions)
    steps = np.abs(np.diagonal(size))
    if len(steps) < size.shape[1] or steps.min() <= LOOSE * steps.max():
        raise NoReferenceError(_NOT_HELD)
    # From the motions once more, so that a part that a motion leaves in place has
    # exactly no displacement in it.
    motions = solve_triangular(size, problem.rigid_motions.T, trans="T").T
    return motions, np.asarray(base @ motions)


def factored(matrix: sparse.csc_array) -> SuperLU:
    """Factor a stiffness, (n, n).

    Raises
    ------
    NoReferenceError
        If some motion costs no force.
    """
    try:
        # Pivots stay on the diagonal, as in a factorisation of Cholesky.
        factor = sparse_factor(
            matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except LinAlgError as trouble:
        raise NoReferenceError(_NOT_HELD) from trouble
    # Rounding leaves a small pivot, not zero, where a motion is free.
    pivots = factor.U.diagonal()
    if np.any(pivots <= LOOSE * matrix.diagonal()[np.argsort(factor.perm_c)]):
        raise NoReferenceError(_NOT_HELD)
    return factor


def _blocks(size: int) -> list[slice]:
    """Slices of columns, or rows, for work in blocks."""
    return [slice(first, first + BLOCK) for first in range(0, size, BLOCK)]


def _symmetrise(matrix: Array) -> None:
    """Replace a matrix (n, n), in place, by its mean with its transpose."""
    # By blocks, as the transpose of the whole would be a second large matrix.
    for rows in _blocks(len(matrix)):
        others = slice(rows.start, None)
        mean = matrix[rows, others] + matrix[others, rows].T
        mean *= 0.5
        matrix[rows, others] = mean
        matrix[others, rows] = mean.T


_NOT_HELD = (
    "The structure can move as a whole even where all its contacts are closed and "
    "stick: prescribe displacements on a side, or add a support."
)
