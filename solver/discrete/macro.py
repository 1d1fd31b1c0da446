"""The macro basis of the sides of rectangular substructures."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import legvander

from solver.arrays import Array
from solver.discrete.plane import Rectangle

LONG_SIDES = 0.6
"""Factor on the macro degree of a side, times the root of its length over the depth behind it.
Measured on layers of macro degree 2, 10 to 1000 times as long as thick, and a column of degree 1:
1 % of the contact force takes at most 45 iterations, 50 with 0.4 and 42 with 1. Without it, layers
that are uncut along or cut in two up take more than 150, and so does a column that is cut into
parts 200 times as high as wide (19)."""
HIGHEST_DEGREE = 10
"""To which a long side may raise its macro degree. With 6, layers of 200 times their thickness cut
in two up take more than 150 iterations to 1 %; with 8 and 10, 37 and 25 (measured)."""


def side_basis(rectangle: Rectangle, side: str, n_points: int, degree: int) -> Array:
    """Polynomials over a side of a substructure, shape (n_points, n_macro).

    What balances only point by point may bend the side, which resists with E d^3 q^4 / 24 per area
    at the wavenumber q, where d is the depth behind it. Bending waves that are long beside d are so
    soft that no k suits both them and the waves shorter than d: the macro forces are to balance
    them. Those softer than E d / l^2 over the length l, as soft as its stretching, number
    some 0.7 times the root of l / d.

    Parameters
    ----------
    rectangle, side
        Whose, and which one.
    n_points
        Points of the side that have rows.
    degree
        Of a side that is not long.
    """
    ratio = rectangle.columns * rectangle.width / (rectangle.rows * rectangle.height)
    slenderness = ratio if side in ("bottom", "top") else 1.0 / ratio
    wanted = round(degree * max(LONG_SIDES * np.sqrt(slenderness), 1.0))
    highest = min(wanted, max(HIGHEST_DEGREE, degree), n_points - 1)
    return np.asarray(legvander(np.linspace(-1.0, 1.0, n_points), highest))
