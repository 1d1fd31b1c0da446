"""Singular values and modes of interface fields, per substructure (paper, section 3.2).

A field is decomposed in the L2 inner product of the place and the time that it lives
on: lengths of the friction rows and trapezoidal weights of the instants.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem

ALIKE = 1e-9
"""Relative difference up to which two entries count as equally large when a sign is
fixed."""


@dataclass(frozen=True, eq=False)
class Decomposition:
    """A space-time field as a sum of value times space mode times time mode.

    Attributes
    ----------
    values
        Singular values, shape (n_modes,), descending; n_modes is the smaller of
        n_points and n_instants, and a field of lower rank has zeros at the end.
    space_modes
        Shape (n_points, n_modes), orthonormal in `space_weights`; the largest entry of
        each is positive.
    time_modes
        Shape (n_modes, n_instants), orthonormal in the weights of the instants.
    positions, space_weights
        Shape (n_points,) both: m or mere numbers, and positive weights.
    """

    values: Array
    space_modes: Array
    time_modes: Array
    positions: Array
    space_weights: Array

    @cached_property
    def errors(self) -> Array:
        """Errors of the best approximations of rank 0 to n_modes, shape (n_modes + 1,).

        Relative to the norm of the field; zero for a field that vanishes. The root of
        the sum of the squared values left out (Eckart and Young).
        """
        errors = np.zeros(len(self.values) + 1)
        if self.values[0] > 0.0:
            squares = (self.values / self.values[0]) ** 2
            errors[:-1] = np.sqrt(np.cumsum(squares[::-1])[::-1] / squares.sum())
        return errors

    def modes_for(self, share: float) -> int:
        """Number of modes that bring the error down to a share of the field's norm."""
        return int(np.argmax(self.errors <= share))

    def correlations(self, modes: Array) -> Array:
        """Cosines between modes and the space modes of the same rank, shape (n,).

        In the inner product of `space_weights`, from -1 to 1, with modes of shape
        (n_points, n).
        """
        lengths = np.sqrt(self.space_weights @ modes**2)
        space_modes = self.space_modes[:, : modes.shape[1]]
        return np.asarray(self.space_weights @ (space_modes * modes) / lengths)


def decompose(
    field: Array,
    space_weights: Array,
    time_weights: Array,
    positions: Array | None = None,
) -> Decomposition:
    """Decompose a field, (n_points, n_instants), in weighted inner products."""
    space_root = np.sqrt(space_weights)[:, None]
    time_root = np.sqrt(time_weights)
    # Weighted by roots, the plain decomposition is that in the weighted inner products.
    left, values, right = np.linalg.svd(
        space_root * field * time_root, full_matrices=False
    )
    space_modes = left / space_root
    time_modes = right / time_root
    signs = _signs(space_modes)
    if positions is None:
        positions = np.arange(float(len(field)))
    return Decomposition(
        values=values,
        space_modes=space_modes * signs,
        time_modes=time_modes * signs[:, None],
        positions=positions,
        space_weights=space_weights,
    )


def decompositions(
    problem: Problem,
    field: Array,
    substructures: Indices | None = None,
    *,
    is_force: bool,
) -> list[Decomposition]:
    """Decompositions of F or W on rows with friction, for some substructures or all.

    Of fields of all rows, (n_rows, n_instants), scaled. Singular values of the friction
    force, per length, are in N sqrt(s/m), of the displacement in m sqrt(m s).
    """
    scales = problem.scales
    lengths = np.zeros(problem.n_rows)
    for law in problem.contacts.laws.values():
        for rows in law.tangent.sides:
            lengths[rows] = law.weights
    slides = lengths > 0.0
    whole = field * (scales.force if is_force else scales.displacement)
    # Forces are nodal: per length they do not depend on the mesh.
    if is_force:
        whole[slides] /= lengths[slides, None]
    positions = problem.positions[problem.row_dofs]
    times = problem.time_weights * scales.time
    rubbing = [part.rows[slides[part.rows]] for part in problem.substructures]
    if substructures is None:
        chosen = rubbing
    else:
        chosen = [rubbing[number] for number in substructures]
    return [
        decompose(whole[rows], lengths[rows], times, positions[rows]) for rows in chosen
    ]


def front_decay(count: int) -> Array:
    """Decay sigma_n/sigma_1 of a front of constant speed, shape (count,).

    (MATHEMATICS.md, 3.)
    """
    return np.asarray(1.0 / (2.0 * np.arange(1, count + 1) - 1.0))


def _signs(modes: Array) -> Array:
    """Signs (n_modes,) that make the largest entries of modes positive."""
    # A substructure that does not rub has modes without entries.
    if not modes.size:
        return np.ones(modes.shape[1])
    size = np.abs(modes)
    # Of entries that are equal but for rounding the first decides, on every machine.
    largest = np.argmax(size >= (1.0 - ALIKE) * size.max(axis=0), axis=0)
    return np.where(modes[largest, np.arange(modes.shape[1])] < 0.0, -1.0, 1.0)
