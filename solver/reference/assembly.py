"""The whole structure as one: stiffness and load that every incremental solver starts from."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.arrays import Array, space_time
from solver.discrete.problem import Problem


def assembled_stiffness(problem: Problem) -> sparse.csr_array:
    """Give K of the whole structure, shape (n_dofs, n_dofs), scaled."""
    entries: dict[int, sparse.coo_array] = {}
    for part in problem.substructures:
        if id(part.elasticity) not in entries:
            entries[id(part.elasticity)] = sparse.coo_array(part.elasticity.stiffness)
    parts = [(part.dofs, entries[id(part.elasticity)]) for part in problem.substructures]
    rows, columns = (
        np.concatenate([dofs[own.coords[axis]] for dofs, own in parts]) for axis in (0, 1)
    )
    values = np.concatenate([own.data for _, own in parts])
    return sparse.csr_array((values, (rows, columns)), shape=(problem.n_dofs, problem.n_dofs))


def external_force(problem: Problem) -> Array:
    """Give the forces on the whole structure, shape (n_dofs, n_instants), scaled."""
    total = space_time(problem.n_dofs, problem.n_instants)
    for part in problem.substructures:
        if part.body_force is not None:
            np.add.at(total, part.dofs, part.body_force)
    for given in problem.given_forces:
        np.add.at(total, problem.row_dofs[given.rows], given.values)
    return total
