"""A separated basis: space modes times time functions.

(MATHEMATICS.md, 3; paper, problem 2.3.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from solver.arrays import Array

STEPS = 4
"""Largest number of steps of the fixed point: 1, 2 and 10 steps, and the leading
singular pair itself, reach 1 % of force error within one iteration of each other (bar
and strand, 98 to 106; measured)."""
STAGNATION = 0.01
"""Change of a pair's size, as a share, at which the fixed point stops; 0 and 0.1 as
well."""


@dataclass(frozen=True, eq=False)
class SeparatedBasis:
    """A field as a sum of space modes times time functions.

    The modes are orthonormal in the inner product of the search direction, a^T k b.

    Attributes
    ----------
    modes, time_functions
        Shapes (n_boundary, n_modes) and (n_modes, n_columns). The columns are instants;
        of a basis that several substructures share, those of all of them.
    k, weights
        Weights in space and of the columns, shapes (n_boundary,) and (n_columns,),
        positive.
    """

    modes: Array
    time_functions: Array
    k: Array
    weights: Array

    @classmethod
    def of_field(
        cls, field: Array, k: Array, weights: Array, tolerance: float, largest: int
    ) -> SeparatedBasis:
        """Basis of a field, shape (n_boundary, n_columns), downsized."""
        # In these coordinates the inner product is the plain one, and unit vectors are
        # modes.
        root = np.sqrt(k)[:, None]
        basis = cls(np.eye(len(k)), root * field, k, weights).downsized(
            tolerance, largest
        )
        return replace(basis, modes=basis.modes / root)

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return int(self.modes.shape[1])

    def field(self) -> Array:
        """The field, shape (n_boundary, n_columns)."""
        return np.asarray(self.modes @ self.time_functions)

    def coefficients(self, field: Array) -> Array:
        """Time functions (n_modes, n_columns) of a field projected on the modes."""
        return np.asarray((self.k[:, None] * self.modes).T @ field)

    def squared(self, field: Array, scratch: Array) -> float:
        """Squared norm of a field of shape (n_boundary, n_columns).

        `scratch` has its shape and is overwritten: fresh memory would cost more than
        the norm.
        """
        return float(self.k @ np.multiply(field, field, out=scratch) @ self.weights)

    def squared_of(self, time_functions: Array) -> float:
        """Squared norm of the modes times time functions, (n_modes, n_columns)."""
        return float(np.sum(time_functions * time_functions @ self.weights))

    def appended(self, mode: Array, time_function: Array) -> SeparatedBasis:
        """Basis with a further pair, whose mode is orthonormal to the others."""
        modes = np.asfortranarray(np.column_stack([self.modes, mode]))
        time_functions = np.vstack([self.time_functions, time_function])
        return replace(self, modes=modes, time_functions=time_functions)

    def orthonormal(self, mode: Array) -> Array | None:
        """A mode made orthonormal to the others, shape (n_boundary,).

        None if it depends on them up to rounding.
        """
        size = np.sqrt(float(self.k @ (mode * mode)))
        if size == 0.0:
            return None
        mode = mode / size
        # Twice is enough: the second pass removes what rounding left in the first.
        for _ in range(2):
            mode = mode - self.modes @ self.coefficients(mode[:, None])[:, 0]
            rest = np.sqrt(float(self.k @ (mode * mode)))
            if rest < 1e-8:
                return None
            mode = mode / rest
        return mode

    def downsized(self, tolerance: float, largest: int) -> SeparatedBasis:
        """Basis of the field's largest singular vectors, in descending order.

        These are dropped up to `tolerance`, a share of the field's norm, and in any
        case beyond the `largest` number of modes. As modes are orthonormal, the
        singular values of the field are those of the small matrix of time functions.
        """
        if self.n_modes == 0:
            return self
        root = np.sqrt(self.weights)
        # A small matrix: its rows are modes, and its columns are weighted by time.
        turn, values, right = np.linalg.svd(
            self.time_functions * root, full_matrices=False
        )
        tails = np.sqrt(np.cumsum(values[::-1] ** 2)[::-1])
        rank = min(int(np.count_nonzero(tails > tolerance * tails[0])), largest)
        modes = np.asfortranarray(self.modes @ turn[:, :rank])
        time_functions = values[:rank, None] * right[:rank] / root
        return replace(self, modes=modes, time_functions=time_functions)

    def outside(self, other: SeparatedBasis) -> float:
        """Norm of the part outside another basis's modes over the field's norm."""
        whole = self.squared_of(self.time_functions)
        if whole == 0.0:
            return 0.0
        # Modes of the other are orthonormal, so squares of coefficients add up.
        inside = other.coefficients(self.modes) @ self.time_functions
        return float(np.sqrt(max(1.0 - self.squared_of(inside) / whole, 0.0)))


def nearest_mode(residual: Array, k: Array, weights: Array) -> Array:
    """Space mode of the pair nearest to a residual delta / k, shape (n_boundary,).

    With G + k Z = g for every boundary field g, problem 2.3 asks for the pair g phi
    nearest to the residual; the paper's fixed point alternates between both factors,
    and is a power iteration towards the leading singular pair. The norm of the mode has
    no meaning. Of a residual that is zero the mode is zero.

    Parameters
    ----------
    residual
        Residual, shape (n_boundary, n_columns), scaled.
    k, weights
        Weights of space, shape (n_boundary,), and of the columns, (n_columns,).
    """
    # Only the shape matters, and the squares of very small numbers are zero.
    largest = float(np.abs(residual).max())
    if largest == 0.0:
        return residual[:, 0]
    residual = residual / largest
    # The instant at which the residual is largest: nearer to the pair than any fixed
    # start.
    mode = residual[:, int(np.argmax((k @ (residual * residual)) * weights))]
    size = 0.0
    for _ in range(STEPS):
        time_function = (k * mode) @ residual / float(k @ (mode * mode))
        mode = residual @ (weights * time_function)
        mode /= float(weights @ (time_function * time_function))
        before = size
        size = float(k @ (mode * mode))
        size *= float(weights @ (time_function * time_function))
        if abs(size - before) <= STAGNATION * size:
            break
    return mode


@dataclass(frozen=True, eq=False)
class SharedBasis:
    """A separated basis of y = W + F/k, and the substructures that share it.

    Its fields are read-only and scaled.

    Columns of the basis run through the numbers of these, ascending, then through the
    instants; its modes have shape (n_boundary, n_modes), rows as `Substructure.rows`,
    largest first. `incoming` is W - F/k of every mode, which belongs to one admissible
    pair with it (paper, eq. 3).
    """

    members: tuple[int, ...]
    basis: SeparatedBasis
    incoming: Array

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return self.basis.n_modes

    def time_functions(self, member: int) -> Array:
        """Time functions of a substructure, shape (n_modes, n_instants)."""
        return self.basis.time_functions[
            :, self.members.index(member) :: len(self.members)
        ]

    @cached_property
    def displacement_modes(self) -> Array:
        """Displacements Z, shape (n_boundary, n_modes)."""
        return 0.5 * (self.basis.modes + self.incoming)

    @cached_property
    def force_modes(self) -> Array:
        """Forces G = k (u - Z) of Z, shape (n_boundary, n_modes) (paper, eq. 3)."""
        return 0.5 * self.basis.k[:, None] * (self.basis.modes - self.incoming)
