"""Interface fields in singular vectors, and slip fronts in clips with memory."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from runs import sample, settings_of

from solver.arrays import Array
from solver.reduction.clips import Clips, clips_of, monotone
from solver.reduction.sizes import of_bases, of_clips, of_products
from solver.reduction.svd import decompose, decompositions, front_decay
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.study.quantities import reading
from solver.study.quantities.reduction_measures import clips_in
from solver.study.scene_run import finished_run


@st.composite
def weighted_fields(draw):
    shape = draw(st.tuples(st.integers(1, 8), st.integers(1, 8)))
    field = draw(arrays.arrays(float, shape, elements=st.floats(-1e3, 1e3, width=32)))
    weights = [
        draw(arrays.arrays(float, length, elements=st.floats(0.01, 100.0)))
        for length in shape
    ]
    return field, *weights


def squared_norm(field, space_weights, time_weights):
    return space_weights @ field**2 @ time_weights


def first_modes(found, rank):
    """Sum them, shape (n_points, n_instants)."""
    return (found.space_modes[:, :rank] * found.values[:rank]) @ found.time_modes[:rank]


def constant_speed_front(n_points, n_instants):
    """Decompose a front that crosses its domain at constant speed in the time there is.

    Scaled to the unit square the field is H(x - t), the kernel of an integration, whose
    singular values are 2/((2n - 1) pi). Here it is sampled in the middle of cells; on
    the front itself it is one half.
    """
    positions = (np.arange(n_points) + 0.5) / n_points
    instants = (np.arange(n_instants) + 0.5) / n_instants
    field = np.heaviside(positions[:, None] - instants, 0.5)
    weights = np.full(n_points, 1.0 / n_points)
    return decompose(field, weights, np.full(n_instants, 1.0 / n_instants), positions)


@examples(max_examples=40)
@given(weighted_fields())
def test_modes_are_orthonormal_in_their_own_inner_products(case):
    field, space, time = case
    found = decompose(field, space, time, np.arange(len(space)))
    same = np.eye(len(found.values))
    np.testing.assert_allclose(
        (found.space_modes.T * space) @ found.space_modes, same, atol=1e-10
    )
    np.testing.assert_allclose(
        (found.time_modes * time) @ found.time_modes.T, same, atol=1e-10
    )
    assert np.all(np.diff(found.values) <= 0.0)


@examples(max_examples=40)
@given(weighted_fields())
def test_the_error_of_every_rank_is_the_distance_to_its_approximation_and_falls(case):
    field, space, time = case
    found = decompose(field, space, time, np.arange(len(space)))
    whole = squared_norm(field, space, time)
    for rank, error in enumerate(found.errors):
        left = squared_norm(field - first_modes(found, rank), space, time)
        assert np.sqrt(left) == pytest.approx(
            error * np.sqrt(whole), abs=1e-9 * np.sqrt(whole)
        )
    assert np.all(np.diff(found.errors) <= 0.0)


def test_a_front_sampled_finely_has_the_spectrum_of_an_integration():
    found = constant_speed_front(400, 400).values[:10]
    orders = np.arange(1, 11)
    np.testing.assert_allclose(found, 2.0 / ((2 * orders - 1) * np.pi), rtol=1e-3)
    np.testing.assert_allclose(found / found[0], front_decay(10), rtol=1e-3)


EXACT = 1e-12


def solved(**changes) -> Clips:
    """Fit clips to the discrete solution of a bar."""
    settings = BarSettings.checked(changes)
    problem = discretise(settings)
    law = problem.contacts["friction"]
    lengths = law.by_point(law.weights)
    friction = reference_of(problem).contact("friction").tangential_force
    load = settings.structure().load
    return clips_of(
        friction / lengths[:, None],
        law.by_point(law.tangential.bound) * problem.scales.force / lengths[:, None],
        load if load.any() else friction.sum(axis=0),
        lengths,
        problem.time_weights * problem.scales.time,
    )


@pytest.mark.parametrize("elements", [50, 800])
@pytest.mark.parametrize(
    ("load", "branches"),
    [
        ("ramp", 1),
        ("triangle", 2),
        ("sine", 3),
        ("cycle", 3),
        ("decaying", 8),
        ("random", 9),
    ],
)
def test_two_vectors_for_each_branch_are_the_friction_of_a_bar(
    load, branches, elements
):
    clips = solved(load=load, elements=elements, peak=1200.0)
    assert clips.branches == branches
    assert clips.errors[0] < EXACT


@pytest.mark.parametrize(
    "changes",
    [
        {"substructures": 1},
        {"substructures": 25},
        {"pressure_profile": "rising"},
        {"friction_profile": "gap"},
        {"section_profile": "falling"},
        {"peak": 2400.0},
        {"load": "cycles", "instants": 161},
        {"peak": 0.0, "support_displacement": 1e-3},
        {"load": "ramp", "pressure_load": "loosening"},
        {"load": "hold", "pressure_load": "loosening"},
    ],
    ids=str,
)
def test_clips_stay_exact_with_cuts_uneven_pressure_sliding_and_a_moving_support(
    changes,
):
    assert solved(**changes).errors[0] < EXACT


@pytest.mark.parametrize(
    "changes",
    [
        {"body_force": 800.0},
        {"load": "sine", "pressure_load": "loosening"},
        {"friction_law": "compliant"},
        {"friction_law": "slip-dependent"},
    ],
    ids=str,
)
def test_modes_of_the_residual_remove_the_error_of_clips(
    changes,
):
    clips = solved(**changes)
    assert clips.errors[0] > 0.01
    assert clips.errors[-1] < EXACT


def play_of(load: Array, bound: Array) -> Array:
    """Friction on a clamped rod, (n_points, n_instants), whose axial force has play."""
    reach = np.cumsum(bound[::-1])[::-1]
    axial = np.zeros((len(bound) + 1, len(load)))
    now = np.zeros(len(bound))
    axial[-1] = load
    for instant, force in enumerate(load):
        now = np.clip(now, force - reach, force + reach)
        axial[:-1, instant] = now
    return np.diff(axial, axis=0)


@st.composite
def pulled_rods(draw):
    sizes = st.floats(0.0, 1.0, allow_subnormal=False).map(lambda one: round(one, 3))
    bound = draw(arrays.arrays(float, st.integers(1, 12), elements=sizes))
    load = draw(arrays.arrays(float, st.integers(1, 25), elements=st.integers(-40, 40)))
    return load / draw(st.sampled_from([5.0, 10.0, 40.0])), bound


@examples(max_examples=40)
@given(pulled_rods())
def test_any_load_on_any_bound_is_a_clip(case):
    load, bound = case
    field = play_of(load, bound)
    clips = clips_of(field, bound, load, np.ones(len(bound)), np.ones(len(load)))
    assert np.abs(clips.field - field).max() <= EXACT * max(bound.max(), 1.0)
    assert np.all(np.abs(clips.field) <= bound[:, None] * (1.0 + EXACT))


@examples(max_examples=40)
@given(arrays.arrays(float, st.integers(1, 30), elements=st.integers(-3, 3)))
def test_branches_go_one_way_and_are_as_few_as_can_be(load):
    found = list(monotone(load))
    assert [one.start for one in found[1:]] == [one.stop for one in found[:-1]]
    assert (found[0].start, found[-1].stop) == (0, len(load))
    path = np.append(0.0, load)
    ways = [np.sign(np.diff(path[one.start : one.stop + 1])) for one in found]
    assert all(not {-1.0, 1.0} <= set(own) for own in ways)
    last = [own[own != 0.0][-1] for own in ways if own.any()]
    assert all(one != other for one, other in pairwise(last))


def test_a_substructure_decomposed_alone_is_as_it_is_among_all():
    iterate = sample(settings_of("bar", substructures=4), 3)
    fields = (iterate.problem, iterate.boundary_force)
    chosen = np.array([1, 3])
    every = decompositions(*fields, is_force=True)
    some = decompositions(*fields, chosen, is_force=True)
    for place, part in zip(chosen, some, strict=True):
        assert np.array_equal(part.values, every[place].values)
        assert np.array_equal(part.positions, every[place].positions)
    assert not np.array_equal(some[0].values, some[1].values)


def test_the_modes_of_a_run_hold_its_friction_and_no_products_need_fewer_numbers():
    reduced = {"linear_stage": "pgd", "substructures": 1, "relaxation": 1.0}
    iterate = sample(settings_of("bar", method="paper", **reduced), 8)
    fields = iterate.problem, iterate.boundary_force
    (best,) = map(of_products, decompositions(*fields, is_force=True))
    own = of_bases(*fields, iterate.bases)
    assert own.errors[-1] < 1e-9
    assert np.all(own.errors >= best.errors[: len(own.errors)] - EXACT)
    assert own.within(0.1) >= best.within(0.1)


def test_quantities_of_a_run_agree_with_compact_forms():
    run = finished_run(BarSettings.checked({}), errors=False, indicators=False)
    clips = clips_in(run.settings, run.iterate)
    assert reading("clip_numbers@1e-9")(run) == of_clips(clips).numbers[0]
    assert reading("clip_error")(run) == clips.errors[0] < EXACT
    assert reading("svd_numbers@0.01")(run) == 30 * (51 + 101)
