"""Stiffness condensed onto some of its degrees of freedom."""

from __future__ import annotations

from copy import copy
from functools import cached_property, partial

import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import SuperLU

from solver.arrays import Array, Indices, separated, space_time, sparse_factor

ENTRY = 12
"""Memory of an entry of a sparse factor, with its place, B."""
MANY = 500
MORE = 2
"""Degrees of freedom inside, and the same over those that are kept, from which on one
factor of both costs less than a solution for each that is kept. A wire of 2450 and 136
is condensed in 7 ms instead of 19, a rectangle of 500 and 140 in 3 instead of 7, one of
240 and 100 in 1.5 instead of 2, a line of beams of 250 and 500 in 30 instead of 5."""
SOME = 50
"""Degrees of freedom that are kept, up to which their solutions cost less than that."""
WIDE = 3
"""Size of the last block of the factor, over that of the kept ones, up to which it is
taken; of wires it is 1.2 to 1.3."""
FEW = 16
"""Degrees of freedom that are kept, over columns, from which on these are solved for by
themselves. Of 37 wires that takes 24 ms for one instant, 310 for 41 of them; by the
response, which is made once in 200 ms, 15 and 110 (measured)."""
DENSE = 10_000_000
"""Multiplications of a product up to which a few entries are multiplied as quickly
among all zeros."""


class FewEliminated:
    """Elimination by factors of the block of eliminated degrees of freedom.

    Parameters
    ----------
    inner
        Stiffness of the rest, (n_rest, n_rest), dense or sparse.
    coupling
        Its coupling with the kept ones, (n_rest, n_kept).

    Raises
    ------
    np.linalg.LinAlgError
        For a dense stiffness that could move while the kept ones are held.
    """

    def __init__(self, inner: sparse.csc_array | Array, coupling: Array) -> None:
        if isinstance(inner, np.ndarray):
            self._solve = partial(cho_solve, cho_factor(inner))
            self._factor_nbytes = inner.nbytes
        else:
            factor = sparse_factor(sparse.csc_array(inner))
            self._solve = factor.solve
            self._factor_nbytes = ENTRY * factor.nnz
        self.response: Array = self._solve(coupling)

    @property
    def nbytes(self) -> int:
        """Memory of factor and response, B."""
        return self._factor_nbytes + self.response.nbytes

    def condense(self, force: Array) -> Array:
        """Condense forces, (..., n_rest, n_columns), onto the kept degrees of freedom.

        Negative, of shape (..., n_kept, n_columns).
        """
        return np.asarray(self.response.T @ force)

    def recover(self, kept: Array, force: Array | None) -> Array:
        """Displacement of eliminated degrees of freedom, (n_rest, n_columns), scaled.

        From that of the kept ones, (n_kept, n_columns), and forces inside, (n_rest,
        n_columns), or None.
        """
        rest = -(self.response @ kept)
        if force is not None:
            rest += self._solve(force)
        return rest


