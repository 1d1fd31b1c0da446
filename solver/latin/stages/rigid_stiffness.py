"""Stiffness of rigid bodies on the springs of contacts, as a band matrix."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.linalg.lapack import dgbtrf, dgbtrs
from scipy.sparse.csgraph import reverse_cuthill_mckee

from solver.arrays import Array, Indices

DENSE_UP_TO = 30_000
"""Entries of a matrix up to which its dense product with one column is no slower than
the sparse one (measured)."""


class RigidContacts(NamedTuple):
    """Pairs of contacts between rigid bodies; all scaled.

    Attributes
    ----------
    jumps
        Jumps across all pairs, then along them, that motions of the bodies make, shape
        (2 n_pairs, n_motions).
    compliance
        Compliance of the springs across and along, shape (2 n_pairs,).
    gap, friction
        Opening between undeformed bodies, and coefficient of friction, (n_pairs,).
    """

    jumps: sparse.csr_array
    compliance: Array
    gap: Array
    friction: Array


class Product:
    """Product of a sparse matrix with fields of motions or forces.

    Parameters
    ----------
    matrix
        The matrix, shape (n_out, n_in).
    """

    def __init__(self, matrix: sparse.csr_array) -> None:
        self._sparse = matrix
        self._dense = None
        if np.prod(matrix.shape) <= DENSE_UP_TO:
            self._dense = matrix.toarray()

    def __call__(self, field: Array) -> Array:
        """Product with a field, (n_in, n_instants); (n_out, n_instants)."""
        if self._dense is not None and field.shape[1] == 1:
            return np.asarray(self._dense @ field)
        return np.asarray(self._sparse @ field)


class BandStiffness:
    """Stiffness against all motions for any statuses of the pairs.

    Bodies are renumbered so that those that touch have numbers near each other, which
    makes the matrix a band. Its entries are a linear map of the stiffnesses of pairs.

    Parameters
    ----------
    contacts
        The contacts.
    constant
        Stiffness of what neither opens nor slips, (n_motions, n_motions), scaled.
    holding
        Stiffness of springs at all rows against each motion, (n_motions,), scaled.
    """

    def __init__(
        self, contacts: RigidContacts, constant: sparse.csr_array, holding: Array
    ) -> None:
        size = len(contacts.gap)
        across = contacts.jumps[:size]
        along = contacts.jumps[size:]
        touched = abs(contacts.jumps)
        pattern = sparse.csr_array(touched.T @ touched + abs(constant))
        self._order = np.asarray(reverse_cuthill_mckee(pattern, symmetric_mode=True))
        self._place = np.argsort(self._order)
        rows, columns = pattern.nonzero()
        apart = np.abs(self._place[rows] - self._place[columns])
        self._width = int(apart.max(initial=0))
        # LAPACK's band has room above it for what pivoting fills.
        self._shape = 3 * self._width + 1, len(self._place)
        entries = sparse.coo_array(constant)
        places = self._flat(*entries.coords)
        self._constant = np.zeros(self._shape[0] * self._shape[1])
        np.add.at(self._constant, places, entries.data)
        motions = np.arange(len(holding))
        self._holding = holding
        self._diagonal = self._flat(motions, motions)
        parts = [
            self._entries(across, across),
            self._entries(along, along),
            self._entries(along, across),
        ]
        self._of_pairs = sparse.csr_array(sparse.hstack(parts))

    def _flat(self, rows: Indices, columns: Indices) -> Indices:
        """Indices of entries in the band, column after column, (n,)."""
        row = self._place[rows]
        column = self._place[columns]
        return np.asarray(2 * self._width + row - column + self._shape[0] * column)

    def _entries(
        self, left: sparse.csr_array, right: sparse.csr_array
    ) -> sparse.csr_array:
        """Map from stiffnesses s, (n_pairs,), to the band entries of left^T s right."""
        rows = np.repeat(np.arange(left.shape[0]), np.diff(left.indptr))
        # Each entry on the left meets all those of its row on the right.
        repeats = np.diff(right.indptr)[rows]
        first = np.repeat(np.arange(left.nnz), repeats)
        begins = np.repeat(np.cumsum(repeats) - repeats, repeats)
        second = right.indptr[rows[first]] + np.arange(len(first)) - begins
        values = left.data[first] * right.data[second]
        places = self._flat(left.indices[first], right.indices[second])
        size = self._shape[0] * self._shape[1]
        return sparse.csr_array((values, (places, rows[first])), (size, left.shape[0]))

    def factored(self, stiffnesses: Array, held: float) -> BandFactors:
        """Factor the matrices of some instants.

        Stiffnesses of the pairs are those across, those along, and those of friction
        against overlap, (3 n_pairs, n_instants). A share `held` of the springs at all
        rows holds every motion.
        """
        entries = np.ascontiguousarray((self._of_pairs @ stiffnesses).T)
        entries += self._constant
        entries[:, self._diagonal] += held * self._holding
        # The band of one instant after that of the other: nothing couples them.
        band = entries.reshape(-1, self._shape[0]).T
        width = self._width
        factors, pivots, _ = dgbtrf(band, width, width, overwrite_ab=True)
        return BandFactors(factors, pivots, width, self._order)


class BandFactors(NamedTuple):
    """Factors of the stiffness at some instants.

    Attributes
    ----------
    factors
        Bands of the factors, one instant after the other, shape (3 width + 1,
        n_instants n_motions).
    pivots
        Rows that pivots were found in, shape (n_instants n_motions,).
    width
        Number of diagonals on either side.
    order
        Indices of the motions in the order of the band, shape (n_motions,).
    """

    factors: Array
    pivots: Indices
    width: int
    order: Indices

    def solve(self, right: Array) -> Array:
        """Solve at all instants, shape of the right side: (n_motions, n_instants)."""
        stacked = np.ascontiguousarray(right[self.order].T).ravel()
        solved, _ = dgbtrs(self.factors, self.width, self.width, stacked, self.pivots)
        motions = np.empty_like(right)
        motions[self.order] = solved.reshape(right.shape[1], -1).T
        return motions

    def solve_at(self, instant: int, right: Array) -> Array:
        """Solve at one instant, shape of the right side: (n_motions,)."""
        size = len(right)
        first = instant * size
        solved, _ = dgbtrs(
            self.factors[:, first : first + size],
            self.width,
            self.width,
            right[self.order],
            self.pivots[first : first + size] - first,
        )
        motions = np.empty_like(right)
        motions[self.order] = solved
        return motions
