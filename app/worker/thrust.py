"""Lines of thrust: how many bodies pass the forces in their joints on to each other."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from app.messages import Needs
from app.worker.geometry import floats
from solver.arrays import Array, Indices
from solver.latin import Iterate
from solver.laws import Contact
from solver.scenes import features_of

if TYPE_CHECKING:
    from app.worker.sampling import Sampler


def thrust(sampler: Sampler, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """Resultant force in every joint, and where it acts; None where no bricks touch.

    "lines" go from the middle of one body over the point where the resultant acts to the middle of
    the other, (n_joints, 3, 2, n_instants), m; the last is the point again on a support. "forces"
    are their sizes, (n_joints, n_instants), N.
    """
    problem = sampler.problem
    if not features_of(sampler.settings).bricks:
        return None
    middles, lines, forces = _middles(sampler), [], []
    for name, law in problem.rubbing.items():
        if law.normal is None:
            return None
        normal, tangential = (
            iterate.contact_force[own][:, sampler.columns] for own in problem.contact_places[name]
        )
        pressed = np.maximum(normal, 0.0)
        whole = pressed.sum(axis=0)
        places = _places(sampler, law)
        share = pressed / np.where(whole > 0.0, whole, 1.0)
        share = np.where(whole > 0.0, share, 1.0 / len(places))
        point = places.T @ share
        above, below = (_middle_of(sampler, law, side, middles) for side in (0, 1))
        ends = np.broadcast_to(above[:, None], point.shape)
        others = point if below is None else np.broadcast_to(below[:, None], point.shape)
        lines.append(np.stack([ends, point, others]))
        forces.append(np.hypot(whole, tangential.sum(axis=0)))
    return {"lines": floats(np.stack(lines)), "forces": floats(np.stack(forces))}


@lru_cache(maxsize=1)
def _middles(sampler: Sampler) -> Array:
    """Middle of the body that each degree of freedom belongs to, (n_dofs, 2), m."""
    problem = sampler.problem
    middles = np.zeros((problem.n_dofs, 2))
    inside = problem.inside
    assert inside is not None
    body_of = {int(part): int(body) for part, body in zip(inside.parts, inside.bodies, strict=True)}
    centres = inside.nodes[inside.elements].mean(axis=1)
    for number, part in enumerate(problem.substructures):
        middles[part.dofs] = centres[inside.bodies == body_of[number]].mean(axis=0)
    return middles


def _places(sampler: Sampler, law: Contact) -> Array:
    """Places of the points of an interface, (n_points, 2), m."""
    _, pairs = np.unique(law.points, return_index=True)
    return np.asarray(sampler.problem.positions[_dofs(sampler, law.tangent.above[pairs])])


def _dofs(sampler: Sampler, rows: Indices) -> Indices:
    return sampler.problem.row_dofs[rows]


def _middle_of(sampler: Sampler, law: Contact, side: int, middles: Array) -> Array | None:
    """Middle of the body above, or of that below, (2,), m; None for a support."""
    sides = law.tangent.sides
    if side >= len(sides):
        return None
    return np.asarray(middles[_dofs(sampler, sides[side][:1])[0]])
