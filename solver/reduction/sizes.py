"""How many numbers a friction field takes for an error: in products, in pieces, as clips.

A product of a space vector and a function of time takes as many numbers as both together. Errors
are relative to the field, in L2 over length and time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.reduction.basis import Reduction
from solver.reduction.clips import Clips
from solver.reduction.svd import Decomposition, InterfaceFields, decompose


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
        """Give the fewest numbers with which the error is within a share; infinite if none are."""
        found = np.flatnonzero(self.errors <= share)
        return float(self.numbers[found[0]]) if len(found) else math.inf


def of_products(found: Decomposition) -> Sizes:
    """Keep the largest singular vectors: no sum of products comes nearer with as many."""
    product = len(found.space_modes) + found.time_modes.shape[1]
    return Sizes(product * np.arange(len(found.errors)), found.errors)


def of_clips(clips: Clips) -> Sizes:
    """Keep clips with memory, and singular vectors of what these leave."""
    product = sum(clips.given.shape)
    return Sizes(clips.numbers + product * np.arange(len(clips.errors)), clips.errors)


def in_pieces(fields: InterfaceFields) -> Sizes:
    """Keep as many singular vectors of each substructure: the best that a PGD could find there."""
    pieces = list(_pieces(fields))
    time_weights = _time_weights(fields.problem)
    values = [decompose(own.field, own.weights, time_weights, own.weights).values for own in pieces]
    most = max(map(len, values))
    left = np.zeros(most + 1)
    numbers = np.zeros(most + 1, dtype=int)
    for own, found in zip(pieces, values, strict=True):
        left[: len(found)] += np.cumsum(found[::-1] ** 2)[::-1]
        numbers += sum(own.field.shape) * np.minimum(np.arange(most + 1), len(found))
    return Sizes(numbers, _relative(left))


def of_bases(fields: InterfaceFields, reduction: Reduction) -> Sizes:
    """Keep as many modes of each of a run's separated bases, the largest.

    Of their space modes the entries count that rub; those of a basis that several share, once.
    """
    most = max(modes.n_modes for modes in reduction.modes)
    left, numbers = np.zeros(most + 1), np.zeros(most + 1, dtype=int)
    time_weights, seen = _time_weights(fields.problem), set[int]()
    for own in _pieces(fields):
        modes = reduction.modes[own.number]
        rest, points = own.field.copy(), 0 if modes.stored in seen else len(own.field)
        seen.add(modes.stored)
        space = modes.force_modes[own.places] * fields.problem.scales.force / own.weights[:, None]
        for rank in range(most + 1):
            if 0 < rank <= modes.n_modes:
                rest -= space[:, [rank - 1]] * modes.time_functions[rank - 1]
            left[rank] += own.weights @ rest**2 @ time_weights
            numbers[rank] += min(rank, modes.n_modes) * (points + rest.shape[1])
    return Sizes(numbers, _relative(left))


def _relative(left: Array) -> Array:
    """Give errors from squares of what is left, the first of which is of the whole field."""
    return np.sqrt(left / left[0]) if left[0] > 0.0 else np.zeros_like(left)


@dataclass(frozen=True, eq=False)
class _Piece:
    """The friction of one substructure on bodies above.

    Attributes
    ----------
    number
        Of the substructure.
    places
        Of the rows that rub, among all of its own.
    field, weights
        N/m, shape (n_rows, n_instants), and lengths, m.
    """

    number: int
    places: Indices
    field: Array
    weights: Array


def _pieces(fields: InterfaceFields) -> Iterator[_Piece]:
    """Cut the friction into substructures; between two bodies it is that of the one above."""
    problem, force = fields.problem, fields.boundary_force
    lengths = np.zeros(problem.n_rows)
    for law in problem.rubbing.values():
        lengths[law.components[-1].above] = law.weights
    for number, part in enumerate(problem.substructures):
        places = np.flatnonzero(lengths[part.rows])
        rows = part.rows[places]
        if len(rows):
            weights = lengths[rows]
            field = force[rows] * problem.scales.force / weights[:, None]
            yield _Piece(number, places, field, weights)


def _time_weights(problem: Problem) -> Array:
    return problem.time_weights * problem.scales.time
