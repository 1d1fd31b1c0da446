"""How many numbers a friction field takes for an error: in products, in pieces, as clips.

A product of a space vector and a function of time takes as many numbers as both together. Errors
are relative to the field, in L2 over length and time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.reduction.basis import SharedBasis
from solver.reduction.clips import Clips
from solver.reduction.svd import Decomposition, decompose

SAME_SHAPE = 1e-9
"""Share of the largest bound by which one that changes in size alone may differ from that."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """Errors of a field that is kept in more and more numbers.

    Attributes
    ----------
    numbers, errors
        Shape (n,) each; the numbers ascend.
    """

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
    alone = clips.branches * (2 * points + 1) + instants + _numbers_of_bound(clips.bound)
    return Sizes(alone + (points + instants) * np.arange(len(clips.errors)), clips.errors)


def _numbers_of_bound(bound: Array) -> int:
    """How many numbers a bound takes: fewer if it changes in size alone."""
    sizes, most = bound.max(axis=0), float(bound.max(initial=0.0))
    shape = bound[:, [int(sizes.argmax())]] / (most or 1.0)
    if np.abs(bound - shape * sizes).max() > SAME_SHAPE * most:
        return bound.size
    return len(bound) + (bound.shape[1] if np.ptp(sizes) else 0)


def in_pieces(problem: Problem, force: Array) -> Sizes:
    """Keep as many singular vectors of each substructure: the best that a PGD could find there.

    Of F of all rows, (n_rows, n_instants), scaled.
    """
    pieces, time_weights = list(_pieces(problem, force)), _time_weights(problem)
    values = [decompose(field, weights, time_weights).values for *_, field, weights in pieces]
    most = max(map(len, values))
    left, numbers = np.zeros(most + 1), np.zeros(most + 1, dtype=int)
    for (*_, field, _), singular in zip(pieces, values, strict=True):
        left[: len(singular)] += np.cumsum(singular[::-1] ** 2)[::-1]
        numbers += sum(field.shape) * np.minimum(np.arange(most + 1), len(singular))
    return Sizes(numbers, _relative(left))


def of_bases(problem: Problem, force: Array, bases: Sequence[SharedBasis]) -> Sizes:
    """Keep as many modes of each of a run's separated bases, the largest.

    Of their space modes the entries count that rub; those of a basis that several share, once.
    """
    most = max(basis.n_modes for basis in bases)
    left, numbers = np.zeros(most + 1), np.zeros(most + 1, dtype=int)
    time_weights, seen = _time_weights(problem), set[SharedBasis]()
    for number, places, field, weights in _pieces(problem, force):
        basis = bases[number]
        rest, points = field.copy(), 0 if basis in seen else len(field)
        seen.add(basis)
        space = basis.force_modes[places] * problem.scales.force / weights[:, None]
        time = basis.time_functions(number)
        for rank in range(most + 1):
            if 0 < rank <= basis.n_modes:
                rest -= space[:, [rank - 1]] * time[rank - 1]
            left[rank] += weights @ rest**2 @ time_weights
            numbers[rank] += min(rank, basis.n_modes) * (points + rest.shape[1])
    return Sizes(numbers, _relative(left))


def _relative(left: Array) -> Array:
    """Errors from squares of what is left, the first of which is of the whole field."""
    return np.sqrt(left / left[0]) if left[0] > 0.0 else np.zeros_like(left)


def _pieces(problem: Problem, force: Array) -> Iterator[tuple[int, Indices, Array, Array]]:
    """Yield the friction of every substructure on bodies above.

    Its number; places of the rows that rub, among its own; friction, N/m, shape
    (n_places, n_instants); and lengths, m. Between two bodies friction is that of the one above.
    """
    lengths = np.zeros(problem.n_rows)
    for law in problem.rubbing.values():
        lengths[law.components[-1].above] = law.weights
    for number, part in enumerate(problem.substructures):
        places = np.flatnonzero(lengths[part.rows])
        if len(places):
            rows = part.rows[places]
            weights = lengths[rows]
            yield number, places, force[rows] * problem.scales.force / weights[:, None], weights


def _time_weights(problem: Problem) -> Array:
    return problem.time_weights * problem.scales.time
