"""Stiffness, load and jumps of the whole structure, for incremental solvers."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices, space_time
from solver.discrete.problem import Problem


class NoReferenceError(ValueError):
    """Error: no reference can be found; the message says why."""


class Interrupted(Exception):  # noqa: N818  # asked for by the caller, so no error
    """Interruption of a solver by its caller before the last instant."""


def never() -> bool:
    """Answer of a caller that interrupts nothing."""
    return False


def assembled_stiffness(problem: Problem) -> sparse.csr_array:
    """Stiffness K of the whole structure, shape (n_dofs, n_dofs), scaled."""
    # Equal substructures share one operator, which is taken apart once.
    entries: dict[int, sparse.coo_array] = {}
    for part in problem.substructures:
        if id(part.elasticity) not in entries:
            entries[id(part.elasticity)] = sparse.coo_array(part.elasticity.stiffness)
    rows = []
    columns = []
    values = []
    for part in problem.substructures:
        matrix = entries[id(part.elasticity)]
        rows.append(part.dofs[matrix.coords[0]])
        columns.append(part.dofs[matrix.coords[1]])
        values.append(matrix.data)
    positions = np.concatenate(rows), np.concatenate(columns)
    return sparse.csr_array(
        (np.concatenate(values), positions), shape=(problem.n_dofs, problem.n_dofs)
    )


def external_force(problem: Problem) -> Array:
    """Forces on the whole structure, shape (n_dofs, n_instants), scaled.

    Raises
    ------
    NoReferenceError
        If other forces act, or the problem holds anything else that no incremental
        solver reads.
    """
    if problem.no_reference:
        raise NoReferenceError(problem.no_reference)
    total = space_time(problem.n_dofs, problem.n_instants)
    for part in problem.substructures:
        if part.body_force is not None:
            np.add.at(total, part.dofs, part.body_force)
    for given in problem.prescribed_forces:
        np.add.at(total, problem.row_dofs[given.rows], given.values)
    return total


def points_dofs(problem: Problem) -> Indices:
    """Degree of freedom of every point with friction, in stacked order, (n_points,)."""
    dofs = np.zeros(problem.contacts.n_points, dtype=np.intp)
    for law, _, points, _ in problem.contacts.stacks:
        dofs[points[law.points]] = problem.row_dofs[law.tangent.above]
    return dofs


def jumps(problem: Problem) -> sparse.csr_array:
    """Matrix J of the jumps of all pairs, shape (n_forces, n_dofs)."""
    rows = []
    columns = []
    values = []
    for law, _, _, forces in problem.contacts.stacks:
        # All pairs of a point make the same jump, so its first pair represents it.
        points, pairs = np.unique(law.points, return_index=True)
        for numbers, component in zip(forces, law.components, strict=True):
            for side, value in zip(component.sides, (1.0, -1.0), strict=False):
                rows.append(numbers[points])
                columns.append(problem.row_dofs[side[pairs]])
                values.append(np.full(len(points), value))
    entries = np.concatenate(rows), np.concatenate(columns)
    return sparse.csr_array(
        (np.concatenate(values), entries),
        shape=(problem.contacts.n_forces, problem.n_dofs),
    )
