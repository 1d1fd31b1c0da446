"""Contact that gives way before it slips: Jenkins' element in series (solver/README.md, 8)."""

from __future__ import annotations

from itertools import islice, takewhile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import SMALL

from solver.latin import Ending, iterations, solve
from solver.laws import Compliant, Component, Contact, Sliders, Unilateral
from solver.reference.choice import reference_of
from solver.reference.closed_forms.compliant_bar import pulled_compliant_bar
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.scenes.rope import rope

LENGTH, AXIAL, BOUND = 1.0, 210e9 * 3.14e-6, 0.3 * 5000.0
COMPLIANT = {"friction_law": "compliant"}


def run(scene="bar", **values):
    chosen = CATALOGUE[scene].settings.checked({**SMALL[scene], **COMPLIANT, **values})
    problem = discretise(chosen)
    return solve(problem, method_of(chosen), distance=distance_to(reference_of(problem), problem))


def pulled(force, stiffness):
    """Give the end displacement of a clamped bar under a monotone pull, and its slip zone."""
    density = stiffness * AXIAL / LENGTH**2
    return pulled_compliant_bar(force, LENGTH, AXIAL, BOUND, density)


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
    peak, stiffness = 100.0, 100.0
    assert pulled(peak, stiffness)[1] == 0.0
    found = run(
        load=[[0.0, 0.0], [1.0, peak]], instants=5, elements=400, contact_stiffness=stiffness
    )
    assert not found.iterate.status.any()
    x = np.linspace(0.0, LENGTH, 401)
    beta = np.sqrt(stiffness) / LENGTH
    exact = peak * np.sinh(beta * x) / (AXIAL * beta * np.cosh(beta * LENGTH))
    np.testing.assert_allclose(found.iterate.displacement[:, -1], exact, atol=1e-3 * exact[-1])


def test_unloading_and_reloading_follow_masings_rule():
    peak, stiffness = 1200.0, 100.0
    path = [[0.0, 0.0], [0.2, peak], [0.6, -peak], [1.0, peak]]
    found = run(load=path, instants=81, elements=200, contact_stiffness=stiffness).iterate
    end = found.displacement[-1]
    load = np.interp(np.linspace(0.0, 1.0, 81), *np.array(path).T)
    top = pulled(peak, stiffness)[0]
    for instant in range(20, 49, 4):
        exact = top - 2.0 * pulled((peak - load[instant]) / 2.0, stiffness)[0]
        assert abs(end[instant] - exact) < 3e-3 * top
    assert abs(end[-1] - end[16]) < 1e-6 * top
    forces = np.linspace(0.0, peak, 400)
    curve = np.array([pulled(force, stiffness)[0] for force in forces])
    exact = 8.0 * np.trapezoid(forces, curve) - 4.0 * peak * top
    loop = np.trapezoid(load[16:], end[16:])
    assert loop == pytest.approx(exact, rel=0.02)


@pytest.mark.parametrize("scene", list(CATALOGUE))
@pytest.mark.parametrize("stiffness", [1.0, 300.0])
def test_every_scene_ends_with_a_certified_solution(scene, stiffness):
    found = run(scene, contact_stiffness=stiffness)
    assert found.is_certified
    assert found.records[-1].error_force < 1e-8


@pytest.mark.parametrize("scene", ["bar", "strand"])
@pytest.mark.parametrize("stiffness", [3.0, 30.0])
def test_a_soft_contact_is_solved_in_a_few_iterations(scene, stiffness):
    changes = {**SMALL[scene], **COMPLIANT, "contact_stiffness": stiffness}
    chosen = CATALOGUE[scene].settings.checked(changes)
    problem = discretise(chosen)
    distance = distance_to(reference_of(problem), problem)
    found = islice(iterations(problem, method_of(chosen)), 20)
    assert len(list(takewhile(lambda it: distance.of_friction_force(it) > 1e-6, found))) < 15


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_a_contact_that_hardly_gives_way_is_coulombs(scene):
    stiff = run(scene, contact_stiffness=1e9).iterate.friction_force
    rigid = run(scene, friction_law="coulomb").iterate.friction_force
    np.testing.assert_allclose(stiff, rigid, atol=1e-5 * np.abs(rigid).max())


@settings(max_examples=60)
@given(st.integers(0, 2**31), st.booleans(), st.booleans())
def test_along_the_search_direction_slider_and_spring_carry_the_same_force(seed, opens, two):
    random = np.random.default_rng(seed)
    pairs, times = 4, 15
    rows = random.permutation(4 * pairs).reshape(4, pairs)
    normal, tangent = (Component(rows[n], rows[n + 2] if two else None) for n in (0, 1))
    common = {
        "points": np.arange(pairs),
        "positions": np.arange(pairs, dtype=float),
        "weights": random.uniform(0.5, 2.0, pairs),
    }
    sliders = (
        Sliders.of_contact(tangent, np.full(pairs, 0.4))
        if opens
        else Sliders.of_known_bound(tangent, random.uniform(0.0, 0.5, pairs))
    )
    along = Compliant(2.0).on(sliders, common["weights"], 1.0)
    across = Unilateral(component=normal, gap=np.zeros(pairs)) if opens else None
    law = Contact(tangential=along, normal=across, **common)
    k = 10.0 ** random.uniform(-1.0, 1.0, rows.size)
    incoming = random.normal(size=(rows.size, times))
    moved = incoming.copy()
    law.rule(k, times)(incoming, moved, slice(None))
    force = k[:, None] * (moved - incoming)
    friction = force[tangent.above]
    slider = along.slider(moved, force)
    np.testing.assert_allclose(friction, (slider - tangent.jump(moved)) / along.softness[:, None])
    bound = along.bound + (along.friction[:, None] * force[normal.above] if opens else 0.0)
    assert np.all(np.abs(friction) <= bound + 1e-9)
    slip = np.diff(slider, axis=1, prepend=0.0)
    slips = np.abs(slip) > 1e-9
    np.testing.assert_allclose(friction[slips], (-np.sign(slip) * bound)[slips], atol=1e-8)
    if two:
        np.testing.assert_allclose(friction, -force[tangent.below], atol=1e-10)


def test_wires_of_a_rope_give_way_alike_by_the_stiffest_and_the_longest_of_them():
    chosen = {"construction": "conductor", "friction_law": "compliant", "contact_stiffness": 40.0}
    small = {"elements": 4, "instants": 3, "substructures": 2}
    made = CATALOGUE["rope"].settings.checked({**chosen, **small})
    scene, problem = rope(made), discretise(made)
    stiffest = max(wire.helix.stiffness for wire in scene.wires)
    longest = max(wire.length for wire in scene.wires)
    assert min(wire.helix.stiffness for wire in scene.wires) < 0.9 * stiffest
    scale = problem.scales.force / problem.scales.displacement
    for law in problem.rubbing.values():
        density = scale / (law.tangential.softness * law.weights)
        np.testing.assert_allclose(density, 40.0 * stiffest / longest**2)
