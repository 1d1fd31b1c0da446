"""Stiffness of rigid bodies on the springs of contacts, as a band matrix."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.linalg.lapack import dgbsv
from scipy.sparse.csgraph import reverse_cuthill_mckee

from solver.arrays import Array, Indices


class RigidContacts(NamedTuple):
    """Pairs of contacts, as rigid bodies see them; all scaled.

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
        """Places of entries in the band, column after column, (n,)."""
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

    def solve(self, stiffnesses: Array, right: Array, held: float) -> Array:
        """Solve for the motions, shape (n_motions,), scaled.

        Stiffnesses of the pairs are those across, those along, and those of friction
        against overlap, (3 n_pairs,); the right side has the shape (n_motions,). A
        share `held` of the springs at all rows holds every motion.
        """
        band = self._constant + self._of_pairs @ stiffnesses
        band[self._diagonal] += held * self._holding
        matrix = band.reshape(self._shape, order="F")
        width = self._width
        solved = dgbsv(width, width, matrix, right[self._order], overwrite_ab=True)
        motions = np.empty_like(right)
        motions[self._order] = solved[2]
        return motions
