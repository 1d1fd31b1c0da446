"""The discrete problem: matrices, traces, laws and macro bases; no options and no state.

Everything here is scaled (see `Scales`). A boundary row is one displacement component of one
interface point as one substructure sees it; an interface owns rows, and so does a substructure.
Fields on the boundary have shape (n_rows, n_instants), and those of one instant are contiguous in
memory (Fortran order), because the friction law walks through time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.laws import Contact, Dirichlet, Friction, Interface, Neumann, Perfect
from solver.laws.friction import as_slice

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
        Shape (n_dofs, n_dofs), symmetric, positive semi-definite; sparse, or dense where the inside
        is condensed.
    trace
        Degree of freedom of each boundary row, shape (n_boundary,). Rows of two interfaces that
        meet at a point share a degree of freedom.
    direction
        The paper's search direction k of each boundary row, shape (n_boundary,), positive.
    """

    stiffness: sparse.csr_array | Array
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


class Inside(Protocol):
    """What lies inside condensed substructures, found when somebody looks.

    Attributes
    ----------
    nodes
        Coordinates of all nodes, shape (n_nodes, 2), m.
    elements
        Corners of every element, counter-clockwise, shape (n_elements, 4); a biquadratic one counts
        as its four quarters.
    bodies
        Body of every element, shape (n_elements,).
    components
        Of every degree of freedom of the problem, 0 along x and 1 along y, shape (n_dofs,).
    """

    nodes: Array
    elements: Indices
    bodies: Indices
    components: Indices

    def displacement(self, skeleton: Array, instants: slice | list[int]) -> Array:
        """Give the displacement of all nodes, shape (n_nodes, 2, n), m.

        Parameters
        ----------
        skeleton
            Displacement of the problem's degrees of freedom, (n_dofs, n_instants), m.
        instants
            Which of them.
        """

    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Bring a weighted sum of all nodes' displacements onto the degrees of freedom.

        Parameters
        ----------
        weights
            Shape (n_nodes, 2).

        Returns
        -------
        Weights of the problem's degrees of freedom, shape (n_dofs,), and what loads inside add,
        shape (n_instants,), m.
        """

    def stress(self, displacement: Array) -> Array:
        """Give stresses (xx, yy, xy) at element centres, shape (n_elements, 3), Pa.

        `displacement` is that of all nodes at one instant, shape (n_nodes, 2), m.
        """


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
        Coordinates of the degrees of freedom of the whole structure, in m: shape (n_dofs,) along a
        rod, (n_dofs, 2) in the plane.
    instants
        Shape (n_instants,), in s.
    scales
        What one scaled unit is in SI.
    inside
        What the degrees of freedom do not show, where substructures are condensed; else None.
    rest
        Displacement that the method may start from, scaled, shape (n_dofs, n_instants): that of a
        body which falls onto its support as if it were rigid. None is no displacement.
    """

    substructures: tuple[Substructure, ...]
    interfaces: Mapping[str, Interface]
    positions: Array
    instants: Array
    scales: Scales
    inside: Inside | None = None
    rest: Array | None = None

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
    def sliding(self) -> tuple[Indices, Array]:
        """Rows of all tangential components, of both sides, and their weights (m, or m^2)."""
        pairs = [(rows, law.weights) for law in self.rubbing.values() for rows in sliding_rows(law)]
        rows, weights = zip(*pairs, strict=True)
        return np.concatenate(rows), np.concatenate(weights)

    @cached_property
    def rubbing_rows(self) -> slice | Indices:
        """Rows of all components of the bodies above at interfaces with friction."""
        parts = [rows for law in self.rubbing.values() for rows in components(law)]
        return as_slice(np.unique(np.concatenate(parts)))

    @cached_property
    def friction(self) -> Friction:
        """The frictional interface of known bound, where it is the only one."""
        (found,) = self.of_law(Friction)
        assert isinstance(found, Friction)
        return found

    @cached_property
    def rubbing(self) -> dict[str, Friction | Contact]:
        """The interfaces with friction, by name."""
        return {
            name: law
            for name, law in self.interfaces.items()
            if isinstance(law, Friction | Contact)
        }

    @cached_property
    def has_cuts(self) -> bool:
        """Whether any two substructures meet, glued or in contact."""
        return bool(self.of_law(Perfect)) or any(
            law.macro is not None for law in self.rubbing.values()
        )

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
            for own, basis, load in _macro(interface):
                row, column = np.nonzero(basis) if isinstance(basis, np.ndarray) else basis.coords
                entries.append(basis[row, column] if isinstance(basis, np.ndarray) else basis.data)
                places.append(own[row])
                numbers.append(n_macro + column)
                loads.append(np.zeros((basis.shape[1], self.n_instants)) if load is None else load)
                n_macro += basis.shape[1]
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
    def sum_of_contact(self) -> sparse.csr_array:
        """Sum over the rows of each point and component of all interfaces with friction.

        Returns
        -------
        Shape (n_forces, n_rows). The forces on the body above are stacked interface by interface:
        of `Friction` the friction forces, of `Contact` all normal forces and then all tangential
        ones.
        """
        blocks = [
            sparse.csr_array(
                (np.ones(len(rows)), (law.points, rows)), shape=(len(law.positions), self.n_rows)
            )
            for law in self.rubbing.values()
            for rows in components(law)
        ]
        return sparse.csr_array(sparse.vstack(blocks))

    @cached_property
    def contact_places(self) -> dict[str, tuple[slice, ...]]:
        """Where the components of each interface stand in a stack of contact forces, by name."""
        found, first = {}, 0
        for name, law in self.rubbing.items():
            size = len(law.positions)
            starts = [first + size * number for number in range(len(components(law)))]
            found[name] = tuple(slice(start, start + size) for start in starts)
            first = starts[-1] + size
        return found

    @cached_property
    def prescribed(self) -> tuple[Indices, Array]:
        """Degrees of freedom with prescribed displacement, each once, and its values.

        Shapes (n,) and (n, n_instants).
        """
        parts = [law for law in self.of_law(Dirichlet) if isinstance(law, Dirichlet)]
        none = np.zeros(0, dtype=np.intp), np.zeros((0, self.n_instants))
        rows = np.concatenate([none[0], *(law.rows for law in parts)])
        dofs, first = np.unique(self.row_dofs[rows], return_index=True)
        return dofs, np.concatenate([none[1], *(law.displacement for law in parts)])[first]


