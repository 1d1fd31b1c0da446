"""Plane elasticity on a rectangle of equal elements, and its condensation onto the outline."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import splu

from solver.arrays import Array, Indices
from solver.discrete.elements import (
    element_stiffness,
    projected_strain_matrix,
    shares,
    strain_matrix,
)


@dataclass(frozen=True, eq=False)
class Rectangle:
    """A rectangle of equal elements; nodes are numbered row by row from the lower left.

    Attributes
    ----------
    columns, rows
        Elements along x and y.
    width, height
        Size of an element, scaled.
    elastic
        As of `elastic_matrix`, scaled.
    order
        Of the elements: 1 bilinear, 2 biquadratic.
    """

    columns: int
    rows: int
    width: float
    height: float
    elastic: Array
    order: int = 1

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return (self.order * self.columns + 1) * (self.order * self.rows + 1)

    @cached_property
    def nodes(self) -> Indices:
        """Number of every node, shape (order rows + 1, order columns + 1), from below."""
        shape = self.order * self.rows + 1, self.order * self.columns + 1
        return np.arange(self.n_nodes, dtype=np.intp).reshape(shape)

    @cached_property
    def elements(self) -> Indices:
        """Nodes of every element, row by row, shape (n_elements, (order + 1)^2)."""
        size = self.order + 1
        windows = np.lib.stride_tricks.sliding_window_view(self.nodes, (size, size))
        return np.asarray(windows[:: self.order, :: self.order].reshape(-1, size * size))

    @cached_property
    def cells(self) -> Indices:
        """Quadrilaterals between neighbouring nodes, counter-clockwise, shape (n_cells, 4).

        An element, or a quarter of a biquadratic one; row by row over the whole rectangle.
        """
        n = self.nodes
        corners = n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]
        return np.stack([corner.ravel() for corner in corners], axis=1)

    @cached_property
    def outline(self) -> Indices:
        """Nodes on the outline, in ascending order."""
        inner = np.zeros_like(self.nodes, dtype=bool)
        inner[1:-1, 1:-1] = True
        return np.asarray(self.nodes[~inner])

    @cached_property
    def stiffness(self) -> sparse.csc_array:
        """Stiffness of all nodes, two degrees of freedom each, shape (2 n_nodes, 2 n_nodes)."""
        own = element_stiffness(self.order, self.width, self.height, self.elastic)
        dofs = both(self.elements)
        rows, columns = np.repeat(dofs, len(own), axis=1), np.tile(dofs, len(own))
        values = np.tile(own.ravel(), len(dofs))
        size = 2 * self.n_nodes
        return sparse.csc_array((values, (rows.ravel(), columns.ravel())), shape=(size, size))

    def edge(self, side: str) -> Indices:
        """Nodes of a side in ascending order of their coordinate."""
        nodes = self.nodes
        sides: dict[str, Indices] = {
            "left": nodes[:, 0],
            "right": nodes[:, -1],
            "bottom": nodes[0],
            "top": nodes[-1],
        }
        return sides[side]

    def edge_weights(self, side: str) -> Array:
        """Length of a side that belongs to each of its nodes, scaled."""
        upright = side in ("left", "right")
        count, step = (self.rows, self.height) if upright else (self.columns, self.width)
        found = np.zeros(self.order * count + 1)
        for place, share in enumerate(shares(self.order)):
            found[place : place + self.order * count : self.order] += step * share
        return found

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at the centres of the cells.

        Parameters
        ----------
        displacement
            Of all nodes, shape (n_nodes, 2).

        Returns
        -------
        Shape (n_cells, 3), scaled. The incompatible modes have no strain at the centre.
        """
        own = displacement[self.elements].reshape(self.rows, self.columns, -1)
        found = np.empty((self.rows, self.order, self.columns, self.order, 3))
        centres = (np.arange(self.order) + 0.5) * 2.0 / self.order - 1.0
        for up, eta in enumerate(centres):
            for along, xi in enumerate(centres):
                at = float(xi), float(eta), self.width, self.height
                strain = strain_matrix(1, *at) if self.order == 1 else projected_strain_matrix(*at)
                found[:, up, :, along] = own @ (self.elastic @ strain).T
        return found.reshape(-1, 3)


