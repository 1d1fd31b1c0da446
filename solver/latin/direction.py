"""The search direction k of every boundary row, constant in a run."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Array, Indices, Problem, sliding_rows
from solver.laws import Contact, Dirichlet, Friction, Neumann
from solver.scenes.plane import PlaneSettings
from solver.settings import Settings

SLIDING_STIFFNESS = 6.5
"""k of a friction node, times the sliding length over ES. Measured with Anderson acceleration and
a nested start on 50 elements, decaying cycles: of 3, 6, 12, 24 and 48 ES/L the one with the fewest
iterations to 1 % of friction force was 4.8 to 7.2 of this, at peaks of 300 to 2400 N."""
PAIR = 2.0
"""Times as much where two bodies of known bound rub on each other. Measured likewise on strands of
2 to 30 wires: of 1/4, 1/2, 1, 2, 4, 8 and 16 the one with the fewest iterations was 2 or 4."""
CUT_STIFFNESS = 8.0
"""k per area of cuts and supports in the plane, times l_sub over E (theory.md, 5)."""
CONTACT_STIFFNESS = 7.0
"""k per area of a contact in the plane, times its length over E. With both, 1 % of the contact
force takes 8 to 14 iterations, 7 to 11 with Anderson acceleration, and differs by at most two from
4 to 64 substructures: pressed flat, on a parabola, tilted, and a quarter as high; 48 and 96
elements along (measured). Twice as much takes up to 20."""
BETWEEN_BODIES = 0.2
"""Factor on the tangential k between two bodies: layers slide on each other along their length.
Four layers, 50 times as long as thick: 3 % of the contact force takes 12 to 25 iterations with 0.1
to 0.3, 33 with 1 (measured)."""


def search_direction(problem: Problem, settings: Settings) -> Array:
    """Give k of every row, shape (n_rows,), scaled.

    It is the paper's, or on friction points the automatic one, times the settings' factors. The
    automatic k is the stiffness of as much of the structure as is expected to slide,
    `SLIDING_STIFFNESS` ES / s at every node, whatever the mesh and the substructures (theory.md,
    5: small k converges fast globally and slowly locally, large k the reverse). In the plane it
    is that of a body as a whole on contacts, and `CUT_STIFFNESS` times the paper's elsewhere.
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
    contacts = [law for law in problem.of_law(Contact) if isinstance(law, Contact)]
    if contacts:
        k *= CUT_STIFFNESS
    for law in contacts:
        share = settings.k_scale * CONTACT_STIFFNESS * law.weights / law.weights.sum()
        easier = 1.0 if law.below is None else BETWEEN_BODIES
        for rows, modulus in zip(pressing_rows(law), law.moduli, strict=False):
            k[rows] = modulus * share
        for rows, modulus in zip(sliding_rows(law), law.moduli, strict=False):
            k[rows] = modulus * easier * share
    if contacts:
        return
    stiffness = settings.k_scale * SLIDING_STIFFNESS / sliding_share(problem)
    for one in problem.rubbing.values():
        for rows in sliding_rows(one):
            k[rows] = stiffness if one.below is None else PAIR * stiffness


def pressing_rows(law: Contact) -> tuple[Indices, ...]:
    """Give the rows of the normal components, of both sides."""
    return (law.normal,) if law.below is None else (law.normal, law.below[0])


def sliding_share(problem: Problem) -> float:
    """Estimate the share of the frictional interface that slides at the largest load.

    It is that load over all that friction can carry, between two points and all of them: the load
    of one body over one interface, where there are several alike. Where displacements are
    prescribed the load is not known beforehand: on a rigid support all may slide; bodies that rub
    on each other carry no more than what the displacement alone makes of a rod, whose scaled
    stiffness is 1.
    """
    first, *_ = problem.rubbing.values()
    assert isinstance(first, Friction)
    capacity = float(first.bound.sum())
    smallest = min(2.0 / len(first.positions), 1.0)
    load = np.zeros(problem.n_instants)
    for law in problem.interfaces.values():
        if isinstance(law, Neumann):
            load += law.force.mean(axis=0)
        elif isinstance(law, Dirichlet) and law.displacement.any():
            if first.below is None:
                return 1.0
            load += law.displacement.mean(axis=0)
    for part in problem.substructures:
        if part.body_force is not None:
            load += part.body_force.sum(axis=0)
    largest = float(np.abs(load).max())
    return float(np.clip(largest / capacity, smallest, 1.0)) if capacity > 0.0 else 1.0
