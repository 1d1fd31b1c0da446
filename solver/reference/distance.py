"""Errors: distances to a reference (theory.md, 4)."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from solver.discrete.problem import Problem
from solver.laws import Neumann

Array = NDArray[np.float64]


class Fields(Protocol):
    """What is compared: an iterate, or a reference; SI, shape (n_points, n_instants)."""

    @property
    def displacement(self) -> Array:
        """Displacement, m."""

    @property
    def friction_force(self) -> Array:
        """Nodal friction force, N."""


class Distance:
    """Relative L2 distance over space and time to a reference on the same mesh and instants.

    Where the reference field vanishes, the distance is relative to `load` instead, and absolute
    if that vanishes too.

    Parameters
    ----------
    reference
        The fields that count as true.
    time_weights
        Shape (n_instants,).
    load
        Forces that act on the structure, shape (n, n_instants), N.
    """

    def __init__(self, reference: Fields, time_weights: Array, load: Array) -> None:
        self._weights = time_weights
        self._displacement = reference.displacement
        self._force = reference.friction_force
        self._displacement_size = self._norm(self._displacement) or 1.0
        self._force_size = self._norm(self._force) or self._norm(load) or 1.0

    def of_displacement(self, fields: Fields) -> float:
        """Give the relative error of the displacement."""
        return self._norm(fields.displacement - self._displacement) / self._displacement_size

    def of_friction_force(self, fields: Fields) -> float:
        """Give the relative error of the friction force."""
        return self._norm(fields.friction_force - self._force) / self._force_size

    def _norm(self, field: Array) -> float:
        largest = float(np.abs(field).max(initial=0.0))
        if largest == 0.0:
            return 0.0
        scaled = field / largest
        return largest * float(np.sqrt((scaled * scaled @ self._weights).sum()))


def distance_to(reference: Fields, problem: Problem) -> Distance:
    """Prepare the distance to a reference of a problem."""
    forces = [law.force for law in problem.of_law(Neumann) if isinstance(law, Neumann)]
    load = np.concatenate([*forces, np.zeros((1, problem.n_instants))])
    return Distance(reference, problem.time_weights, load * problem.scales.force)