class ManyEliminated:
    """Elimination by factors of the whole sparse stiffness with springs.

    The last block of the factor is the stiffness that is left when all before it are
    eliminated. An ordering by degree takes the kept degrees of freedom last, as entries
    between all of them tie each to all others. A few of the rest that are tied to as
    many may come among them, and are eliminated from the dense block. A body that can
    move has a singular stiffness: so each kept degree of freedom has a spring, which is
    subtracted from the block again.

    Parameters
    ----------
    factor
        Factor of the whole stiffness with the springs, (n, n).
    kept
        Degrees of freedom that are kept, (n_kept,).
    spring
        Stiffness of the springs.

    Attributes
    ----------
    condensed
        Stiffness of the kept ones, (n_kept, n_kept).
    """

    def __init__(self, factor: SuperLU, kept: Indices, spring: float) -> None:
        self._factor = factor
        self._kept = kept
        self._rest = _others(factor.shape[0], kept)
        places = factor.perm_c
        first = int(places[kept].min())
        lower = factor.L[first:, first:].toarray()
        block = lower @ factor.U[first:, first:].toarray()
        own = places[kept] - first
        between = _others(len(block), own)
        condensed = block[np.ix_(own, own)]
        if len(between):
            coupling = block[np.ix_(between, own)]
            inner = block[np.ix_(between, between)]
            condensed -= coupling.T @ cho_solve(cho_factor(inner), coupling)
        self._with_springs: Array = 0.5 * (condensed + condensed.T)
        self.condensed: Array = self._with_springs - spring * np.eye(len(kept))

    @classmethod
    def of(cls, whole: sparse.csc_array, kept: Indices) -> ManyEliminated | None:
        """Eliminate all but `kept` of a stiffness, (n, n); None where that is slower.

        It is slower for few degrees of freedom, and where many others come after the
        first that is kept, as in a body that has many more degrees of freedom.
        """
        count = len(kept)
        if count < SOME or whole.shape[0] - count < max(MANY, MORE * count):
            return None
        spring = float(whole.diagonal().max())
        factor = sparse_factor(
            _tied(whole, kept, spring),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        if len(factor.perm_c) - int(factor.perm_c[kept].min()) > WIDE * count:
            return None
        return cls(factor, kept, spring)

    @property
    def nbytes(self) -> int:
        """Memory of factor and response, B, including a response to be computed."""
        response = self._with_springs.itemsize * len(self._rest) * len(self._kept)
        factor = ENTRY * int(self._factor.nnz)
        return factor + response + self._with_springs.nbytes

    def condense(self, force: Array) -> Array:
        """Condensed forces with opposite sign, (..., n_kept, n_columns)."""
        together = force.reshape(-1, *force.shape[-2:])
        on_kept = [
            -self._with_springs @ self._sprung(of_one)[self._kept]
            for of_one in together
        ]
        return np.reshape(on_kept, (*force.shape[:-2], len(self._kept), -1))

    def recover(self, kept: Array, force: Array | None) -> Array:
        """Displacement of eliminated degrees of freedom, (n_rest, n_columns)."""
        further = kept
        rest = np.zeros((len(self._rest), kept.shape[1]))
        if force is not None:
            sprung = self._sprung(force)
            further = kept - sprung[self._kept]
            rest += sprung[self._rest]
        # A few columns cost less without the response.
        if FEW * kept.shape[1] < len(kept):
            return rest + self._pulled_along(further)
        return rest + self._response @ further

    @cached_property
    def _response(self) -> Array:
        """Matrix from kept to eliminated displacements, (n_rest, n_kept)."""
        return self._pulled_along(np.eye(len(self._kept)))

    def _pulled_along(self, kept: Array) -> Array:
        """Eliminated displacements, (n_rest, n), by kept ones, (n_kept, n)."""
        force = space_time(self._factor.shape[0], kept.shape[1])
        force[self._kept] = self._with_springs @ kept
        return np.asarray(self._factor.solve(force)[self._rest])

    def _sprung(self, force: Array) -> Array:
        """Displacement, (n, n_columns), with springs, by forces (n_rest, n_columns).

        The kept degrees of freedom are on springs.
        """
        # A load mostly is the same at all instants, but for its size.
        patterns, courses = separated(force)
        whole = np.zeros((self._factor.shape[0], patterns.shape[1]))
        whole[self._rest] = patterns
        return np.asarray(self._factor.solve(whole) @ courses)


class SchurComplement:
    """A symmetric stiffness condensed onto some of its degrees of freedom.

    The whole stiffness is sparse, (n, n), or has been condensed before. Those `kept`
    ascend, (n_kept,), and have the dense `stiffness`, shape (n_kept, n_kept), scaled.

    Raises
    ------
    np.linalg.LinAlgError
        For a stiffness condensed before that could move while the kept degrees of
        freedom are held.
    """

    def __init__(
        self, whole: sparse.csc_array | SchurComplement, kept: Indices
    ) -> None:
        self.kept = kept
        self._signs = np.ones(len(kept))
        self._before = None
        # Positions of the kept ones, and of the rest, in the whole stiffness.
        positions = kept
        stiffness: sparse.csc_array | Array
        if isinstance(whole, SchurComplement):
            self._before = whole
            # What was condensed before is condensed further: its inside is eliminated
            # already.
            stiffness = whole.stiffness
            positions = np.searchsorted(whole.kept, kept)
        else:
            stiffness = whole
        self._size = stiffness.shape[0]
        self._positions = positions
        self._rest = _others(self._size, positions)
        self._eliminated: FewEliminated | ManyEliminated | None = None
        many = None
        if not isinstance(stiffness, np.ndarray):
            many = ManyEliminated.of(stiffness, positions)
        if many is not None:
            self._eliminated = many
            condensed = many.condensed
        else:
            condensed = self._condensed_by_response(stiffness)
        self.stiffness: Array = condensed + condensed.T
        self.stiffness *= 0.5

    def _condensed_by_response(self, stiffness: sparse.csc_array | Array) -> Array:
        """Condense by a response in blocks: (n_kept, n_kept), from (n, n)."""
        positions = self._positions
        condensed = _dense(stiffness[positions][:, positions])
        if not len(self._rest):
            return condensed
        others = stiffness[self._rest]
        tied = others[:, positions]
        coupling = _dense(tied)
        few = FewEliminated(others[:, self._rest], coupling)
        self._eliminated = few
        if coupling.size * len(positions) < DENSE:
            tied = coupling
        condensed -= tied.T @ few.response
        return condensed

    def with_signs(self, signs: Array) -> SchurComplement:
        """Make the same stiffness with some degrees of freedom reversed.

        `signs` are -1 for these and 1 for others, (n_kept,). All but the condensed
        stiffness is shared. Not for a stiffness that was condensed before.
        """
        assert self._before is None
        turned = copy(self)
        turned._signs = self._signs * signs
        if np.any(signs < 0.0):
            turned.stiffness = signs[:, None] * self.stiffness
            turned.stiffness *= signs
        return turned

    @property
    def nbytes(self) -> int:
        """Memory of matrices and factors, also of an earlier condensation, B."""
        nbytes = self.stiffness.nbytes
        if self._eliminated is not None:
            nbytes += self._eliminated.nbytes
        if self._before is not None:
            nbytes += self._before.nbytes
        return nbytes

    def condense(self, force: Array) -> Array:
        """Condense forces, (..., n, n_columns), to (..., n_kept, n_columns)."""
        if self._before is not None:
            force = self._before.condense(force)
        on_kept = force.take(self._positions, axis=-2)
        if self._eliminated is not None:
            carried = self._eliminated.condense(force.take(self._rest, axis=-2))
            carried *= self._signs[:, None]
            on_kept -= carried
        return on_kept

    def recover(self, kept: Array, force: Array | None) -> Array:
        """Displacement of all degrees of freedom, shape (n, n_columns).

        From those that are kept, (n_kept, n_columns), and the forces on all, (n,
        n_columns), or None.
        """
        condensed = force
        if self._before is not None and force is not None:
            condensed = self._before.condense(force)
        whole = np.empty((self._size, kept.shape[1]))
        whole[self._positions] = kept
        if self._eliminated is not None:
            inside = None
            if condensed is not None:
                inside = np.ascontiguousarray(condensed[self._rest])
            turned = self._signs[:, None] * kept
            whole[self._rest] = self._eliminated.recover(turned, inside)
        if self._before is None:
            return whole
        return self._before.recover(whole, force)


def _others(count: int, some: Indices) -> Indices:
    """Integers from 0 to `count` - 1 except `some`, (n,), ascending: (count - n,)."""
    is_other = np.ones(count, dtype=bool)
    is_other[some] = False
    return np.flatnonzero(is_other)


def _tied(whole: sparse.csc_array, kept: Indices, spring: float) -> sparse.csc_array:
    """Stiffness, (n, n), with a spring at each kept degree of freedom, (n_kept,).

    All pairs of these are entries, if of zero.
    """
    ties = spring * np.eye(len(kept))
    entries = whole.tocoo()
    rows = np.concatenate([entries.row, np.repeat(kept, len(kept))])
    columns = np.concatenate([entries.col, np.tile(kept, len(kept))])
    values = np.concatenate([entries.data, ties.ravel()])
    return sparse.csc_array((values, (rows, columns)), shape=whole.shape)


def _dense(block: sparse.csc_array | Array) -> Array:
    """A block of a stiffness as a dense array, of the same shape."""
    if isinstance(block, np.ndarray):
        return np.asarray(block, order="C")
    return np.asarray(block.toarray(order="C"))
