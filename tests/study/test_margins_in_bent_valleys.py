"""Profiles of misfits that are formulas: valleys with bends, and settings in turn."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np

from solver.arrays import Array
from solver.study.compared_runs import ComparedRuns
from solver.study.profile_likelihood import LikelihoodProfile
from solver.study.valley import Valley

ROWS = 40
"""Rows of a measured loop that no setting changes: they have its noise."""
NOISE = 0.01
"""Deviation of these rows."""
FAR = 5.0
"""Distance of the bounds, in z."""


class Formula(ComparedRuns):
    """Differences by a formula of z, (p,), in place of runs; meshes change nothing."""

    def __init__(self, differences: Callable[[Array], Array], count: int) -> None:
        self._formula = differences
        self.scales = SimpleNamespace(
            bounds=FAR * np.array([-np.ones(count), np.ones(count)]),
            holds=lambda z: bool((np.abs(z) <= FAR).all()),
        )
        self.first = SimpleNamespace(differences=self.differences(np.zeros(count)))

    def differences(self, z: Array) -> Array:
        rest = NOISE * (-1.0) ** np.arange(ROWS)
        return np.concatenate([self._formula(z), rest])

    def of_mesh(self, z: Array) -> float:
        return 0.0


def profiles(differences: Callable[[Array], Array]) -> list[LikelihoodProfile]:
    """Profiles of three settings around z = 0."""
    valley = Valley(Formula(differences, 3), np.zeros(3), seeks=False)
    return valley.profiles(np.eye(3))


def test_settings_that_count_one_by_one_have_the_margins_of_a_straight_valley() -> None:
    for profile in profiles(lambda z: z):
        assert profile.is_known
        # Two standard errors: 0.01 over a slope of 1.
        below, above = profile.ends()
        assert abs(below - 2.0 * NOISE) < 0.1 * NOISE
        assert abs(above - 2.0 * NOISE) < 0.1 * NOISE


def test_a_cap_is_not_known_where_the_sum_below_it_may_be_as_low() -> None:
    def lower_of_both(z: Array) -> Array:
        cap, first, second = np.exp(z)
        return np.array([min(cap, 0.8 * first + 0.8 * second) - 1.0])

    cap, *_ = profiles(lower_of_both)
    below, above = cap.ends()
    assert below < 4.0 * NOISE
    assert above == np.inf


def test_a_valley_with_a_bend_is_as_wide_as_any_setting_finds_it() -> None:
    corner = np.array([0.2, 0.0, 0.0])
    beyond = np.array([0.5, 0.0, 0.6])

    def nearest(z: Array, start: Array, along: Array, most: float) -> Array:
        share = np.clip((z - start) @ along / (along @ along), 0.0, most)
        return start + share * along

    def from_the_floor(z: Array) -> Array:
        before = nearest(z, np.zeros(3) - corner, 2.0 * corner, 1.0)
        after = nearest(z, corner, beyond, 5.0)
        return min(z - before, z - after, key=np.linalg.norm)

    first, second, third = profiles(from_the_floor)
    assert first.ends()[1] == np.inf
    assert second.is_known
    # Straight away from the middle the floor is left at once.
    assert third.ends()[1] == np.inf
