"""Plane elasticity on a rectangle of equal elements, and its condensation onto the outline."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import splu

from solver.discrete.problem import Array, Indices

GAUSS = 1.0 / np.sqrt(3.0)
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def elastic_matrix(young: float, poisson: float, state: str) -> Array:
    """Give the matrix from strains (xx, yy, 2 xy) to stresses, shape (3, 3).

    `state` is "strain" or "stress" (Timoshenko and Goodier, Theory of Elasticity, 1970, ch. 2).
    """
    if state == "strain":
        young, poisson = young / (1.0 - poisson**2), poisson / (1.0 - poisson)
    factor = young / (1.0 - poisson**2)
    shear = 0.5 * (1.0 - poisson)
    return factor * np.array([[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, shear]])


def von_mises(stress: Array, poisson: float, state: str) -> Array:
    """Give von Mises' equivalent of stresses (xx, yy, xy), shape (n, 3), as shape (n,).

    In plane strain the stress across the plane is Poisson's ratio times the sum of the other two.
    """
    xx, yy, xy = stress.T
    zz = poisson * (xx + yy) if state == "strain" else np.zeros_like(xx)
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * squares + 3.0 * xy**2))


def strain_matrix(xi: float, eta: float, width: float, height: float) -> Array:
    """Give the matrix from nodal displacements to strains at a point, shape (3, 8)."""
    along = 0.25 * CORNERS[:, 0] * (1.0 + eta * CORNERS[:, 1]) * 2.0 / width
    across = 0.25 * CORNERS[:, 1] * (1.0 + xi * CORNERS[:, 0]) * 2.0 / height
    matrix = np.zeros((3, 8))
    matrix[0, 0::2], matrix[1, 1::2] = along, across
    matrix[2, 0::2], matrix[2, 1::2] = across, along
    return matrix


def element_stiffness(width: float, height: float, elastic: Array) -> Array:
    """Give the stiffness of a rectangular element per unit thickness, shape (8, 8).

    Bilinear, with the two incompatible bending modes of each component condensed, so that thin
    layers bend and nearly incompressible ones deform without locking (Taylor, Beresford and
    Wilson, Int. J. Numer. Meth. Eng. 10, 1976; on rectangles it passes the patch test). Two by
    two Gauss points. Nodes run counter-clockwise from the lower left one.
    """
    area = 0.25 * width * height
    whole = np.zeros((12, 12))
    for xi, eta in GAUSS * CORNERS:
        bending = np.zeros((3, 4))
        bending[0, 0] = bending[2, 1] = -2.0 * xi * 2.0 / width
        bending[2, 2] = bending[1, 3] = -2.0 * eta * 2.0 / height
        strain = np.hstack([strain_matrix(xi, eta, width, height), bending])
        whole += area * strain.T @ elastic @ strain
    stiffness = whole[:8, :8] - whole[:8, 8:] @ np.linalg.solve(whole[8:, 8:], whole[8:, :8])
    return np.asarray(0.5 * (stiffness + stiffness.T))


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
    """

    columns: int
    rows: int
    width: float
    height: float
    elastic: Array

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return (self.columns + 1) * (self.rows + 1)

    @cached_property
    def nodes(self) -> Indices:
        """Number of every node, shape (rows + 1, columns + 1), from below."""
        return np.arange(self.n_nodes, dtype=np.intp).reshape(self.rows + 1, self.columns + 1)

    @cached_property
    def elements(self) -> Indices:
        """Nodes of every element, counter-clockwise, shape (n_elements, 4)."""
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
        own = element_stiffness(self.width, self.height, self.elastic)
        dofs = both(self.elements)
        rows, columns = np.repeat(dofs, 8, axis=1), np.tile(dofs, 8)
        values = np.tile(own.ravel(), len(dofs))
        size = 2 * self.n_nodes
        return sparse.csc_array((values, (rows.ravel(), columns.ravel())), shape=(size, size))

    def edge(self, side: str) -> Indices:
        """Give the nodes of a side in ascending order of their coordinate."""
        nodes = self.nodes
        sides: dict[str, Indices] = {
            "left": nodes[:, 0],
            "right": nodes[:, -1],
            "bottom": nodes[0],
            "top": nodes[-1],
        }
        return sides[side]

    def stress(self, displacement: Array) -> Array:
        """Give stresses (xx, yy, xy) at the centres of the elements.

        Parameters
        ----------
        displacement
            Of all nodes, shape (n_nodes, 2).

        Returns
        -------
        Shape (n_elements, 3), scaled. The incompatible modes have no strain at the centre.
        """
        at_centre = self.elastic @ strain_matrix(0.0, 0.0, self.width, self.height)
        return np.asarray(displacement[self.elements].reshape(-1, 8) @ at_centre.T)


def both(nodes: Indices) -> Indices:
    """Give the two degrees of freedom of nodes, side by side in the last axis."""
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
        """Give the displacement of all nodes from that of the outline.

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
        """Give the displacement of all nodes, shape (n_nodes, 2, n), from what is kept.

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
