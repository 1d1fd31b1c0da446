"""Displacements as functions of jumps and of motions glued at the contacts.

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
import scipy
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, connected_components

from solver.arrays import Array, Flags, Indices, linked, ones_at, sparse_factor

NONE = 1e-9
"""Eigenvalue of J J', whose entries are whole numbers, and share of a force, that count
as zero."""


def graph_of(jumps: sparse.csr_array) -> tuple[Indices, Indices]:
    """Graph of the jumps: the two points of each, smaller first, (n_jumps,) each.

    The ground is the last point of all.
    """
    ground = jumps.shape[1]
    first = jumps.indices[jumps.indptr[:-1]]
    last = np.where(
        np.diff(jumps.indptr) == 2, jumps.indices[jumps.indptr[1:] - 1], ground
    )
    return np.minimum(first, last), np.maximum(first, last)


def _is_forest(jumps: sparse.csr_array) -> bool:
    """Check whether jumps form no ring, so that all are independent."""
    size, ground = jumps.shape
    trees, _ = linked(*graph_of(jumps), ground + 1)
    return bool(size + trees == ground + 1)


def from_jumps(jumps: sparse.csr_array) -> tuple[sparse.csr_array, sparse.csr_array]:
    """Matrices T of the jumps and Z of the trees, with u = T j + Z a.

    Parameters
    ----------
    jumps
        J, shape (n_jumps, n_dofs), +1 and -1 or one of these in a row. Where jumps
        depend on each other, each in a ring of them, T has nothing for those that
        follow from others.

    Returns
    -------
    T, shape (n_dofs, n_jumps), with J T = I but for such jumps, and Z, shape (n_dofs,
    n_trees) for the trees that do not stand on the ground, with J Z = 0.
    """
    ground = jumps.shape[1]
    edges = graph_of(jumps)
    count, number = linked(*edges, ground + 1)
    # The first point of a tree is its root, but the ground that of its own.
    _, roots = np.unique(number, return_index=True)
    standing = number[ground]
    roots[standing] = ground
    whole = ones_at(np.arange(ground), number[:-1], (ground, count))
    return _along_branches(jumps, edges, roots), whole[:, np.arange(count) != standing]


def _along_branches(
    jumps: sparse.csr_array, edges: tuple[Indices, Indices], roots: Indices
) -> sparse.csr_array:
    """Displacements T: a jump moves all points beyond it, seen from the tree's root.

    Shape (n_dofs, n_jumps), of jumps (n_jumps, n_dofs), their points and the roots of
    all trees, (n_trees,).
    """
    size, ground = jumps.shape
    points, parents = _parents(edges, roots, ground)
    branches = _branches(edges, points, parents, ground)
    signs = np.asarray(jumps[branches, points]).ravel()
    step = sparse.csr_array((signs, (points, branches)), shape=(ground, size))
    held = parents < ground
    beyond = ones_at(points[held], parents[held], (ground, ground))
    # Each pass hands the motion of all points to the points that hang on them.
    moved = step
    while step.nnz:
        step = sparse.csr_array(beyond @ step)
        moved = moved + step
    return sparse.csr_array(moved)


def _parents(
    edges: tuple[Indices, Indices], roots: Indices, ground: int
) -> tuple[Indices, Indices]:
    """Points that are no roots, and the parent of each in its tree, (n,) both."""
    # Every root hangs on the ground, so that one search meets all points.
    others = roots[roots != ground]
    rows = np.concatenate([edges[0], others])
    ends = np.concatenate([edges[1], np.full(len(others), ground)])
    links = ones_at(rows, ends, (ground + 1, ground + 1))
    order, parents = breadth_first_order(links, ground, directed=False)
    points = np.setdiff1d(order, roots)
    return points, parents[points]


def _branches(
    edges: tuple[Indices, Indices], points: Indices, parents: Indices, ground: int
) -> Indices:
    """First jump between each point and its parent, (n,) all."""
    # An edge has one number, by its two points, so that edges are found by a search.
    keys, first = np.unique(edges[0] * (ground + 1) + edges[1], return_index=True)
    wanted = np.minimum(points, parents) * (ground + 1) + np.maximum(points, parents)
    return np.asarray(first[np.searchsorted(keys, wanted)])


def self_stresses(jumps: sparse.csr_array, rigid: Flags) -> Array:
    """Orthonormal self-stresses: forces that move nothing, (n_jumps, n_stresses).

    Parameters
    ----------
    jumps
        Each of one degree of freedom, or of one minus another, shape (n_jumps, n_dofs).
    rigid
        Jumps with nothing in series, shape (n_jumps,): the force of others is
        determinate.
    """
    size = len(rigid)
    places = np.flatnonzero(rigid)
    jumps = jumps[places]
    if _is_forest(jumps):
        return np.zeros((size, 0))
    # Jumps that share a point are coupled, so each ring has a small matrix of its own.
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
    """Base of the jumps: independent jumps that determine all others.

    Parameters
    ----------
    jumps, rigid
        As `self_stresses`.

    Returns
    -------
    The base, shape (n_base,): all rigid jumps, and of the others as many as are
    independent. And the matrix from jumps of the base to all, shape (n_jumps, n_base).
    """
    size = len(rigid)
    if rigid.all() or _is_forest(jumps):
        return np.arange(size), sparse.csr_array(sparse.eye_array(size))
    tree_jumps = _spanning(jumps, rigid)
    base = np.union1d(np.flatnonzero(rigid), tree_jumps)
    others = np.setdiff1d(np.arange(size), base)
    # A jump outside the trees is the sum of those along the path between its points.
    branches = jumps[tree_jumps]
    squares = sparse_factor(sparse.csc_array(branches @ branches.T))
    paths = squares.solve((branches @ jumps[others].T).toarray())
    rows = np.concatenate([base, np.repeat(others, len(tree_jumps))])
    places = np.searchsorted(base, tree_jumps)
    columns = np.concatenate([np.arange(len(base)), np.tile(places, len(others))])
    # Paths follow jumps forward or backward: whole numbers up to rounding.
    values = np.concatenate([np.ones(len(base)), np.round(paths).T.ravel()])
    ties = sparse.csr_array((values, (rows, columns)), shape=(size, len(base)))
    ties.eliminate_zeros()
    return base, ties


def _spanning(jumps: sparse.csr_array, rigid: Flags) -> Indices:
    """Jumps of spanning trees, preferably rigid ones, (n_tree_jumps,)."""
    first, last = graph_of(jumps)
    forest = scipy.cluster.hierarchy.DisjointSet(range(jumps.shape[1] + 1))
    chosen = []
    # Kruskal's algorithm, with the rigid jumps as the lightest edges.
    for jump in np.argsort(~rigid, kind="stable").tolist():
        if forest.merge(int(first[jump]), int(last[jump])):
            chosen.append(jump)
    return np.array(chosen)


def _rings(jumps: sparse.csr_array, group: Indices) -> Indices:
    """Number of rings in every group of jumps that share points, (n_groups,).

    A ring is an edge beyond those of a tree; groups have the shape (n_jumps,).
    """
    _, at = np.unique(jumps.indices, return_index=True)
    of_entries = np.repeat(group, np.diff(jumps.indptr))
    edges = np.bincount(group)
    nodes = np.bincount(of_entries[at], minlength=len(edges))
    # The ground is one more node.
    nodes[np.unique(group[np.diff(jumps.indptr) == 1])] += 1
    return np.asarray(edges - nodes + 1)
