"""What the laws of interfaces with friction have in common: pairs that meet at points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class AtPoints:
    """An interface whose pairs (or rows) belong to points; those of one point share its force.

    Attributes
    ----------
    points
        Point of the interface that each pair belongs to, shape (n_pairs,).
    positions
        Place of the points along the interface, shape (n_points,), m.
    """

    points: Indices
    positions: Array

    def by_point(self, values: Array) -> Array:
        """Add up values of the pairs, shape (n_pairs, ...), at every point, (n_points, ...)."""
        found = np.zeros((len(self.positions), *values.shape[1:]))
        np.add.at(found, self.points, values)
        return found
