"""Automatic k, Anderson acceleration and nested meshes: a shorter path to the same limit."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from bars import measured

from solver.latin import Ending, iterations
from solver.latin.anderson import AndersonState
from solver.latin.directions import sliding_share
from solver.latin.start import prolong
from solver.laws.around import FRICTION_FACTOR
from solver.loads import PRESETS
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

FAST = {"search_direction": "auto", "acceleration": "anderson", "start": "nested"}


def options(**changes: object) -> BarSettings:
    return BarSettings.checked({"method": "paper", **FAST, **changes})


def within(solution, level: float) -> int:
    return next(entry.iteration for entry in solution.records if entry.error_force <= level)


@pytest.mark.parametrize("load", PRESETS)
def test_all_together_reach_one_percent_of_friction_force_early(load):
    assert within(measured(options(load=load, max_iterations=30)), 0.01) <= 30


@pytest.mark.parametrize("seed", range(3))
def test_and_so_on_random_paths(seed):
    assert within(measured(options(load="random", seed=seed, max_iterations=30)), 0.01) <= 30


@pytest.mark.parametrize("load", ["sine", "decaying"])
@pytest.mark.parametrize("peak", [300.0, 1200.0, 2400.0])
def test_and_at_every_peak(load, peak):
    assert within(measured(options(load=load, peak=peak, max_iterations=30)), 0.01) <= 30


@pytest.mark.parametrize(
    ("setting", "sizes", "most"),
    [("substructures", (1, 5, 50), 1.2), ("elements", (50, 200), 2.0)],
    ids=str,
)
def test_iterations_to_one_percent_hardly_depend_on(setting, sizes, most):
    early = {"tolerance": 1e-20, "max_iterations": 60}
    found = [within(measured(options(**early, **{setting: size})), 0.01) for size in sizes]
    assert max(found) <= most * min(found)


@pytest.mark.parametrize("change", [{}, {"load": "random"}], ids=str)
def test_the_limit_is_the_same(change):
    solution = measured(options(tolerance=1e-24, max_iterations=3000, **change))
    assert solution.status.ending is Ending.CONVERGED
    assert solution.records[-1].error_force < 1e-8
    assert solution.records[-1].error_displacement < 1e-8


@pytest.mark.parametrize(
    "change",
    [
        {"elements": 1, "substructures": 1},
        {"elements": 13, "substructures": 13},
        {"instants": 1},
        {"peak": 0.0},
        {"friction": 0.0},
        {"friction": 1e6},
        {"peak": 5000.0},
        {"multiscale": False},
        {"relaxation": 1.0},
        {"elements": 53, "body_force": 700.0, "peak": 300.0},
        {"support_displacement": 1e-4},
        {"pressure_profile": "gap"},
        {"linear_stage": "pgd"},
    ],
    ids=str,
)
def test_on_every_kind_of_input_it_ends_well(change):
    solution = measured(options(max_iterations=300, tolerance=1e-14, **change))
    assert solution.status.ending is not Ending.DIVERGED
    assert np.isfinite(solution.iterate.friction_force).all()
    if change.get("linear_stage") != "pgd":
        assert solution.records[-1].error_displacement < 1e-3


def test_a_run_goes_on_from_a_checkpoint_to_the_bit(monkeypatch):
    monkeypatch.setattr("solver.latin.anderson.MEMORY", 4)
    chosen = options()
    problem = discretise(chosen)
    straight = list(islice(iterations(problem, method_of(chosen)), 30))
    for place in (1, 3, 12, 20):
        again = next(
            islice(
                iterations(problem, method_of(chosen), straight[place].checkpoint), 28 - place, None
            )
        )
        assert again.number == straight[29].number
        assert np.array_equal(again.outgoing, straight[29].outgoing)


def by_point(**changes: object):
    chosen = options(**changes)
    problem = discretise(chosen)
    return problem.friction.by_point(
        method_of(chosen).direction.of(problem)[problem.friction.tangent.above]
    )


def test_the_automatic_direction_does_not_know_the_cuts():
    found = by_point(substructures=1)
    for substructures in (2, 10, 50):
        assert np.allclose(by_point(substructures=substructures), found, rtol=1e-12)


@pytest.mark.parametrize("peak", [300.0, 900.0, 2400.0])
def test_it_is_between_the_stiffness_of_what_slides_and_that_of_an_element(peak):
    for elements in (50, 200):
        share = sliding_share(discretise(options(elements=elements, peak=peak)))
        inside = by_point(elements=elements, peak=peak)[1:-1]
        assert np.allclose(inside, FRICTION_FACTOR * np.sqrt(elements / share))


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
    ],
    ids=str,
)
def test_the_sliding_share_is_load_over_capacity(change, share):
    assert sliding_share(discretise(options(**change))) == pytest.approx(share)


def test_a_fixed_point_that_is_linear_is_found_in_as_many_steps_as_it_has_dimensions():
    generator = np.random.default_rng(5)
    matrix, shift = 0.9 * np.linalg.qr(generator.normal(size=(6, 6)))[0], generator.normal(size=6)
    state = [np.zeros((6, 1, 1), order="F")]
    mix = AndersonState([np.ones((6, 1, 1))], memory=10)
    for _ in range(9):
        mix.start(state)
        state[0][:, 0, 0] = matrix @ state[0][:, 0, 0] + shift
        mix(state)
    exact = np.linalg.solve(np.eye(6) - matrix, shift)
    assert np.allclose(state[0][:, 0, 0], exact, atol=1e-5)


def test_the_memory_is_given_up_when_the_residual_grows():
    mix = AndersonState([np.ones((2, 1, 1))], memory=5)
    for size in (1.0, 0.5, 0.4, 0.41):
        mix.start([np.zeros((2, 1, 1))])
        mix([np.full((2, 1, 1), size)])
    assert mix.seen == 1
    assert mix.count == 0


def test_what_is_linear_is_carried_over_exactly():
    """A bar that does not slide at one end and slides evenly at the other, on two meshes."""
    coarse, fine = (
        discretise(options(elements=number, substructures=5, peak=4000.0, instants=3))
        for number in (20, 40)
    )
    chosen = options(substructures=5)
    k = method_of(chosen).direction.of(fine)
    stretch = np.linspace(0.0, 1.0, 3)
    displacement = (coarse.positions[coarse.row_dofs])[:, None] * stretch
    force = np.zeros_like(displacement)
    found = prolong(coarse, displacement, force, fine, k)
    for part in fine.substructures:
        own = fine.positions[part.dofs][:, None] * stretch
        needed = part.elasticity.stiffness @ own
        trace = part.elasticity.trace
        rubs = np.isin(part.rows, fine.friction.tangent.above)
        assert np.allclose(found[part.rows[rubs]], own[trace[rubs]])
        ends = part.rows[~rubs]
        assert np.allclose(
            (found[ends] - own[trace[~rubs]]) * k[ends, None], needed[trace[~rubs]], atol=1e-12
        )
