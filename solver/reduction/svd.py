"""Singular values of interface fields, per substructure (paper, section 3.2)."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Array, Problem
from solver.latin.iterate import Iterate


def friction_spectra(iterate: Iterate) -> list[Array]:
    """Compute the singular values of the friction force in every substructure.

    The field is the force per length, in L2 over the substructure's friction rows and time.

    Returns
    -------
    One array of descending singular values per substructure, numbered from the clamp, N/sqrt(m)
    times the root of scaled time.
    """
    problem = iterate.problem
    law = problem.friction
    density = iterate.boundary_force[law.rows] * problem.scales.force
    weighted = density / np.sqrt(law.weights)[:, None] * np.sqrt(problem.time_weights)
    own = friction_rows(problem)
    values: dict[int, Array] = {}
    for size in sorted({len(rows) for rows in own}):
        alike = [number for number, rows in enumerate(own) if len(rows) == size]
        stack = weighted[np.stack([own[number] for number in alike])]
        found = np.linalg.svd(stack, compute_uv=False)
        values.update(zip(alike, found, strict=True))
    return [values[number] for number in range(len(own))]


def friction_rows(problem: Problem) -> list[np.ndarray]:
    """Give, per substructure, the places of its rows in the friction interface."""
    place = np.full(problem.n_rows, -1)
    place[problem.friction.rows] = np.arange(len(problem.friction.rows))
    return [place[part.rows][place[part.rows] >= 0] for part in problem.substructures]
