"""Contact forces that balance each other, where contacts join bodies in a ring.

At a broken wire, say, both of its new ends rub on the neighbours left and right: four jumps between
four points. Then the jumps depend on each other, and their forces are not all determinate.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree
from scipy.sparse.linalg import splu

from solver.arrays import Array, Indices
from solver.reference.glued import graph_of, trees_of

NONE = 1e-9
"""Eigenvalue of J J', whose entries are whole numbers, and share of a force that count as zero."""


def self_stresses(jumps: sparse.csr_array, rigid: NDArray[np.bool_]) -> Array:
    """Give forces that move nothing, an orthonormal basis of shape (n_jumps, n_stresses).

    Parameters
    ----------
    jumps
        Each of one degree of freedom, or of one minus another, shape (n_jumps, n_dofs).
    rigid
        Jumps with nothing in series, shape (n_jumps,): what has tells its own force.
    """
    found = _of_rigid(jumps[np.flatnonzero(rigid)])
    whole = np.zeros((len(rigid), found.shape[1]))
    whole[rigid] = found
    return whole


def base_of(jumps: sparse.csr_array, rigid: NDArray[np.bool_]) -> tuple[Indices, sparse.csr_array]:
    """Find jumps from which those with something in series follow, where they depend on others.

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
    edges = graph_of(jumps)
    trees, _ = trees_of(edges, jumps.shape[1])
    if rigid.all() or size + trees == jumps.shape[1] + 1:  # a forest: no ring
        return np.arange(size), sparse.csr_array(sparse.eye_array(size))
    dear = np.where(rigid, 1.0, 2.0)
    first, last = edges
    # Of edges that join the same two points SciPy would take the sum of both for one.
    order = np.lexsort((np.arange(size), dear, last, first))
    new = np.ones(size, dtype=bool)
    new[1:] = np.any(np.diff(np.stack(edges)[:, order], axis=1) != 0, axis=0)
    single = order[new]
    nodes = jumps.shape[1] + 1
    weights = sparse.csr_array((dear[single], (first[single], last[single])), shape=(nodes, nodes))
    tree = minimum_spanning_tree(weights).tocoo()
    number = sparse.csr_array((single + 1, (first[single], last[single])), shape=(nodes, nodes))
    own = np.asarray(number[tree.coords[0], tree.coords[1]]).ravel() - 1
    base = np.union1d(np.flatnonzero(rigid), own)
    others = np.setdiff1d(np.arange(size), base)
    branches = jumps[own]
    squares = splu(sparse.csc_array(branches @ branches.T))
    paths = squares.solve((branches @ jumps[others].T).toarray())
    rows = np.concatenate([base, np.repeat(others, len(own))])
    places = np.searchsorted(base, own)
    columns = np.concatenate([np.arange(len(base)), np.tile(places, len(others))])
    values = np.concatenate([np.ones(len(base)), np.round(paths).T.ravel()])
    ties = sparse.csr_array((values, (rows, columns)), shape=(size, len(base)))
    ties.eliminate_zeros()
    return base, ties


def _of_rigid(jumps: sparse.csr_array) -> Array:
    size, ground = jumps.shape
    trees, _ = trees_of(graph_of(jumps), ground)
    if size + trees == ground + 1:  # a forest: no ring
        return np.zeros((size, 0))
    products = sparse.csr_array(jumps @ jumps.T)
    _, group = connected_components(products, directed=False)
    found = []
    for number in np.flatnonzero(_rings(jumps, group)):
        members = np.flatnonzero(group == number)
        values, vectors = np.linalg.eigh(products[members][:, members].toarray())
        own = vectors[:, values < NONE]
        whole = np.zeros((size, own.shape[1]))
        whole[members] = np.where(np.abs(own) > NONE, own, 0.0)
        found.append(whole)
    return np.concatenate(found, axis=1)


def _rings(jumps: sparse.csr_array, group: Indices) -> Indices:
    """Count the rings in every group of jumps that share points: edges beyond those of a tree."""
    _, at = np.unique(jumps.indices, return_index=True)
    of_entries = np.repeat(group, np.diff(jumps.indptr))
    edges = np.bincount(group)
    nodes = np.bincount(of_entries[at], minlength=len(edges))
    nodes[np.unique(group[np.diff(jumps.indptr) == 1])] += 1  # the ground is one more
    return np.asarray(edges - nodes + 1)
