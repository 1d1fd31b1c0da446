"""Interfaces with the outside: prescribed displacement, prescribed force (solver/README.md, 2)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from solver.arrays import Array, Indices, as_slice
from solver.laws.interface import (
    Gaps,
    Interface,
    MacroPart,
    RowValues,
    Rule,
    beyond,
    squared,
)


@dataclass(frozen=True)
class Dirichlet(Interface):
    """Prescribed displacement.

    Attributes
    ----------
    rows
        Boundary rows, shape (n_rows,).
    displacement
        Shape (n_rows, n_times).
    """

    rows: Indices
    displacement: Array

    def rule(self, k: Array, n_instants: int) -> Rule:
        """W^ is the displacement that is prescribed."""
        rows, given = as_slice(self.rows), self.displacement

        def prescribe(_incoming: Array, displacement: Array, instants: slice) -> None:
            displacement[rows] = given[:, instants]

        return prescribe

    def gaps(self, displacement: Array, force: Array, noise: float) -> Gaps:
        """Compare the displacement with that prescribed."""
        missed = beyond(displacement[self.rows] - self.displacement, noise)
        return Gaps(displacement=squared(missed))

    def during(self, instants: slice) -> Self:
        """Law of some instants alone."""
        return replace(self, displacement=self.displacement[:, instants])

    @property
    def given_displacement(self) -> RowValues:
        """The displacement."""
        return RowValues(self.rows, self.displacement)

    @property
    def acts(self) -> bool:
        """Whether anything moves."""
        return bool(self.displacement.any())


@dataclass(frozen=True)
class Neumann(Interface):
    """Prescribed force.

    Attributes
    ----------
    rows
        Boundary rows, shape (n_rows,).
    force
        Nodal forces on the body, shape (n_rows, n_times).
    macro
        Macro basis of the interface, shape (n_rows, n_macro).
    """

    rows: Indices
    force: Array
    macro: Array

    def rule(self, k: Array, n_instants: int) -> Rule:
        """Move by F_d / k."""
        rows = as_slice(self.rows)
        moved = self.force / k[self.rows, None]

        def push(incoming: Array, displacement: Array, instants: slice) -> None:
            displacement[rows] = incoming[rows] + moved[:, instants]

        return push

    def gaps(self, displacement: Array, force: Array, noise: float) -> Gaps:
        """Compare the force with that prescribed."""
        return Gaps(force=squared(beyond(force[self.rows] - self.force, noise)))

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces, which the load balances."""
        yield MacroPart(self.rows, self.macro, np.asarray(self.macro.T @ self.force))

    def during(self, instants: slice) -> Self:
        """Law of some instants alone."""
        return replace(self, force=self.force[:, instants])

    @property
    def given_force(self) -> RowValues:
        """The force."""
        return RowValues(self.rows, self.force)

    @property
    def acts(self) -> bool:
        """Whether anything pulls."""
        return bool(self.force.any())
