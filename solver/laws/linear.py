"""Linear laws: prescribed displacements and forces, and glued cuts (solver/README.md, 2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from solver.arrays import Array, Indices, as_slice
from solver.checks import ROWS, Numbers, check
from solver.laws.interface import (
    Gaps,
    Given,
    Glued,
    IncrementalForm,
    Interface,
    MacroPart,
    Rule,
    beyond,
    joined,
    squared,
)


@dataclass(frozen=True)
class _Given(Interface):
    """What is given at boundary rows, (n_rows,): values of (n_rows, n_instants), scaled."""

    rows: Indices
    values: Array

    def __post_init__(self) -> None:
        check(self, rows=ROWS)
        check(self, values=Numbers(((len(self.rows), None),)))

    def during(self, instants: slice) -> Self:
        """Law of some instants alone."""
        return replace(self, values=self.values[:, instants])

    @property
    def n_instants(self) -> int:
        """Number of instants that the values are for."""
        return int(self.values.shape[1])


@dataclass(frozen=True)
class Dirichlet(_Given):
    """Prescribed displacement."""

    def incremental_form(self) -> IncrementalForm:
        """Displacements that are given."""
        return IncrementalForm(displacement=Given(self.rows, self.values))

    def rule(self, k: Array, n_instants: int) -> Rule:
        """W^ is the displacement that is prescribed."""
        rows = as_slice(self.rows)
        given = self.values

        def prescribe(_incoming: Array, displacement: Array, instants: slice) -> None:
            displacement[rows] = given[:, instants]

        return prescribe

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Compare the displacement with that prescribed."""
        return Gaps(
            displacement=squared(beyond(displacement[self.rows] - self.values, noise))
        )


@dataclass(frozen=True)
class Neumann(_Given):
    """Prescribed nodal forces on the body, with a macro basis of shape (n_rows, n_macro)."""

    macro: Array

    def __post_init__(self) -> None:
        super().__post_init__()
        check(self, macro=Numbers(((len(self.rows), None),)))

    def incremental_form(self) -> IncrementalForm:
        """Forces that are given."""
        return IncrementalForm(force=Given(self.rows, self.values))

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Move by F_d / k."""
        rows = as_slice(self.rows)
        moved = self.values / k[self.rows, None]

        def push(incoming: Array, displacement: Array, instants: slice) -> None:
            displacement[rows] = incoming[rows] + moved[:, instants]

        return push

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Compare the force with that prescribed."""
        return Gaps(force=squared(beyond(force[self.rows] - self.values, noise)))

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces, which the load balances."""
        yield MacroPart(self.rows, self.macro, np.asarray(self.macro.T @ self.values))


@dataclass(frozen=True)
class Perfect(Interface):
    """A glued cut: rows of its two sides, (n_points,), and a macro basis, (n_points, n_macro)."""

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
        """Rows of both sides."""
        return np.concatenate([self.first, self.second])

    def incremental_form(self) -> IncrementalForm:
        """Both sides as one."""
        return IncrementalForm(glued=Glued(self.first, self.second))

    def during(self, _instants: slice) -> Self:
        """Law of some instants alone, which is that of all."""
        return self

    @classmethod
    def together(cls, laws: Sequence[Self]) -> list[Self]:
        """Join all cuts; the macro bases stay behind."""
        return [joined([replace(law, macro=law.macro[:, :0]) for law in laws])]

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Both sides move by the mean of their z, weighted by k (solver/README.md, 2)."""
        first = as_slice(self.first)
        second = as_slice(self.second)
        other = k[self.second]
        k = k[self.first]
        share = (k / (k + other))[:, None]

        def glue(incoming: Array, displacement: Array, _instants: slice) -> None:
            below = incoming[second]
            common = below + share * (incoming[first] - below)
            displacement[first] = common
            displacement[second] = common

        return glue

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Compare both sides."""
        apart = _at(displacement, self.first) - _at(displacement, self.second)
        unbalanced = _at(force, self.first) + _at(force, self.second)
        return Gaps(
            squared(beyond(apart, 2.0 * noise)), squared(beyond(unbalanced, noise))
        )

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces of both sides, which cancel."""
        yield MacroPart(self.rows, np.concatenate([self.macro, self.macro]))


def _at(field: Array, rows: Indices) -> Array:
    """Rows of a field that is contiguous in space, as it lies in memory: (n_times, n)."""
    return np.take(field.T, rows, axis=1)
