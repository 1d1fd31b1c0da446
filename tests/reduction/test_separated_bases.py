"""Separated bases follow the full stage as their modes reach, also to the end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from runs import assert_goes_on, distance_of, errors, sample, settings_of, solved
from small_scenes import KINDS, SMALL

from solver.latin import Ending, Solution
from solver.latin.end.status_step import states_of
from solver.reduction.basis import SeparatedBasis
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.study.scene_run import finished_run

GENEROUS = {"pgd_modes": 100, "pgd_pairs": 100, "pgd_tolerance": 1e-12}


def options(**changes: object) -> BarSettings:
    return BarSettings.checked({"method": "paper", "linear_stage": "pgd", **changes})


def test_a_generous_basis_follows_the_full_stage():
    chosen = options(**GENEROUS)
    reduced = solved(chosen)
    full = solved(chosen.replace(linear_stage="full"))
    assert reduced.status.ending is full.status.ending is Ending.CONVERGED
    assert len(reduced.records) == len(full.records)
    for one, other in zip(reduced.records, full.records, strict=True):
        assert one.error_displacement == pytest.approx(
            other.error_displacement, rel=0.1
        )
        assert one.error_force == pytest.approx(other.error_force, rel=0.1)


@pytest.mark.parametrize(("substructures", "most"), [(10, 8), (5, 11)])
def test_the_default_basis_reaches_one_percent_of_displacement(substructures, most):
    solution = solved(options(substructures=substructures, max_iterations=300))
    assert min(entry.error_displacement for entry in solution.records) < 0.01
    assert solution.records[-1].error_displacement < 0.01
    # The friction force of a moving front does not separate well: 0.7 % at 10, 8.5 % at
    # 5.
    assert solution.records[-1].error_force < (0.01 if substructures == 10 else 0.12)
    assert 0 < max(basis.n_modes for basis in solution.iterate.bases) <= most


@pytest.mark.parametrize(
    ("scene", "size"),
    [("bar", {"substructures": 5}), ("layers", {"elements": 16, "instants": 31})],
)
def test_the_force_follows_the_number_of_modes(scene, size):
    settings = settings_of(scene, linear_stage="pgd", **size)
    few, some, many = (
        errors(settings.replace(pgd_modes=most), 40)[-1] for most in (3, 6, 12)
    )
    assert few > 1.5 * some > 3.0 * many


def test_every_mode_is_admissible():
    """The force of a mode is that of its displacement in the substructure (eq. 3)."""
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


fields = st.tuples(
    st.integers(1, 9),
    st.integers(1, 12),
    st.integers(0, 2**32 - 1),
    st.floats(-9.0, 0.0),
)


def random_basis(
    rows: int, columns: int, seed: int
) -> tuple[SeparatedBasis, np.ndarray]:
    generator = np.random.default_rng(seed)
    k = 10.0 ** generator.uniform(-2, 2, rows)
    weights = generator.uniform(0.1, 1.0, columns)
    sizes = 10.0 ** -np.arange(min(rows, columns), dtype=float)
    field = (
        generator.normal(size=(rows, len(sizes)))
        * sizes
        @ generator.normal(size=(len(sizes), columns))
    )
    return SeparatedBasis.of_field(field, k, weights, 0.0, 100), field


@examples(max_examples=40)
@given(fields)
def test_downsizing_drops_no_more_than_its_tolerance(drawn):
    rows, columns, seed, power = drawn
    basis, field = random_basis(rows, columns, seed)
    tolerance = 10.0**power
    basis = basis.downsized(tolerance, 100)
    scratch = np.empty_like(field)
    lost = basis.squared(field - basis.field(), scratch)
    change = np.sqrt(lost / basis.squared(field, scratch))
    assert change <= tolerance + 1e-7
    kept = np.sqrt(np.sum(basis.time_functions**2 * basis.weights, axis=1))
    assert np.all(np.diff(kept) <= 0.0)


@examples(max_examples=40)
@given(fields)
def test_the_modes_of_a_field_are_orthonormal_and_hold_it(drawn):
    rows, columns, seed, _ = drawn
    basis, field = random_basis(rows, columns, seed)
    gram = basis.modes.T @ (basis.k[:, None] * basis.modes)
    assert np.allclose(gram, np.eye(basis.n_modes), atol=1e-12)
    assert np.allclose(basis.field(), field, atol=1e-10 * np.abs(field).max())
    assert basis.outside(basis) < 1e-6


@pytest.mark.parametrize("change", [{}, {"pgd_sharing": 0.5}], ids=str)
def test_a_run_goes_on_from_a_checkpoint_to_the_bit(change):
    assert_goes_on(options(substructures=5, **change), 40, 24)


@pytest.mark.parametrize("scene", ["bar", "strand"])
def test_sharing_as_it_is_by_default_costs_no_accuracy(scene):
    shared, own = (
        sample(settings_of(scene, linear_stage="pgd", **changes), 40)
        for changes in ({}, {"pgd_sharing": 0.0})
    )
    distance = distance_of(shared.problem)
    assert distance.of_friction_force(shared) == pytest.approx(
        distance.of_friction_force(own), rel=0.01
    )
    kept, alone = (sum(one.n_modes for one in set(run.bases)) for run in (shared, own))
    assert kept < 0.75 * alone


def test_an_instant_right_after_another_does_not_blow_up_the_modes():
    path = [[0.0, -1.0], [2.3e-308, 0.0], [1.0, -1.0]]
    size = {
        "elements": 2,
        "layers": 1,
        "instants": 1,
        "substructures": 1,
        "length": 1.0,
    }
    method = {"method": "paper", "linear_stage": "pgd", "multiscale": False}
    settings = settings_of(
        "rope", **size, **method, load=path, friction=1.0, fall_off=1.0
    )
    assert np.abs(sample(settings, 10).boundary_force).max() < 1.0


def small(scene: str = "bar", **changes: Any) -> Any:
    return settings_of(scene, **SMALL[scene], **{"linear_stage": "pgd", **changes})


@pytest.fixture(scope="module")
def bar() -> Solution:
    return solved(small(pgd_modes=2))


@pytest.mark.parametrize("scene", KINDS)
def test_two_modes_find_the_solution_of_every_kind_of_scene(scene: str) -> None:
    solution = solved(small(scene, pgd_modes=2))
    assert solution.is_certified
    before, last = solution.records[-2:]
    assert last.error_force < 1e-9 < before.error_force
    assert last.iteration == before.iteration + 1


def test_the_status_states_the_error_of_the_bases_alone(bar: Solution) -> None:
    left = bar.records[-2].error_force
    assert "status step" in bar.status.advice
    assert (
        f"contact force was still {float(f'{100.0 * left:.2g}'):g} % away"
        in bar.status.advice
    )
    full = solved(small(linear_stage="full"))
    assert full.is_certified
    assert "bases" not in full.status.advice


@pytest.mark.parametrize(("stage", "is_answered"), [("full", True), ("pgd", False)])
def test_a_run_on_bases_is_not_answered_by_its_neighbour(
    stage: str, is_answered: bool
) -> None:
    first = finished_run(small(linear_stage=stage), errors=False)
    again = finished_run(
        small(linear_stage=stage), errors=False, before=states_of(first.iterate)
    )
    assert again.was_warm is is_answered
    assert again.iterate.number == (1 if is_answered else first.iterate.number)
    assert np.allclose(again.force, first.force)
