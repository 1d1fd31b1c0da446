"""Pressure that changes with time:
what stuck slips as it falls, and a table says all of it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bars import pulled
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import Latin, solve
from solver.discrete import discretise
from solver.discrete.rods.rods import Rods
from solver.latin import Paper, Stop
from solver.reference.closed_forms.pulled_bar import ClosedForm, closed_form
from solver.reference.contact import IncrementalContact
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings

STIFFNESS = 659_400.0
DRAWN = settings(max_examples=15)
FACTORS = st.lists(st.floats(0.05, 1.0), min_size=8, max_size=8)


def rod(**values: Any) -> Rods:
    return BarSettings.checked(values).structure()


def solved(scene: Rods) -> ClosedForm:
    found = closed_form(scene)
    assert found is not None
    return found


def test_a_bar_slips_on_as_its_bolt_loosens_while_the_load_stands_still():
    scene = rod(load="hold", peak=500.0, pressure_load="loosening", instants=81)
    bound = scene.strengths[0]
    held = scene.instants >= 0.25
    assert np.all(scene.load[held] == 500.0)
    end = solved(scene).end_displacement
    formula = scene.load**2 / (2.0 * STIFFNESS * bound)
    formula[scene.load > bound] = np.nan  # the whole bar slides
    slides = np.isnan(formula)
    assert held.sum() > 20
    assert 0 < slides.sum() < held.sum()
    np.testing.assert_allclose(
        end[~slides], formula[~slides], atol=1e-6 * np.nanmax(formula)
    )
    found = reference_of(discretise(scene))
    assert np.all(np.diff(found.displacement[-1, held]) > 0.0)
    grown = (found.status == 1).sum(axis=0)[held]
    assert np.all(np.diff(grown) >= 0)
    assert grown[-1] > grown[0] + 20


def test_finer_meshes_come_to_the_closed_form_with_order_two():
    errors = []
    sizes = np.array([10, 20, 40, 80])
    for elements in sizes:
        scene = rod(
            load="hold", peak=500.0, pressure_load="loosening", elements=int(elements)
        )
        found = reference_of(discretise(scene))
        end = solved(scene).end_displacement
        errors.append(np.abs(found.displacement[-1] - end).max() / end.max())
    assert -np.polyfit(np.log(sizes), np.log(errors), 1)[0] == pytest.approx(
        2.0, abs=0.2
    )
    assert errors[-1] < 1e-3


def test_slip_under_cyclic_pressure_ends_after_its_first_cycle():
    found = solved(rod(load="hold", peak=400.0, pressure_load="shaken", instants=241))
    end = found.end_displacement
    first = round(240 * (0.25 + 0.75 / 12))
    assert end[first] > 2.0 * end[60]
    np.testing.assert_allclose(end[first:], end[first], rtol=1e-12)


@DRAWN
@given(st.lists(st.floats(-1500.0, 1500.0), min_size=8, max_size=8), FACTORS)
def test_closed_form_and_reference_agree_for_any_load_and_pressure(load, factors):
    scene = rod(elements=80, instants=9)
    pressure = np.array([1.0, *factors])
    scene = pulled(scene, [0.0, *load], strength=np.outer(scene.strength, pressure))
    found = reference_of(discretise(scene))
    exact = closed_form(scene)
    assert found.converged.all()
    bound = np.outer(np.full(81, 1500.0 / 80), pressure)
    assert np.all(np.abs(found.contact_force[1:]) <= bound[1:] * (1.0 + 1e-9))
    if exact is not None:
        size = max(np.abs(exact.displacement).max(), 1e-6)
        apart = np.abs(exact.displacement - found.displacement).max()
        assert apart <= 5e-3 * size


@pytest.mark.parametrize("method", [Latin(), Latin(direction=Paper())])
@pytest.mark.parametrize("law", ["coulomb", "compliant", "slip-dependent"])
@pytest.mark.parametrize("path", ["loosening", "shaken"])
def test_latin_and_both_incremental_solvers_find_the_same(path, law, method):
    values = {"load": "sine", "peak": 700.0, "pressure_load": path, "friction_law": law}
    problem = discretise(rod(**values, elements=20, substructures=4, instants=41))
    found = reference_of(problem)
    assert found.converged.all()
    if law == "coulomb":
        other = IncrementalContact(problem).march()
        size = np.abs(found.contact_force).max()
        np.testing.assert_allclose(
            other.contact_force, found.contact_force, atol=1e-9 * size
        )
    tight = replace(method, finish=None, stop=Stop(accuracy=1e-3, iterations=2000))
    iterate = solve(problem, tight, watch=False).iterate
    assert distance_to(found, problem).of_friction_force(iterate) < 1e-3


def test_foolish_pressures_are_refused_in_words():
    with pytest.raises(RefusedError, match="pressures of at least 0"):
        BarSettings.checked({"pressure_load": [[0.0, 5000.0], [1.0, -1.0]]})
    for bound in (np.ones((101, 51)), np.ones(50), np.full(51, -1.0)):
        with pytest.raises(RefusedError, match=r"Rods\.strength"):
            replace(rod(), strength=bound)
    with pytest.raises(RefusedError, match="all that friction can hold"):
        CATALOGUE["strand"].checked(
            {"load": "hold", "peak": 600.0, "pressure_load": "loosening"}
        )
