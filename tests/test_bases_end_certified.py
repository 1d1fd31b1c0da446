"""A run on separated bases may end by a status step, and says what its bases alone came to."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.files import result_arrays, summary
from solver.latin import Record, Solution, StatusStep, iterations, solve
from solver.reduction.basis import Reduction, ReductionRecord
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.quantities.finished import finished_run

SMALL = {"elements": 12, "instants": 21}


def options(scene: str = "bar", **changes: Any) -> Settings:
    given = {"linear_stage": "pgd", **SMALL, **changes}
    return CATALOGUE[scene].settings.checked(given)


def ended(settings: Settings) -> Solution:
    problem = discretise(settings)
    return solve(problem, method_of(settings), distance=distance_to(reference_of(problem), problem))


@pytest.fixture(scope="module")
def bar() -> Solution:
    return ended(options(pgd_modes=2))


def bases_of(entry: Record | Solution) -> Any:
    found = entry.iterate.reduction if isinstance(entry, Solution) else entry.reduction
    assert found
    return found


@pytest.mark.parametrize("scene", CATALOGUE)
def test_two_modes_find_the_solution_of_every_scene(scene: str) -> None:
    solution = ended(options(scene, pgd_modes=2))
    assert solution.is_certified
    before, last = solution.records[-2:]
    assert last.error_force < 1e-9 < before.error_force
    assert last.iteration == before.iteration + 1


def test_the_bases_of_the_search_stay_and_the_step_does_nothing_to_them(bar: Solution) -> None:
    shown: Reduction = bases_of(bar)
    assert [own.n_modes for own in shown.modes] == [one.modes for one in bar.records[-2].reduction]
    assert shown.records == tuple(ReductionRecord.idle(own.n_modes) for own in shown.modes)
    assert bar.records[-1].reduction == shown.records


def test_what_the_bases_alone_came_to_is_said(bar: Solution) -> None:
    left = bar.records[-2].error_force
    assert "status step" in bar.status.advice
    assert f"contact force was still {float(f'{100.0 * left:.2g}'):g} % away" in bar.status.advice
    full = ended(options(linear_stage="full"))
    assert full.is_certified
    assert "bases" not in full.status.advice


def test_files_hold_the_bases_of_the_search(bar: Solution) -> None:
    settings = options(pgd_modes=2)
    arrays = result_arrays(settings, bar)
    assert arrays["certified"]
    assert arrays["pgd_modes"].shape == (len(bar.records), settings.n_substructures)
    assert np.array_equal(arrays["pgd_modes"][-1], arrays["pgd_modes"][-2])
    assert not arrays["pgd_added"][-1].any()
    assert summary(settings, bar)["modes_largest"] == arrays["pgd_modes"][-1].max()


def test_a_run_goes_on_from_the_solution_and_not_from_the_bases(bar: Solution) -> None:
    iterate = bar.iterate
    generous = options(pgd_modes=40, pgd_tolerance=1e-12)
    problem = iterate.problem
    method = replace(method_of(generous), finish=None)
    first = next(iterations(problem, method, iterate.checkpoint))
    distance = distance_to(reference_of(problem), problem)
    assert distance.of_friction_force(first) < 1e-6


def test_a_run_that_only_iterates_stays_approximate_and_names_the_step() -> None:
    settings = options(pgd_modes=2, finish="none")
    problem = discretise(settings)
    method = replace(method_of(settings), stop=replace(method_of(settings).stop, iterations=60))
    solution = solve(problem, method)
    assert not solution.is_certified
    assert solution.iterate.number == 60
    assert "finish=at-once" in solution.status.advice
    assert method.finish is None
    assert solve(problem, replace(method, finish=StatusStep())).is_certified


@pytest.mark.parametrize(("stage", "is_answered"), [("full", True), ("pgd", False)])
def test_a_run_on_bases_is_not_answered_by_its_neighbour(stage: str, is_answered: bool) -> None:
    first = finished_run(options(linear_stage=stage), errors=False)
    again = finished_run(options(linear_stage=stage), errors=False, before=first.states)
    assert again.was_warm is is_answered
    assert again.iterate.number == (1 if is_answered else first.iterate.number)
    assert np.allclose(again.force, first.force)
