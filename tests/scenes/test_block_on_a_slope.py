"""A block on a slope sticks, slides into its spring, comes back late, and tips.

Closed forms: MATHEMATICS.md, 9.
"""

from __future__ import annotations

import numpy as np
import pytest
from contact_problems import friction_of, local_stage
from hypothesis import given, settings
from hypothesis import strategies as st
from runs import solved

from solver.laws import Component, Contact, Unilateral
from solver.scenes.incline import InclineSettings
from solver.settings.values import SettingError

SMALL = {"elements": 12, "elements_up": 6, "instants": 41}


class Run:
    """A run on a slope: angle, spring force and displacement over time."""

    def __init__(self, **values):
        self.settings = InclineSettings.checked(SMALL | values)
        self.solution = solved(self.settings)
        iterate = self.solution.iterate
        problem = iterate.problem
        loop = self.settings.structure().loop(problem)
        self.degrees = loop.displacement(iterate.displacement)
        self.angle = np.radians(self.degrees)
        self.force = loop.force(iterate)
        whole = problem.inside.displacement(iterate.displacement, slice(None))
        self.moved = whole[:, 0].mean(axis=0)
        weight = self.settings.weight
        mu = self.settings.friction
        self.sliding_down = weight * (np.sin(self.angle) - mu * np.cos(self.angle))
        self.sliding_up = weight * (np.sin(self.angle) + mu * np.cos(self.angle))


@pytest.fixture(scope="module")
def run():
    return Run()


def test_the_block_sticks_until_the_slope_is_that_of_friction(run):
    sticks = (run.degrees < np.degrees(np.arctan(0.3)) - 0.5) & (np.arange(41) < 20)
    assert sticks.sum() > 5
    assert not run.force[sticks].any()
    assert np.abs(run.moved[sticks]).max() < 0.15 * run.settings.slack
    slides = (np.tan(run.angle) > 0.3) & (np.arange(41) < 20)
    assert np.all(run.moved[slides] < -run.settings.slack)


def test_on_the_way_back_nothing_moves_until_the_spring_overcomes_friction(run):
    peak = run.force.max()
    back = np.arange(41) > 20
    waits = back & (run.sliding_up > 1.1 * peak)
    assert waits.sum() > 10
    np.testing.assert_allclose(run.force[waits], peak, rtol=0.02)
    returns = back & (run.sliding_up < 0.95 * peak)
    assert returns.sum() > 2
    np.testing.assert_allclose(run.force[returns], run.sliding_up[returns], rtol=1e-7)


@pytest.mark.parametrize(("slope", "returns"), [(30.0, False), (36.0, True)])
def test_the_spring_pulls_the_block_back_only_from_twice_the_angle_of_friction(
    slope, returns
):
    """At the end W (sin - mu cos) of the steepest slope pulls against mu W."""
    found = Run(slope=slope)
    assert (np.tan(np.radians(slope) / 2.0) > 0.3) == returns
    assert (found.force[-1] == pytest.approx(300.0, rel=1e-6)) == returns
    assert returns or found.force[-1] > 0.97 * found.force.max()


@pytest.mark.parametrize("height", [0.12, 0.15, 0.3])
def test_a_block_tips_where_the_slope_exceeds_base_over_height(height):
    steepest = np.degrees(np.arctan(0.1 / height))
    assert InclineSettings.checked(
        {**SMALL, "height": height, "slope": 0.99 * steepest}
    )
    with pytest.raises(SettingError, match="tips over an end of its base") as refusal:
        InclineSettings.checked({**SMALL, "height": height, "slope": 1.01 * steepest})
    told = float(str(refusal.value).split("at ")[-1].split("°")[0])
    assert steepest < told < 1.011 * steepest


def test_a_slope_that_falls_below_the_horizontal_lets_the_block_go():
    with pytest.raises(SettingError, match="friction cannot hold it"):
        InclineSettings.checked({**SMALL, "slope_load": [[0.0, 0.0], [1.0, -20.0]]})
    assert InclineSettings.checked({**SMALL, "slope_load": [[0.0, 0.0], [1.0, -16.0]]})


@settings(max_examples=60)
@given(st.integers(0, 2**31))
def test_along_the_search_direction_a_slack_spring_pushes_by_what_its_gap_lacks(seed):
    random = np.random.default_rng(seed)
    spring = Unilateral(
        component=Component(np.arange(3)),
        gap=random.uniform(0.0, 1.0, 3),
        compliance=10.0 ** random.uniform(-2.0, 2.0, 3),
    )
    law = Contact(
        normal=spring,
        tangential=friction_of(Component(np.arange(3, 6))),
        points=np.arange(3),
        positions=np.arange(3.0),
        weights=np.ones(3),
    )
    moved, force = local_stage(law, random, rows=6)
    overlap = np.maximum(-(moved[:3] + spring.gap[:, None]), 0.0)
    np.testing.assert_allclose(
        force[:3], overlap / spring.compliance[:, None], atol=1e-12
    )
    assert not force[3:].any()
    assert np.all(law.violation(moved, force, 1e-14).energy(1.0, 1.0) < 1e-10)


def test_the_force_of_a_rigid_block_is_told_of_blocks_that_are_stiff_enough():
    """A slender block of rubber loads its spring by 14 % more as it springs back."""
    stiff = Run()
    (exact,) = stiff.settings.exact(stiff.solution.iterate.problem)
    off = np.abs(exact.up - stiff.force).max()
    assert off < 0.03 * stiff.force.max()
    soft = Run(slope=23.0, weight=2500.0, height=0.21)
    assert not list(soft.settings.exact(soft.solution.iterate.problem))
    rigid = np.maximum(soft.sliding_down, 0.0).max()
    assert soft.force.max() > 1.1 * rigid
