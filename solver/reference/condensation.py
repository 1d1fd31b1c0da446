"""Condensation of a structure to its contacts: stiffness and load of all jumps.

With J the jumps of the displacement (above minus below), the displacement u under
contact forces f is that of K u = F + J' f. It is u = T j + Z a
(`solver.reference.glued`): with jumps j, and a of the structure glued at its contacts.
So S jump = f + q (MATHEMATICS.md, 6), if only the structure, glued at its contacts,
is held. Jumps and forces are stacked as `Problem.sum_of_contact` says.

Three parts are kept apart, as they may differ by any number of digits:

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
from functools import cached_property

import numpy as np
from numpy.linalg import LinAlgError
from scipy import sparse
from scipy.linalg import solve_triangular
from scipy.sparse.linalg import SuperLU

from solver.arrays import (
    ROUNDING,
    Array,
    Flags,
    Indices,
    read_only,
    separated,
    sparse_factor,
)
from solver.cache import CACHE, content_of
from solver.discrete.problem import Problem
from solver.reference.assembly import (
    Interrupted,
    NoReferenceError,
    assembled_stiffness,
    external_force,
    jumps,
)
from solver.reference.glued import base_of, from_jumps, self_stresses
from solver.reference.rules import rules_of

LOOSE = 1e-14
"""Pivot, as a share of its diagonal entry, below which a structure counts as not
held."""

SOFTEST = 1e-8
"""Smallest spring at a pair, as a share of the stiffest degree of freedom."""

LEFT_INSIDE = 4.0 * ROUNDING
"""Share of the forces inside elements that rounding of the displacements leaves."""

BLURRED = 1e-5
"""Share of the forces up to which forces out of balance may be rounding: forces in
elements of slender bodies are 1e7 times those of contact."""

TIE = 1e3
"""Stiffness that ties jumps which depend on each other, in springs at a pair."""

OF_ENTRY = 12
"""Memory of an entry of a sparse matrix, with its place, B."""

BLOCK = 500
"""Columns of a dense matrix that are taken at a time: more would fill the memory."""


class GluedStructure:
    """The structure glued at its contacts: independent of friction and loads.

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
        stop: Callable[[], bool] | None,
    ) -> None:
        free = _free_dofs(problem)
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

    def _subtract_glued(
        self, condensed: Array, stop: Callable[[], bool] | None
    ) -> None:
        """Subtract the reaction of the glued structure, in place, (n_base, n_base)."""
        for columns in _blocks(len(condensed)):
            if stop is not None and stop():
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


