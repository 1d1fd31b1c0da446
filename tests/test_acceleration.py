"""Automatic k, Anderson acceleration and nested meshes: a shorter path to the same limit."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from bars import measured

from solver.latin import Ending, iterations
from solver.latin.acceleration.mixing import Mixing
from solver.latin.direction.rules import sliding_share
from solver.latin.start.prolong import prolong
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


def test_a_run_goes_on_from_a_checkpoint_to_the_bit(monkeypatch):
    monkeypatch.setattr("solver.latin.acceleration.anderson.MEMORY", 4)
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
    mix = Mixing([np.ones((6, 1, 1))], memory=10)
    for _ in range(9):
        mix.start(state)
        state[0][:, 0, 0] = matrix @ state[0][:, 0, 0] + shift
        mix(state)
    exact = np.linalg.solve(np.eye(6) - matrix, shift)
    assert np.allclose(state[0][:, 0, 0], exact, atol=1e-5)


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
