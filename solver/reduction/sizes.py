"""Storage of a friction field for an error: as products, modes, or clips.

A product of a space vector and a function of time takes as many numbers as both
together. Errors are relative to the field, in L2 over length and time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.reduction.basis import SharedBasis
from solver.reduction.clips import Clips
from solver.reduction.svd import Decomposition

SAME_SHAPE = 1e-9
"""Share of the largest strength by which one that changes in size alone may differ from
that."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """Errors of a field over the count of stored numbers, shape (n,) each."""

    numbers: Indices
    errors: Array

    def within(self, share: float) -> float:
        """Smallest count with an error within a share; infinite without one."""
        return float(min(self.numbers[self.errors <= share], default=math.inf))


def of_products(product: Decomposition) -> Sizes:
    """Sizes of the largest singular vectors: the best sums of products."""
    numbers = len(product.space_modes) + product.time_modes.shape[1]
    return Sizes(numbers * np.arange(len(product.errors)), product.errors)


def of_clips(clips: Clips) -> Sizes:
    """Sizes of clips with memory, and singular vectors of the residual.

    Clips take two vectors and an instant for each branch, the load, and the strength.
    """
    points, instants = clips.given.shape
    alone = (
        clips.branches * (2 * points + 1)
        + instants
        + _numbers_of_strength(clips.strength)
    )
    numbers = alone + (points + instants) * np.arange(len(clips.errors))
    return Sizes(numbers, clips.errors)


def _numbers_of_strength(strength: Array) -> int:
    """Count of numbers that store a strength, (n_points, n_instants)."""
    sizes = strength.max(axis=0)
    largest = float(strength.max(initial=0.0))
    shape = strength[:, [int(sizes.argmax())]] / (largest or 1.0)
    if np.abs(strength - shape * sizes).max() > SAME_SHAPE * largest:
        return int(strength.size)
    # A strength that changes in size alone is one product.
    if np.ptp(sizes):
        return len(strength) + int(strength.shape[1])
    return len(strength)


def of_bases(problem: Problem, force: Array, bases: Sequence[SharedBasis]) -> Sizes:
    """Sizes of the largest modes of separated bases, equally many of each.

    The field is friction, between two bodies that of the body above. Of space modes the
    entries count that rub; those of a basis that several substructures share, once.

    Parameters
    ----------
    problem
        The problem of the run.
    force
        F of all rows, shape (n_rows, n_instants), scaled.
    bases
        The basis of each substructure.
    """
    lengths = np.zeros(problem.n_rows)
    seen = set[SharedBasis]()
    for law in problem.contacts.laws.values():
        lengths[law.components[-1].above] = law.weights
    largest = max(basis.n_modes for basis in bases)
    left = np.zeros(largest + 1)
    numbers = np.zeros(largest + 1, dtype=int)
    for number, (part, basis) in enumerate(
        zip(problem.substructures, bases, strict=True)
    ):
        places = np.flatnonzero(lengths[part.rows])
        points = len(places)
        # Substructures that share a basis store its modes once, but each its time
        # functions.
        if basis in seen:
            points = 0
        seen.add(basis)
        _add_squares(left, problem, force, lengths, number, basis)
        if len(places):
            ranks = np.minimum(np.arange(largest + 1), basis.n_modes)
            numbers += ranks * (points + force.shape[1])
    errors = np.zeros_like(left)
    if left[0] > 0.0:
        errors = np.sqrt(left / left[0])
    return Sizes(numbers, errors)


def _add_squares(
    left: Array,
    problem: Problem,
    force: Array,
    lengths: Array,
    number: int,
    basis: SharedBasis,
) -> None:
    """Add the squared residual of a substructure with 0, 1, ... modes, (n_modes + 1,).

    By F of all rows, (n_rows, n_instants), scaled, and their lengths, (n_rows,), m.
    """
    part = problem.substructures[number]
    places = np.flatnonzero(lengths[part.rows])
    rows = part.rows[places]
    weights = lengths[rows]
    per_length = problem.scales.force / lengths[rows, None]
    rest = force[rows] * per_length
    space = basis.force_modes[places] * per_length
    time = basis.time_functions(number)
    # One mode more at a time is subtracted, so that all ranks cost one pass.
    for rank in range(len(left)):
        if 0 < rank <= basis.n_modes:
            rest -= space[:, [rank - 1]] * time[rank - 1]
        left[rank] += weights @ rest**2 @ problem.time_weights
