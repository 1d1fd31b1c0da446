"""How many numbers a friction field takes for an error: in products, modes, or as clips.

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
"""Share of the largest bound by which one that changes in size alone may differ from
that."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """Errors of a field that is kept in more and more numbers, shape (n,) each."""

    numbers: Indices
    errors: Array

    def within(self, share: float) -> float:
        """Fewest numbers with which the error is within a share; infinite if none are."""
        return float(min(self.numbers[self.errors <= share], default=math.inf))


def of_products(product: Decomposition) -> Sizes:
    """Keep the largest singular vectors: no sum of products comes nearer with as many."""
    numbers = len(product.space_modes) + product.time_modes.shape[1]
    return Sizes(numbers * np.arange(len(product.errors)), product.errors)


def of_clips(clips: Clips) -> Sizes:
    """Keep clips with memory, and singular vectors of what these leave.

    Clips take two vectors and a place a branch, the load, and the bound.
    """
    points, instants = clips.given.shape
    alone = (
        clips.branches * (2 * points + 1) + instants + _numbers_of_bound(clips.bound)
    )
    return Sizes(
        alone + (points + instants) * np.arange(len(clips.errors)), clips.errors
    )


def _numbers_of_bound(bound: Array) -> int:
    """How many numbers a bound takes: fewer if it changes in size alone."""
    sizes = bound.max(axis=0)
    most = float(bound.max(initial=0.0))
    shape = bound[:, [int(sizes.argmax())]] / (most or 1.0)
    if np.abs(bound - shape * sizes).max() > SAME_SHAPE * most:
        return bound.size
    return len(bound) + (bound.shape[1] if np.ptp(sizes) else 0)


def of_bases(problem: Problem, force: Array, bases: Sequence[SharedBasis]) -> Sizes:
    """Keep as many modes of each of a run's separated bases, the largest.

    Of F of all rows, (n_rows, n_instants), scaled; between two bodies friction is that
    of the one above. Of space modes the entries count that rub; those of a basis that
    several share, once.
    """
    lengths = np.zeros(problem.n_rows)
    seen = set[SharedBasis]()
    for law in problem.rubbing.values():
        lengths[law.components[-1].above] = law.weights
    most = max(basis.n_modes for basis in bases)
    left = np.zeros(most + 1)
    numbers = np.zeros(most + 1, dtype=int)
    for number, (part, basis) in enumerate(
        zip(problem.substructures, bases, strict=True)
    ):
        places = np.flatnonzero(lengths[part.rows])
        rows = part.rows[places]
        if basis in seen:
            points = 0
        else:
            points = len(places)
        seen.add(basis)
        weights = lengths[rows]
        per_length = problem.scales.force / lengths[rows, None]
        rest = force[rows] * per_length
        space = basis.force_modes[places] * per_length
        time = basis.time_functions(number)
        for rank in range(most + 1):
            if 0 < rank <= basis.n_modes:
                rest -= space[:, [rank - 1]] * time[rank - 1]
            left[rank] += weights @ rest**2 @ problem.time_weights
            if len(places):
                numbers[rank] += min(rank, basis.n_modes) * (points + rest.shape[1])
    return Sizes(
        numbers, np.sqrt(left / left[0]) if left[0] > 0.0 else np.zeros_like(left)
    )
