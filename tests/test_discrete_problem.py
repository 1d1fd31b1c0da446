"""A bar is cut without loss: what the substructures share, own and add up to."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from bars import relative, sample

from solver.latin.indicators import latin_indicator
from solver.latin.linear.response import DenseResponse, SparseResponse
from solver.scenes import discretise
from solver.scenes.bar import BarSettings, bar

response = importlib.import_module("solver.latin.linear.response")
coarse = importlib.import_module("solver.latin.linear.coarse")


def options(**values):
    return BarSettings.checked({"method": "paper", "instants": 31, **values})


@pytest.mark.parametrize("young", [1e3, 1e15])
def test_the_iteration_does_not_see_the_size_of_a_pascal(young):
    factor = young / 210e9
    plain = sample(options(), 25)
    other = sample(options(young=young, peak=900.0 * factor, pressure=5000.0 * factor), 25)
    assert relative(other.outgoing, plain.outgoing) < 1e-10
    assert relative(other.displacement, plain.displacement) < 1e-10
    assert relative(other.friction_force, factor * plain.friction_force) < 1e-10
    assert latin_indicator(other) == pytest.approx(latin_indicator(plain), rel=1e-10)


@pytest.mark.parametrize("length", [1e-3, 1e3])
def test_the_iteration_does_not_see_the_size_of_a_metre(length):
    plain = sample(options(), 25)
    other = sample(options(length=length, pressure=5000.0 / length), 25)
    assert relative(other.outgoing, plain.outgoing) < 1e-10
    assert relative(other.displacement, length * plain.displacement) < 1e-10
    assert relative(other.friction_force, plain.friction_force) < 1e-10


@pytest.mark.parametrize("change", [{}, {"multiscale": False}, {"body_force": 800.0}], ids=str)
@pytest.mark.parametrize("substructures", [1, 4, 10])
def test_dense_and_sparse_boundary_responses_agree(monkeypatch, change, substructures):
    chosen = options(substructures=substructures, **change)
    dense = sample(chosen, 25)
    monkeypatch.setattr(response, "DENSE_UP_TO", 0)
    sparse = sample(chosen, 25)
    assert relative(sparse.outgoing, dense.outgoing) < 1e-10
    assert relative(sparse.incoming, dense.incoming) < 1e-10


@pytest.mark.parametrize("change", [{}, {"elements": 53}, {"body_force": 800.0}], ids=str)
def test_dense_and_sparse_coarse_solvers_agree(monkeypatch, change):
    chosen = options(**change)
    dense = sample(chosen, 25)
    monkeypatch.setattr(coarse, "DENSE_UP_TO", 0)
    sparse = sample(chosen, 25)
    assert relative(sparse.outgoing, dense.outgoing) < 1e-10


@pytest.mark.parametrize("kind", [DenseResponse, SparseResponse])
@pytest.mark.parametrize("seed", range(3))
def test_a_boundary_response_solves_its_substructure(kind, seed):
    chosen = options(elements=12, substructures=2)
    elasticity = discretise(chosen).substructures[0].elasticity
    random = np.random.default_rng(seed)
    k = elasticity.direction * random.uniform(0.3, 3.0, len(elasticity.direction))
    response = kind(elasticity, k)
    outgoing, inside = random.normal(size=(len(k), 4)), random.normal(size=(7, 4))
    found = np.empty_like(outgoing, order="F")
    response.reflect(np.asfortranarray(outgoing), found)
    trace = np.zeros((len(k), 7))
    trace[np.arange(len(k)), elasticity.trace] = 1.0
    system = elasticity.stiffness.toarray() + trace.T @ np.diag(k) @ trace
    displacement = trace @ np.linalg.solve(system, trace.T @ (k[:, None] * outgoing))
    np.testing.assert_allclose(found, 2.0 * displacement - outgoing, rtol=0.0, atol=1e-11)
    under_body = trace @ np.linalg.solve(system, inside)
    np.testing.assert_allclose(response.of_body_force(inside), under_body, rtol=0.0, atol=1e-11)
    rows = np.array([0, len(k) - 2, len(k) - 1])
    condensed = np.diag(k) - np.diag(k) @ trace @ np.linalg.solve(system, trace.T) @ np.diag(k)
    np.testing.assert_allclose(response.force_rows(rows), condensed[rows], rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("multiscale", [True, False])
def test_without_friction_a_body_force_hangs_the_bar_as_in_the_textbook(multiscale):
    chosen = options(
        friction=0.0, peak=0.0, body_force=1000.0, substructures=7, multiscale=multiscale
    )
    iterate = sample(chosen, 3000)
    scene, x = bar(chosen), iterate.problem.positions
    profile = scene.length * x - 0.5 * x**2
    expected = profile[:, None] * scene.body_force / scene.stiffness
    assert relative(iterate.displacement, expected) < 1e-9
