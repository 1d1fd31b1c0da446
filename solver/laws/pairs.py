"""Pairs of points along an interface, a point of the body above and what lies below it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.laws.interface import Component, Gaps, Interface, MacroPart, beyond, squared


@dataclass(frozen=True, kw_only=True)
class Pairs(Interface):
    """An interface of two sides, of which one may be a rigid support.

    A pair is a point of the body above and what lies below it; the pairs of one point (two, where a
    cut crosses the interface, or ends at it) share its force.

    Attributes
    ----------
    points
        Point of the interface that each pair belongs to, shape (n_pairs,).
    positions
        Place of the points along the interface, shape (n_points,), m.
    macro
        Macro basis of each component between two bodies, shape (n_pairs, n_macro): what one takes
        from the other is in equilibrium in the coarse problem. None on a rigid support.
    """

    points: Indices
    positions: Array
    macro: sparse.csr_array | None = None

    @property
    def rows(self) -> Indices:  # type: ignore[override]  # others are given them
        """Rows of all components, of both sides."""
        return np.concatenate([rows for component in self.components for rows in component.sides])

    @property
    @abstractmethod
    def components(self) -> tuple[Component, ...]:
        """All components, the tangential one last."""

    @property
    def tangent(self) -> Component:
        """The component along the interface."""
        return self.components[-1]

    @property
    def is_on_support(self) -> bool:
        """Whether what lies below is rigid."""
        return self.tangent.below is None

    def by_point(self, values: Array) -> Array:
        """Add up values of the pairs, shape (n_pairs, ...), at every point, (n_points, ...)."""
        once, again = self._first_pairs
        found = np.zeros((len(self.positions), *values.shape[1:]))
        found[self.points[once]] = values[once]
        np.add.at(found, self.points[again], values[again])
        return found

    @cached_property
    def _first_pairs(self) -> tuple[Indices, Indices]:
        """The first pair of every point, and those of points that have had one."""
        _, once = np.unique(self.points, return_index=True)
        return once, np.setdiff1d(np.arange(len(self.points)), once)

    def mean_by_point(self, values: Array) -> Array:
        """Give the mean of the pairs of every point, shape (n_points, ...)."""
        counts = np.bincount(self.points, minlength=len(self.positions))
        return np.asarray(self.by_point(values) / counts.reshape(-1, *[1] * (values.ndim - 1)))

    def macro_parts(self) -> Iterator[MacroPart]:
        """Give the macro forces of both sides, which cancel, component by component."""
        if self.macro is None:
            return
        basis = sparse.coo_array(sparse.vstack([self.macro, self.macro]))
        for component in self.components:
            yield MacroPart(np.concatenate(component.sides), basis)

    def gaps(self, displacement: Array, force: Array, noise: float) -> Gaps:
        """Compare the forces of both sides; where they move is what the law is about."""
        if self.is_on_support:
            return Gaps()
        sums = (sum(force[rows] for rows in component.sides) for component in self.components)
        return Gaps(force=sum(squared(beyond(np.asarray(one), noise)) for one in sums))
