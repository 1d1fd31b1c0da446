"""Contact forces that balance each other, where contacts join bodies in a ring.

At a broken wire, say, both of its new ends rub on the neighbours left and right: four jumps between
four points. Then the jumps depend on each other, and their forces are not all determinate.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from solver.arrays import Array

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


def _of_rigid(jumps: sparse.csr_array) -> Array:
    size, ground = jumps.shape
    first = jumps.indices[jumps.indptr[:-1]]
    last = np.where(np.diff(jumps.indptr) == 2, jumps.indices[jumps.indptr[1:] - 1], ground)
    edges = sparse.csr_array((np.ones(size), (first, last)), shape=(ground + 1, ground + 1))
    trees, _ = connected_components(edges, directed=False)
    if size + trees == ground + 1:  # a forest: no ring
        return np.zeros((size, 0))
    products = sparse.csr_array(jumps @ jumps.T)
    _, group = connected_components(products, directed=False)
    found = []
    for members in np.split(np.argsort(group, kind="stable"), np.cumsum(np.bincount(group))[:-1]):
        values, vectors = np.linalg.eigh(products[members][:, members].toarray())
        own = vectors[:, values < NONE]
        whole = np.zeros((size, own.shape[1]))
        whole[members] = np.where(np.abs(own) > NONE, own, 0.0)
        found.append(whole)
    return np.concatenate(found, axis=1)
