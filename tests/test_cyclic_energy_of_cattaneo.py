"""What friction takes in a cycle of Cattaneo's contact: as on a half-plane, if it is narrow."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from solver.reference.choice import reference_of
from solver.reference.closed_forms.half_plane import HalfPlane
from solver.reference.glued import jumps
from solver.scenes import discretise
from solver.scenes.block import BlockSettings

LENGTH, RADIUS, FRICTION, STEPS, SHARE = 0.1, 5.0, 0.3, 6, 0.5
STIFFNESS = 210e9 / (1.0 - 0.4999**2)


@functools.cache
def cycle(half_width, pressing):
    """Press a block as high as long, and shear it to and fro by half of what makes it slide.

    At nu = 0.4999 tangential forces do not move the surface of a half-plane along its normal. Along
    the half-width there are twelve elements.

    Parameters
    ----------
    half_width, pressing
        Of Hertz, and the displacement of the top by which it comes about, m.

    Returns
    -------
    Energy of a cycle over that of a half-plane, and how far the contact moves, in half-widths.
    """
    elements = round(12 * LENGTH / half_width)
    shear = SHARE * FRICTION * np.pi * STIFFNESS * half_width**2 / (4.0 * RADIUS) / LENGTH
    settings = BlockSettings.checked(
        {
            "radius": RADIUS,
            "length": LENGTH,
            "height": LENGTH,
            "poisson": 0.4999,
            "friction": FRICTION,
            "elements": elements,
            "elements_up": 60,
            "substructures": 1,
            "substructures_up": 1,
            "duration": 6.0,
            "instants": 6 * STEPS + 1,
            "top": "pushed",
            "top_normal_load": [[0.0, 0.0], [1.0, pressing]],
            "top_tangential_load": [[1.0, 0.0], [2.0, shear], [4.0, -shear], [6.0, shear]],
        }
    )
    problem = discretise(settings)
    found = reference_of(problem)
    assert found.converged.all()
    normal, tangential = problem.contact_places["support"]
    pressed, rubbed = found.contact_force[normal], found.contact_force[tangential]
    slip = np.diff((jumps(problem) @ found.displacement)[tangential], axis=1)
    taken = -(rubbed[:, 1:] * slip)[:, 2 * STEPS :].sum()
    total = pressed.sum(axis=0)
    middle = problem.rubbing["support"].positions @ pressed[:, 1:] / total[1:]
    moved = 0.5 * abs(middle[2 * STEPS - 1] - middle[4 * STEPS - 1]) / half_width
    share = abs(rubbed[:, -1].sum()) / (FRICTION * total[-1])
    return taken / HalfPlane(total[-1], RADIUS, STIFFNESS).energy(FRICTION, share), moved


WIDE, NARROW = (0.02, -1.06e-4), (0.01, -3.31e-5)


def test_a_contact_of_a_fifth_of_the_body_takes_what_it_would_of_a_half_plane():
    energy, _ = cycle(*NARROW)
    assert energy == pytest.approx(1.0, abs=0.07)


def test_a_contact_of_two_fifths_of_a_high_body_rolls_and_takes_far_less():
    energy, moved = cycle(*WIDE)
    assert energy < 0.8
    assert moved > 1.5 * cycle(*NARROW)[1]
