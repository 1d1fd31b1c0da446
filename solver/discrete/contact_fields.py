"""What an interface with friction shows: forces, opening, slip and status, point by point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.problem import Problem


@dataclass(frozen=True, eq=False)
class ContactFields:
    """Fields of one interface on its points, SI, shape (n_points, n_instants) each.

    Attributes
    ----------
    normal_force
        Pressing force on the body above, positive, N; None where the bound is known.
    tangential_force
        Friction force on the body above, N.
    opening
        Distance of the two sides, m; None where the bound is known.
    slip
        Tangential displacement of the body above over what is below, m; it says how far a point
        has come, so its changes in time are the slip.
    status
        -1 is slip backward, 0 stick, +1 slip forward, `OPEN` without contact.
    """

    normal_force: Array | None
    tangential_force: Array
    opening: Array | None
    slip: Array
    status: NDArray[np.int8]


def contact_fields(
    problem: Problem, name: str, force: Array, displacement: Array, status: NDArray[np.int8]
) -> ContactFields:
    """Fields of one interface, out of those of a whole structure.

    `force` is stacked as `Problem.sum_of_contact` says, (n_forces, n_instants), N; W is that
    of all rows, `displacement`, scaled, (n_rows, n_instants).
    """
    law, places = problem.rubbing[name], problem.contact_places[name]
    scale = problem.scales.displacement
    jumps = [law.mean_by_point(one.jump(displacement)) * scale for one in law.components]
    if law.normal is None:
        return ContactFields(None, force[places[0]], None, jumps[0], status)
    gap = law.mean_by_point(law.normal.gap[:, None]) * scale
    return ContactFields(force[places[0]], force[places[1]], jumps[0] + gap, jumps[1], status)
