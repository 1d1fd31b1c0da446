"""Contact that gives way before it slips:
closed forms, every scene (MATHEMATICS.md, 8).
"""

from __future__ import annotations

import numpy as np
import pytest
from runs import settings_of, solved
from small_scenes import KINDS, SMALL

from solver.latin import Ending, solve
from solver.reference.closed_forms.pulled_bar import pulled_compliant_bar
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

LENGTH = 1.0
AXIAL = 210e9 * 3.14e-6
STRENGTH = 0.3 * 5000.0
COMPLIANT = {"friction_law": "compliant"}


def run(scene="bar", **values):
    return solved(settings_of(scene, **(SMALL[scene] | COMPLIANT | values)))


def pulled(force, stiffness):
    """End displacement of a clamped bar under a monotone pull, and its slip zone."""
    density = stiffness * AXIAL / LENGTH**2
    return pulled_compliant_bar(force, LENGTH, AXIAL, STRENGTH, density)


@pytest.mark.parametrize("stiffness", [3.0, 1e3])
@pytest.mark.parametrize("peak", [100.0, 1400.0])
def test_a_pulled_bar_moves_as_in_closed_form_and_the_better_the_finer(stiffness, peak):
    exact, _ = pulled(peak, stiffness)
    errors = []
    for elements in (50, 200):
        found = run(
            load=[[0.0, 0.0], [1.0, peak]],
            instants=11,
            elements=elements,
            contact_stiffness=stiffness,
        )
        assert found.status.ending is Ending.CONVERGED
        errors.append(abs(found.iterate.displacement[-1, -1] - exact) / exact)
    assert errors[1] < 2e-3
    assert errors[1] < 0.6 * errors[0]


def test_where_nothing_slips_the_bar_stands_on_springs():
    peak = 100.0
    stiffness = 100.0
    assert pulled(peak, stiffness)[1] == 0.0
    found = run(
        load=[[0.0, 0.0], [1.0, peak]],
        instants=5,
        elements=400,
        contact_stiffness=stiffness,
    )
    assert not found.iterate.status.any()
    x = np.linspace(0.0, LENGTH, 401)
    beta = np.sqrt(stiffness) / LENGTH
    exact = peak * np.sinh(beta * x) / (AXIAL * beta * np.cosh(beta * LENGTH))
    np.testing.assert_allclose(
        found.iterate.displacement[:, -1], exact, atol=1e-3 * exact[-1]
    )


SOFT = [(scene, 1.0) for scene in CATALOGUE]
STIFF = [(scene, 300.0) for scene in KINDS]


@pytest.mark.parametrize(("scene", "stiffness"), [*SOFT, *STIFF])
def test_every_scene_ends_with_a_certified_solution(scene, stiffness):
    found = run(scene, contact_stiffness=stiffness)
    assert found.is_certified
    assert found.records[-1].error_force < 1e-8


@pytest.mark.parametrize("scene", KINDS)
def test_a_contact_that_hardly_gives_way_is_coulombs(scene):
    found = []
    for law in ({"contact_stiffness": 1e9}, {"friction_law": "coulomb"}):
        settings = settings_of(scene, **(SMALL[scene] | COMPLIANT | law))
        solution = solve(discretise(settings), method_of(settings), watch=False)
        found.append(solution.iterate.friction_force)
    stiff, rigid = found
    np.testing.assert_allclose(stiff, rigid, atol=1e-5 * np.abs(rigid).max())
