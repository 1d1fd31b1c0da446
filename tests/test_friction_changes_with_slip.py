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
from solver.study.stability.residual import kkt_residual

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
        assert (found.jumps_at is not None) is jumps
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
    assert found.jumps_at is not None
    assert force[found.jumps_at] == pytest.approx(largest, rel=0.015)
    run = solve(problem, Latin())
    assert run.is_certified
    assert f"At {problem.instants[found.jumps_at]:.4g} s" in run.status.advice
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


@pytest.mark.parametrize("length", [1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("displaced", [False, True])
def test_the_size_of_a_load_step_does_not_change_which_solution_is_taken(length, displaced):
    found = []
    for steps in (10, 320):
        end = np.linspace(0.0, 1.0, steps + 1) * (6e-4 * AXIAL if displaced else 800.0)
        found.append(reference_of(bar(SlipDependent(0.3, length), end, 40, displaced=displaced)))
        assert found[-1].converged.all()
        assert found[-1].jumps_at is None
    few, many = (one.displacement for one in found)
    assert np.allclose(few, many[:, ::32], rtol=0.0, atol=1e-9 * np.abs(many).max())


STRIP = {
    **CHANGING,
    "friction_ratio": 0.3,
    "length": 1.0,
    "height": 0.01,
    "gap": "flat",
    "friction": 0.3,
    "plane": "stress",
    "poisson": 0.0,
    "top": "traction",
    "top_normal_traction": -1e6,
    "right": "pushed",
    "elements": 100,
    "elements_up": 2,
}
"""A strip that friction alone holds, pulled at one end by a displacement."""


def pull_out(length):
    """Give displacement and force of the strip's end, up to where the other begins to slip.

    Behind the front friction softens over the same distance as long as it goes on, and beyond is
    its last value.
    """
    stiffness, first, ratio = 2.1e11 * 0.01, 0.3e6, 0.3
    slope = np.sqrt(first * (1.0 - ratio) / length / stiffness)
    softens = np.linspace(0.0, np.arccos(ratio), 100) / slope
    slid = np.linspace(0.0, 1.0 - softens[-1], 200)
    force = first / slope * np.sin(slope * softens)
    moved = length / (1.0 - ratio) * (1.0 - np.cos(slope * softens))
    along = (force[-1] + 0.5 * ratio * first * slid) * slid / stiffness
    forces = np.concatenate([force, force[-1] + ratio * first * slid])
    return np.concatenate([moved, length + along]), forces


@pytest.mark.parametrize("length", [1e-6, 1e-5])
@pytest.mark.parametrize("end", [6e-5, 3e-4])
def test_a_strip_held_by_friction_goes_along_its_loading_path_until_it_jumps(length, end):
    path = [[0.0, 0.0], [0.25, 0.0], [1.0, end]]
    values = {**STRIP, "slip_length": length, "right_normal_load": path, "instants": 121}
    chosen = CATALOGUE["block"].settings.checked(values)
    problem = discretise(chosen)
    run = solve(problem, method_of(chosen))
    assert run.status.ending is Ending.CONVERGED
    assert run.is_certified
    assert kkt_residual(run.iterate, problem) < 1e-9
    moved = np.interp(problem.instants, *np.transpose(path))
    pulled = -run.iterate.friction_force.sum(axis=0)
    exact = pull_out(length)
    assert exact[1][-1] == pytest.approx({1e-6: 107.2e3, 1e-5: 144.5e3}[length], rel=1e-3)
    jumps_at = reference_of(problem).jumps_at
    assert jumps_at == np.searchsorted(moved, exact[0][-1])
    assert f"At {problem.instants[jumps_at]:.4g} s" in run.status.advice
    apart = pulled[:jumps_at] - np.interp(moved[:jumps_at], *exact)
    assert np.abs(apart).max() < 0.01 * exact[1][-1]
    # All of it slides on, with the last friction.
    assert pulled[jumps_at:] == pytest.approx(0.3 * 0.3e6, rel=1e-9)


def test_what_a_run_advises_where_its_iterates_stall_finds_the_solution():
    path = [[0.0, 0.0], [0.25, 0.0], [1.0, 6e-5]]
    values = {**STRIP, "elements": 20, "instants": 31, "slip_length": 1e-5}
    values |= {"right_normal_load": path, "finish": "none"}
    chosen = CATALOGUE["block"].settings.checked(values)
    problem = discretise(chosen)
    run = solve(problem, method_of(chosen))
    assert run.status.ending is Ending.STALLED
    assert "finish=at-once" in run.status.advice
    assert "jumps" in run.status.advice
    assert solve(problem, method_of(chosen.replace(finish="at-once"))).is_certified


@pytest.mark.parametrize(("ratio", "jumps"), [(0.7, False), (0.75, True), (0.8, False)])
def test_a_fault_that_softens_is_solved_and_jumps_only_where_its_elements_are_too_long(
    ratio, jumps
):
    values = {**CHANGING, "friction_ratio": ratio, "slip_length": 1e-3}
    for elements, expected in ((48, jumps), (96, False)):
        chosen = CATALOGUE["fault"].settings.checked({**values, "elements": elements})
        run = solve(discretise(chosen), method_of(chosen))
        assert run.is_certified
        assert ("jumps" in run.status.advice) is expected


@pytest.mark.parametrize("ratio", [0.7, 0.8])
def test_the_iterates_find_a_softening_fault_by_themselves(ratio):
    values = {**CHANGING, "friction_ratio": ratio, "slip_length": 1e-3, "finish": "none"}
    chosen = CATALOGUE["fault"].settings.checked(values)
    problem = discretise(chosen)
    run = solve(problem, method_of(chosen), distance=distance_to(reference_of(problem), problem))
    assert run.status.ending is Ending.CONVERGED
    assert run.records[-1].error_force < 0.01


@settings(max_examples=15)
@given(
    st.integers(0, 2**31),
    st.sampled_from(["block", "layers", "fault", "incline", "bar", "strand"]),
    st.sampled_from([0.0, 0.4, 0.8, 2.0]),
    st.sampled_from([1e-8, 1e-6, 1e-5, 1e-4]),
)
def test_what_is_found_obeys_equilibrium_and_the_law_wherever_it_is_found(
    seed, scene, ratio, length
):
    random = np.random.default_rng(seed)
    values = {**CHANGING, "friction_ratio": ratio, "slip_length": length, "instants": 21}
    values |= {"friction": random.uniform(0.1, 0.8), "elements": 12}
    chosen = CATALOGUE[scene].settings.checked(values)
    problem = discretise(chosen)
    found = reference_of(problem)
    if found.converged.all():
        assert kkt_residual(found, problem) < 1e-8
    else:
        assert found.jumps_at is not None
