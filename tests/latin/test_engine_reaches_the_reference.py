"""Driven on, the iteration reaches the reference by whatever path it takes."""

from __future__ import annotations

from itertools import islice
from typing import Any

import numpy as np
import pytest
from bars import SMALL, options, relative, table
from runs import sample

from solver.latin import Ending, iterations, solve
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

LOOK = 20


PATHS = ["ramp", "triangle", "cycle", "sine", "decaying", "random"]


def balanced(substructures, **values):
    """Options with a friction k of 100 ES/L^2 per length, however the bar is cut."""
    factor = 100.0 / substructures**2
    cut = SMALL | {"substructures": substructures, "k_scale": factor}
    return options(**cut, **values)


def driven(chosen):
    """Iterate until the LATIN indicator, looked at now and then, is small enough."""
    problem = discretise(chosen)
    for iterate in islice(
        iterations(problem, method_of(chosen)), LOOK - 1, chosen.max_iterations, LOOK
    ):
        if iterate.indicator <= chosen.tolerance:
            return iterate
    pytest.fail(f"eta is {iterate.indicator} after {iterate.number} iterations")


def assert_reached(chosen):
    iterate = driven(chosen)
    reference = reference_of(iterate.problem)
    distance = distance_to(reference, iterate.problem)
    assert distance.of_friction_force(iterate) < 1e-8
    assert distance.of_displacement(iterate) < 1e-9
    return iterate


def test_the_default_reaches_the_reference_in_fields_and_statuses():
    chosen = options()
    problem = discretise(chosen)
    reference = reference_of(problem)
    solution = solve(
        problem,
        method_of(chosen),
        distance=distance_to(reference, problem),
        watch=False,
    )
    assert solution.status.ending is Ending.CONVERGED
    last = solution.records[-1]
    assert last.indicator <= 1e-26
    assert last.error_force < 1e-8
    assert last.error_displacement < 1e-9
    assert np.array_equal(solution.iterate.status, reference.status)


@pytest.mark.parametrize("load", PATHS)
def test_every_load_path_reaches_the_reference(load):
    assert_reached(options(**SMALL, load=load, peak=2000.0))


@pytest.mark.parametrize(
    "change",
    [
        {"friction_profile": "rising"},
        {"friction_profile": "falling", "pressure_profile": "gap"},
        {"pressure_profile": [[0.0, 1.0], [0.5, 0.0], [1.0, 3.0]]},
        {"friction": 0.0},
        {"support_displacement": 5e-4},
        {"support_displacement": -2e-3, "support_load": "cycle", "peak": 0.0},
        {"body_force": 1000.0},
        {"body_force": -3000.0, "body_load": "decaying", "support_displacement": 1e-4},
        {"instants": 1, "load": "ramp"},
        {"instants": 2, "load": "ramp"},
    ],
    ids=str,
)
def test_every_kind_of_bar_reaches_the_reference(change):
    assert_reached(options(**(SMALL | change)))


@pytest.mark.parametrize("substructures", [1, 7, 30])
def test_the_decomposition_changes_the_path_and_not_the_limit(substructures):
    chosen = balanced(substructures)
    other = balanced(5)
    assert_reached(chosen)
    assert (
        relative(sample(chosen, 5).displacement, sample(other, 5).displacement) > 1e-3
    )


@pytest.mark.parametrize("k_scale", [0.5, 3.0])
def test_k_changes_the_path_and_not_the_limit(k_scale):
    chosen = options(**SMALL, k_scale=k_scale)
    assert_reached(chosen)
    plain = options(**SMALL)
    assert (
        relative(sample(chosen, 5).displacement, sample(plain, 5).displacement) > 1e-3
    )


@pytest.mark.parametrize("substructures", [6, 10])
def test_monoscale_and_multiscale_differ_on_the_way_and_agree_in_the_limit(
    substructures,
):
    multi, mono = (
        options(**{**SMALL, "substructures": substructures}, multiscale=multiscale)
        for multiscale in (True, False)
    )
    assert relative(sample(mono, 5).displacement, sample(multi, 5).displacement) > 1e-3
    ends = [assert_reached(chosen) for chosen in (multi, mono)]
    assert relative(ends[1].displacement, ends[0].displacement) < 1e-9


def test_the_bar_remembers_its_return_points():
    forces = [
        0.0,
        600.0,
        1200.0,
        300.0,
        900.0,
        500.0,
        900.0,
        300.0,
        1200.0,
        -1200.0,
        1200.0,
    ]
    chosen = options(**{**SMALL, "instants": len(forces)}, load=table(forces))
    iterate = assert_reached(chosen)
    displacement = iterate.displacement
    friction = iterate.friction_force
    for closes, opened in [(6, 4), (7, 3), (8, 2), (10, 2)]:
        assert relative(displacement[:, closes], displacement[:, opened]) < 1e-9
        assert relative(friction[1:, closes], friction[1:, opened]) < 1e-7
    assert relative(displacement[:, 4], displacement[:, 2]) > 1e-2


SCENES: dict[str, dict[str, Any]] = {
    "bar": {},
    "strand": {"elements": 20, "instants": 51},
    "block": {"elements": 24, "elements_up": 8},
}


@pytest.mark.parametrize(
    "changes", [{"method": "paper"}, {"linear_stage": "pgd"}], ids=str
)
@pytest.mark.parametrize("scene", SCENES)
def test_an_iterate_at_the_end_shows_stick_and_slip_of_the_solution(scene, changes):
    settings = CATALOGUE[scene].checked(SCENES[scene] | changes)
    problem = discretise(settings)
    solution = solve(problem, method_of(settings), watch=False)
    assert solution.status.ending == "converged"
    assert np.mean(solution.iterate.status != reference_of(problem).status) < 0.004
