"""Displacements seen from the contacts: what jumps make, and what moves where nothing jumps.

Every jump is the displacement of one degree of freedom, or of one minus another. So jumps join
degrees of freedom to trees, and the ground is a root. A displacement is u = T j + Z a: a moves each
tree as one, the structure glued at its contacts, and j are the jumps along its branches.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, connected_components

from solver.arrays import Indices
from solver.discrete.problem import Problem


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


def graph_of(jumps: sparse.csr_array) -> tuple[Indices, Indices]:
    """Give the two points that every jump is between, the last of all the ground, smaller first."""
    ground = jumps.shape[1]
    first = jumps.indices[jumps.indptr[:-1]]
    last = np.where(np.diff(jumps.indptr) == 2, jumps.indices[jumps.indptr[1:] - 1], ground)
    return np.minimum(first, last), np.maximum(first, last)


def trees_of(edges: tuple[Indices, Indices], ground: int) -> tuple[int, Indices]:
    """Count the trees that edges join points to, and number the tree of every point."""
    size = len(edges[0])
    links = sparse.csr_array((np.ones(size), edges), shape=(ground + 1, ground + 1))
    count, number = connected_components(links, directed=False)
    return int(count), number


def from_jumps(jumps: sparse.csr_array) -> tuple[sparse.csr_array, sparse.csr_array]:
    """Give T and Z.

    Parameters
    ----------
    jumps
        J, shape (n_jumps, n_dofs), +1 and -1 or one of these in a row. Where jumps depend on each
        other, each in a ring of them, T has nothing for those that follow from others.

    Returns
    -------
    T, shape (n_dofs, n_jumps), with J T = I but for such jumps, and Z, shape (n_dofs, n_trees) for
    the trees that do not stand on the ground, with J Z = 0.
    """
    size, ground = jumps.shape
    edges = graph_of(jumps)
    count, number = trees_of(edges, ground)
    _, root = np.unique(number, return_index=True)
    root[number[ground]] = ground
    own = number[:ground] != number[ground]
    columns = number[:ground] - (number[:ground] > number[ground])
    moves = sparse.csr_array(
        (np.ones(np.count_nonzero(own)), (np.flatnonzero(own), columns[own])),
        shape=(ground, count - 1),
    )
    # Every root hangs on the ground, so that one search meets all points.
    rows = np.concatenate([edges[0], root[root != ground]])
    ends = np.concatenate([edges[1], np.full(count - 1, ground)])
    links = sparse.csr_array((np.ones(len(rows)), (rows, ends)), shape=(ground + 1, ground + 1))
    order, parent = breadth_first_order(links, ground, directed=False)
    point = np.setdiff1d(order, root)
    parent = parent[point]
    above = np.minimum(point, parent), np.maximum(point, parent)
    keys, edge = np.unique(edges[0] * (ground + 1) + edges[1], return_index=True)
    branch = edge[np.searchsorted(keys, above[0] * (ground + 1) + above[1])]
    signs = np.asarray(jumps[branch, point]).ravel()
    step = sparse.csr_array((signs, (point, branch)), shape=(ground, size))
    held = parent < ground
    back = sparse.csr_array(
        (np.ones(np.count_nonzero(held)), (point[held], parent[held])), shape=(ground, ground)
    )
    found = step
    while step.nnz:
        step = sparse.csr_array(back @ step)
        found = found + step
    return sparse.csr_array(found), moves
