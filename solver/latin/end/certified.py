"""From a certified solution to an iterate in which both stages agree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.arrays import Array, read_only
from solver.discrete.problem import Problem
from solver.latin.end.status_step import Certificate
from solver.latin.iterate import Iterate

ENOUGH = 1e-14
"""Share of the largest force at which the forces on rows are in balance, up to
rounding."""
MOST_STEPS = 60
"""Steps of the conjugate gradients, at most; the rows of one point are few, so a dozen
suffice."""


def finished(
    problem: Problem, k: Array, certificate: Certificate, last: Iterate | None = None
) -> Iterate:
    """The iterate that a certified solution is, after the `last` of the run that led to it.

    Its linear and its local stage are the same fields, a fixed point of the method for
    every k, of the rows, (n_rows,), read-only. Its bases are those of the search, if it
    had any.
    """
    scales = problem.scales
    solution = certificate.solution
    deformation = solution.deformation / scales.displacement
    force = row_forces(problem, deformation, solution.contact_force / scales.force)
    moved = (solution.displacement / scales.displacement)[problem.row_dofs]
    stretched = force / k[:, None]
    fields = moved + stretched, moved - stretched, moved, force
    outgoing, incoming, local, force = (
        read_only(np.asfortranarray(field)) for field in fields
    )
    return Iterate(
        number=last.number + 1 if last else 1,
        seconds=last.seconds if last else 0.0,
        problem=problem,
        k=k,
        outgoing=outgoing,
        incoming=incoming,
        local_displacement=local,
        local_incoming=incoming,
        bases=last.bases if last else (),
        residual=certificate.residual,
        force=force,
    )


def row_forces(problem: Problem, displacement: Array, contact_force: Array) -> Array:
    """Share out the forces on every substructure's boundary among its rows.

    Where contact and loads act they are known. What the elasticity of a substructure
    needs beyond them at a degree of freedom is carried by its other rows there, and
    what one side of a cut takes the other gives; where several cuts meet, which leaves
    a choice, the smallest such forces. From how the structure deforms, (n_dofs,
    n_instants), and contact forces as stacked by `Problem.sum_of_contact`, F of every
    row, (n_rows, n_instants); all scaled.
    """
    known, is_known = known_forces(problem, contact_force)
    balance, needed = balance_of_rows(problem, displacement)
    sides = np.concatenate([np.zeros((2, 0), dtype=np.intp), *problem.cuts], axis=1)
    pairs = np.arange(sides.shape[1])
    opposite = sparse.csr_array(
        (np.ones(sides.size), (np.tile(pairs, 2), sides.ravel())),
        shape=(len(pairs), problem.n_rows),
    )
    right = np.concatenate(
        [needed - balance @ known, np.zeros((len(pairs), problem.n_instants))]
    )
    system = sparse.csr_array(sparse.vstack([balance, opposite]))
    open_rows = np.flatnonzero(~is_known)
    known[open_rows] = _smallest(sparse.csr_array(system[:, open_rows]), right)
    return known


def known_forces(
    problem: Problem, contact_force: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """The forces of rows that rub or are loaded, and which rows these are."""
    force = np.zeros((problem.n_rows, problem.n_instants))
    is_known = np.zeros(problem.n_rows, dtype=bool)
    for loaded in problem.given_forces:
        force[loaded.rows] = loaded.values
        is_known[loaded.rows] = True
    for name, law in problem.rubbing.items():
        for place, component in zip(
            problem.contact_places[name], law.components, strict=True
        ):
            carried = law.shares[:, None] * contact_force[place][law.points]
            for rows, sign in zip(component.sides, (1.0, -1.0), strict=False):
                force[rows] = sign * carried
                is_known[rows] = True
    return force, is_known


def balance_of_rows(
    problem: Problem, displacement: Array
) -> tuple[sparse.csr_array, Array]:
    """What sums the rows of every boundary point, (n, n_rows), and the force that it needs."""
    rows = []
    places = []
    needed = []
    size = 0
    for part in problem.substructures:
        points, place, stiffness = part.elasticity.boundary
        force = np.asarray(stiffness @ displacement[part.dofs])
        if part.body_force is not None:
            force = force - part.body_force[points]
        needed.append(force)
        rows.append(part.rows)
        places.append(size + place)
        size += len(points)
    entries = np.ones(problem.n_rows), (np.concatenate(places), np.concatenate(rows))
    return sparse.csr_array(entries, shape=(size, problem.n_rows)), np.concatenate(
        needed
    )


def _smallest(system: sparse.csr_array, right: Array) -> Array:
    """The smallest x with A x = b, by conjugate gradients on A A^T, all columns together."""
    solution = np.zeros((system.shape[1], right.shape[1]))
    rest = right.copy()
    way = solution
    before = 1.0
    enough = ENOUGH * float(np.abs(right).max(initial=0.0))
    for _ in range(MOST_STEPS):
        gradient = system.T @ rest
        # What no x takes away is rounding in the equilibrium of the whole.
        if np.abs(gradient).max(initial=0.0) <= enough:
            break
        steep = float(np.vdot(gradient, gradient))
        way = gradient + (steep / before) * way
        image = system @ way
        length = steep / float(np.vdot(image, image))
        solution += length * way
        rest -= length * image
        before = steep
    return solution
