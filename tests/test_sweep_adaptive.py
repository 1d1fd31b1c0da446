"""An adaptive sweep takes fewer runs than a grid for the same error of its chart."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator
from sweeps import Here, tiny

from solver.arrays import Array
from solver.definitions import SettingError
from solver.study.chart import Map
from solver.study.sweep import Plan, Row
from solver.study.sweep.adaptive import Chooser, sweep_adaptively
from solver.study.sweep.chart import charts

ES, LENGTH = 210e9 * 3.14e-6, 1.0


def energy(peak: float, bound: float) -> float:
    """Energy of a cycle of the bar; once it slides whole, as if all that is pulled further did."""
    front = min(peak, bound * LENGTH)
    return 2.0 * front**3 / (3.0 * ES * bound) + 1e-3 * max(peak - bound * LENGTH, 0.0)


def energies(plan: Plan) -> Array:
    found = []
    for number in range(plan.size):
        at = {"friction": 0.3, **plan.point(number)}
        found.append(energy(at["peak"], 5000.0 * at["friction"]))
    return np.array(found)


def chosen(plan: Plan, exact: Array, runs: int, at_once: int = 4) -> list[int]:
    """Let a chooser take its samples, some of them always under way."""
    chooser, under_way = Chooser(plan, runs), list[int]()
    found: list[int] = []
    while True:
        asked = chooser.ask(at_once - len(under_way))
        found += asked
        under_way += asked
        if not under_way:
            return found
        done = under_way.pop(0)
        chooser.tell(Row(done, "converged", "", (float(exact[done]),)))


def error(plan: Plan, exact: Array, points: list[int]) -> float:
    """Largest error of the logarithm between points, over its range."""
    grid = np.stack(np.unravel_index(np.arange(plan.size), plan.shape), axis=1).astype(float)
    height, at = np.log(exact), np.array(sorted(points))
    if len(plan.shape) == 1:
        drawn = np.interp(grid[:, 0], grid[at, 0], height[at])
    else:
        scaled = grid / (np.array(plan.shape) - 1.0)
        drawn = LinearNDInterpolator(scaled[at], height[at])(scaled)
    return float(np.abs(drawn - height).max() / np.ptp(height))


def even(plan: Plan, along: int) -> list[int]:
    lines = [np.linspace(0, count - 1, along).round().astype(int) for count in plan.shape]
    places = np.meshgrid(*lines, indexing="ij")
    return [int(number) for number in np.ravel_multi_index(tuple(places), plan.shape).ravel()]


@pytest.mark.parametrize("runs", [20, 40])
def test_the_energy_over_the_peak_takes_half_the_runs_of_a_grid(runs: int) -> None:
    plan = tiny(["peak=300:2400:841"], ["dissipation@1"])
    exact = energies(plan)
    points = chosen(plan, exact, runs)
    assert len(set(points)) == runs
    assert error(plan, exact, points) < error(plan, exact, even(plan, 2 * runs))


def test_the_map_of_the_energy_takes_half_the_runs_of_a_grid() -> None:
    plan = tiny(["friction=0.1:0.6:41", "peak=300:2400:41"], ["dissipation@1"])
    exact = energies(plan)
    points = chosen(plan, exact, 98)
    assert len(set(points)) == 98
    assert error(plan, exact, points) < error(plan, exact, even(plan, 14))


def test_a_sweep_takes_no_more_runs_than_it_may_and_goes_on_from_those_it_has() -> None:
    plan = tiny(["peak=300:900:61"], ["peak_displacement"])
    pool = Here()
    rows = list(sweep_adaptively(plan, pool, 9))
    assert len({row.number for row in rows}) == len(rows) == 9
    assert {0, plan.size - 1} <= {row.number for row in rows}
    more = list(sweep_adaptively(plan, pool, 12, known=rows))
    assert len({row.number for row in [*rows, *more]}) == 12
    assert list(sweep_adaptively(plan, pool, 12, known=[*rows, *more])) == []


@pytest.mark.parametrize("value", [math.nan, math.inf, 3.0])
def test_what_has_no_bend_is_sampled_evenly(value: float) -> None:
    plan = tiny(["peak=1:900:41", "friction=0.1:0.3:11"], ["iterations"])
    points = chosen(plan, np.full(plan.size, value), 60)
    assert len(set(points)) == 60
    grid = np.stack(np.unravel_index(np.arange(plan.size), plan.shape), axis=1) / [40.0, 10.0]
    apart = np.linalg.norm(grid[:, None] - grid[None, points], axis=2).min(axis=1)
    assert apart.max() < 0.15


@pytest.mark.parametrize(
    ("vary", "runs", "words"),
    [
        (["load=sine,ramp"], 9, "ranges of numbers"),
        (["peak=1:9:9", "method=fast,paper"], 20, "ranges of numbers"),
        (["peak=1:9:9", "friction=0.2"], 20, "ranges of numbers"),
        (["peak=1:9:9"], 3, "at least 4 runs"),
        (["peak=1:9:9", "friction=0.2:0.3:9"], 9, "at least 16 runs"),
    ],
)
def test_what_cannot_be_sampled_is_refused(vary: list[str], runs: int, words: str) -> None:
    with pytest.raises(SettingError, match=words):
        Chooser(tiny(vary, ["iterations"]), runs)


def test_a_curve_joins_what_was_sampled_and_a_map_lays_facets_through_it() -> None:
    line = tiny(["peak=1:900:41"], ["iterations"])
    (panel,) = charts(line, [Row(n, "converged", "", (float(n),)) for n in (0, 20, 40)])
    assert not isinstance(panel, Map)
    assert panel.curves[0].y.tolist() == [0.0, 20.0, 40.0]
    plan = tiny(["peak=1:900:9", "friction=0.1:0.3:9"], ["iterations"])
    rows = [Row(n, "converged", "", (float(n + 1),)) for n in (0, 8, 40, 72, 80)]
    whole = [Row(n, "converged", "", (1.0,)) for n in range(81)]
    for given in (rows, rows[:2], whole, whole[:9], []):
        (area,) = charts(plan, given)
        assert isinstance(area, Map)
        assert area.is_sampled == (given is rows)
        assert not area.is_sampled or np.isfinite(area.z).all()
