"""Friction that hardens, softens, is cohesive or capped (MATHEMATICS.md, 8 and 14)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contact_problems import local_stage, rubbing_points
from hypothesis import given, settings
from hypothesis import strategies as st
from runs import solved

from solver import Stack, discrete
from solver.arrays import Array
from solver.discrete import Side, SideComponent, Support
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.latin import Ending, Latin, solve
from solver.laws import Contact, FrictionLaw, SlipFactor
from solver.reference.distance import distance_to, kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

STIFFNESS = 6.6e5
MOST = 1500.0
CHANGING = {"friction_law": "slip-dependent"}


def pulled_bar(law, force, elements, *, displaced=False, strength=MOST):
    """A clamped bar of 1 m whose end is pulled, or displaced by force L / ES."""
    force = np.asarray(force, dtype=float)
    return discrete.discretise(
        Rods(
            length=1.0,
            stiffness=STIFFNESS,
            elements=elements,
            substructures=1,
            strength=np.full(elements + 1, strength),
            left=End(displacement=np.zeros(len(force))),
            right=End(displacement=force / STIFFNESS) if displaced else End(force),
            instants=np.linspace(0.0, 1.0, len(force)),
            duration=1.0,
            friction_law=law,
        )
    )


def changing(ratio, slip_length):
    return FrictionLaw(slip_factor=SlipFactor((0.0, slip_length), (1.0, ratio)))


def gamma(ratio, slip_length):
    return np.sqrt(MOST * abs(ratio - 1.0) / slip_length / STIFFNESS)


STRENGTHS = [
    None,
    SlipFactor((0.0, 1e-3), (1.0, 5.0)),
    SlipFactor((0.0, 0.3), (1.0, 0.0)),
    SlipFactor((0.0, 0.1, 0.4, 3.0), (1.0, 1.6, 0.4, 0.7)),
]


def bound_of(law: Contact, moved: Array, force: Array, slip: Array) -> Array:
    """Bound on friction by the words of the law, (n_points, n_instants).

    `moved` and `force` are fields of all rows; contact obeys Signorini's law.
    """
    along = law.tangential
    bound = np.broadcast_to(along.bound, slip.shape)
    if law.normal is not None:
        opening = law.normal.opening(moved, force)
        pressing = force[law.normal.component.above]
        assert np.all(pressing >= 0.0)
        assert np.all(opening >= -1e-11)
        assert np.all(np.minimum(opening, pressing) <= 1e-11)
        bound = bound * ~np.logical_or.accumulate(opening > 1e-8, axis=1)
        bound = bound + along.friction[:, None] * pressing
        if along.cap is not None:
            bound = np.minimum(bound, along.cap[:, None])
    if along.slip_factor is not None:
        bound = bound * along.slip_factor(np.cumsum(np.abs(slip), axis=1))
    return bound


@settings(max_examples=120)
@given(
    st.integers(0, 2**31),
    st.booleans(),
    st.booleans(),
    st.sampled_from([None, 2.0, 0.02]),
    st.sampled_from(STRENGTHS),
    st.sampled_from([0.0, 0.3]),
    st.sampled_from([None, 0.6]),
    st.sampled_from([0.0, 0.5]),
    st.sampled_from([0.0, 0.4, 10.0]),
)
def test_the_local_stage_obeys_the_law_with_all_that_may_be_of_it(
    seed, opens, two, compliance, slip_factor, cohesion, cap, gap, mu
):
    """Signorini's law across, and Coulomb's along with what may be added to it."""
    random, along, common = rubbing_points(seed, opens=opens, two=two)
    along = replace(along, slip_factor=slip_factor, bound=along.bound + cohesion)
    if opens:
        common["normal"] = replace(common["normal"], gap=gap * random.normal(size=4))
        along = replace(along, friction=np.full(4, mu))
        if cap is not None:
            along = replace(along, cap=np.full(4, cap))
    if compliance is not None:
        along = replace(along, compliance=compliance / common["weights"])
    law = Contact(tangential=along, **common)
    moved, force = local_stage(law, random)
    friction = force[law.tangent.above]
    slider = along.slider(moved, force)
    slip = np.diff(slider, axis=1, prepend=0.0)
    bound = bound_of(law, moved, force, slip)
    assert np.all(np.abs(friction) <= bound + 1e-9)
    slips = np.abs(slip) > 1e-8
    np.testing.assert_allclose(
        friction[slips], (-np.sign(slip) * bound)[slips], atol=1e-7
    )
    assert law.violation(moved, force, 1e-14).energy(1.0, 1.0).max() < 1e-6
    if compliance is not None:
        spring = (slider - law.tangent.jump(moved)) / along.compliance[:, None]
        np.testing.assert_allclose(friction, spring, atol=1e-9)
    if two:
        for above, below in law.components:
            np.testing.assert_allclose(force[above], -force[below], atol=1e-9)


@pytest.mark.parametrize("ratio", [0.0, 0.5, 2.0])
def test_a_point_on_a_spring_moves_as_in_closed_form(ratio):
    first = 0.5 * MOST
    spring = STIFFNESS
    length = 2.0 * MOST / STIFFNESS
    slope = first * (ratio - 1.0) / length
    force = np.linspace(0.0, 4.0 * MOST, 81)
    problem = pulled_bar(changing(ratio, length), force, 1)
    found = reference_of(problem)
    early = np.maximum(force - first, 0.0) / (spring + slope)
    expected = np.where(early < length, early, (force - first * ratio) / spring)
    assert found.converged.all()
    np.testing.assert_allclose(
        found.displacement[-1], expected, atol=1e-12 * expected.max()
    )
    run = solve(
        problem, Latin(finish=None), distance=distance_to(found, problem), watch=False
    )
    assert run.status.ending is Ending.CONVERGED
    assert run.records[-1].error_force < 0.01


def test_a_point_whose_friction_falls_faster_than_its_spring_unloads_jumps():
    force = np.linspace(0.0, MOST, 41)
    for share, jumps in ((0.98, False), (1.02, True)):
        length = (
            0.5 * MOST / (share * STIFFNESS)
        )  # the slope over the spring's stiffness is the share
        found = reference_of(pulled_bar(changing(0.0, length), force, 1))
        assert (found.jumps_at is not None) is jumps
        assert np.all(force[~found.converged] > 0.5 * MOST)


@pytest.mark.parametrize(("ratio", "length"), [(3.0, 1e-3), (0.5, 1e-3)])
def test_a_pulled_bar_moves_as_in_closed_form_with_errors_of_second_order(
    ratio, length
):
    peak = 900.0
    rate = gamma(ratio, length)
    slope = MOST * abs(ratio - 1.0) / length
    if ratio > 1.0:
        exact = MOST / slope * (np.sqrt(1.0 + (peak * rate / MOST) ** 2) - 1.0)
    else:
        exact = MOST / slope * (1.0 - np.sqrt(1.0 - (peak * rate / MOST) ** 2))
    sizes = np.array([25, 50, 100, 200])
    errors = []
    for elements in sizes:
        found = reference_of(
            pulled_bar(changing(ratio, length), np.linspace(0, peak, 21), elements)
        )
        errors.append(abs(found.displacement[-1, -1] - exact) / exact)
    assert errors[-1] < 1e-4
    # The front ends somewhere inside an element, so errors scatter around their order.
    assert -np.polyfit(np.log(sizes), np.log(errors), 1)[0] > 1.5


@pytest.mark.parametrize("ratio", [0.5, 1.5])
@pytest.mark.parametrize("load", ["sine", "random"])
def test_a_run_comes_to_the_reference_by_itself_and_is_certified(ratio, load):
    values = {**CHANGING, "friction_ratio": ratio, "slip_length": 3e-4, "load": load}
    chosen = CATALOGUE["bar"].checked({**values, "instants": 51, "finish": "none"})
    run, whole = (
        solved(chosen.replace(finish=finish)) for finish in ("none", "at-once")
    )
    assert run.status.ending is Ending.CONVERGED
    assert run.records[-1].error_force < 0.02
    assert whole.is_certified
    assert whole.records[-1].error_force < 1e-9
    assert whole.records[-1].behaviour < 1e-9


def test_beyond_the_largest_load_the_bar_jumps_and_the_run_says_so():
    length = 4e-4
    largest = MOST / gamma(0.0, length)
    force = np.linspace(0.0, 1.2 * largest, 61)
    problem = pulled_bar(changing(0.0, length), force, 50)
    found = reference_of(problem)
    assert found.jumps_at is not None
    assert force[found.jumps_at] == pytest.approx(largest, rel=0.03)
    run = solve(problem, Latin(), watch=False)
    assert run.is_certified
    assert f"At {problem.instants[found.jumps_at]:.4g} s" in run.status.advice
    assert "jumps" in run.status.advice


@pytest.mark.parametrize("length", [1e-6, 1e-4])
@pytest.mark.parametrize("displaced", [False, True])
def test_the_size_of_a_load_step_does_not_change_which_solution_is_taken(
    length, displaced
):
    found = []
    for steps in (5, 10):
        end = np.linspace(0.0, 1.0, steps + 1) * (
            6e-4 * STIFFNESS if displaced else 800.0
        )
        found.append(
            reference_of(
                pulled_bar(changing(0.3, length), end, 40, displaced=displaced)
            )
        )
        assert found[-1].converged.all()
        assert found[-1].jumps_at is None
    few, many = (one.displacement for one in found)
    assert np.allclose(few, many[:, ::2], rtol=0.0, atol=1e-9 * np.abs(many).max())


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
    """Displacement and force of the strip's end, up to first slip of the other end.

    Behind the front friction softens over the same distance as long as it goes on, and
    beyond is its last value.
    """
    stiffness = 2.1e11 * 0.01
    first = 0.3e6
    ratio = 0.3
    slope = np.sqrt(first * (1.0 - ratio) / length / stiffness)
    softens = np.linspace(0.0, np.arccos(ratio), 100) / slope
    slid = np.linspace(0.0, 1.0 - softens[-1], 200)
    force = first / slope * np.sin(slope * softens)
    moved = length / (1.0 - ratio) * (1.0 - np.cos(slope * softens))
    along = (force[-1] + 0.5 * ratio * first * slid) * slid / stiffness
    forces = np.concatenate([force, force[-1] + ratio * first * slid])
    return np.concatenate([moved, length + along]), forces


@pytest.mark.parametrize(("length", "end"), [(1e-6, 6e-5), (1e-5, 3e-4)])
def test_a_strip_held_by_friction_goes_along_its_loading_path_until_it_jumps(
    length, end
):
    path = [[0.0, 0.0], [0.25, 0.0], [1.0, end]]
    values = {
        **STRIP,
        "slip_length": length,
        "right_normal_load": path,
        "instants": 61,
    }
    chosen = CATALOGUE["block"].checked(values)
    problem = discretise(chosen)
    run = solve(problem, method_of(chosen), watch=False)
    assert run.status.ending is Ending.CONVERGED
    assert run.is_certified
    assert kkt_residual(run.iterate, problem) < 1e-9
    moved = np.interp(problem.instants, *np.transpose(path))
    pulled = -run.iterate.friction_force.sum(axis=0)
    exact = pull_out(length)
    assert exact[1][-1] == pytest.approx(
        {1e-6: 107.2e3, 1e-5: 144.5e3}[length], rel=1e-3
    )
    jumps_at = reference_of(problem).jumps_at
    assert jumps_at == np.searchsorted(moved, exact[0][-1])
    assert f"At {problem.instants[jumps_at]:.4g} s" in run.status.advice
    apart = pulled[:jumps_at] - np.interp(moved[:jumps_at], *exact)
    assert np.abs(apart).max() < 0.01 * exact[1][-1]
    # All of it slides on, with the last friction.
    assert pulled[jumps_at:] == pytest.approx(0.3 * 0.3e6, rel=1e-9)


@pytest.mark.parametrize(("ratio", "jumps"), [(0.7, False), (0.75, True), (0.8, False)])
def test_a_fault_that_softens_is_solved_and_jumps_only_where_its_elements_are_too_long(
    ratio, jumps
):
    values = {**CHANGING, "friction_ratio": ratio, "slip_length": 2e-3}
    for elements, expected in ((48, jumps), (96, False)):
        chosen = CATALOGUE["fault"].checked({**values, "elements": elements})
        run = solve(discretise(chosen), method_of(chosen), watch=False)
        assert run.is_certified
        assert ("jumps" in run.status.advice) is expected


@settings(max_examples=10)
@given(
    st.integers(0, 2**31),
    st.sampled_from(["block", "layers", "fault", "incline", "bar", "strand"]),
    st.sampled_from([0.0, 0.4, 0.8, 2.0]),
    st.sampled_from([1e-8, 1e-6, 1e-5, 1e-4]),
)
def test_solutions_with_changing_friction_obey_equilibrium_and_the_law(
    seed, scene, ratio, length
):
    random = np.random.default_rng(seed)
    values = {
        **CHANGING,
        "friction_ratio": ratio,
        "slip_length": length,
        "instants": 13,
    }
    values |= {"friction": random.uniform(0.1, 0.8), "elements": 12}
    chosen = CATALOGUE[scene].checked(values)
    problem = discretise(chosen)
    found = reference_of(problem)
    if found.converged.all():
        assert kkt_residual(found, problem) < 1e-8
    else:
        assert found.jumps_at is not None


WHOLE = np.linspace(0.0, 1.0, 41)


def pressed_block(law, *, lifted=False):
    """A flat block, moved on its support until all of it slips, and on once more."""
    low = -4e-6
    high = 2e-6 if lifted else -4e-6
    down = np.interp(WHOLE, [0.0, 0.2, 0.5, 0.6, 0.7], [0.0, low, low, high, low])
    along = np.interp(WHOLE, [0.0, 0.2, 0.5, 0.7, 1.0], [0.0, 0.0, 3e-5, 3e-5, 6e-5])
    sides = {
        "top": Side(
            x=SideComponent(prescribed=True, mean=along),
            y=SideComponent(prescribed=True, mean=down),
        )
    }
    return discrete.discretise(
        Stack(
            length=0.1,
            height=0.02,
            young=210e9,
            poisson=0.0,
            state="stress",
            elements=(16, 4),
            substructures=(2, 1),
            instants=WHOLE,
            duration=1.0,
            support=Support(gap=np.zeros(17), friction=0.3),
            friction_law=law,
            sides=sides,
        )
    )


TABLE = SlipFactor((0.0, 5e-6, 2e-5), (1.0, 1.4, 0.5))


@pytest.mark.parametrize("lifted", [False, True])
@pytest.mark.parametrize(
    ("law", "first", "last"),
    [
        (FrictionLaw(), 12.6e6, 12.6e6),
        (FrictionLaw(cohesion=2e6), 14.6e6, 12.6e6),
        (FrictionLaw(cohesion=2e6, stiffness=1e13), 14.6e6, 12.6e6),
        (FrictionLaw(cohesion=1e6, stiffness=1e13, slip_factor=TABLE), 6.8e6, 6.3e6),
    ],
)
def test_a_block_that_slips_carries_cohesion_and_friction_until_it_is_lifted(
    law, first, last, lifted
):
    problem = pressed_block(law, lifted=lifted)
    reference = reference_of(problem)
    run = solve(problem, Latin(), distance=distance_to(reference, problem), watch=False)
    assert run.is_certified
    assert run.records[-1].error_force < 1e-12
    assert kkt_residual(run.iterate, problem) < 1e-11
    stress = -run.iterate.contact("support").tangential_force.sum(axis=0) / 0.1
    assert stress[20] == pytest.approx(first, rel=1e-9)
    assert stress[-1] == pytest.approx(last if lifted else first, rel=1e-9)
    alone = solve(
        problem,
        Latin(finish=None),
        distance=distance_to(reference, problem),
        watch=False,
    )
    assert alone.records[-1].error_force < 0.01


def test_contact_that_gives_way_across_is_in_series_with_the_body():
    run = solve(pressed_block(FrictionLaw(normal_stiffness=1e13)), Latin(), watch=False)
    assert run.is_certified
    pressed = run.iterate.contact("support").normal_force.sum(axis=0)[10]
    assert pressed / 0.1 == pytest.approx(4e-6 / (0.02 / 210e9 + 1e-13), rel=1e-9)
