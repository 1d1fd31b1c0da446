"""What an interface with friction shows: forces, opening, slip and status, point by point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.discrete.problem import Array, Problem, components, components_below, sliding_rows
from solver.laws import Contact, Friction

NO_SLIP = 1e-9
"""Slip, as a share of the largest displacement, up to which a point counts as stuck."""
OPEN = 2
"""Status of a point without contact; -1 is slip backward, 0 stick, +1 slip forward."""


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
        As `OPEN` says.
    """

    normal_force: Array | None
    tangential_force: Array
    opening: Array | None
    slip: Array
    status: NDArray[np.int8]


def contact_fields(
    problem: Problem, name: str, force: Array, displacement: Array, status: NDArray[np.int8]
) -> ContactFields:
    """Take the fields of one interface out of those of a whole structure.

    Parameters
    ----------
    problem, name
        Which interface.
    force
        Stacked contact forces, N, as `Problem.sum_of_contact` says, (n_forces, n_instants).
    displacement
        W of all rows, scaled, shape (n_rows, n_instants).
    status
        Shape (n_points, n_instants).
    """
    law, places = problem.rubbing[name], problem.contact_places[name]
    scale = problem.scales.displacement
    jumps = [mean_by_point(law, jump) * scale for jump in jumps_of(law, displacement)]
    if isinstance(law, Friction):
        return ContactFields(None, force[places[0]], None, jumps[0], status)
    gap = mean_by_point(law, law.gap[:, None]) * scale
    return ContactFields(force[places[0]], force[places[1]], jumps[0] + gap, jumps[1], status)


def jumps_of(law: Friction | Contact, field: Array) -> tuple[Array, ...]:
    """Give a row field above minus that below, (n_pairs, n_instants) for each component."""
    if law.below is None:
        return tuple(field[rows] for rows in components(law))
    return tuple(
        field[above] - field[below]
        for above, below in zip(components(law), components_below(law), strict=True)
    )


def sums_of(law: Friction | Contact, field: Array) -> tuple[Array, ...]:
    """Give a row field above plus that below, as `jumps_of`; nothing on a rigid support."""
    if law.below is None:
        return ()
    return tuple(
        field[above] + field[below]
        for above, below in zip(components(law), components_below(law), strict=True)
    )


def mean_by_point(law: Friction | Contact, values: Array) -> Array:
    """Give the mean of the pairs of every point, shape (n_points, ...)."""
    counts = np.bincount(law.points, minlength=len(law.positions))
    return np.asarray(law.by_point(values) / counts.reshape(-1, *[1] * (values.ndim - 1)))


def status_of(
    law: Friction | Contact, displacement: Array, force: Array | None = None
) -> NDArray[np.int8]:
    """Give the contact status of a local stage, shape (n_points, n_instants).

    The law repeats the position of a stuck point bit by bit, or up to rounding where both sides
    move; a point that is just at its bound moves by rounding alone, and that is not called slip.
    Where a cut ends at the interface both sides have their say, and the larger slip wins.

    Parameters
    ----------
    law
        The interface.
    displacement, force
        W^ and F^ of all rows, shape (n_rows, n_instants); F^ tells where a contact is open.
    """
    position = jumps_of(law, displacement)[-1]
    slip = np.diff(position, axis=1, prepend=0.0)
    total = law.by_point(slip)
    largest = max(np.abs(displacement[rows]).max(initial=0.0) for rows in sliding_rows(law))
    if isinstance(law, Contact) and force is not None:
        # A stuck contact moves by rounding alone; but a scaled structure's compliance is near 1.
        largest = max(np.abs(displacement).max(), np.abs(force).max())
    total[np.abs(total) <= NO_SLIP * largest] = 0.0
    status = np.sign(total).astype(np.int8)
    if isinstance(law, Contact) and force is not None:
        status[law.by_point(force[law.normal]) <= 0.0] = OPEN
    return status
