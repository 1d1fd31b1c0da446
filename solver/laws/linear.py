"""Linear laws: prescribed displacements, forces, glued cuts (MATHEMATICS.md, 2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from solver.arrays import Array, Indices, as_slice
from solver.checks import ROWS, Numbers, check
from solver.laws.interface import (
    Gaps,
    Glued,
    IncrementalForm,
    Interface,
    MacroPart,
    PrescribedRows,
    Rule,
    beyond,
    joined,
    squared,
)


@dataclass(frozen=True)
class _Given(Interface):
    """Prescribed values, (n_rows, n_instants), scaled, at boundary rows, (n_rows,)."""

    rows: Indices
    values: Array

    def __post_init__(self) -> None:
        check(self, rows=ROWS)
        check(self, values=Numbers(((len(self.rows), None),)))

    def during(self, instants: slice) -> Self:
        """The law restricted to a range of instants."""
        return replace(self, values=self.values[:, instants])

    @property
    def n_instants(self) -> int:
        """Number of instants of the values."""
        return int(self.values.shape[1])


@dataclass(frozen=True)
class Dirichlet(_Given):
    """Prescribed displacement."""

    def incremental_form(self) -> IncrementalForm:
        """Prescribed displacements."""
        return IncrementalForm(displacement=PrescribedRows(self.rows, self.values))

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Local stage in which W^ is the prescribed displacement."""
        rows = as_slice(self.rows)
        given = self.values

        def prescribe(_incoming: Array, displacement: Array, instants: slice) -> None:
            displacement[rows] = given[:, instants]

        return prescribe

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Compare the displacement with the prescribed one, as `Interface.gaps`."""
        missing = displacement[self.rows] - self.values
        return Gaps(displacement=squared(beyond(missing, noise)))


@dataclass(frozen=True)
class Neumann(_Given):
    """Prescribed nodal forces on the body, and a macro basis, (n_rows, n_macro)."""

    macro: Array

    def __post_init__(self) -> None:
        super().__post_init__()
        check(self, macro=Numbers(((len(self.rows), None),)))

    def incremental_form(self) -> IncrementalForm:
        """Prescribed forces."""
        return IncrementalForm(force=PrescribedRows(self.rows, self.values))

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Local stage in which W^ is z plus F_d / k."""
        rows = as_slice(self.rows)
        moved = self.values / k[self.rows, None]

        def push(incoming: Array, displacement: Array, instants: slice) -> None:
            displacement[rows] = incoming[rows] + moved[:, instants]

        return push

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Compare the force with the prescribed one, as `Interface.gaps`."""
        return Gaps(force=squared(beyond(force[self.rows] - self.values, noise)))

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces, which the load balances."""
        yield MacroPart(self.rows, self.macro, np.asarray(self.macro.T @ self.values))


@dataclass(frozen=True)
class Perfect(Interface):
    """A glued cut: rows of both sides, (n_points,), basis, (n_points, n_macro)."""

    first: Indices
    second: Indices
    macro: Array

    def __post_init__(self) -> None:
        check(self, first=ROWS)
        size = len(self.first)
        opposite = Numbers(((size,),), low=0, whole=True)
        check(self, second=opposite, macro=Numbers(((size, None),)))

    @property
    def rows(self) -> Indices:  # type: ignore[override]  # others are given them
        """Rows of both sides, (2 n_points,)."""
        return np.concatenate([self.first, self.second])

    def incremental_form(self) -> IncrementalForm:
        """Pairs of glued rows."""
        return IncrementalForm(glued=Glued(self.first, self.second))

    def during(self, _instants: slice) -> Self:
        """The law itself, which is the same at all instants."""
        return self

    @classmethod
    def join(cls, laws: Sequence[Self]) -> list[Self]:
        """Join all cuts to one law, without macro bases."""
        return [joined([replace(law, macro=law.macro[:, :0]) for law in laws])]

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Local stage in which both sides move by the mean of their z, weighted by k.

        See MATHEMATICS.md, 2; `k` is that of all rows, (n_rows,).
        """
        first = as_slice(self.first)
        second = as_slice(self.second)
        k_first = k[self.first]
        k_second = k[self.second]
        share = (k_first / (k_first + k_second))[:, None]

        def glue(incoming: Array, displacement: Array, _instants: slice) -> None:
            other = incoming[second]
            # The mean from one side on, so that sides which agree stay exactly where
            # they are.
            common = other + share * (incoming[first] - other)
            displacement[first] = common
            displacement[second] = common

        return glue

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Compare both sides, as `Interface.gaps`."""
        # Fields are contiguous in space: gathering from the transpose reads memory in
        # order.
        apart = _at(displacement, self.first) - _at(displacement, self.second)
        unbalanced = _at(force, self.first) + _at(force, self.second)
        return Gaps(
            displacement=squared(beyond(apart, 2.0 * noise)),
            force=squared(beyond(unbalanced, noise)),
        )

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces of both sides, which cancel."""
        yield MacroPart(self.rows, np.concatenate([self.macro, self.macro]))


def _at(field: Array, rows: Indices) -> Array:
    """Rows, (n,), of a field, (n_rows, n_times), in memory order: (n_times, n)."""
    return np.take(field.T, rows, axis=1)
