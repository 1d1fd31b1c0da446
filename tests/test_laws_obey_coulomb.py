"""The interface laws hold pointwise on any input, bit by bit where no arithmetic is involved."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from solver.latin.local_stage import LocalStage
from solver.laws import Neumann
from solver.laws.perfect import perfect
from solver.laws.play import WALK_FROM_POINTS, _Scan, _Walk, play
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

ANY = settings(max_examples=40)
EPS = float(np.finfo(float).eps)
SHAPES = array_shapes(min_dims=2, max_dims=2, max_side=30)
REAL = st.floats(-1e6, 1e6)
REACH = st.floats(0.0, 1e6)


@st.composite
def targets_and_reaches(draw, varying=True):
    """Targets, and reaches that vary over points, and over instants too where wanted."""
    shape = draw(SHAPES)
    each = shape if varying and draw(st.booleans()) else shape[:1]
    return draw(arrays(float, shape, elements=REAL)), draw(arrays(float, each, elements=REACH))


@st.composite
def eighths(draw, *, reaches=1):
    """Targets and reaches whose sums are exact in doubles."""
    shape = draw(SHAPES)
    target = draw(arrays(np.int64, shape, elements=st.integers(-8000, 8000))) / 8.0
    whole = st.integers(0, 4000)
    found = [draw(arrays(np.int64, shape[:1], elements=whole)) / 8.0 for _ in range(reaches)]
    return target, *found


def dominating(target):
    """Give the place in time of the largest size that any point of the only row has."""
    return int(np.abs(target[0]).argmax())


def same_bits(one, other):
    return one.shape == other.shape and one.tobytes() == other.tobytes()


@ANY
@given(targets_and_reaches())
def test_friction_force_never_exceeds_its_bound(case):
    target, reach = case
    bound = np.broadcast_to(reach.T, target.T.shape).T
    force = play(target, reach) - target
    rounding = 2.0 * EPS * (np.abs(target) + bound)
    assert np.all(np.abs(force) <= bound + rounding)


@ANY
@given(targets_and_reaches())
def test_a_slipping_point_has_the_whole_bound_against_its_slip(case):
    target, reach = case
    bound = np.broadcast_to(reach.T, target.T.shape).T
    position = play(target, reach)
    slip = np.diff(position, axis=1, prepend=0.0)
    forward, backward = slip > 0.0, slip < 0.0
    assert np.array_equal(position[forward], (target - bound)[forward])
    assert np.array_equal(position[backward], (target + bound)[backward])


@ANY
@given(targets_and_reaches())
def test_a_point_sticks_where_its_force_stays_inside_the_bound(case):
    target, reach = case
    bound = np.broadcast_to(reach.T, target.T.shape).T
    position = play(target, reach)
    before = np.concatenate([np.zeros((len(target), 1)), position[:, :-1]], axis=1)
    inside = (target - bound <= before) & (before <= target + bound)
    assert np.array_equal(position[inside], before[inside])


@ANY
@given(targets_and_reaches(), st.data())
def test_play_is_monotone_in_its_target(case, data):
    target, reach = case
    more = data.draw(arrays(float, target.shape, elements=REACH))
    assert np.all(play(target, reach) <= play(target + more, reach))


@ANY
@given(targets_and_reaches(), st.data())
def test_play_does_not_expand_distances(case, data):
    target, reach = case
    other = data.draw(arrays(float, target.shape, elements=REAL))
    apart = np.abs(play(target, reach) - play(other, reach))
    furthest = np.maximum.accumulate(np.abs(target - other), axis=1)
    assert np.all(apart <= furthest + 4.0 * EPS * (np.abs(target) + np.abs(other) + 1e6))


@ANY
@given(targets_and_reaches())
def test_play_is_odd(case):
    target, reach = case
    assert np.array_equal(play(-target, reach), -play(target, reach))


@ANY
@given(targets_and_reaches())
def test_play_is_causal(case):
    target, reach = case
    half = target.shape[1] // 2 + 1
    some = reach[:, :half] if reach.ndim == 2 else reach
    assert np.array_equal(play(target[:, :half], some), play(target, reach)[:, :half])


@ANY
@given(eighths(reaches=2))
def test_play_of_a_play_is_the_play_with_both_reaches(case):
    target, first, second = case
    assert np.array_equal(play(play(target, first), second), play(target, first + second))


@ANY
@given(targets_and_reaches(varying=False), st.integers(2, 4))
def test_repeated_instants_change_nothing(case, times):
    target, reach = case
    held = play(np.repeat(target, times, axis=1), reach)
    assert np.array_equal(held, np.repeat(play(target, reach), times, axis=1))


@ANY
@given(targets_and_reaches(varying=False), st.floats(0.0, 1.0))
def test_instants_on_the_way_change_nothing(case, share):
    target, reach = case
    between = target[:, :-1] + share * np.diff(target, axis=1)
    between = np.clip(
        between,
        np.minimum(target[:, :-1], target[:, 1:]),
        np.maximum(target[:, :-1], target[:, 1:]),
    )
    finer = np.empty((len(target), 2 * target.shape[1] - 1))
    finer[:, ::2], finer[:, 1::2] = target, between
    assert np.array_equal(play(finer, reach)[:, ::2], play(target, reach))


@ANY
@given(targets_and_reaches(varying=False), st.floats(-1.0, 1.0))
def test_a_closed_loop_inside_the_past_leaves_no_trace(case, turn):
    target, reach = case[0][:1], case[1][:1]
    top = dominating(target)
    loop = np.array([[turn * target[0, top], target[0, top]]])
    longer = np.concatenate([target[:, : top + 1], loop, target[:, top + 1 :]], axis=1)
    found = np.delete(play(longer, reach), [top + 1, top + 2], axis=1)
    assert np.array_equal(found, play(target, reach))


@ANY
@given(targets_and_reaches(varying=False))
def test_the_largest_target_so_far_wipes_out_what_came_before(case):
    target, reach = case[0][:1], case[1][:1]
    top = dominating(target)
    assert np.array_equal(play(target, reach)[:, top:], play(target[:, top:], reach))


@ANY
@given(arrays(float, SHAPES, elements=REAL))
def test_without_reach_the_point_follows_and_with_infinite_reach_it_stays(target):
    nothing = np.zeros(len(target))
    assert np.array_equal(play(target, nothing), target)
    assert not play(target, nothing + np.inf).any()


@pytest.mark.parametrize("n_times", range(1, 41))
def test_scan_and_walk_agree_bit_by_bit(n_times):
    random = np.random.default_rng(n_times)
    for n_points in (1, 2, 3, 7, WALK_FROM_POINTS - 1, WALK_FROM_POINTS, WALK_FROM_POINTS + 1, 200):
        scan, walk = _Scan(n_points, n_times), _Walk(n_points, n_times)
        for reach_times in (1, n_times):
            target = np.asfortranarray(random.normal(size=(n_points, n_times)).cumsum(axis=1))
            reach = random.uniform(0.0, 2.0, size=(n_points, reach_times))
            kept = target.copy()
            assert same_bits(scan(target, reach), walk(target, reach))
            assert same_bits(target, kept)


@pytest.mark.parametrize("n_points", [*range(1, 201, 7), WALK_FROM_POINTS, 200])
def test_what_a_point_does_depends_on_no_other(n_points):
    random = np.random.default_rng(n_points)
    target = random.normal(size=(n_points, 23)).cumsum(axis=1)
    reach = random.uniform(0.0, 2.0, size=n_points)
    alone = [play(target[j : j + 1], reach[j : j + 1]) for j in range(n_points)]
    assert same_bits(np.concatenate(alone), np.ascontiguousarray(play(target, reach)))


@ANY
@given(st.data(), array_shapes(min_dims=2, max_dims=2, max_side=10))
def test_a_perfect_interface_has_one_displacement_and_opposite_forces(data, shape):
    first, second = (data.draw(arrays(float, shape, elements=REAL)) for _ in range(2))
    stiff = st.floats(1e-6, 1e6)
    k, other = (data.draw(arrays(float, (shape[0], 1), elements=stiff)) for _ in range(2))
    common = perfect(first, second, k / (k + other))
    forces = k * (common - first), other * (common - second)
    rounding = 8.0 * EPS * (k + other) * (np.abs(first) + np.abs(second))
    assert np.all(np.abs(forces[0] + forces[1]) <= rounding + 1e-300)


@ANY
@given(st.data(), array_shapes(min_dims=2, max_dims=2, max_side=10))
def test_a_prescribed_force_is_what_the_search_direction_finds(data, shape):
    target, force = (data.draw(arrays(float, shape, elements=REAL)) for _ in range(2))
    k = data.draw(arrays(float, (shape[0], 1), elements=st.floats(1e-6, 1e6)))
    every = np.arange(shape[0])
    law = Neumann(every, force, np.ones((shape[0], 1)))
    moved = np.empty_like(target)
    law.rule(k[:, 0], shape[1])(target, moved, slice(None))
    found = k * (moved - target)
    rounding = 4.0 * EPS * (np.abs(force) + k * np.abs(target))
    assert np.all(np.abs(found - force) <= rounding + 1e-300)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("substructures", [1, 2, 7, 20])
def test_the_local_stage_obeys_every_law_along_its_search_direction(seed, substructures):
    options = BarSettings.checked(
        {
            "elements": 20,
            "instants": 21,
            "substructures": substructures,
            "support_displacement": 1e-3,
            "k_scale": 3.0,
            "k_friction_scale": 0.2,
        }
    )
    problem = discretise(options)
    k = method_of(options).direction.of(problem)
    incoming = np.random.default_rng(seed).normal(size=(problem.n_rows, problem.n_instants))
    incoming *= problem.friction.tangential.bound.max() / k.min()
    stage = LocalStage(problem, k)
    outgoing = stage(np.asfortranarray(incoming))
    displacement = stage.displacement
    force = k[:, None] * (displacement - incoming)
    assert np.array_equal(outgoing, 2.0 * displacement - incoming)

    rounding = 8.0 * EPS * np.abs(k[:, None] * incoming).max()
    support, load, law = (problem.interfaces[name] for name in ("support", "load", "friction"))
    assert np.array_equal(displacement[support.rows], support.displacement)
    assert np.all(np.abs(force[load.rows] - load.force) <= rounding)
    for name, cut in problem.interfaces.items():
        if name.startswith("cut"):
            assert np.array_equal(displacement[cut.first], displacement[cut.second])
            assert np.all(np.abs(force[cut.first] + force[cut.second]) <= rounding)
    bound = law.tangential.bound
    slip = np.diff(displacement[law.tangent.above], axis=1, prepend=0.0)
    friction = force[law.tangent.above]
    assert np.all(np.abs(friction) <= bound + rounding)
    assert np.all(np.abs(friction + bound * np.sign(slip))[slip != 0.0] <= rounding)
    assert (slip != 0.0).any()
    assert (slip == 0.0).any()
