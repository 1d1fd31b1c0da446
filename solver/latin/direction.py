"""The search direction k of every boundary row, constant in a run."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Array, Indices, Problem
from solver.laws import Contact, Dirichlet, Friction, Neumann
from solver.scenes.plane import PlaneSettings
from solver.settings import Settings

SLIDING_STIFFNESS = 6.5
"""k of a friction node, times the sliding length over ES. Measured with Anderson acceleration and
a nested start on 50 elements, decaying cycles: of 3, 6, 12, 24 and 48 ES/L the one with the fewest
iterations to 1 % of friction force was 4.8 to 7.2 of this, at peaks of 300 to 2400 N."""

CUT_FACTOR = 4.0
"""Times the paper's k, on cuts and held sides in the plane (theory.md, 5)."""
SUPPORT_STIFFNESS = 5.0
"""k per area, times the length of a body over E, on a rigid support, whatever the substructures.
Measured with Anderson acceleration on a block twice as long as high: of 2, 4, 8, 16 and 32 the one
with the fewest iterations to 1e-3 of the k-free indicator was 4 or 8, and they are 22 to 26 for 1
to 128 substructures, where a k of 4 E / l_sub takes 20 to 60."""
LAYER_STIFFNESS = 1.25
"""The same between two bodies. Measured on four layers 50 times as long as thick: of 0.4, 1.2 and 4
the best for 4, 8 and 12 substructures along each, with macro forces of degree 1, 2 and 3."""


def search_direction(problem: Problem, settings: Settings) -> Array:
    """Give k of every row, shape (n_rows,), scaled.

    It is the paper's, or on friction points the automatic one, times the settings' factors. The
    automatic k is the stiffness of as much of the structure as is expected to slide,
    `SLIDING_STIFFNESS` ES / s at every node, whatever the mesh and the substructures (theory.md,
    5: small k converges fast globally and slowly locally, large k the reverse). In the plane it
    is that of a body as a whole, on contacts in both components, and `CUT_FACTOR` times the
    paper's elsewhere.
    """
    k: Array = settings.k_scale * problem.direction
    if settings.search_direction == "auto":
        _automatic(problem, settings, k)
    for law in problem.rubbing.values():
        for rows in sliding_rows(law):
            k[rows] *= settings.k_friction_scale
        if isinstance(law, Contact) and isinstance(settings, PlaneSettings):
            for rows in pressing_rows(law):
                k[rows] *= settings.k_normal_scale
    return np.ascontiguousarray(k)


def _automatic(problem: Problem, settings: Settings, k: Array) -> None:
    if problem.of_law(Contact):
        k *= CUT_FACTOR
        for law in problem.of_law(Contact):
            assert isinstance(law, Contact)
            density = SUPPORT_STIFFNESS if law.below is None else LAYER_STIFFNESS
            density *= settings.k_scale / problem.scales.displacement
            for rows in (*pressing_rows(law), *sliding_rows(law)):
                k[rows] = density * law.weights
    else:
        k[problem.friction.rows] = settings.k_scale * SLIDING_STIFFNESS / sliding_share(problem)


def sliding_rows(law: Friction | Contact) -> tuple[Indices, ...]:
    """Give the rows of the tangential components, of both sides."""
    if isinstance(law, Friction):
        return (law.rows,) if law.below is None else (law.rows, law.below)
    return (law.tangent,) if law.below is None else (law.tangent, law.below[1])


def pressing_rows(law: Contact) -> tuple[Indices, ...]:
    """Give the rows of the normal components, of both sides."""
    return (law.normal,) if law.below is None else (law.normal, law.below[0])


def sliding_share(problem: Problem) -> float:
    """Estimate the share of the frictional interface that slides at the largest load.

    It is that load over all that friction can carry, between two points and all of them. Where
    displacements are prescribed the load is not known beforehand, and all may slide.
    """
    capacity = float(problem.friction.bound.sum())
    smallest = min(2.0 / len(problem.friction.positions), 1.0)
    load = np.zeros(problem.n_instants)
    for law in problem.interfaces.values():
        if isinstance(law, Neumann):
            load += law.force.sum(axis=0)
        elif isinstance(law, Dirichlet) and law.displacement.any():
            return 1.0
    for part in problem.substructures:
        if part.body_force is not None:
            load += part.body_force.sum(axis=0)
    largest = float(np.abs(load).max())
    return float(np.clip(largest / capacity, smallest, 1.0)) if capacity > 0.0 else 1.0
