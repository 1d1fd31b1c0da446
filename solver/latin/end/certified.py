"""The certified answer of a run, with all fields of a solution."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.arrays import Array, ones_at, power_of_two, read_only
from solver.discrete.problem import Problem
from solver.latin.end.status_step import Certificate
from solver.latin.iterate import Checkpoint, Iterate
from solver.reduction.basis import SharedBasis

ENOUGH = 1e-14
"""Share of the largest force up to which the forces on rows count as balanced."""
MOST_STEPS = 60
"""Largest number of steps of the conjugate gradients; the rows of one point are few, so
a dozen suffice."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer(Iterate):
    """Certified answer of a run: an iterate that obeys equilibrium and all laws.

    Both stages agree in it, so that it is a fixed point of the method for every k. Its
    bases are those of the search that led to it, and do not hold all of it.

    Attributes
    ----------
    residual
        KKT residual relative to the contact force.
    force
        F of both stages, shape (n_rows, n_instants), scaled, read-only. Beside a body's
        rigid motion the digits of F/k may be lost.
    is_beside
        Whether it is next to the iterates of a search that came to its own end.
        Otherwise it counts as the last iteration.
    """

    residual: float
    force: Array
    is_beside: bool = False

    @property
    def iterations(self) -> int:
        """Number of iterations done, not counting an answer that is no iteration."""
        return self.number - self.is_beside

    @property
    def checkpoint(self) -> Checkpoint:
        """State from which the iteration can be resumed, in full fields."""
        return replace(super().checkpoint, bases=())

    @property
    def boundary_force(self) -> Array:
        """F of the linear stage, shape (n_rows, n_instants), scaled."""
        return self.force

    @property
    def boundary_local_force(self) -> Array:
        """F^ of the local stage, shape (n_rows, n_instants), scaled."""
        return self.force


def certified_answer(
    problem: Problem,
    k: Array,
    certificate: Certificate,
    last: Iterate | None = None,
    *,
    is_beside: bool = False,
) -> Answer:
    """Answer of a run from the certified solution of a status step.

    Parameters
    ----------
    problem
        The problem that is solved.
    k
        Search direction of the rows, shape (n_rows,), scaled, read-only.
    certificate
        The certified solution.
    last
        Last iterate of the run that led to the solution.
    is_beside
        Whether the answer is next to the iterates.
    """
    scales = problem.scales
    solution = certificate.solution
    deformation = solution.deformation / scales.displacement
    force = row_forces(problem, deformation, solution.contact_force / scales.force)
    moved = (solution.displacement / scales.displacement)[problem.row_dofs]
    stretched = force / k[:, None]
    incoming = _field(moved - stretched)
    number = 1
    seconds = 0.0
    bases: tuple[SharedBasis, ...] = ()
    if last is not None:
        number = last.number + 1
        seconds = last.seconds
        bases = last.bases
    return Answer(
        number=number,
        seconds=seconds,
        problem=problem,
        k=k,
        outgoing=_field(moved + stretched),
        incoming=incoming,
        local_displacement=_field(moved),
        local_incoming=incoming,
        bases=bases,
        residual=certificate.residual,
        force=_field(force),
        is_beside=is_beside,
    )


def answer_of_iterate(iterate: Iterate, residual: float, *, is_beside: bool) -> Answer:
    """Answer of a run from an iterate that is itself a solution, by KKT residual."""
    return Answer(
        number=iterate.number + 1,
        seconds=iterate.seconds,
        problem=iterate.problem,
        k=iterate.k,
        outgoing=iterate.outgoing,
        incoming=iterate.incoming,
        local_displacement=iterate.local_displacement,
        local_incoming=iterate.local_incoming,
        bases=iterate.bases,
        k_state=iterate.k_state,
        residual=residual,
        force=read_only(iterate.boundary_force),
        is_beside=is_beside,
    )


def _field(values: Array) -> Array:
    """Field of shape (n_rows, n_instants), contiguous in space, read-only."""
    return read_only(np.asfortranarray(values))


