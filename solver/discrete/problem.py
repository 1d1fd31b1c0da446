"""The discrete problem: matrices, traces, laws and macro bases; no options and no state.

Everything here is scaled (see `Scales`). A boundary row is one displacement component of one
interface point as one substructure sees it; an interface owns rows, and so does a substructure.
Fields on the boundary have shape (n_rows, n_instants), and those of one instant are contiguous in
memory (Fortran order), because the friction law walks through time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.laws import Dirichlet, Friction, Interface, Neumann, Perfect

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def space_time(n_rows: int, n_instants: int) -> Array:
    """Allocate a zero field of shape (n_rows, n_instants), contiguous in space."""
    return np.zeros((n_rows, n_instants), order="F")


@dataclass(frozen=True)
class Scales:
    """Units in which a problem is written, so that no method sees the size of a pascal.

    Attributes
    ----------
    displacement, force, time
        One scaled unit of each, in m, N and s.
    """

    displacement: float
    force: float
    time: float


@dataclass(frozen=True)
class Elasticity:
    """The elastic operator that identical substructures share.

    Attributes
    ----------
    stiffness
        Shape (n_dofs, n_dofs), symmetric, positive semi-definite.
    trace
        Degree of freedom of each boundary row, shape (n_boundary,). Rows of two interfaces that
        meet at a point share a degree of freedom.
    direction
        The paper's search direction k of each boundary row, shape (n_boundary,), positive.
    """

    stiffness: sparse.csr_array
    trace: Indices
    direction: Array


@dataclass(frozen=True)
class Substructure:
    """One part of the structure.

    Attributes
    ----------
    elasticity
        Shared by identity with all substructures of the same shape.
    dofs
        Its degrees of freedom in the whole structure, shape (n_dofs,).
    rows
        Its boundary rows, shape (n_boundary,).
    body_force
        Nodal forces inside, shape (n_dofs, n_instants), or None.
    """

    elasticity: Elasticity
    dofs: Indices
    rows: Indices
    body_force: Array | None


@dataclass(frozen=True)
class Problem:
    """A structure as an assembly of substructures and interfaces (paper, section 2).

    Attributes
    ----------
    substructures
        All substructures, in order.
    interfaces
        All interfaces by name; together they own every boundary row once.
    positions
        Coordinates of the degrees of freedom of the whole structure, shape (n_dofs,), in m.
    instants
        Shape (n_instants,), in s.
    scales
        What one scaled unit is in SI.
    """

    substructures: tuple[Substructure, ...]
    interfaces: Mapping[str, Interface]
    positions: Array
    instants: Array
    scales: Scales

    @cached_property
    def n_rows(self) -> int:
        """Number of boundary rows."""
        return sum(len(part.rows) for part in self.substructures)

    @property
    def n_instants(self) -> int:
        """Number of instants."""
        return len(self.instants)

    @property
    def n_dofs(self) -> int:
        """Number of degrees of freedom of the whole structure."""
        return len(self.positions)

    @cached_property
    def direction(self) -> Array:
        """The paper's search direction k of every row, shape (n_rows,)."""
        k = np.empty(self.n_rows)
        for part in self.substructures:
            k[part.rows] = part.elasticity.direction
        return k

    @cached_property
    def row_dofs(self) -> Indices:
        """Degree of freedom of the whole structure under every row, shape (n_rows,)."""
        dofs = np.empty(self.n_rows, dtype=np.intp)
        for part in self.substructures:
            dofs[part.rows] = part.dofs[part.elasticity.trace]
        return dofs

    @cached_property
    def time_weights(self) -> Array:
        """Trapezoidal weights of the instants, shape (n_instants,), scaled."""
        if self.n_instants == 1:
            return np.ones(1)
        steps = np.diff(self.instants) / self.scales.time
        weights = np.zeros(self.n_instants)
        weights[:-1] += 0.5 * steps
        weights[1:] += 0.5 * steps
        return weights

    def of_law(self, law: type) -> list[Interface]:
        """Give the interfaces that obey one law."""
        return [interface for interface in self.interfaces.values() if type(interface) is law]

    @cached_property
    def friction(self) -> Friction:
        """The frictional interface."""
        (found,) = self.of_law(Friction)
        assert isinstance(found, Friction)
        return found

    @cached_property
    def has_cuts(self) -> bool:
        """Whether any two substructures meet."""
        return bool(self.of_law(Perfect))

    @cached_property
    def macro(self) -> tuple[sparse.csr_array, Array]:
        """Macro basis of all interfaces whose macro forces are in equilibrium, and their load.

        Returns
        -------
        P, shape (n_rows, n_macro), and P^T F_d, shape (n_macro, n_instants) (paper, eq. 1;
        theory.md, 2).
        """
        entries, places, numbers, loads = [], [], [], []
        n_macro = 0
        for interface in self.interfaces.values():
            if isinstance(interface, Perfect):
                rows = np.concatenate([interface.first, interface.second])
                basis = np.concatenate([interface.macro, interface.macro])
                load = np.zeros((basis.shape[1], self.n_instants))
            elif isinstance(interface, Neumann):
                rows, basis = interface.rows, interface.macro
                load = basis.T @ interface.force
            else:
                continue
            own = basis.shape[1]
            entries.append(basis.ravel())
            places.append(rows.repeat(own))
            numbers.append(np.arange(n_macro, n_macro + own)[None].repeat(len(rows), 0).ravel())
            loads.append(load)
            n_macro += own
        found = (np.concatenate(entries), (np.concatenate(places), np.concatenate(numbers)))
        shape = (self.n_rows, n_macro)
        return sparse.csr_array(found, shape=shape), np.concatenate(loads)

    @cached_property
    def mean_of_rows(self) -> sparse.csr_array:
        """Mean over the rows of each degree of freedom, shape (n_dofs, n_rows)."""
        total = sparse.csr_array(
            (np.ones(self.n_rows), (self.row_dofs, np.arange(self.n_rows))),
            shape=(self.n_dofs, self.n_rows),
        )
        counts = np.asarray(total.sum(axis=1)).ravel()
        return sparse.csr_array(sparse.diags_array(1.0 / np.maximum(counts, 1.0)) @ total)

    @cached_property
    def sum_of_friction(self) -> sparse.csr_array:
        """Sum over the rows of each point of the frictional interface, (n_points, n_rows)."""
        law = self.friction
        return sparse.csr_array(
            (np.ones(len(law.rows)), (law.points, law.rows)),
            shape=(len(law.positions), self.n_rows),
        )

    @cached_property
    def prescribed(self) -> tuple[Indices, Array]:
        """Degrees of freedom with prescribed displacement, and its values (n, n_instants)."""
        parts = [law for law in self.of_law(Dirichlet) if isinstance(law, Dirichlet)]
        rows = np.concatenate([law.rows for law in parts])
        return self.row_dofs[rows], np.concatenate([law.displacement for law in parts])