def _macro(
    interface: Interface,
) -> Iterator[tuple[Indices, Array | sparse.coo_array, Array | None]]:
    """Give the rows of both sides, their macro basis, and their load, for each component."""
    match interface:
        case Perfect():
            rows, macro = np.concatenate([interface.first, interface.second]), interface.macro
            yield rows, np.concatenate([macro, macro]), None
        case Neumann():
            load = interface.macro.T @ interface.force
            yield interface.rows, interface.macro, load
        case Friction(macro=macro) | Contact(macro=macro) if macro is not None:
            both_sides = sparse.coo_array(sparse.vstack([macro, macro]))
            sides = zip(components(interface), components_below(interface), strict=True)
            for above, below in sides:
                yield np.concatenate([above, below]), both_sides, None


def components(law: Friction | Contact) -> tuple[Indices, ...]:
    """Give the rows of the body above, one array for each component of force."""
    return (law.rows,) if isinstance(law, Friction) else (law.normal, law.tangent)


def components_below(law: Friction | Contact) -> tuple[Indices, ...]:
    """Give the rows of the body below in the same order; nothing on a rigid support."""
    if law.below is None:
        return ()
    return (law.below,) if isinstance(law, Friction) else law.below


def sliding_rows(law: Friction | Contact) -> tuple[Indices, ...]:
    """Give the rows of the tangential components, of both sides."""
    return (components(law)[-1], *components_below(law)[-1:])
