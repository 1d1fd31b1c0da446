"""Tables along a body are averaged exactly, and keep what would touch first."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.settings.load_paths import interpolate
from solver.settings.profiles import (
    gap_at,
    harmonic_means,
    means,
    off_nodes,
    shares_of,
)

ANY = settings(max_examples=40)
VALUES = st.lists(st.floats(0.1, 10.0), min_size=2, max_size=7)
NODES = np.linspace(0.0, 2.0, 9)
EDGES = shares_of(NODES)


def table(values: list[float]) -> list[list[float]]:
    """Points at uneven places, of which none is a node."""
    x = 2.0 * np.linspace(0.0, 1.0, len(values)) ** 1.3
    return [list(point) for point in zip(x.tolist(), values, strict=True)]


def sampled(function, edges: np.ndarray) -> np.ndarray:
    """Means over shares by the midpoint rule on many points."""
    count = 4000
    return np.array(
        [
            function(first + (last - first) * (np.arange(count) + 0.5) / count).mean()
            for first, last in pairwise(edges)
        ]
    )


def test_shares_of_nodes_meet_half_way_and_fill_the_body() -> None:
    nodes = np.array([0.0, 1.0, 1.5, 4.0])
    assert shares_of(nodes).tolist() == [0.0, 0.5, 1.25, 2.75, 4.0]


@ANY
@given(VALUES)
def test_means_of_a_table_are_those_of_many_samples(values: list[float]) -> None:
    points = table(values)
    wanted = sampled(lambda x: interpolate(points, x), EDGES)
    assert means([points], EDGES) == pytest.approx(wanted, rel=1e-5)


@ANY
@given(VALUES, VALUES)
def test_means_of_a_product_are_exact_over_any_shares(
    values: list[float], others: list[float]
) -> None:
    """The sum over fine shares is that over the whole, and that of samples."""
    both = [table(values), table(others)]
    fine = means(both, EDGES) @ np.diff(EDGES)
    whole = means(both, np.array([0.0, 2.0]))[0] * 2.0
    assert fine == pytest.approx(whole, rel=1e-12)
    product = sampled(
        lambda x: interpolate(both[0], x) * interpolate(both[1], x),
        np.array([0.0, 2.0]),
    )
    assert whole / 2.0 == pytest.approx(product[0], rel=1e-4)


@ANY
@given(VALUES)
def test_harmonic_means_are_the_inverse_of_means_of_the_inverse(
    values: list[float],
) -> None:
    points = table(values)
    wanted = 1.0 / sampled(lambda x: 1.0 / interpolate(points, x), EDGES)
    found = harmonic_means(points, EDGES)
    assert found == pytest.approx(wanted, rel=1e-4)
    assert np.all(found <= means([points], EDGES) * (1.0 + 1e-12))


@pytest.mark.parametrize("change", [0.0, 1e-16, 1e-12, 1e-9, 1.1e-8, 1e-7, 1e-5])
def test_a_table_that_hardly_changes_has_its_mean_for_harmonic_mean(
    change: float,
) -> None:
    points = [[0.0, 3.0], [2.0, 3.0 * (1.0 + change)]]
    edges = np.array([0.0, 2.0])
    wanted = 3.0 * (change / np.log1p(change) if change else 1.0)
    assert harmonic_means(points, edges) == pytest.approx([wanted], rel=1e-14)


def test_a_logarithmic_mean_is_that_of_a_line() -> None:
    assert harmonic_means([[0.0, 1.0], [2.0, np.e]], np.array([0.0, 2.0])) == (
        pytest.approx([np.e - 1.0], rel=1e-14)
    )


@ANY
@given(VALUES)
def test_a_gap_at_nodes_is_nowhere_larger_than_its_table_and_as_low_at_its_lowest(
    values: list[float],
) -> None:
    points = table(values)
    gap = gap_at(points, NODES)
    assert np.all(gap <= interpolate(points, NODES))
    assert gap.min() == pytest.approx(min(values), rel=1e-12)


def test_a_slope_that_nodes_tell_stays_and_a_spike_goes_to_the_nearer_node() -> None:
    slope = [[0.0, 1.0], [1.1, 2.1], [2.0, 3.0]]
    assert gap_at(slope, NODES) == pytest.approx(1.0 + NODES)
    for spike, node in ((0.6, 2), (0.7, 3)):
        points = [[0.0, 1.0], [0.55, 1.0], [spike, 0.0], [0.74, 1.0], [2.0, 1.0]]
        wanted = np.ones(9)
        wanted[node] = 0.0
        assert gap_at(points, NODES) == pytest.approx(wanted)


def test_points_are_off_what_nodes_see_by_their_height_over_the_line() -> None:
    points = [[-1.0, 9.0], [0.0, 1.0], [0.6, 2.0], [1.0, 1.0], [2.0, 1.0]]
    off = off_nodes(points, 2.0, 2)
    assert off.tolist() == [0.0, 0.0, 1.0, 0.0, 0.0]
    assert off_nodes(points, 2.0, 10).tolist() == pytest.approx([0.0] * 5)
