"""Rectangular elements of plane elasticity: shape functions, strains, stiffness.

Corners of an element are numbered counter-clockwise from the lower left; degrees of freedom are x
and y of every corner in turn.
"""

from __future__ import annotations

from itertools import product

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


EDGE_MASS = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
"""From a traction at both ends of an edge of length 1, linear between them, to their forces."""


def strain_matrix(xi: float, eta: float, width: float, height: float) -> Array:
    """Matrix from displacements of the corners to strains at a point, (3, 8).

    `xi` and `eta` run from -1 to 1 over an element of the given width and height.
    """
    dx = 0.5 * np.array([eta - 1.0, 1.0 - eta, 1.0 + eta, -1.0 - eta]) / width
    dy = 0.5 * np.array([xi - 1.0, -1.0 - xi, 1.0 + xi, 1.0 - xi]) / height
    matrix = np.zeros((3, 8))
    matrix[0, 0::2], matrix[1, 1::2] = dx, dy
    matrix[2, 0::2], matrix[2, 1::2] = dy, dx
    return matrix


def element_stiffness(width: float, height: float, elastic: Array) -> Array:
    """Stiffness of an element per unit thickness, shape (8, 8), with `elastic_matrix`.

    Bilinear, with the two incompatible bending modes of each component condensed (Taylor, Beresford
    and Wilson, Int. J. Numer. Meth. Eng. 10, 1976): it does not lock where thin layers bend or
    bodies are nearly incompressible, and passes the patch test on rectangles.
    """
    stiffness = np.zeros((12, 12))
    for eta, xi in product(leggauss(2)[0].tolist(), repeat=2):
        at = xi, eta, width, height
        strain = np.hstack([strain_matrix(*at), _bending(*at)])
        stiffness += 0.25 * width * height * strain.T @ elastic @ strain
    coupling = stiffness[8:, :8]
    stiffness = stiffness[:8, :8] - coupling.T @ np.linalg.solve(stiffness[8:, 8:], coupling)
    return np.asarray(0.5 * (stiffness + stiffness.T))


def _bending(xi: float, eta: float, width: float, height: float) -> Array:
    """Strains of 1 - xi^2 and 1 - eta^2 of both components, shape (3, 4)."""
    strain = np.zeros((3, 4))
    strain[0, 0] = strain[2, 1] = -2.0 * xi * 2.0 / width
    strain[2, 2] = strain[1, 3] = -2.0 * eta * 2.0 / height
    return strain
