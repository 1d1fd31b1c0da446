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
    if that vanishes too. Forces are compared where they are determinate.

    Parameters
    ----------
    reference
        The fields that count as true.
    time_weights
        Shape (n_instants,).
    load
        Forces that act on the structure, shape (n, n_instants), N.
    determinate
        Where the friction force is, shape (n_points, n_instants); a point that is held still by
        a support shares its force with that support in any way.
    """

    def __init__(
        self,
        reference: Fields,
        time_weights: Array,
        load: Array,
        determinate: NDArray[np.bool_],
    ) -> None:
        self._weights = time_weights
        self._determinate = determinate
        self._displacement = reference.displacement
        self._force = reference.friction_force * determinate
        self._displacement_size = self._norm(self._displacement) or 1.0
        self._force_size = self._norm(self._force) or self._norm(load) or 1.0

    def of_displacement(self, fields: Fields) -> float:
        """Give the relative error of the displacement."""
        return self._norm(fields.displacement - self._displacement) / self._displacement_size

    def of_friction_force(self, fields: Fields) -> float:
        """Give the relative error of the friction force."""
        force = fields.friction_force * self._determinate
        return self._norm(force - self._force) / self._force_size

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
    law = problem.friction
    dofs, displacement = problem.prescribed
    still = np.zeros((problem.n_dofs, problem.n_instants), dtype=bool)
    still[dofs] = np.diff(displacement, axis=1, prepend=0.0) == 0.0
    determinate = np.ones((len(law.positions), problem.n_instants), dtype=bool)
    determinate[law.points] = ~still[problem.row_dofs[law.rows]]
    return Distance(reference, problem.time_weights, load * problem.scales.force, determinate)
