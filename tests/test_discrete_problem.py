"""A bar is cut without loss: what the substructures share, own and add up to."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from bars import relative, sample
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.discrete.rod import rod_stiffness, substructure_sizes, tributary
from solver.latin.coarse import CoarseProblem
from solver.latin.indicators import latin_indicator
from solver.latin.linear_stage import LinearStage
from solver.latin.response import DenseResponse, SparseResponse
from solver.scenes import discretise
from solver.scenes.bar import BarSettings, bar
from solver.scenes.method import method_of

ANY = settings(max_examples=60)
response = importlib.import_module("solver.latin.response")
coarse = importlib.import_module("solver.latin.coarse")


def options(**values):
    return BarSettings.checked({"method": "paper", "instants": 31, **values})


@st.composite
def bars(draw):
    elements = draw(st.integers(1, 60))
    return options(
        elements=elements,
        substructures=draw(st.integers(1, elements)),
        instants=3,
        friction_profile=draw(st.sampled_from(["uniform", "rising", "gap"])),
        body_force=draw(st.sampled_from([0.0, 700.0])),
        length=draw(st.sampled_from([1.0, 0.3, 40.0])),
    )


@ANY
@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.just(n), st.integers(1, n))))
def test_sizes_differ_by_at_most_one_and_use_every_element(case):
    elements, substructures = case
    sizes = substructure_sizes(elements, substructures)
    assert len(sizes) == substructures
    assert sum(sizes) == elements
    assert max(sizes) - min(sizes) <= 1
    assert min(sizes) >= 1


@ANY
@given(bars())
def test_identical_substructures_share_one_elasticity(chosen):
    parts = discretise(chosen).substructures
    by_size = {len(part.dofs): part.elasticity for part in parts}
    assert all(part.elasticity is by_size[len(part.dofs)] for part in parts)
    assert len(by_size) == (1 if chosen.elements % chosen.substructures == 0 else 2)


@ANY
@given(bars())
def test_every_row_belongs_to_one_interface_and_one_substructure(chosen):
    problem = discretise(chosen)
    of_parts = np.concatenate([part.rows for part in problem.substructures])
    of_laws = np.concatenate([law.rows for law in problem.interfaces.values()])
    assert np.array_equal(np.sort(of_parts), np.arange(problem.n_rows))
    assert np.array_equal(np.sort(of_laws), np.arange(problem.n_rows))


@ANY
@given(bars())
def test_the_two_sides_of_a_cut_are_the_same_point_of_two_neighbours(chosen):
    problem = discretise(chosen)
    owner = np.empty(problem.n_rows, dtype=int)
    for number, part in enumerate(problem.substructures):
        owner[part.rows] = number
    cuts = [law for name, law in problem.interfaces.items() if name.startswith("cut")]
    assert len(cuts) == chosen.substructures - 1
    for cut in cuts:
        assert np.array_equal(problem.row_dofs[cut.first], problem.row_dofs[cut.second])
        assert np.array_equal(owner[cut.first] + 1, owner[cut.second])


@ANY
@given(bars())
def test_stiffnesses_bounds_and_body_forces_of_the_parts_add_up_to_the_bar(chosen):
    problem, scene = discretise(chosen), bar(chosen)
    stiffness = np.zeros((problem.n_dofs, problem.n_dofs))
    body = np.zeros((problem.n_dofs, problem.n_instants))
    for part in problem.substructures:
        stiffness[np.ix_(part.dofs, part.dofs)] += part.elasticity.stiffness.toarray()
        if part.body_force is not None:
            body[part.dofs] += part.body_force
    lengths = tributary(chosen.elements, chosen.length / chosen.elements)
    law = problem.friction
    bound = np.bincount(law.points, weights=law.tangential.most) * problem.scales.force
    whole = rod_stiffness(chosen.elements, float(chosen.elements)).toarray()
    np.testing.assert_allclose(stiffness, whole, rtol=1e-12)
    np.testing.assert_allclose(bound, scene.bound * lengths, rtol=1e-12)
    expected = 0.0 if scene.body_force is None else lengths[:, None] * scene.body_force
    np.testing.assert_allclose(body * problem.scales.force, expected, rtol=1e-12)


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


def test_the_size_of_a_substructure_chooses_its_response(monkeypatch):
    chosen = options(elements=40, substructures=1)
    problem = discretise(chosen)
    k = method_of(chosen).direction.of(problem)
    for limit, kind in [(problem.n_rows, DenseResponse), (problem.n_rows - 1, SparseResponse)]:
        monkeypatch.setattr(response, "DENSE_UP_TO", limit)
        (group,) = LinearStage(problem, k, multiscale=True).groups
        assert type(group.response) is kind


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


def test_one_substructure_or_monoscale_builds_no_coarse_problem(monkeypatch):
    built = []
    make = CoarseProblem.__init__
    monkeypatch.setattr(
        CoarseProblem, "__init__", lambda self, *given: built.append(1) or make(self, *given)
    )
    for substructures, multiscale, expected in [(1, True, 0), (5, False, 0), (5, True, 1)]:
        built.clear()
        sample(options(substructures=substructures, multiscale=multiscale), 1)
        assert len(built) == expected
