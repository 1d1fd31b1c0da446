"""Pairs of opposite points of two sides, with their points and interfaces."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy import sparse

from solver.arrays import Array, Flags, Indices, ones_at
from solver.checks import Numbers, check, check_value
from solver.laws.interface import Component, Interface
from solver.refusal import RefusedError, Words


@dataclass(frozen=True, kw_only=True)
class Pairs(Interface):
    """Pairs of a point of the body above and its opposite below.

    A point has two pairs where a cut crosses the interface, or ends at it. One law may
    hold on many interfaces, as in a wall: points and pairs of one then follow those of
    the other.

    Attributes
    ----------
    points
        Point of the interface that each pair belongs to, shape (n_pairs,).
    positions
        Positions of the points along the interface, shape (n_points,), m.
    weights
        Tributary length or area of each pair, shape (n_pairs,), m or m^2.
    is_spring
        Whether the pairs are ends of a spring, and no surface.
    names
        Names of the interfaces, where there are several; one alone has the name that
        `Problem.interfaces` gives to its law.
    interfaces
        Number in `names` of the interface of each point, ascending, shape (n_points,);
        None where `names` is empty.

    Raises
    ------
    RefusedError
        For fields of other shapes, or interfaces that are mixed or without points.
    """

    points: Indices
    positions: Array
    weights: Array
    is_spring: bool = False
    names: tuple[str, ...] = ()
    interfaces: Indices | None = None

    def __post_init__(self) -> None:
        check(self, positions=Numbers(((None,),)))
        last = len(self.positions) - 1
        check(self, points=Numbers(((None,),), low=0, high=last, whole=True))
        size = len(self.points)
        check(self, weights=Numbers(((size,),), low=0.0, above=True))
        if self.names or self.interfaces is not None:
            last = len(self.names) - 1
            kind = Numbers(((len(self.positions),),), low=0, high=last, whole=True)
            check_value(f"{type(self).__name__}.interfaces", self.interfaces, kind)
            self._check_order(np.asarray(self.interfaces))

    def _check_order(self, interfaces: Indices) -> None:
        """Refuse interfaces without points, and points or pairs out of order."""
        steps_of_points = np.diff(interfaces)
        steps_of_pairs = np.diff(interfaces[self.points])
        is_sorted = np.all(steps_of_points >= 0) and np.all(steps_of_pairs >= 0)
        if not is_sorted or not self.sizes.all():
            raise RefusedError(
                f"{type(self).__name__}.interfaces",
                Words("out of order"),
                "points and pairs of one interface after those of the other",
                "sort them by the numbers of their interfaces, each of which has some",
            )

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
        """Check whether a rigid support lies below."""
        return self.tangent.below is None

    @property
    def rows(self) -> Indices:  # type: ignore[override]  # others are given them
        """Rows of all components, of both sides, (n_rows_of_interface,)."""
        rows = list[Indices]()
        for component in self.components:
            rows.extend(component.sides)
        return np.concatenate(rows)

    @cached_property
    def sizes(self) -> Indices:
        """Number of points of each interface, shape (n_interfaces,)."""
        if self.interfaces is None:
            return np.array([len(self.positions)])
        return np.bincount(self.interfaces, minlength=len(self.names))

    @cached_property
    def interface_of_pairs(self) -> Indices:
        """Index of the interface of each pair, ascending, shape (n_pairs,)."""
        if self.interfaces is None:
            return np.zeros(len(self.points), dtype=np.intp)
        return self.interfaces[self.points]

    @cached_property
    def ranges(self) -> list[tuple[slice, slice]]:
        """Range of the points, and of the pairs, of each interface."""
        pairs = np.bincount(self.interface_of_pairs, minlength=len(self.sizes))
        ends_of_points = np.cumsum([0, *self.sizes]).tolist()
        ends_of_pairs = np.cumsum([0, *pairs]).tolist()
        points = [slice(first, last) for first, last in pairwise(ends_of_points)]
        pairs_of = [slice(first, last) for first, last in pairwise(ends_of_pairs)]
        return list(zip(points, pairs_of, strict=True))

    def spread_to_interfaces(self, points: Flags) -> Flags:
        """Mask of all points of interfaces with a point in a mask, (n_points,) both."""
        counts = [points[some].any() for some, _ in self.ranges]
        return np.repeat(counts, self.sizes)

    def sums(self, values: Array) -> Array:
        """Sums over the pairs of each interface, equal to the bit to separate sums.

        From values of pairs, (n_pairs, ...), to (n_interfaces, ...).
        """
        # Sums of unequal length in one pass would be added up in another order.
        totals = [np.add.reduce(values[pairs]) for _, pairs in self.ranges]
        return np.array(totals)

    def by_point(self, values: Array) -> Array:
        """Sum over the pairs of each point: (n_pairs, ...) to (n_points, ...)."""
        if self._are_single:
            return np.array(values, dtype=float)
        if values.size == len(values):
            size = len(self.positions)
            sums = np.bincount(self.points, values.ravel(), minlength=size)
            return np.asarray(sums.reshape(size, *values.shape[1:]), dtype=float)
        return np.asarray(self._pairs_of_points @ values)

    @cached_property
    def _are_single(self) -> bool:
        """Check whether pairs and points are the same, in the same order."""
        return np.array_equal(self.points, np.arange(len(self.positions)))

    @cached_property
    def _pairs_of_points(self) -> sparse.csr_array:
        """Matrix with 1 where a pair belongs to a point, shape (n_points, n_pairs)."""
        size = len(self.points)
        return ones_at(self.points, np.arange(size), (len(self.positions), size))

    def mean_by_point(self, values: Array) -> Array:
        """Mean over the pairs of each point: (n_pairs, ...) to (n_points, ...)."""
        if self._are_single:
            return np.array(values, dtype=float)
        # Pairs of a point share its force, but each has its displacement and gap.
        counts = np.bincount(self.points, minlength=len(self.positions))
        trailing = [1] * (values.ndim - 1)
        return np.asarray(self.by_point(values) / counts.reshape(-1, *trailing))

    def in_parallel(self, compliance: Array | None) -> Array:
        """Compliance of every point, (n_points,), with its pairs in parallel.

        Zero without compliances of the pairs, (n_pairs,).
        """
        if compliance is None:
            return np.zeros(len(self.positions))
        return np.asarray(1.0 / self.by_point(1.0 / compliance))