class Condensation:
    """The structure between its contacts, condensed to the jumps that are unknown.

    Jumps that prescribed displacements alone make are known.

    Attributes
    ----------
    moving
        Places of the unknown jumps in the stack, shape (n_moving,).
    base, ties
        Places among these of the jumps from which all follow, shape (n_base,); and the
        matrix by which they follow, shape (n_moving, n_base).
    stiffness
        S between the base, shape (n_base, n_base), symmetric, scaled.
    load
        q of the base, shape (n_base, n_instants), scaled.
    springs
        Stiffness of each pair by the elements beside it, shape (n_base,), scaled.
    motions, gauge
        Rigid motions that no support holds, shape (n_dofs, n_motions), and the jumps Q
        of the base that they make, shape (n_base, n_motions).
    stresses, tie
        Forces that move nothing, where jumps of the base depend on each other, shape
        (n_base, n_stresses); and the stiffness in S that keeps the jumps from coming
        apart along them, scaled.
    all_rules, rules
        Rules of all jumps, and of the unknown ones.
    given
        Jumps that prescribed displacements make, shape (n_forces, n_instants), scaled;
        final where a jump is not unknown.
    """

    def __init__(
        self, problem: Problem, stop: Callable[[], bool] | None = None
    ) -> None:
        """Condense a problem.

        Raises
        ------
        Interrupted
            As soon as `stop` returns True; it is asked now and then.
        NoReferenceError
            If the structure can move with all contacts closed and stuck.
        """
        self._fixed, self._prescribed = problem.prescribed
        self._free = _free_dofs(problem)
        self._whole = assembled_stiffness(problem)
        self._force = external_force(problem)
        self._jumps = jumps(problem)
        self.all_rules = rules_of(problem)
        self.given: Array = self._jumps[:, self._fixed] @ self._prescribed
        free_jumps = self._jumps[:, self._free]
        self.moving: Indices = np.flatnonzero(np.diff(free_jumps.indptr))
        self.rules = self.all_rules.kept(self.moving)
        self._glued = self._glued_structure(problem, stop)
        self.base = self._glued.base
        self.ties = self._glued.ties
        self.stiffness = self._glued.stiffness
        self.springs = self._glued.springs
        self.motions = self._glued.motions
        self.gauge = self._glued.gauge
        self.stresses = self._glued.stresses
        self.tie = self._glued.tie
        self._condense_load()

    def _glued_structure(
        self, problem: Problem, stop: Callable[[], bool] | None
    ) -> GluedStructure:
        """Structure glued at its contacts, from an earlier run if nothing changed."""
        moving = self._jumps[self.moving]
        rigid = self.rules.compliance == 0.0
        given = self.given[self.moving]
        key = (
            "glued",
            problem.content_of_bodies,
            problem.content_of_stiffness,
            content_of(self._fixed, moving, rigid, given),
        )
        return CACHE.get(
            key,
            lambda: GluedStructure(problem, self._whole, moving, rigid, given, stop),
        )

    def _condense_load(self) -> None:
        """Condense the load of the free degrees of freedom to the base."""
        glued = self._glued
        pushed = self._whole[self._free][:, self._fixed] @ self._prescribed
        load = self._force[self._free] - pushed
        # The few patterns of the load are solved for, not its many instants.
        patterns, courses = separated(load)
        self._alone = glued.solved(glued.glued.T @ patterns) @ courses
        load = glued.jumped.T @ load - glued.pulled.T @ self._alone
        self.load: Array = glued.balanced(load) + glued.given_force
        if self.gauge.size:
            # The resultant of the loads is known exactly, without condensation.
            resultant = self.motions.T @ self._force
            self.load += self.gauge @ (resultant - self.gauge.T @ self.load)

    @cached_property
    def shift(self) -> Array:
        """Jumps by prescribed displacements that do not follow from the base.

        Shape (n_moving, n_instants), scaled.
        """
        return np.asarray(self.given[self.moving] - self.ties @ self._glued.given)

    def deformation(self, strained: Array) -> Array:
        """Displacements without rigid motions by jumps y of the base.

        Shape (n_dofs, n_instants) by y of shape (n_base, n_instants), scaled.
        """
        displacement = np.empty_like(self._force)
        displacement[self._fixed] = self._prescribed
        jumped = self._glued.balanced(strained - self._glued.given)
        glued = self._alone - self._glued.solved(self._glued.pulled @ jumped)
        displacement[self._free] = (
            self._glued.jumped @ jumped + self._glued.glued @ glued
        )
        return displacement

    def jump(self, displacement: Array) -> Array:
        """Jumps (n_forces, n_instants) of a displacement (n_dofs, n_instants)."""
        return np.asarray(self._jumps @ displacement)

    def unbalanced(self, deformation: Array, force: Array) -> Array:
        """Forces out of balance, (n_free, n_instants), without those of supports.

        Parameters
        ----------
        deformation
            Displacements without rigid motions, shape (n_dofs, n_instants), scaled.
        force
            Forces of all contacts, shape (n_forces, n_instants), scaled.
        """
        outer = self._force + self._jumps.T @ force
        return np.asarray((self._whole @ deformation - outer)[self._free])

    def inside(self, deformation: Array) -> float:
        """Largest sum of the sizes of forces inside elements at a node, scaled.

        By displacements without rigid motions, shape (n_dofs, n_instants), scaled.
        """
        # Sizes without signs: forces cancel at a degree of freedom, their rounding does
        # not.
        forces = abs(self._whole) @ np.abs(deformation)
        return float(forces.max(initial=0.0))

    def rounding(self, deformation: Array, motion: Array, size: float) -> float:
        """Largest unbalanced force by rounding alone, scaled.

        The forces inside a slender body are far larger than those that act on it.
        Springs and closing contacts depend on how far a body has moved, too: there
        rounding of the rigid motion deforms the body, by no more than a small share of
        the largest force.

        Parameters
        ----------
        deformation, motion
            Displacements without rigid motions, and these, shape (n_dofs, n_instants),
            scaled.
        size
            Largest force, scaled.
        """
        inside = self.inside(deformation)
        moved = self.unit[:, None] * np.abs(self.jump(motion))
        sprung = moved[self.all_rules.compliance > 0.0]
        left = LEFT_INSIDE * max(inside, sprung.max(initial=0.0))
        blurred = min(LEFT_INSIDE * moved.max(initial=0.0), BLURRED * size)
        return float(max(left, blurred))

    @cached_property
    def unit(self) -> Array:
        """Stiffness of every jump with its spring in series, (n_forces,), scaled."""
        unit = np.ones(len(self.all_rules.gap))
        springs = abs(self.ties) @ self.springs
        unit[self.moving] = springs / (1.0 + springs * self.rules.compliance)
        return unit

    @cached_property
    def largest_force(self) -> float:
        """Largest force of loads and prescribed displacements on a degree of freedom.

        Where there are none, the largest force that closes bodies which overlap from
        the start, scaled.
        """
        pushed = self._whole[:, self._fixed] @ self._prescribed
        largest = max(
            np.abs(self._force).max(initial=0.0), np.abs(pushed).max(initial=0.0)
        )
        overlap = np.maximum(-self.all_rules.gap, 0.0)
        return float(largest or (self.unit * overlap).max(initial=0.0))


def _free_dofs(problem: Problem) -> Indices:
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
