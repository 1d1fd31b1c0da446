"""Lines of thrust: how bricks pass the forces in their joints on to each other."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from app.messages import Needs
from app.worker.geometry import floats
from solver.arrays import Array
from solver.latin import Iterate

if TYPE_CHECKING:
    from app.worker.sampling import Sampler


def thrust(sampler: Sampler, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """Resultant force in every joint, and where it acts; None where no bricks touch.

    "lines" go from the middle of one brick over the point where the resultant acts to the middle of
    the other, (n_joints, 3, 2, n_instants), m; on a support they end there. "forces" are their
    sizes, (n_joints, n_instants), N.
    """
    if not sampler.settings.features.bricks:
        return None
    lines, forces = [], []
    for name, (places, above, below) in _joints(sampler).items():
        components = sampler.problem.contact_places[name]
        normal, tangential = (iterate.contact_force[own][:, sampler.columns] for own in components)
        pressed = np.maximum(normal, 0.0)
        whole = pressed.sum(axis=0)
        share = pressed / np.where(whole > 0.0, whole, 1.0)
        point = places.T @ np.where(whole > 0.0, share, 1.0 / len(places))
        lines.append(np.stack(np.broadcast_arrays(above, point, point if below is None else below)))
        forces.append(np.hypot(whole, tangential.sum(axis=0)))
    return {"lines": floats(np.stack(lines)), "forces": floats(np.stack(forces))}


@lru_cache(maxsize=1)
def _joints(sampler: Sampler) -> dict[str, tuple[Array, Array, Array | None]]:
    """Places of the points of each joint, (n_points, 2), and middles of its bricks, (2, 1), m."""
    problem, inside = sampler.problem, sampler.problem.inside
    assert inside is not None
    centres = inside.nodes[inside.elements].mean(axis=1)
    middles = np.zeros((problem.n_dofs, 2))
    for number, part in enumerate(problem.substructures):
        middles[part.dofs] = centres[inside.parts == number].mean(axis=0)
    joints = {}
    for name, law in problem.rubbing.items():
        _, pairs = np.unique(law.points, return_index=True)
        sides = [problem.row_dofs[rows[pairs]] for rows in law.tangent.sides]
        ends = [middles[dofs[0]][:, None] for dofs in sides]
        joints[name] = problem.positions[sides[0]], ends[0], ends[1] if len(ends) > 1 else None
    return joints
