"""Slip on an interface of given strength: what is published holds, and the plane reaches it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from solver.discrete.stack.data import Given, Side, Support
from solver.discrete.stack.stack import Stack
from solver.latin import Auto, Ending, Latin, Stop, solve
from solver.reference.choice import reference_of
from solver.reference.closed_forms.slip_front import (
    front_over_diffusion,
    slip_under_growing_strength,
)

VIESCA = {0.1: 3.6405, 0.3: 1.3474, 0.5: 0.79161, 0.7: 0.43513, 0.9: 0.13981}
"""lambda over T: the condition of Viesca, J. Fluid Mech. 928, A29, 2021, evaluated elsewhere."""


@pytest.mark.parametrize(("stress", "factor"), VIESCA.items())
def test_the_front_of_a_fluid_runs_with_the_factor_of_its_stress(stress, factor):
    assert front_over_diffusion(stress) == pytest.approx(factor, rel=5e-5)


@pytest.mark.parametrize("place", [0.0, 0.3, 0.9])
def test_slip_under_growing_strength_is_that_of_the_drop_of_stress(place):
    """The slip at a place is an integral over the drop, with the logarithm of a point force."""
    half, drop, stiffness = 2.0, 1e5, 5e8
    here = place * half

    def slipped(there):
        roots = np.sqrt((half**2 - here**2) * (half**2 - there**2))
        green = np.log((half**2 - here * there + roots) / (half * abs(here - there)))
        return drop * (1.0 - abs(there) / half) * green

    parts = sorted({-half, 0.0, here, half})
    found = sum(quad(slipped, *ends, limit=200)[0] for ends in pairwise(parts))
    exact = slip_under_growing_strength(np.array([here]), half, drop, stiffness)[0]
    assert 2.0 / (np.pi * stiffness) * found == pytest.approx(exact, rel=1e-6)


def loosened(substructures):
    """Shear a body over an interface whose strength falls from its middle, then comes back."""
    x, time = np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, 9)
    strength = 1e6 - 8e5 * np.sin(np.pi * time) * np.exp(-8.0 * x[:, None])
    none, shear = Given(False, 0.0 * time), Given(False, np.full_like(time, 6e5))
    level = Given(True, 0.0 * time)
    return Stack(
        length=1.0,
        height=0.5,
        elements=(20, 10),
        substructures=substructures,
        young=1e9,
        poisson=0.3,
        instants=time,
        duration=1.0,
        support=Support(np.zeros(21), 0.0, strength),
        sides={"left": Side(none, level), "top": Side(shear, level), "right": Side(none, shear)},
    )


@pytest.mark.parametrize("substructures", [(1, 1), (4, 2)])
def test_a_known_bound_in_the_plane_is_obeyed_and_presses_nothing(substructures):
    problem = loosened(substructures).discretise()
    reference = reference_of(problem)
    method = Latin(direction=Auto(), stop=Stop(accuracy=1e-4, iterations=300))
    solution = solve(problem, method)
    assert reference.converged.all()
    assert solution.status.ending is Ending.CONVERGED
    law, there = problem.rubbing["support"], reference.contact("support")
    found = solution.iterate.contact("support")
    bound = law.by_point(law.tangential.bound) * problem.scales.force
    assert there.normal_force is None
    assert np.all(np.abs(there.tangential_force) <= bound * (1.0 + 1e-9))
    moves = there.status != 0
    assert 3 < np.count_nonzero(moves) < 0.5 * moves.size
    held = np.abs(there.tangential_force)[moves]
    assert held == pytest.approx(bound[moves], rel=1e-9)
    scale = np.abs(there.tangential_force).max()
    assert np.abs(found.tangential_force - there.tangential_force).max() < 1e-3 * scale
