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
    ground = jumps.shape[1]
    edges = graph_of(jumps)
    _, number = trees_of(edges, ground)
    _, roots = np.unique(number, return_index=True)
    roots[number[ground]] = ground
    return _along_branches(jumps, edges, roots), _of_whole_trees(number)


def _of_whole_trees(number: Indices) -> sparse.csr_array:
    """Move every tree as one; `number` is the tree of every point, the last of all the ground."""
    trees, standing = number[:-1], number[-1]
    moved = np.flatnonzero(trees != standing)
    columns = trees[moved] - (trees[moved] > standing)
    return sparse.csr_array((np.ones(len(moved)), (moved, columns)), (len(trees), number.max()))


def _along_branches(
    jumps: sparse.csr_array, edges: tuple[Indices, Indices], roots: Indices
) -> sparse.csr_array:
    """Move all that is beyond a jump, seen from the root of its tree."""
    size, ground = jumps.shape
    # Every root hangs on the ground, so that one search meets all points.
    others = roots[roots != ground]
    rows = np.concatenate([edges[0], others])
    ends = np.concatenate([edges[1], np.full(len(others), ground)])
    links = sparse.csr_array((np.ones(len(rows)), (rows, ends)), shape=(ground + 1, ground + 1))
    order, parents = breadth_first_order(links, ground, directed=False)
    points = np.setdiff1d(order, roots)
    parents = parents[points]
    keys, first = np.unique(edges[0] * (ground + 1) + edges[1], return_index=True)
    wanted = np.minimum(points, parents) * (ground + 1) + np.maximum(points, parents)
    branches = first[np.searchsorted(keys, wanted)]
    signs = np.asarray(jumps[branches, points]).ravel()
    step = sparse.csr_array((signs, (points, branches)), shape=(ground, size))
    held = parents < ground
    ones = np.ones(np.count_nonzero(held))
    beyond = sparse.csr_array((ones, (points[held], parents[held])), shape=(ground, ground))
    found = step
    while step.nnz:
        step = sparse.csr_array(beyond @ step)
        found = found + step
    return sparse.csr_array(found)
