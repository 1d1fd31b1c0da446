"""The whole structure as one: stiffness and load that every incremental solver starts from."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices, space_time
from solver.discrete.problem import Problem


def assembled_stiffness(problem: Problem) -> sparse.csr_array:
    """Stiffness K of the whole structure, shape (n_dofs, n_dofs), scaled."""
    entries: dict[int, sparse.coo_array] = {}
    for part in problem.substructures:
        if id(part.elasticity) not in entries:
            entries[id(part.elasticity)] = sparse.coo_array(part.elasticity.stiffness)
    parts = [(part.dofs, entries[id(part.elasticity)]) for part in problem.substructures]
    rows, columns = (
        np.concatenate([dofs[matrix.coords[axis]] for dofs, matrix in parts]) for axis in (0, 1)
    )
    values = np.concatenate([matrix.data for _, matrix in parts])
    return sparse.csr_array((values, (rows, columns)), shape=(problem.n_dofs, problem.n_dofs))


def external_force(problem: Problem) -> Array:
    """Forces on the whole structure, shape (n_dofs, n_instants), scaled."""
    total = space_time(problem.n_dofs, problem.n_instants)
    for part in problem.substructures:
        if part.body_force is not None:
            np.add.at(total, part.dofs, part.body_force)
    for given in problem.given_forces:
        np.add.at(total, problem.row_dofs[given.rows], given.values)
    return total


def points_dofs(problem: Problem) -> Indices:
    """Degree of freedom under every point that rubs, stacked interface by interface."""
    dofs = []
    for law in problem.rubbing.values():
        under = np.zeros(len(law.positions), dtype=np.intp)
        under[law.points] = problem.row_dofs[law.tangent.above]
        dofs.append(under)
    return np.concatenate(dofs)
