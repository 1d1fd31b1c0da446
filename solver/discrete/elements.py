"""Rectangular elements of plane elasticity: shape functions, strains, stiffness.

The nodes of an element are a grid of (order + 1) x (order + 1), numbered row by row from the lower
left; degrees of freedom are x and y of every node in turn.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.polynomial.legendre import leggauss

from solver.arrays import Array


def elastic_matrix(young: float, poisson: float, state: str) -> Array:
    """Matrix from strains (xx, yy, 2 xy) to stresses, shape (3, 3).

    `state` is "strain" or "stress" (Timoshenko and Goodier, Theory of Elasticity, 1970, ch. 2).
    """
    if state == "strain":
        young, poisson = young / (1.0 - poisson**2), poisson / (1.0 - poisson)
    factor = young / (1.0 - poisson**2)
    shear = 0.5 * (1.0 - poisson)
    return factor * np.array([[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, shear]])


def von_mises(stress: Array, poisson: float, state: str) -> Array:
    """Von Mises' equivalent of stresses (xx, yy, xy), shape (n, 3), as shape (n,).

    In plane strain the stress across the plane is Poisson's ratio times the sum of the other two.
    """
    xx, yy, xy = stress.T
    zz = poisson * (xx + yy) if state == "strain" else np.zeros_like(xx)
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * squares + 3.0 * xy**2))


@cache
def edge_mass(order: int) -> Array:
    """Matrix from a traction at an edge's nodes to their forces, for an edge of length 1.

    Shape (order + 1, order + 1), read-only; exact where the traction varies like the shape
    functions. Its sums are each node's share of the length: trapezium or Simpson's rule.
    """
    places, weights = leggauss(order + 1)
    values = np.array([_shape(order, xi)[0] for xi in places])
    matrix = np.asarray(0.5 * values.T @ (weights[:, None] * values))
    matrix.flags.writeable = False
    return matrix


def strain_matrix(order: int, xi: float, eta: float, width: float, height: float) -> Array:
    """Matrix from nodal displacements to strains at a point, (3, 2 (order + 1)^2).

    `xi` and `eta` run from -1 to 1 over an element of the given width and height.
    """
    (along, along_slope), (up, up_slope) = _shape(order, xi), _shape(order, eta)
    dx = np.outer(up, along_slope).ravel() * 2.0 / width
    dy = np.outer(up_slope, along).ravel() * 2.0 / height
    matrix = np.zeros((3, 2 * len(dx)))
    matrix[0, 0::2], matrix[1, 1::2] = dx, dy
    matrix[2, 0::2], matrix[2, 1::2] = dy, dx
    return matrix


def element_stiffness(order: int, width: float, height: float, elastic: Array) -> Array:
    """Stiffness of an element per unit thickness, shape (n, n), n = 2 (order + 1)^2.

    Neither kind locks where thin layers bend or bodies are nearly incompressible; both pass the
    patch test on rectangles.

    Parameters
    ----------
    order
        1: bilinear, with the two incompatible bending modes of each component condensed (Taylor,
        Beresford and Wilson, Int. J. Numer. Meth. Eng. 10, 1976). Two by two Gauss points.
        2: biquadratic, the dilatation replaced by the nearest that is linear over the element, so
        that the mean stress has no spurious modes (Hughes, The Finite Element Method, 1987, 4.4
        and 4.5). Three by three Gauss points.
    width, height, elastic
        Of the element; as of `elastic_matrix`.
    """
    stiffness = np.zeros((12, 12) if order == 1 else (18, 18))
    for xi, eta, share in _gauss_points(order + 1):
        at = xi, eta, width, height
        if order == 1:
            strain = np.hstack([strain_matrix(1, *at), _bending(*at)])
        else:
            strain = projected_strain_matrix(*at)
        stiffness += share * width * height * strain.T @ elastic @ strain
    if order == 1:
        coupling = stiffness[8:, :8]
        stiffness = stiffness[:8, :8] - coupling.T @ np.linalg.solve(stiffness[8:, 8:], coupling)
    return np.asarray(0.5 * (stiffness + stiffness.T))


def projected_strain_matrix(xi: float, eta: float, width: float, height: float) -> Array:
    """Strains of a biquadratic element, its dilatation projected, shape (3, 18)."""
    matrix = strain_matrix(2, xi, eta, width, height)
    projected = np.zeros(18)
    for right, up, share in _gauss_points(3):
        # 1, xi and eta are orthogonal; their squares have means of 1, 1/3 and 1/3.
        kernel = share * (1.0 + 3.0 * xi * right + 3.0 * eta * up)
        projected += kernel * strain_matrix(2, right, up, width, height)[:2].sum(axis=0)
    matrix[:2] += 0.5 * (projected - matrix[:2].sum(axis=0))
    return matrix


def _gauss_points(count: int) -> list[tuple[float, float, float]]:
    """Places, and shares of the area, of count x count points."""
    places, weights = (values.tolist() for values in leggauss(count))
    along = list(zip(places, weights, strict=True))
    return [(xi, eta, 0.25 * one * other) for eta, one in along for xi, other in along]


def _bending(xi: float, eta: float, width: float, height: float) -> Array:
    """Strains of 1 - xi^2 and 1 - eta^2 of both components, shape (3, 4)."""
    strain = np.zeros((3, 4))
    strain[0, 0] = strain[2, 1] = -2.0 * xi * 2.0 / width
    strain[2, 2] = strain[1, 3] = -2.0 * eta * 2.0 / height
    return strain


def _shape(order: int, xi: float) -> tuple[Array, Array]:
    """Lagrange's polynomials on equidistant nodes of [-1, 1], and their slopes."""
    if order == 1:
        return np.array([0.5 * (1.0 - xi), 0.5 * (1.0 + xi)]), np.array([-0.5, 0.5])
    values = np.array([0.5 * xi * (xi - 1.0), 1.0 - xi**2, 0.5 * xi * (xi + 1.0)])
    return values, np.array([xi - 0.5, -2.0 * xi, xi + 0.5])