def both(nodes: Indices) -> Indices:
    """Two degrees of freedom of nodes, side by side in the last axis."""
    return np.stack([2 * nodes, 2 * nodes + 1], axis=-1).reshape(*nodes.shape[:-1], -1)


class Condensed:
    """A rectangle seen from its outline: Schur complement, and what happens inside.

    Attributes
    ----------
    rectangle
        The mesh.
    stiffness
        Shape (n_outline, n_outline), dense, symmetric; n_outline counts degrees of freedom.
    dofs
        Degrees of freedom of the outline among those of the rectangle.
    """

    def __init__(self, rectangle: Rectangle) -> None:
        whole = rectangle.stiffness
        self.rectangle = rectangle
        self.dofs = both(rectangle.outline)
        self._inner = np.setdiff1d(np.arange(whole.shape[0]), self.dofs)
        outer = whole[self.dofs][:, self.dofs].toarray()
        self._factor = None
        if len(self._inner):
            self._factor = splu(sparse.csc_array(whole[self._inner][:, self._inner]))
            self._coupling = whole[self._inner][:, self.dofs].toarray()
            self._inside = self._factor.solve(self._coupling)
            outer -= self._coupling.T @ self._inside
        self.stiffness: Array = 0.5 * (outer + outer.T)

    def condense(self, force: Array) -> Array:
        """Bring nodal forces, shape (2 n_nodes, n), onto the outline, shape (n_outline, n)."""
        if self._factor is None:
            return np.asarray(force[self.dofs])
        return np.asarray(force[self.dofs] - self._inside.T @ force[self._inner])

    def recover(self, outline: Array, force: Array | None) -> Array:
        """Displacement of all nodes from that of the outline.

        Parameters
        ----------
        outline
            Shape (n_outline, n).
        force
            Nodal forces, shape (2 n_nodes, n), or None.

        Returns
        -------
        Shape (n_nodes, 2, n).
        """
        found = np.empty((2 * self.rectangle.n_nodes, outline.shape[1]))
        found[self.dofs] = outline
        if self._factor is not None:
            inner = -(self._inside @ outline)
            if force is not None:
                inner += self._factor.solve(np.ascontiguousarray(force[self._inner]))
            found[self._inner] = inner
        return found.reshape(-1, 2, outline.shape[1])


class Kept:
    """A condensed rectangle seen from some degrees of freedom of its outline alone.

    Attributes
    ----------
    condensed
        The rectangle.
    stiffness
        Shape (n_kept, n_kept), dense, symmetric.
    dofs
        The kept degrees of freedom among those of the rectangle, ascending.

    Raises
    ------
    np.linalg.LinAlgError
        Where holding these would leave the rectangle free to move.
    """

    def __init__(self, condensed: Condensed, dofs: Indices) -> None:
        self.condensed = condensed
        self.dofs = dofs
        self._own = np.searchsorted(condensed.dofs, dofs)
        self._left = np.setdiff1d(np.arange(len(condensed.dofs)), self._own)
        whole = condensed.stiffness
        self.stiffness: Array = whole[np.ix_(self._own, self._own)]
        if len(self._left):
            coupling = whole[np.ix_(self._left, self._own)]
            self._factor = cho_factor(whole[np.ix_(self._left, self._left)])
            self._inside = cho_solve(self._factor, coupling)
            found = self.stiffness - coupling.T @ self._inside
            self.stiffness = 0.5 * (found + found.T)

    def condense(self, force: Array) -> Array:
        """Bring nodal forces, shape (2 n_nodes, n), onto what is kept, shape (n_kept, n)."""
        outline = self.condensed.condense(force)
        if not len(self._left):
            return outline
        return np.asarray(outline[self._own] - self._inside.T @ outline[self._left])

    def recover(self, kept: Array, force: Array | None) -> Array:
        """Displacement of all nodes, shape (n_nodes, 2, n), from what is kept.

        Parameters
        ----------
        kept
            Shape (n_kept, n).
        force
            Nodal forces, shape (2 n_nodes, n), or None.
        """
        outline = np.empty((len(self.condensed.dofs), kept.shape[1]))
        outline[self._own] = kept
        if len(self._left):
            outline[self._left] = -(self._inside @ kept)
            if force is not None:
                on_outline = self.condensed.condense(force)[self._left]
                outline[self._left] += cho_solve(self._factor, on_outline)
        return self.condensed.recover(outline, force)
