"""Friction that hardens or softens with accumulated slip (solver/README.md, 14)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.discrete.rods.rods import Rods
from solver.latin import Ending, Latin, solve
from solver.laws import Component, Contact, Sliders, Unilateral
from solver.laws.slip_dependent import SlipDependent
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

AXIAL, BOUND = 6.6e5, 1500.0
CHANGING = {"friction_law": "slip-dependent"}


def bar(law, force, elements, *, displaced=False, bound=BOUND):
    """Give a clamped bar of 1 m whose end is pulled, or displaced by force L / ES."""
    return (
        Rods(
            length=1.0,
            stiffness=AXIAL,
            elements=elements,
            substructures=1,
            bound=np.full(elements + 1, bound),
            load=np.asarray(force, dtype=float),
            instants=np.linspace(0.0, 1.0, len(force)),
            duration=1.0,
            rigid_grip=displaced,
            friction_law=law,
        )
    ).discretise()


def gamma(ratio, slip_length):
    return np.sqrt(BOUND * abs(ratio - 1.0) / slip_length / AXIAL)


@settings(max_examples=80)
@given(
    st.integers(0, 2**31),
    st.booleans(),
    st.booleans(),
    st.sampled_from([0.0, 0.4, 1.0, 1.6, 5.0]),
    st.sampled_from([1e-3, 0.3, 10.0]),
)
def test_the_local_stage_obeys_the_bound_that_its_slip_has_left(seed, opens, two, ratio, length):
    random = np.random.default_rng(seed)
    pairs, times = 4, 25
    rows = random.permutation(4 * pairs).reshape(4, pairs)
    normal, tangent = (Component(rows[n], rows[n + 2] if two else None) for n in (0, 1))
    plain = (
        Sliders.of_contact(tangent, np.full(pairs, 0.4))
        if opens
        else Sliders.of_known_bound(tangent, random.uniform(0.0, 0.5, pairs))
    )
    law = Contact(
        tangential=SlipDependent(ratio, length).on(plain, np.ones(pairs), 1.0),
        normal=Unilateral(component=normal, gap=np.zeros(pairs)) if opens else None,
        points=np.arange(pairs),
        positions=np.arange(float(pairs)),
        weights=np.ones(pairs),
    )
    k = 10.0 ** random.uniform(-1.0, 1.0, rows.size)
    incoming = random.normal(size=(rows.size, times))
    moved = incoming.copy()
    law.rule(k, times)(incoming, moved, slice(None))
    force = k[:, None] * (moved - incoming)
    slip = np.diff(tangent.jump(moved), axis=1, prepend=0.0)
    gone = np.minimum(np.cumsum(np.abs(slip), axis=1) / length, 1.0)
    bound = plain.bound * np.ones(times)
    if opens:
        bound = bound + plain.friction[:, None] * force[normal.above]
    bound = bound * (1.0 + (ratio - 1.0) * gone)
    friction = force[tangent.above]
    assert np.all(np.abs(friction) <= bound + 1e-9)
    slips = np.abs(slip) > 1e-9
    assert slips.any()
    np.testing.assert_allclose(friction[slips], (-np.sign(slip) * bound)[slips], atol=1e-7)
    assert law.behaviour(moved, force, 1e-14).violation(1.0).max() < 1e-7


def test_a_ratio_of_one_is_coulombs_law():
    load = {"load": "random", "peak": 1200.0, "elements": 20, "instants": 31}
    fields = []
    for law in ({}, {**CHANGING, "friction_ratio": 1.0}):
        chosen = CATALOGUE["bar"].settings.checked({**load, **law})
        fields.append(solve(discretise(chosen), method_of(chosen)).iterate)
    one, other = fields
    np.testing.assert_allclose(one.displacement, other.displacement, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("ratio", [0.0, 0.5, 2.0])
def test_a_point_on_a_spring_moves_as_in_closed_form(ratio):
    first, spring, length = 0.5 * BOUND, AXIAL, 2.0 * BOUND / AXIAL
    slope = first * (ratio - 1.0) / length
    force = np.linspace(0.0, 4.0 * BOUND, 81)
    problem = bar(SlipDependent(ratio, length), force, 1)
    found = reference_of(problem)
    early = np.maximum(force - first, 0.0) / (spring + slope)
    expected = np.where(early < length, early, (force - first * ratio) / spring)
    assert found.converged.all()
    np.testing.assert_allclose(found.displacement[-1], expected, atol=1e-12 * expected.max())
    run = solve(problem, Latin(finish=None), distance=distance_to(found, problem))
    assert run.status.ending is Ending.CONVERGED
    assert run.records[-1].error_force < 0.01


def test_a_point_whose_friction_falls_faster_than_its_spring_unloads_jumps():
    force = np.linspace(0.0, BOUND, 41)
    for share, jumps in ((0.98, False), (1.02, True)):
        length = 0.5 * BOUND / (share * AXIAL)  # the slope over the spring's stiffness is the share
        found = reference_of(bar(SlipDependent(0.0, length), force, 1))
        assert found.jumps is jumps
        assert np.all(force[~found.converged] > 0.5 * BOUND)


@pytest.mark.parametrize(("ratio", "length"), [(3.0, 1e-3), (0.5, 1e-3)])
def test_a_pulled_bar_moves_as_in_closed_form_with_errors_of_second_order(ratio, length):
    peak, rate = 900.0, gamma(ratio, length)
    slope = BOUND * abs(ratio - 1.0) / length
    if ratio > 1.0:
        exact = BOUND / slope * (np.sqrt(1.0 + (peak * rate / BOUND) ** 2) - 1.0)
    else:
        exact = BOUND / slope * (1.0 - np.sqrt(1.0 - (peak * rate / BOUND) ** 2))
    sizes, errors = np.array([25, 50, 100, 200]), []
    for elements in sizes:
        found = reference_of(bar(SlipDependent(ratio, length), np.linspace(0, peak, 21), elements))
        errors.append(abs(found.displacement[-1, -1] - exact) / exact)
    assert errors[-1] < 1e-4
    # The front ends somewhere inside an element, so errors scatter around their order.
    assert -np.polyfit(np.log(sizes), np.log(errors), 1)[0] > 1.5


@pytest.mark.parametrize("ratio", [0.5, 1.5])
@pytest.mark.parametrize("load", ["sine", "random"])
def test_a_run_comes_to_the_reference_by_itself_and_is_certified(ratio, load):
    values = {**CHANGING, "friction_ratio": ratio, "slip_length": 3e-4, "load": load}
    chosen = CATALOGUE["bar"].settings.checked({**values, "instants": 51, "finish": "none"})
    problem = discretise(chosen)
    distance = distance_to(reference_of(problem), problem)
    run = solve(problem, method_of(chosen), distance=distance)
    assert run.status.ending is Ending.CONVERGED
    assert run.records[-1].error_force < 0.02
    whole = solve(problem, method_of(chosen.replace(finish="at-once")), distance=distance)
    assert whole.is_certified
    assert whole.records[-1].error_force < 1e-9
    assert whole.records[-1].behaviour < 1e-9


def test_beyond_the_largest_load_the_bar_jumps_and_the_run_says_so():
    length = 4e-4
    largest = BOUND / gamma(0.0, length)
    force = np.linspace(0.0, 1.2 * largest, 121)
    problem = bar(SlipDependent(0.0, length), force, 100)
    found = reference_of(problem)
    assert found.jumps
    assert force[found.converged].max() == pytest.approx(largest, rel=0.015)
    run = solve(problem, Latin())
    assert run.status.ending is Ending.STALLED
    assert "jumps" in run.status.advice


def test_a_displaced_end_goes_on_beyond_the_largest_load():
    length, forces = 4e-4, []
    largest = BOUND / gamma(0.0, length)
    end = np.linspace(0.0, 1.2 * length, 61)
    for elements in (50, 200):
        found = reference_of(bar(SlipDependent(0.0, length), end * AXIAL, elements, displaced=True))
        assert found.converged.all()
        force = (found.displacement[-1] - found.displacement[-2]) * AXIAL * elements
        assert force.argmax() < 60 or force[-1] <= force.max()
        forces.append(abs(force.max() / largest - 1.0))
    assert forces[1] < min(forces[0], 5e-3)


def test_where_there_is_no_reference_a_run_ends_by_its_estimate():
    chosen = CATALOGUE["block"].settings.checked({**CHANGING, "slip_length": 1e-5})
    run = solve(discretise(chosen), method_of(chosen))
    assert run.status.ending is Ending.CONVERGED
    assert not run.is_certified
