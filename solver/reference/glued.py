"""Displacements seen from the contacts: what jumps make, and what moves where nothing jumps.

Every jump is the displacement of one degree of freedom, or of one minus another. So
jumps join degrees of freedom to trees, and the ground is a root. A displacement is u =
T j + Z a: a moves each tree as one, the structure glued at its contacts, and j are the
jumps along its branches.

Where contacts join bodies in a ring, jumps depend on each other, and some of their
forces balance each other: at a broken wire, say, both of its new ends rub on the
neighbours left and right, four jumps between four points. These forces are not
determinate.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.cluster.hierarchy import DisjointSet
from scipy.sparse.csgraph import breadth_first_order, connected_components

from solver.arrays import Array, Flags, Indices, sparse_factor

NONE = 1e-9
"""Eigenvalue of J J', whose entries are whole numbers, and share of a force that count
as zero."""


def graph_of(jumps: sparse.csr_array) -> tuple[Indices, Indices]:
    """The two points that every jump is between, the last of all the ground, smaller first."""
    ground = jumps.shape[1]
    first = jumps.indices[jumps.indptr[:-1]]
    last = np.where(
        np.diff(jumps.indptr) == 2, jumps.indices[jumps.indptr[1:] - 1], ground
    )
    return np.minimum(first, last), np.maximum(first, last)


def trees_of(edges: tuple[Indices, Indices], ground: int) -> tuple[int, Indices]:
    """Count the trees that edges join points to, and number the tree of every point."""
    size = len(edges[0])
    links = sparse.csr_array((np.ones(size), edges), shape=(ground + 1, ground + 1))
    count, number = connected_components(links, directed=False)
    return int(count), number


def _is_forest(jumps: sparse.csr_array) -> bool:
    """Whether there is no ring: no jump that depends on others."""
    size, ground = jumps.shape
    trees, _ = trees_of(graph_of(jumps), ground)
    return bool(size + trees == ground + 1)


def from_jumps(jumps: sparse.csr_array) -> tuple[sparse.csr_array, sparse.csr_array]:
    """T and Z.

    Parameters
    ----------
    jumps
        J, shape (n_jumps, n_dofs), +1 and -1 or one of these in a row. Where jumps
        depend on each other, each in a ring of them, T has nothing for those that
        follow from others.

    Returns
    -------
    T, shape (n_dofs, n_jumps), with J T = I but for such jumps, and Z, shape (n_dofs, n_trees) for
    the trees that do not stand on the ground, with J Z = 0.
    """
    ground = jumps.shape[1]
    edges = graph_of(jumps)
    count, number = trees_of(edges, ground)
    _, roots = np.unique(number, return_index=True)
    standing = number[ground]
    roots[standing] = ground
    points = np.arange(ground)
    whole = sparse.csr_array((np.ones(ground), (points, number[:-1])), (ground, count))
    return _along_branches(jumps, edges, roots), whole[:, np.arange(count) != standing]


def _along_branches(
    jumps: sparse.csr_array, edges: tuple[Indices, Indices], roots: Indices
) -> sparse.csr_array:
    """Move all that is beyond a jump, seen from the root of its tree."""
    size, ground = jumps.shape
    # Every root hangs on the ground, so that one search meets all points.
    others = roots[roots != ground]
    rows = np.concatenate([edges[0], others])
    ends = np.concatenate([edges[1], np.full(len(others), ground)])
    links = sparse.csr_array(
        (np.ones(len(rows)), (rows, ends)), shape=(ground + 1, ground + 1)
    )
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
    beyond = sparse.csr_array(
        (ones, (points[held], parents[held])), shape=(ground, ground)
    )
    moved = step
    while step.nnz:
        step = sparse.csr_array(beyond @ step)
        moved = moved + step
    return sparse.csr_array(moved)


def self_stresses(jumps: sparse.csr_array, rigid: Flags) -> Array:
    """Forces that move nothing, an orthonormal basis of shape (n_jumps, n_stresses).

    Parameters
    ----------
    jumps
        Each of one degree of freedom, or of one minus another, shape (n_jumps, n_dofs).
    rigid
        Jumps with nothing in series, shape (n_jumps,): what has tells its own force.
    """
    size = len(rigid)
    places = np.flatnonzero(rigid)
    jumps = jumps[places]
    if _is_forest(jumps):
        return np.zeros((size, 0))
    products = sparse.csr_array(jumps @ jumps.T)
    _, group = connected_components(products, directed=False)
    stresses = []
    for number in np.flatnonzero(_rings(jumps, group)):
        members = np.flatnonzero(group == number)
        values, vectors = np.linalg.eigh(products[members][:, members].toarray())
        null = vectors[:, values < NONE]
        whole = np.zeros((size, null.shape[1]))
        whole[places[members]] = np.where(np.abs(null) > NONE, null, 0.0)
        stresses.append(whole)
    return np.concatenate(stresses, axis=1)


def base_of(jumps: sparse.csr_array, rigid: Flags) -> tuple[Indices, sparse.csr_array]:
    """Jumps from which those with something in series follow, where they depend on others.

    Parameters
    ----------
    jumps, rigid
        As `self_stresses`.

    Returns
    -------
    The base, shape (n_base,): all rigid jumps, and of the others as many as are independent. And
    what all jumps are of them, shape (n_jumps, n_base).
    """
    size = len(rigid)
    if rigid.all() or _is_forest(jumps):
        return np.arange(size), sparse.csr_array(sparse.eye_array(size))
    first, last = (points.tolist() for points in graph_of(jumps))
    forest = DisjointSet(range(jumps.shape[1] + 1))
    rigid_first = np.argsort(~rigid, kind="stable").tolist()
    tree_jumps = np.array(
        [jump for jump in rigid_first if forest.merge(first[jump], last[jump])]
    )
    base = np.union1d(np.flatnonzero(rigid), tree_jumps)
    others = np.setdiff1d(np.arange(size), base)
    branches = jumps[tree_jumps]
    squares = sparse_factor(sparse.csc_array(branches @ branches.T))
    paths = squares.solve((branches @ jumps[others].T).toarray())
    rows = np.concatenate([base, np.repeat(others, len(tree_jumps))])
    places = np.searchsorted(base, tree_jumps)
    columns = np.concatenate([np.arange(len(base)), np.tile(places, len(others))])
    values = np.concatenate([np.ones(len(base)), np.round(paths).T.ravel()])
    ties = sparse.csr_array((values, (rows, columns)), shape=(size, len(base)))
    ties.eliminate_zeros()
    return base, ties


def _rings(jumps: sparse.csr_array, group: Indices) -> Indices:
    """Count the rings in every group of jumps that share points: edges beyond those of a tree."""
    _, at = np.unique(jumps.indices, return_index=True)
    of_entries = np.repeat(group, np.diff(jumps.indptr))
    edges = np.bincount(group)
    nodes = np.bincount(of_entries[at], minlength=len(edges))
    nodes[np.unique(group[np.diff(jumps.indptr) == 1])] += 1  # the ground is one more
    return np.asarray(edges - nodes + 1)
