"""Bars that several tests run, with what they compare."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from solver.discrete.rods.end import End
from solver.scenes.bar import BarSettings

SMALL = {"elements": 30, "instants": 41, "substructures": 6}
SMALL_BAR = ["--set", "elements=12", "--set", "instants=11", "--set", "substructures=3"]
"""A bar that a command solves in no time."""


def options(**values):
    return BarSettings.checked(
        {"method": "paper", "tolerance": 1e-26, "max_iterations": 20_000, **values}
    )


def table(forces):
    times = np.linspace(0.0, 1.0, len(forces))
    return [[float(t), float(f)] for t, f in zip(times, forces, strict=True)]


def pulled(bar, load, **changes):
    """Hold a bar at its left end, and pull it at its right one at any instants."""
    load = np.asarray(load, dtype=float)
    changes = {"pressure": None, **changes}
    ends = {"left": End(displacement=np.zeros_like(load)), "right": End(force=load)}
    return replace(bar, **ends, **changes)


def relative(found, expected):
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def boundary_of(problem, reference):
    """W and F of a reference on every row, scaled.

    The forces that elasticity leaves over are those of the ends.
    """
    law = problem.friction
    displacement = reference.displacement / problem.scales.displacement
    friction = reference.contact_force / problem.scales.force
    most = law.tangential.largest_bound.max(axis=1)
    share = most / np.bincount(law.points, weights=most)[law.points]
    force = np.zeros((problem.n_rows, problem.n_instants))
    force[law.tangent.above] = share[:, None] * friction[law.points]
    for part in problem.substructures:
        own = np.isin(part.rows, law.tangent.above)
        rest = part.elasticity.stiffness @ displacement[part.dofs]
        if part.body_force is not None:
            rest -= part.body_force
        rest[part.elasticity.trace[own]] -= force[part.rows[own]]
        force[part.rows[~own]] = rest[part.elasticity.trace[~own]]
    return displacement[problem.row_dofs], force
