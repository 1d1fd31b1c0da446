"""Plane elasticity on rectangular elements, and polynomials along a line.

Corners of an element are numbered counter-clockwise from the lower left; degrees of
freedom are x and y of every corner, or node, in turn.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from scipy import sparse

from solver.arrays import Array, Indices

MOST_POISSON = 0.4999
"""Largest Poisson's ratio; above it a body keeps its volume up to the rounding of its
strains."""
EDGE_MASS = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
"""Matrix from a traction at both ends of an edge of length 1, linear between them, to
nodal forces."""
LONG_SIDES = 0.6
"""Factor on the macro degree of a side, beside the root of its length over the depth
behind it. For layers 10 to 1000 times as long as thick 1 % of the contact force takes
at most 45 iterations, 50 with 0.4, 42 with 1, and more than 150 without (measured)."""
HIGHEST_DEGREE = 10
"""Largest macro degree of a long side. With 6, layers of 200 times their
thickness cut in two up take more than 150 iterations to 1 %; with 8 and 10, 37 and 25
(measured)."""
DIGITS = 12
"""Digits of positions along a line of length 2 by which a macro basis is made."""


def elastic_matrix(young: float, poisson: float, state: str) -> Array:
    """Matrix from strains (xx, yy, 2 xy) to stresses, shape (3, 3), in the unit of E.

    `state` is "strain" or "stress" (Timoshenko and Goodier, Theory of Elasticity, 1970,
    ch. 2).
    """
    # Plane strain is plane stress of a body with other constants.
    if state == "strain":
        young = young / (1.0 - poisson**2)
        poisson = poisson / (1.0 - poisson)
    factor = young / (1.0 - poisson**2)
    shear = 0.5 * (1.0 - poisson)
    return factor * np.array(
        [[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, shear]]
    )


def von_mises(stress: Array, poisson: Array | float, state: str) -> Array:
    """Von Mises' equivalent, (n,), of stresses (xx, yy, xy), (n, 3), in their unit.

    In plane strain the stress across the plane is Poisson's ratio, (n,) or one of all,
    times the sum of the other two.
    """
    xx, yy, xy = stress.T
    if state == "strain":
        zz = poisson * (xx + yy)
    else:
        zz = np.zeros_like(xx)
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * squares + 3.0 * xy**2))


def strain_matrix(xi: float, eta: float, width: float, height: float) -> Array:
    """Matrix from displacements of the corners to strains at a point, shape (3, 8).

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
        compatible = strain_matrix(xi, eta, width, height)
        strain = np.hstack([compatible, _bending(xi, eta, width, height)])
        stiffness += 0.25 * width * height * strain.T @ elastic @ strain
    # The bending modes belong to one element, so they are eliminated in it.
    coupling = stiffness[8:, :8]
    response = np.linalg.solve(stiffness[8:, 8:], coupling)
    condensed = stiffness[:8, :8] - coupling.T @ response
    return np.asarray(0.5 * (condensed + condensed.T))


def _bending(xi: float, eta: float, width: float, height: float) -> Array:
    """Strains of the modes 1 - xi^2 and 1 - eta^2 of both components, shape (3, 4)."""
    along = -2.0 * xi * 2.0 / width
    up = -2.0 * eta * 2.0 / height
    strain = np.zeros((3, 4))
    strain[0, 0] = along
    strain[2, 1] = along
    strain[2, 2] = up
    strain[1, 3] = up
    return strain


def dofs_of(nodes: Indices) -> Indices:
    """Degrees of freedom x and y of nodes, (..., n), in turn: shape (..., 2 n)."""
    return np.stack([2 * nodes, 2 * nodes + 1], axis=-1).reshape(*nodes.shape[:-1], -1)


def assembled(
    blocks: Array, rows: Indices, columns: Indices, shape: tuple[int, int]
) -> sparse.csr_array:
    """Sparse matrix of a shape from the blocks of elements: equal places add up.

    `rows` and `columns` are those of the entries of all blocks, which they broadcast
    with.
    """
    places = [np.broadcast_to(each, blocks.shape).ravel() for each in (rows, columns)]
    return sparse.csr_array(sparse.coo_array((blocks.ravel(), tuple(places)), shape))


def legendre_basis(positions: Array, slenderness: float, degree: int) -> Array:
    """Macro basis of a line: Legendre polynomials, shape (n_points, n_macro).

    Forces that balance only point by point may bend the side of a part, which resists
    with E d^3 q^4 / 24 per area at the wavenumber q, where d is the depth behind it.
    Bending waves that are long beside d are so soft that no k suits both them and the
    waves shorter than d: the macro forces are to balance them. About 0.7 times the root
    of l / d waves are softer than E d / l^2, the stretching of the side of length l.

    Parameters
    ----------
    positions
        Positions along the line, from -1 to 1, (n_points,).
    slenderness
        Length of the line over the depth behind it.
    degree
        Degree for a line that is not long.
    """
    # A long side has many soft waves, which the macro forces have to balance.
    wanted = round(degree * max(LONG_SIDES * np.sqrt(slenderness), 1.0))
    highest = min(wanted, max(HIGHEST_DEGREE, degree), len(positions) - 1)
    # Lines that differ by rounding have one basis, which their substructures share.
    return np.asarray(legvander(positions.round(DIGITS), highest))