def row_forces(problem: Problem, displacement: Array, contact_force: Array) -> Array:
    """Forces of rows, distributed from those at boundary points of substructures.

    The forces of contacts and loads are known. The rest of the force that the
    elasticity of a substructure needs at a degree of freedom is carried by its other
    rows there, and the forces on both sides of a cut are opposite. Where several cuts
    meet this leaves a choice: then the forces are the smallest ones.

    Parameters
    ----------
    problem
        The problem that is solved.
    displacement
        Displacement that deforms the structure, shape (n_dofs, n_instants), scaled.
    contact_force
        Contact forces stacked by `Problem.sum_of_contact`, shape (n_forces,
        n_instants), scaled.

    Returns
    -------
    F of every row, shape (n_rows, n_instants), scaled.
    """
    force, is_known = known_forces(problem, contact_force)
    balance, needed = balance_of_rows(problem, displacement)
    # Unknown forces balance the elasticity, and are opposite across cuts.
    opposite = _sum_of_sides(problem)
    right = np.concatenate(
        [needed - balance @ force, np.zeros((opposite.shape[0], problem.n_instants))]
    )
    system = sparse.csr_array(sparse.vstack([balance, opposite]))
    open_rows = np.flatnonzero(~is_known)
    force[open_rows] = _smallest(sparse.csr_array(system[:, open_rows]), right)
    return force


def _sum_of_sides(problem: Problem) -> sparse.csr_array:
    """Sum of the forces on both sides of cuts, shape (n_pairs, n_rows)."""
    nothing = np.zeros((2, 0), dtype=np.intp)
    sides = np.concatenate([nothing, *problem.cuts], axis=1)
    n_pairs = sides.shape[1]
    pairs = np.tile(np.arange(n_pairs), 2)
    return ones_at(pairs, sides.ravel(), (n_pairs, problem.n_rows))


def known_forces(
    problem: Problem, contact_force: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Known forces of rows: contact forces and prescribed loads.

    Parameters
    ----------
    problem
        The problem that is solved.
    contact_force
        Contact forces stacked by `Problem.sum_of_contact`, shape (n_forces,
        n_instants), scaled.

    Returns
    -------
    F of the rows, shape (n_rows, n_instants), scaled, zero where it is unknown; and
    whether it is known, shape (n_rows,).
    """
    force = np.zeros((problem.n_rows, problem.n_instants))
    is_known = np.zeros(problem.n_rows, dtype=bool)
    for loaded in problem.prescribed_forces:
        force[loaded.rows] = loaded.values
        is_known[loaded.rows] = True
    for law, _, _, forces in problem.contacts.stacks:
        for numbers, component in zip(forces, law.components, strict=True):
            carried = law.shares[:, None] * contact_force[numbers][law.points]
            for rows, sign in zip(component.sides, (1.0, -1.0), strict=False):
                force[rows] = sign * carried
                is_known[rows] = True
    return force, is_known


def balance_of_rows(
    problem: Problem, displacement: Array
) -> tuple[sparse.csr_array, Array]:
    """Matrix of sums of row forces at boundary points, and the required sums.

    `displacement` has shape (n_dofs, n_instants), scaled. With n points on the
    boundaries of all substructures, the sum has shape (n, n_rows), and the needed
    forces have shape (n, n_instants), scaled.
    """
    rows = []
    points_of_rows = []
    needed = []
    size = 0
    for part in problem.substructures:
        points, point_of_row, stiffness = part.elasticity.boundary
        force = np.asarray(stiffness @ displacement[part.dofs])
        if part.body_force is not None:
            force = force - part.body_force[points]
        needed.append(force)
        rows.append(part.rows)
        points_of_rows.append(size + point_of_row)
        size += len(points)
    shape = size, problem.n_rows
    balance = ones_at(np.concatenate(points_of_rows), np.concatenate(rows), shape)
    return balance, np.concatenate(needed)


def _smallest(system: sparse.csr_array, right: Array) -> Array:
    """Minimum-norm x with A x = b, by conjugate gradients on A A^T, for all columns.

    A has shape (m, n), b shape (m, n_instants), x shape (n, n_instants).
    """
    solution = np.zeros((system.shape[1], right.shape[1]))
    size = power_of_two(right)
    residual = right / size
    direction = solution
    before = 1.0
    enough = ENOUGH * float(np.abs(residual).max(initial=0.0))
    for _ in range(MOST_STEPS):
        gradient = system.T @ residual
        # A residual without gradient is rounding in the equilibrium of the whole.
        if np.abs(gradient).max(initial=0.0) <= enough:
            break
        steepness = float(np.vdot(gradient, gradient))
        direction = gradient + (steepness / before) * direction
        image = system @ direction
        length = steepness / float(np.vdot(image, image))
        solution += length * direction
        residual -= length * image
        before = steepness
    return solution * size
