"""Automatic k, Anderson, nested meshes: a shorter path to the same limit."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from runs import assert_goes_on, distance_of, errors, solved

from solver.latin import Ending, iterations
from solver.latin.direction.directions import sliding_share
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.settings.load_paths import PRESETS

FAST = {"search_direction": "auto", "acceleration": "anderson", "start": "nested"}


def options(**changes: object) -> BarSettings:
    return BarSettings.checked({"method": "paper"} | FAST | changes)


def within(solution, level: float) -> int:
    return next(
        entry.iteration for entry in solution.records if entry.error_force <= level
    )


@pytest.mark.parametrize(
    "changes",
    [{"load": load} for load in PRESETS] + [{"peak": 300.0}, {"peak": 2400.0}],
    ids=str,
)
def test_all_together_reach_one_percent_of_friction_force_early(changes):
    assert within(solved(options(max_iterations=30, **changes)), 0.01) <= 30


def test_a_run_starts_from_no_mesh_that_has_other_instants():
    """Tables have all instants where a mesh is coarse, and few where it is fine."""
    times = np.linspace(0.0, 1.0, 2000)
    wave = 300.0 * np.sin(20.0 * np.pi * times)
    fine = options(elements=1200, load=np.stack([times, wave], axis=1).tolist())
    assert fine.n_instants < len(times)
    for settings in (fine, options()):
        assert all(
            len(coarse.instants) == settings.n_instants for coarse in settings.coarser()
        )
    assert len(next(options().coarser()).positions) == options().elements // 2 + 1


@pytest.mark.parametrize(
    ("setting", "sizes", "most"),
    [("substructures", (1, 5, 50), 1.2), ("elements", (50, 200), 1.0)],
    ids=str,
)
def test_finer_cuts_and_meshes_take_hardly_more_iterations(setting, sizes, most):
    early = {"tolerance": 1e-20, "max_iterations": 60}
    found = [
        within(solved(options(**early, **{setting: size})), 0.01) for size in sizes
    ]
    assert max(found) <= most * found[0]


@pytest.mark.parametrize("change", [{}, {"load": "random"}], ids=str)
def test_the_limit_is_the_same(change):
    solution = solved(options(tolerance=1e-24, max_iterations=3000, **change))
    assert solution.status.ending is Ending.CONVERGED
    assert solution.records[-1].error_force < 1e-8
    assert solution.records[-1].error_displacement < 1e-8


@pytest.mark.parametrize(
    ("change", "share"),
    [
        ({}, 0.6),
        ({"peak": 300.0}, 0.2),
        ({"peak": -300.0}, 0.2),
        ({"peak": 4000.0}, 1.0),
        ({"peak": 0.0}, 2.0 / 51.0),
        ({"friction": 0.0}, 1.0),
        ({"support_displacement": 1e-3}, 1.0),
        ({"load": "ramp", "peak": 300.0, "body_force": 300.0}, 0.4),
        ({"load": "ramp", "peak": 300.0, "body_force": -300.0}, 0.2),
        # ES alpha times 100 K are 791.28 N.
        ({"peak": 0.0, "temperature": 100.0}, 791.28 / 1500.0),
        ({"peak": 0.0, "temperature": -100.0}, 791.28 / 1500.0),
        ({"temperature": 100.0}, 0.6),
    ],
    ids=str,
)
def test_the_sliding_share_is_load_over_capacity(change, share):
    assert sliding_share(discretise(options(**change))) == pytest.approx(share)


@pytest.mark.parametrize("load", PRESETS)
def test_a_millionth_of_friction_force_takes_at_most_200_iterations(load):
    settings = options(load=load, relaxation=1.0)
    problem = discretise(settings)
    distance = distance_of(problem)
    found = islice(iterations(problem, method_of(settings)), 200)
    assert any(distance.of_friction_force(iterate) <= 1e-6 for iterate in found)


@pytest.mark.parametrize("substructures", [1, 10])
def test_acceleration_shortens_the_plain_iteration(substructures):
    chosen = options(substructures=substructures, start="zero")
    accelerated, plain = (
        errors(one, 300) for one in (chosen, chosen.replace(acceleration="none"))
    )
    assert sum(accelerated > 1e-3) < 0.5 * sum(plain > 1e-3)


def test_a_run_without_acceleration_goes_on_from_any_checkpoint_to_the_bit():
    chosen = options(acceleration="none")
    for place in (2, 20):
        assert_goes_on(chosen, 40, place)
