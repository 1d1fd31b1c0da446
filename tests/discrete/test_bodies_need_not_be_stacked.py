"""Bodies in the plane may touch wherever their sides meet."""

from __future__ import annotations

import numpy as np
import pytest

from solver import Latin, solve
from solver.discrete import Problem, Side, SideComponent, Stack, discretise
from solver.discrete.plane.rectangles.bricks import Brick
from solver.latin import Ending
from solver.reference.incremental import reference_of

SIZE = 0.25
TIMES = np.linspace(0.0, 1.0, 5)
WEIGHT = 1e-4
"""On the lintel, scaled."""


def lintel_on_two_piers() -> Problem:
    """Two piers that are held below, with a lintel from one to the other."""
    still = SideComponent(True, 0.0 * TIMES)
    pressed = SideComponent(False, -WEIGHT / (10 * SIZE) * TIMES)
    lintel = Stack(
        length=2 * SIZE,
        height=4 * SIZE,
        elements=(2, 4),
        substructures=(1, 1),
        bricks=[Brick(0, 0, 2, 4), Brick(8, 0, 2, 4), Brick(0, 4, 10, 2)],
        young=1.0,
        poisson=0.2,
        state="stress",
        friction=0.5,
        sides={
            "bottom": Side(still, still),
            "top": Side(SideComponent(False, 0.0 * TIMES), pressed),
        },
        instants=TIMES,
        duration=1.0,
    )
    return discretise(lintel)


def test_two_piers_carry_half_of_a_lintel_each() -> None:
    problem = lintel_on_two_piers()
    assert list(problem.contacts) == ["brick 1 and brick 3", "brick 2 and brick 3"]
    run = solve(problem, Latin(), watch=False)
    assert run.status.ending is Ending.CONVERGED
    for found in (run.iterate, reference_of(problem)):
        left, right = (found.contact(name) for name in problem.contacts)
        for side in (left, right):
            carried = side.normal_force.sum(axis=0)
            assert carried == pytest.approx(0.5 * WEIGHT * TIMES, rel=1e-2, abs=1e-9)
        thrust = left.tangential_force + right.tangential_force[::-1]
        assert np.abs(thrust).max() < 1e-2 * np.abs(left.tangential_force).max()


def test_the_lintel_sags_between_its_piers() -> None:
    problem = lintel_on_two_piers()
    assert problem.inside is not None
    moved = problem.inside.displacement(reference_of(problem).displacement, [4])[
        :, 1, 0
    ]
    lintel = problem.inside.bodies
    nodes = np.unique(problem.inside.elements[lintel == 2])
    x = problem.inside.nodes[nodes, 0]
    sag = moved[nodes]
    assert sag[np.isclose(x, 5 * SIZE)].max() < sag[np.isclose(x, 0.0)].min()
