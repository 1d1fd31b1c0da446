"""Interface laws hold pointwise on any input, to the bit without arithmetic."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from solver.latin.stages.blocks import Blocks
from solver.latin.stages.local import LocalStage
from solver.laws.play import play
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
    """Targets, and reaches that vary over points, and over instants where wanted."""
    shape = draw(SHAPES)
    if varying and draw(st.booleans()):
        each = shape
    else:
        each = shape[:1]
    return draw(arrays(float, shape, elements=REAL)), draw(
        arrays(float, each, elements=REACH)
    )


def dominating(target):
    """Instant of the largest size that any point of the only row has."""
    return int(np.abs(target[0]).argmax())


@ANY
@given(targets_and_reaches())
def test_play_is_coulombs_law(case):
    """A force in the bound, all of it against slip, none where the point may stick."""
    target, slack = case
    bound = np.broadcast_to(slack.T, target.T.shape).T
    position = play(target, slack)
    before = np.concatenate([np.zeros((len(target), 1)), position[:, :-1]], axis=1)
    rounding = 2.0 * EPS * (np.abs(target) + bound)
    assert np.all(np.abs(position - target) <= bound + rounding)
    forward = position > before
    backward = position < before
    assert np.array_equal(position[forward], (target - bound)[forward])
    assert np.array_equal(position[backward], (target + bound)[backward])
    inside = (target - bound <= before) & (before <= target + bound)
    assert np.array_equal(position[inside], before[inside])


@ANY
@given(targets_and_reaches(), st.data())
def test_play_is_monotone_in_its_target(case, data):
    target, slack = case
    more = data.draw(arrays(float, target.shape, elements=REACH))
    assert np.all(play(target, slack) <= play(target + more, slack))


@ANY
@given(targets_and_reaches())
def test_play_is_causal(case):
    target, slack = case
    half = target.shape[1] // 2 + 1
    if slack.ndim == 2:
        some = slack[:, :half]
    else:
        some = slack
    assert np.array_equal(play(target[:, :half], some), play(target, slack)[:, :half])


@ANY
@given(targets_and_reaches(varying=False), st.floats(0.0, 1.0))
def test_instants_between_turning_points_change_nothing(case, share):
    target, slack = case
    between = target[:, :-1] + share * np.diff(target, axis=1)
    between = np.clip(
        between,
        np.minimum(target[:, :-1], target[:, 1:]),
        np.maximum(target[:, :-1], target[:, 1:]),
    )
    finer = np.empty((len(target), 2 * target.shape[1] - 1))
    finer[:, ::2] = target
    finer[:, 1::2] = between
    assert np.array_equal(play(finer, slack)[:, ::2], play(target, slack))


@ANY
@given(targets_and_reaches(varying=False), st.floats(-1.0, 1.0))
def test_a_closed_loop_inside_the_past_leaves_no_trace(case, turn):
    target = case[0][:1]
    slack = case[1][:1]
    top = dominating(target)
    loop = np.array([[turn * target[0, top], target[0, top]]])
    longer = np.concatenate([target[:, : top + 1], loop, target[:, top + 1 :]], axis=1)
    found = np.delete(play(longer, slack), [top + 1, top + 2], axis=1)
    assert np.array_equal(found, play(target, slack))


@ANY
@given(arrays(float, SHAPES, elements=REAL))
def test_without_slack_a_point_follows_and_with_infinite_slack_it_stays(target):
    nothing = np.zeros(len(target))
    assert np.array_equal(play(target, nothing), target)
    assert not play(target, nothing + np.inf).any()


@pytest.mark.parametrize("n_points", [1, 7, 200])
def test_points_are_independent_of_each_other(n_points):
    random = np.random.default_rng(n_points)
    target = random.normal(size=(n_points, 23)).cumsum(axis=1)
    slack = random.uniform(0.0, 2.0, size=n_points)
    alone = [play(target[j : j + 1], slack[j : j + 1]) for j in range(n_points)]
    assert np.array_equal(np.concatenate(alone), play(target, slack))


@pytest.mark.parametrize("substructures", [1, 7])
def test_the_local_stage_obeys_all_linear_laws_along_its_search_direction(
    substructures,
):
    options = BarSettings.checked(
        {
            "elements": 20,
            "instants": 21,
            "substructures": substructures,
            "support_displacement": 1e-3,
            "k_scale": 3.0,
        }
    )
    problem = discretise(options)
    k = method_of(options).direction.of(problem)
    incoming = np.random.default_rng(3).normal(
        size=(problem.n_rows, problem.n_instants)
    )
    incoming *= problem.friction.tangential.bound.max() / k.min()
    stage = LocalStage(problem, k, Blocks(problem.n_rows, problem.n_instants))
    outgoing = stage(np.asfortranarray(incoming))
    displacement = stage.displacement
    force = k[:, None] * (displacement - incoming)
    assert np.array_equal(outgoing, 2.0 * displacement - incoming)

    rounding = 8.0 * EPS * np.abs(k[:, None] * incoming).max()
    support, load = (problem.interfaces[name] for name in ("support", "load"))
    assert np.array_equal(displacement[support.rows], support.values)
    assert np.all(np.abs(force[load.rows] - load.values) <= rounding)
    for name, cut in problem.interfaces.items():
        if name.startswith("cut"):
            assert np.array_equal(displacement[cut.first], displacement[cut.second])
            assert np.all(np.abs(force[cut.first] + force[cut.second]) <= rounding)
