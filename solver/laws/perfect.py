"""Perfect interface between two substructures: one displacement, opposite forces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from solver.arrays import Array, Indices, as_slice
from solver.laws.interface import Gaps, Interface, MacroPart, Rule, beyond, squared


@dataclass(frozen=True)
class Perfect(Interface):
    """A glued cut.

    Attributes
    ----------
    first, second
        Boundary rows of the two sides, point by point, shape (n_points,).
    macro
        Macro basis of the interface, shape (n_points, n_macro).
    """

    first: Indices
    second: Indices
    macro: Array

    @property
    def rows(self) -> Indices:  # type: ignore[override]  # others are given them
        """Rows of both sides."""
        return np.concatenate([self.first, self.second])

    @property
    def joined(self) -> tuple[Indices, Indices]:
        """Both sides."""
        return self.first, self.second

    @classmethod
    def together(cls, laws: Sequence[Self]) -> list[Self]:
        """Join all cuts; the macro bases stay behind."""
        if not laws:
            return []
        first = np.concatenate([law.first for law in laws])
        second = np.concatenate([law.second for law in laws])
        return [cls(first, second, np.zeros((len(first), 0)))]

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Both sides move by the mean of their z, weighted by k (solver/README.md, 2)."""
        first, second = as_slice(self.first), as_slice(self.second)
        k, other = k[self.first], k[self.second]
        share = (k / (k + other))[:, None]

        def glue(incoming: Array, displacement: Array, _instants: slice) -> None:
            below = incoming[second]
            common = below + share * (incoming[first] - below)
            displacement[first] = common
            displacement[second] = common

        return glue

    def gaps(self, displacement: Array, force: Array, noise: float) -> Gaps:
        """Compare both sides."""
        apart = _at(displacement, self.first) - _at(displacement, self.second)
        unbalanced = _at(force, self.first) + _at(force, self.second)
        return Gaps(squared(beyond(apart, 2.0 * noise)), squared(beyond(unbalanced, noise)))

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces of both sides, which cancel."""
        yield MacroPart(self.rows, np.concatenate([self.macro, self.macro]))


def _at(field: Array, rows: Indices) -> Array:
    """Rows of a field that is contiguous in space, as it lies in memory: (n_times, n)."""
    return np.take(field.T, rows, axis=1)
