"""Singular values and modes of interface fields are what their weighted inner products say."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from solver.latin import iterations
from solver.reduction.svd import (
    InterfaceField,
    against_front,
    decompose,
    decompositions,
    friction_spectra,
    front_decay,
)
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

DEGENERATE = {
    "one instant": {"instants": 1, "load": "ramp"},
    "no load": {"peak": 0.0},
    "one element per substructure": {"elements": 5, "substructures": 5},
    "one substructure": {"substructures": 1},
    "sizes that differ": {"elements": 52, "substructures": 5},
    "no sliding": {"peak": 1e-3},
    "all sliding": {"peak": 2000.0},
}


@st.composite
def weighted_fields(draw):
    shape = draw(st.tuples(st.integers(1, 8), st.integers(1, 8)))
    field = draw(arrays.arrays(float, shape, elements=st.floats(-1e3, 1e3, width=32)))
    weights = [
        draw(arrays.arrays(float, length, elements=st.floats(0.01, 100.0))) for length in shape
    ]
    return field, *weights


def squared_norm(field, space_weights, time_weights):
    return space_weights @ field**2 @ time_weights


def iterate_of(number=15, **changes):
    chosen = BarSettings.checked({"method": "paper", "substructures": 5, **changes})
    problem = discretise(chosen)
    return next(islice(iterations(problem, method_of(chosen)), number - 1, None))


def first_modes(found, rank):
    """Sum them, shape (n_points, n_instants)."""
    return (found.space_modes[:, :rank] * found.values[:rank]) @ found.time_modes[:rank]


def constant_speed_front(n_points, n_instants):
    """Decompose a front that crosses its domain at constant speed in the time there is.

    Scaled to the unit square the field is H(x - t), the kernel of an integration, whose singular
    values are 2/((2n - 1) pi). Here it is sampled in the middle of cells; on the front itself it is
    one half.
    """
    positions = (np.arange(n_points) + 0.5) / n_points
    instants = (np.arange(n_instants) + 0.5) / n_instants
    field = np.heaviside(positions[:, None] - instants, 0.5)
    weights = np.full(n_points, 1.0 / n_points)
    return decompose(field, weights, np.full(n_instants, 1.0 / n_instants), positions)


@given(weighted_fields())
def test_modes_are_orthonormal_in_their_own_inner_products(case):
    field, space, time = case
    found = decompose(field, space, time, np.arange(len(space)))
    same = np.eye(len(found.values))
    np.testing.assert_allclose((found.space_modes.T * space) @ found.space_modes, same, atol=1e-10)
    np.testing.assert_allclose((found.time_modes * time) @ found.time_modes.T, same, atol=1e-10)
    assert np.all(np.diff(found.values) <= 0.0)


@given(weighted_fields())
def test_the_error_of_every_rank_is_the_distance_to_its_approximation_and_falls(case):
    field, space, time = case
    found = decompose(field, space, time, np.arange(len(space)))
    whole = squared_norm(field, space, time)
    for rank, error in enumerate(found.errors):
        left = squared_norm(field - first_modes(found, rank), space, time)
        assert np.sqrt(left) == pytest.approx(error * np.sqrt(whole), abs=1e-9 * np.sqrt(whole))
    assert np.all(np.diff(found.errors) <= 0.0)


@given(weighted_fields(), st.floats(0.0, 1.0))
def test_no_fewer_modes_than_counted_reach_the_error(case, share):
    field, space, time = case
    found = decompose(field, space, time, np.arange(len(space)))
    count = found.modes_for(share)
    assert found.errors[count] <= share
    assert count == 0 or found.errors[count - 1] > share


def test_a_zero_field_has_rank_zero_and_needs_no_mode():
    found = decompose(np.zeros((4, 6)), np.ones(4), np.ones(6), np.arange(4))
    assert not found.values.any()
    assert not found.errors.any()
    assert found.modes_for(0.0) == 0
    assert not against_front(found.values).any()


@pytest.mark.parametrize("field", list(InterfaceField))
@pytest.mark.parametrize("changes", DEGENERATE.values(), ids=DEGENERATE.keys())
def test_every_field_is_decomposed_whatever_the_bar(changes, field):
    iterate = iterate_of(**changes)
    found = decompositions(iterate, field)
    parts = iterate.problem.substructures
    assert len(found) == len(parts)
    for each, part in zip(found, parts, strict=True):
        n_points, n_instants = len(part.rows) - 2, iterate.problem.n_instants
        assert each.space_modes.shape == (n_points, min(n_points, n_instants))
        assert each.time_modes.shape == (min(n_points, n_instants), n_instants)
        assert each.positions.shape == (n_points,)
        places = iterate.problem.positions[part.dofs]
        assert set(each.positions) == set(places)
        assert np.isfinite(each.errors).all()


@pytest.mark.parametrize("changes", DEGENERATE.values(), ids=DEGENERATE.keys())
def test_the_short_way_gives_the_singular_values_of_the_long_one(changes):
    iterate = iterate_of(**changes)
    for short, each in zip(
        friction_spectra(iterate),
        decompositions(iterate, InterfaceField.FRICTION_FORCE),
        strict=True,
    ):
        np.testing.assert_allclose(short, each.values, rtol=1e-9, atol=1e-9 * each.values[0])


def test_singular_values_of_one_substructure_add_up_to_the_norm_in_si_units():
    iterate = iterate_of(substructures=1, length=2.0, duration=3.0)
    (force,) = decompositions(iterate, InterfaceField.FRICTION_FORCE)
    (displacement,) = decompositions(iterate, InterfaceField.DISPLACEMENT)
    assert force.space_weights.sum() == pytest.approx(2.0)
    assert force.time_weights.sum() == pytest.approx(3.0)
    density = iterate.friction_force / force.space_weights[:, None]
    for found, field in ((force, density), (displacement, iterate.displacement)):
        whole = squared_norm(field, found.space_weights, found.time_weights)
        assert np.sum(found.values**2) == pytest.approx(whole)


def test_a_front_sampled_finely_has_the_spectrum_of_an_integration():
    found = constant_speed_front(400, 400).values[:10]
    orders = np.arange(1, 11)
    np.testing.assert_allclose(found, 2.0 / ((2 * orders - 1) * np.pi), rtol=1e-3)
    np.testing.assert_allclose(found / found[0], front_decay(10), rtol=1e-3)
