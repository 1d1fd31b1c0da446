"""The linear stage on separated bases: follows the full stage as far as its modes reach."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.files import result_arrays, summary
from solver.latin import Ending, iterations, solve
from solver.reduction.basis import SeparatedBasis
from solver.reduction.enrichment import nearest_mode
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

GENEROUS = {"pgd_modes": 100, "pgd_pairs": 100, "pgd_tolerance": 1e-12}
SMALL = {"elements": 20, "instants": 31, "substructures": 5}


def options(**changes: object) -> BarSettings:
    return BarSettings.checked({"method": "paper", "linear_stage": "pgd", **changes})


def run(settings: BarSettings, **rest: object):
    problem = discretise(settings)
    distance = distance_to(incremental(problem), problem)
    return solve(problem, method_of(settings), distance=distance, **{"watch": False, **rest})


def sample(settings: BarSettings, number: int):
    return next(islice(iterations(discretise(settings), method_of(settings)), number - 1, None))


def test_a_generous_basis_follows_the_full_stage():
    chosen = options(**GENEROUS)
    reduced = run(chosen)
    full = run(chosen.replace(linear_stage="full"))
    assert reduced.status.ending is full.status.ending is Ending.CONVERGED
    assert len(reduced.records) == len(full.records)
    for one, other in zip(reduced.records, full.records, strict=True):
        assert one.error_displacement == pytest.approx(other.error_displacement, rel=0.1)
        assert one.error_force == pytest.approx(other.error_force, rel=0.1)


@pytest.mark.parametrize(("substructures", "most"), [(10, 8), (5, 11)])
def test_the_default_basis_reaches_one_percent_of_displacement(substructures, most):
    solution = run(options(substructures=substructures, max_iterations=300))
    assert min(entry.error_displacement for entry in solution.records) < 0.01
    assert solution.records[-1].error_displacement < 0.01
    # The friction force of a moving front does not separate well: 0.7 % at 10, 8.5 % at 5.
    assert solution.records[-1].error_force < (0.01 if substructures == 10 else 0.12)
    assert solution.iterate.reduction is not None
    assert max(entry.modes for entry in solution.iterate.reduction.records) <= most


@pytest.mark.parametrize(
    ("scene", "size"),
    [("bar", {"substructures": 5}), ("layers", {"elements": 16, "instants": 31})],
)
def test_the_force_follows_the_number_of_modes(scene, size):
    settings = CATALOGUE[scene].settings.checked({"linear_stage": "pgd", **size, "finish": "none"})
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    errors = []
    for modes in (3, 6, 12):
        latin = method_of(settings.replace(pgd_modes=modes))
        iterate = next(islice(iterations(problem, latin), 39, None))
        errors.append(distance.of_friction_force(iterate))
    assert errors[0] > 1.5 * errors[1] > 3.0 * errors[2]


def test_modes_stay_orthonormal_over_a_thousand_iterations():
    chosen = options(**SMALL, tolerance=1e-30)
    for shown in sample(chosen, 1000).bases:
        gram = shown.outgoing.T @ (shown.k[:, None] * shown.outgoing)
        assert np.abs(gram - np.eye(len(gram))).max() < 1e-10


def test_every_mode_is_admissible():
    """The force of a mode is what its displacement needs inside the substructure (eq. 3)."""
    chosen = options(substructures=5)
    problem = discretise(chosen)
    iterate = sample(chosen, 30)
    for part, shown in zip(problem.substructures, iterate.bases, strict=True):
        elasticity = part.elasticity
        trace = np.zeros((len(elasticity.trace), elasticity.stiffness.shape[0]))
        trace[np.arange(len(elasticity.trace)), elasticity.trace] = 1.0
        inside = np.linalg.lstsq(trace, shown.displacement_modes, rcond=None)[0]
        assert np.allclose(trace @ inside, shown.displacement_modes, atol=1e-12)
        residual = elasticity.stiffness @ inside - trace.T @ shown.force_modes
        assert np.abs(residual).max() < 1e-10 * np.abs(shown.force_modes).max()


def test_the_bases_hold_the_iterate():
    chosen = options(substructures=4)
    problem, iterate = discretise(chosen), sample(chosen, 12)
    for part, shown in zip(problem.substructures, iterate.bases, strict=True):
        displacement = shown.displacement_modes @ shown.time_functions
        force = shown.force_modes @ shown.time_functions
        assert np.allclose(displacement, iterate.boundary_displacement[part.rows], atol=1e-12)
        assert np.allclose(force, iterate.boundary_force[part.rows], atol=1e-12)


def test_a_basis_given_the_exact_solution_needs_no_enrichment():
    chosen = options(**SMALL, tolerance=1e-22, max_iterations=20_000)
    exact = solve(
        discretise(chosen), method_of(chosen.replace(linear_stage="full")), watch=False
    ).iterate.checkpoint
    tight = chosen.replace(**GENEROUS, tolerance=1e-30).replace(pgd_tolerance=1e-9)
    for iterate in islice(iterations(discretise(chosen), method_of(tight), exact), 5):
        assert iterate.reduction is not None
        assert [entry.added for entry in iterate.reduction.records] == [0] * 5


@pytest.mark.parametrize("change", [{}, {"pgd_sharing": 0.5}], ids=str)
def test_a_run_goes_on_from_a_checkpoint_to_the_bit(change):
    chosen = options(substructures=5, **change)
    straight = sample(chosen, 40)
    half = sample(chosen, 25).checkpoint
    again = next(islice(iterations(discretise(chosen), method_of(chosen), half), 14, None))
    assert np.array_equal(again.outgoing, straight.outgoing)
    assert again.reduction is not None
    assert straight.reduction is not None
    assert again.reduction.records == straight.reduction.records


def test_the_records_account_for_the_residual():
    for iterate in islice(iterations(discretise(options()), method_of(options())), 30):
        assert iterate.reduction is not None
        for entry in iterate.reduction.records:
            assert 0.0 <= entry.updated <= 1.0
            assert 0.0 <= entry.enriched <= 1.0
            assert entry.updated + entry.enriched <= 1.0 + 1e-6
            assert entry.modes <= 10


@pytest.mark.parametrize("scene", ["bar", "strand"])
def test_sharing_as_it_is_by_default_costs_no_accuracy(scene):
    settings = CATALOGUE[scene].settings.checked({"linear_stage": "pgd", "finish": "none"})
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    errors, stored = [], []
    for chosen in (settings, settings.replace(pgd_sharing=0.0)):
        iterate = next(islice(iterations(problem, method_of(chosen)), 39, None))
        errors.append(distance.of_friction_force(iterate))
        stored.append(iterate.reduction.stored)
    assert errors[0] == pytest.approx(errors[1], rel=0.01)
    assert stored[0] < 0.75 * stored[1]


def test_shared_bases_store_fewer_modes():
    chosen = options(substructures=5, max_iterations=150, pgd_sharing=0.0)
    own, shared = run(chosen), run(chosen.replace(pgd_sharing=0.5, pgd_modes=13))
    assert own.iterate.reduction is not None
    assert shared.iterate.reduction is not None
    assert own.iterate.reduction.saved == 0
    assert shared.iterate.reduction.saved > 0
    assert shared.records[-1].error_displacement < 0.02


@pytest.mark.parametrize(
    "change",
    [
        {"elements": 10, "substructures": 10},
        {"instants": 1},
        {"instants": 2},
        {"peak": 0.0},
        {"friction": 1e6},
        {"peak": 4000.0},
        {"friction": 0.0},
        {"substructures": 1},
        {"multiscale": False},
        {"elements": 53, "body_force": 500.0},
        {"relaxation": 1.0},
        {"support_displacement": 1e-4},
        {"pgd_modes": 1},
        {"pgd_tolerance": 1.0},
    ],
    ids=str,
)
def test_degenerate_input_gives_finite_fields(change):
    chosen = options(max_iterations=40, **change)
    solution = run(chosen)
    assert solution.status.ending is not Ending.DIVERGED
    assert np.isfinite(solution.iterate.displacement).all()
    assert np.isfinite(solution.iterate.friction_force).all()


def test_without_load_no_mode_is_made():
    solution = run(options(peak=0.0))
    assert solution.iterate.reduction is not None
    assert solution.iterate.reduction.stored == 0


@pytest.mark.parametrize("change", [{"friction": 1e6}, {"peak": 4000.0}], ids=str)
def test_without_and_with_nothing_but_sliding_the_generous_basis_is_exact(change):
    chosen = options(**SMALL, tolerance=1e-14, max_iterations=30_000, **change)
    full = run(chosen.replace(linear_stage="full"))
    reduced = run(chosen.replace(**GENEROUS))
    assert reduced.records[-1].error_displacement == pytest.approx(
        full.records[-1].error_displacement, rel=0.1, abs=1e-9
    )


fields = st.tuples(
    st.integers(1, 9), st.integers(1, 12), st.integers(0, 2**32 - 1), st.floats(-9.0, 0.0)
)


def random_basis(rows: int, columns: int, seed: int) -> tuple[SeparatedBasis, np.ndarray]:
    generator = np.random.default_rng(seed)
    k, weights = 10.0 ** generator.uniform(-2, 2, rows), generator.uniform(0.1, 1.0, columns)
    sizes = 10.0 ** -np.arange(min(rows, columns), dtype=float)
    field = (
        generator.normal(size=(rows, len(sizes)))
        * sizes
        @ generator.normal(size=(len(sizes), columns))
    )
    return SeparatedBasis.of_field(field, k, weights, 0.0, 100), field


@given(fields)
def test_downsizing_drops_no_more_than_its_tolerance(drawn):
    rows, columns, seed, power = drawn
    basis, field = random_basis(rows, columns, seed)
    tolerance = 10.0**power
    dropped = basis.downsize(tolerance, 100)
    scratch = np.empty_like(field)
    lost = basis.squared(field - basis.field(), scratch)
    change = np.sqrt(lost / basis.squared(field, scratch))
    assert dropped <= tolerance
    assert change == pytest.approx(dropped, abs=1e-7)
    kept = np.sqrt(np.sum(basis.time_functions**2 * basis.weights, axis=1))
    assert np.all(np.diff(kept) <= 0.0)


@given(fields)
def test_the_modes_of_a_field_are_orthonormal_and_hold_it(drawn):
    rows, columns, seed, _ = drawn
    basis, field = random_basis(rows, columns, seed)
    gram = basis.modes.T @ (basis.k[:, None] * basis.modes)
    assert np.allclose(gram, np.eye(basis.n_modes), atol=1e-12)
    assert np.allclose(basis.field(), field, atol=1e-10 * np.abs(field).max())
    assert basis.outside(basis) < 1e-6


def test_the_fixed_point_finds_the_singular_pair(monkeypatch):
    monkeypatch.setattr("solver.reduction.enrichment.STEPS", 200)
    monkeypatch.setattr("solver.reduction.enrichment.STAGNATION", 0.0)
    random = np.random.default_rng(4)
    residual = random.normal(size=(12, 3)) @ np.diag([9.0, 3.0, 1.0]) @ random.normal(size=(3, 20))
    k, weights = random.uniform(0.1, 10.0, 12), random.uniform(0.5, 2.0, 20)
    found = nearest_mode(residual, k, weights) * np.sqrt(k)
    root = np.sqrt(k)[:, None] * residual * np.sqrt(weights)
    leading = np.linalg.svd(root)[0][:, 0]
    assert abs(found @ leading) == pytest.approx(np.linalg.norm(found), rel=1e-9)


def test_the_search_direction_is_the_full_stage_s():
    chosen = options(k_friction_scale=3.0)
    problem = discretise(chosen)
    k = method_of(chosen).direction.of(problem)
    iterate = sample(chosen, 3)
    for part, shown in zip(problem.substructures, iterate.bases, strict=True):
        assert np.array_equal(shown.k, k[part.rows])


def test_results_hold_what_the_bases_went_through():
    chosen = options(max_iterations=12, tolerance=1e-30)
    solution = run(chosen)
    arrays = result_arrays(chosen, solution)
    for name in ("modes", "added", "updated", "enriched", "dropped"):
        assert arrays[f"pgd_{name}"].shape == (12, 10)
    figures = summary(chosen, solution)
    assert figures["modes_stored"] + figures["modes_saved"] == arrays["pgd_modes"][-1].sum()
    assert figures["modes_largest"] == arrays["pgd_modes"][-1].max()
    assert figures["modes_saved"] > 0
