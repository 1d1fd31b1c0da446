"""Plane elasticity on rectangles of equal elements, and its condensation onto what is kept.

Corners of an element are numbered counter-clockwise from the lower left; degrees of
freedom are x and y of every corner, or node, in turn.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from itertools import product

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve

from solver.arrays import Array, Indices, sparse_factor
from solver.discrete.substructure import tributary

EDGE_MASS = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
"""From a traction at both ends of an edge of length 1, linear between them, to their
forces."""
LONG_SIDES = 0.6
"""Factor on the macro degree of a side, times the root of its length over the depth
behind it. Of layers 10 to 1000 times as long as thick 1 % of the contact force takes at
most 45 iterations, 50 with 0.4, 42 with 1, and more than 150 without (measured)."""
HIGHEST_DEGREE = 10
"""To which a long side may raise its macro degree. With 6, layers of 200 times their
thickness cut in two up take more than 150 iterations to 1 %; with 8 and 10, 37 and 25
(measured)."""


def elastic_matrix(young: float, poisson: float, state: str) -> Array:
    """Matrix from strains (xx, yy, 2 xy) to stresses, shape (3, 3).

    `state` is "strain" or "stress" (Timoshenko and Goodier, Theory of Elasticity, 1970,
    ch. 2).
    """
    if state == "strain":
        young = young / (1.0 - poisson**2)
        poisson = poisson / (1.0 - poisson)
    factor = young / (1.0 - poisson**2)
    shear = 0.5 * (1.0 - poisson)
    return factor * np.array(
        [[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, shear]]
    )


def von_mises(stress: Array, poisson: float, state: str) -> Array:
    """Von Mises' equivalent of stresses (xx, yy, xy), shape (n, 3), as shape (n,).

    In plane strain the stress across the plane is Poisson's ratio times the sum of the
    other two.
    """
    xx, yy, xy = stress.T
    if state == "strain":
        zz = poisson * (xx + yy)
    else:
        zz = np.zeros_like(xx)
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * squares + 3.0 * xy**2))


def strain_matrix(xi: float, eta: float, width: float, height: float) -> Array:
    """Matrix from displacements of the corners to strains at a point, (3, 8).

    `xi` and `eta` run from -1 to 1 over an element of the given width and height.
    """
    dx = 0.5 * np.array([eta - 1.0, 1.0 - eta, 1.0 + eta, -1.0 - eta]) / width
    dy = 0.5 * np.array([xi - 1.0, -1.0 - xi, 1.0 + xi, 1.0 - xi]) / height
    matrix = np.zeros((3, 8))
    matrix[0, 0::2] = dx
    matrix[1, 1::2] = dy
    matrix[2, 0::2] = dy
    matrix[2, 1::2] = dx
    return matrix


def element_stiffness(width: float, height: float, elastic: Array) -> Array:
    """Stiffness of an element per unit thickness, shape (8, 8), with `elastic_matrix`.

    Bilinear, with the two incompatible bending modes of each component condensed
    (Taylor, Beresford and Wilson, Int. J. Numer. Meth. Eng. 10, 1976): it does not lock
    where thin layers bend or bodies are nearly incompressible, and passes the patch
    test on rectangles.
    """
    stiffness = np.zeros((12, 12))
    for eta, xi in product(leggauss(2)[0].tolist(), repeat=2):
        at = xi, eta, width, height
        strain = np.hstack([strain_matrix(*at), _bending(*at)])
        stiffness += 0.25 * width * height * strain.T @ elastic @ strain
    coupling = stiffness[8:, :8]
    stiffness = stiffness[:8, :8] - coupling.T @ np.linalg.solve(
        stiffness[8:, 8:], coupling
    )
    return np.asarray(0.5 * (stiffness + stiffness.T))


def _bending(xi: float, eta: float, width: float, height: float) -> Array:
    """Strains of 1 - xi^2 and 1 - eta^2 of both components, shape (3, 4)."""
    strain = np.zeros((3, 4))
    strain[0, 0] = strain[2, 1] = -2.0 * xi * 2.0 / width
    strain[2, 2] = strain[1, 3] = -2.0 * eta * 2.0 / height
    return strain


@dataclass(frozen=True, eq=False)
class Rectangle:
    """A rectangle of equal elements; nodes are numbered row by row from the lower left.

    Width and height are those of an element, scaled; so is `elastic`, as of
    `elastic_matrix`.
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
        shape = self.rows + 1, self.columns + 1
        return np.arange(self.n_nodes, dtype=np.intp).reshape(shape)

    @cached_property
    def elements(self) -> Indices:
        """Corners of every element, counter-clockwise, row by row, shape (n_elements, 4)."""
        n = self.nodes
        corners = n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]
        return np.stack([corner.ravel() for corner in corners], axis=1)

    @cached_property
    def stiffness(self) -> sparse.csc_array:
        """Stiffness of all nodes, two degrees of freedom each, shape (2 n_nodes, 2 n_nodes)."""
        own = element_stiffness(self.width, self.height, self.elastic)
        dofs = dofs_of(self.elements)
        rows = np.repeat(dofs, len(own), axis=1)
        columns = np.tile(dofs, len(own))
        values = np.tile(own.ravel(), len(dofs))
        size = 2 * self.n_nodes
        return sparse.csc_array(
            (values, (rows.ravel(), columns.ravel())), shape=(size, size)
        )

    @cached_property
    def outline(self) -> SchurComplement:
        """Its stiffness, seen from the degrees of freedom on its outline."""
        is_outer = np.ones_like(self.nodes, dtype=bool)
        is_outer[1:-1, 1:-1] = False
        return SchurComplement(self.stiffness, dofs_of(self.nodes[is_outer]))

    def edge(self, side: str) -> Indices:
        """Nodes of a side in ascending order of their coordinate."""
        if side in ("bottom", "top"):
            lines = self.nodes
        else:
            lines = self.nodes.T
        return np.asarray(lines[0 if side in ("bottom", "left") else -1])

    def edge_weights(self, side: str) -> Array:
        """Length of a side that belongs to each of its nodes, scaled."""
        upright = side in ("left", "right")
        if upright:
            count = self.rows
            step = self.height
        else:
            count = self.columns
            step = self.width
        return step * tributary(count)

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at the centres of the elements, (n_elements, 3), scaled.

        From the displacement of all nodes, (n_nodes, 2); incompatible modes have no
        strain there.
        """
        strain = strain_matrix(0.0, 0.0, self.width, self.height)
        own = displacement[self.elements].reshape(len(self.elements), -1)
        return np.asarray(own @ (self.elastic @ strain).T)


def dofs_of(nodes: Indices) -> Indices:
    """Both degrees of freedom of nodes, side by side in the last axis."""
    return np.stack([2 * nodes, 2 * nodes + 1], axis=-1).reshape(*nodes.shape[:-1], -1)


def side_basis(rectangle: Rectangle, side: str, n_points: int, degree: int) -> Array:
    """Polynomials over a side of a substructure, shape (n_points, n_macro).

    What balances only point by point may bend the side, which resists with E d^3 q^4 /
    24 per area at the wavenumber q, where d is the depth behind it. Bending waves that
    are long beside d are so soft that no k suits both them and the waves shorter than
    d: the macro forces are to balance them. Those softer than E d / l^2 over the length
    l, as soft as its stretching, number some 0.7 times the root of l / d. `n_points` of
    the side have rows, and `degree` is that of one that is not long.
    """
    ratio = rectangle.columns * rectangle.width / (rectangle.rows * rectangle.height)
    if side in ("bottom", "top"):
        slenderness = ratio
    else:
        slenderness = 1.0 / ratio
    wanted = round(degree * max(LONG_SIDES * np.sqrt(slenderness), 1.0))
    highest = min(wanted, max(HIGHEST_DEGREE, degree), n_points - 1)
    return np.asarray(legvander(np.linspace(-1.0, 1.0, n_points), highest))


class SchurComplement:
    """A symmetric stiffness, sparse or condensed already, seen from some degrees of freedom.

    These are `kept`, ascending, and have a dense `stiffness`, shape (n_kept, n_kept).

    Raises
    ------
    np.linalg.LinAlgError
        Where holding what is kept would leave one that is condensed already free to
        move.
    """

    def __init__(
        self, whole: sparse.csc_array | SchurComplement, kept: Indices
    ) -> None:
        self.kept = kept
        self._before = None
        places = kept
        stiffness: sparse.csc_array | Array
        if isinstance(whole, SchurComplement):
            self._before = whole
            stiffness = whole.stiffness
            places = np.searchsorted(whole.kept, kept)
        else:
            stiffness = whole
        self._size = stiffness.shape[0]
        self._places = places
        self._rest = np.setdiff1d(np.arange(self._size), places)
        own = _dense(stiffness[places][:, places])
        others = stiffness[self._rest]
        if len(self._rest):
            coupling = _dense(others[:, places])
            inner = others[:, self._rest]
            if isinstance(inner, np.ndarray):
                self._solve = partial(cho_solve, cho_factor(inner))
            else:
                self._solve = sparse_factor(sparse.csc_array(inner)).solve
            self._response = self._solve(coupling)
            own -= coupling.T @ self._response
        self.stiffness: Array = 0.5 * (own + own.T)

    def condense(self, force: Array) -> Array:
        """Bring forces, shape (n, n_columns), onto what is kept, shape (n_kept, n_columns)."""
        if self._before is not None:
            force = self._before.condense(force)
        if not len(self._rest):
            return np.asarray(force[self._places])
        return np.asarray(force[self._places] - self._response.T @ force[self._rest])

    def recover(self, kept: Array, force: Array | None) -> Array:
        """Displacement of all, shape (n, n_columns), from that of what is kept, under forces."""
        nearer = force
        if self._before is not None and force is not None:
            nearer = self._before.condense(force)
        whole = np.empty((self._size, kept.shape[1]))
        whole[self._places] = kept
        if len(self._rest):
            rest = -(self._response @ kept)
            if nearer is not None:
                rest += self._solve(np.ascontiguousarray(nearer[self._rest]))
            whole[self._rest] = rest
        if self._before is None:
            return whole
        return self._before.recover(whole, force)


def _dense(block: sparse.csc_array | Array) -> Array:
    return np.asarray(
        block if isinstance(block, np.ndarray) else block.toarray(), order="C"
    )
