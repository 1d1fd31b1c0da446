"""What a path over time has, a run sees: every turning point, and all between them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.definitions import SettingError
from solver.latin import Ending, solve
from solver.loads import PRESSURES
from solver.reference.choice import reference_of
from solver.reference.closed_forms.diffusion import spread
from solver.scenes import CATALOGUE, discretise, left_out
from solver.scenes.base import EVERY_POINT, LARGEST_FIELD, THINNED
from solver.scenes.method import method_of

SPIKE = [[0.0, 0.0], [0.5, 0.0], [0.503, 1200.0], [0.506, 0.0], [1.0, 0.0]]
SCENES_AND_PATHS = [
    (scene, name)
    for scene, entry in CATALOGUE.items()
    for name in entry.settings.checked({}).paths
    if hasattr(entry.settings.definitions()[name], "presets")
]
"""Paths that may be tables, of scenes by default."""


def drawn(scene: str, name: str, seed: int) -> Any:
    """Settings with a table of wide and narrow swings, of which the instants know nothing."""
    random = np.random.default_rng([seed, *name.encode()])
    grip = {"grip": "displacement"} if scene == "strand" else {}
    settings = CATALOGUE[scene].settings.checked(grip)
    size = float(settings.size_of(name)) or 1e5
    middles = np.sort(random.uniform(0.02, 0.98, 5)) * settings.duration
    halves = 10.0 ** random.uniform(-6.0, -3.0, 5) * settings.duration
    times = np.unique(np.concatenate([middles - halves, middles, middles + halves]))
    shares = random.uniform(0.1, 1.0, len(times))
    table = [[float(a), float(size * b)] for a, b in zip(times, shares, strict=True)]
    return settings.replace(**{name: table})


def turns(values: np.ndarray) -> np.ndarray:
    """Values at which a path turns back, its ends among them."""
    moves = values[np.concatenate([[True], np.diff(values) != 0.0])]
    inner = np.sign(np.diff(moves))[1:] != np.sign(np.diff(moves))[:-1]
    return np.concatenate([moves[:1], moves[1:-1][inner], moves[-1:]])


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("scene", "name"), SCENES_AND_PATHS)
def test_a_table_is_seen_with_its_extremes_its_integral_and_its_turning_points(scene, name, seed):
    settings = drawn(scene, name, seed)
    times, given = np.array(getattr(settings, name)).T
    seen, instants = settings.path(name), settings.times()
    assert (seen.max(), seen.min()) == (given.max(), given.min())
    np.testing.assert_array_equal(turns(seen), turns(given))
    ends = [(0.0 - times[0]) * -given[0], (settings.duration - times[-1]) * given[-1]]
    assert np.trapezoid(seen, instants) == pytest.approx(np.trapezoid(given, times) + sum(ends))
    assert left_out(settings) == []


def of_preset(scene: str, name: str, preset: str, **changes: Any) -> Any:
    """Settings with a preset; wires are gripped, so that no pull is too large."""
    grip = {"grip": "displacement"} if scene == "strand" else {}
    return CATALOGUE[scene].settings.checked({name: preset, "seed": 3, **grip, **changes})


@pytest.mark.parametrize(("scene", "name"), SCENES_AND_PATHS)
def test_a_preset_is_seen_with_its_extremes_whatever_the_number_of_instants(scene, name):
    for preset in CATALOGUE[scene].settings.definitions()[name].presets:
        for number in (1, 2, 7, 38, 41):
            settings = of_preset(scene, name, preset, instants=number)
            fine = np.linspace(0.0, settings.duration, 96_001)
            path = settings.SHAPES.get(preset, PRESSURES.get(preset))
            given = path(fine / settings.duration, 3) * settings.size_of(name)
            seen = settings.path(name)
            if number == 1:  # it begins at rest: what is between that and its end, is passed
                given, seen = (np.concatenate([[0.0], one]) for one in (given, seen))
            else:
                steps = np.diff(settings.times())
                assert steps.max() <= settings.duration / (number - 1) * (1.0 + 1e-9)
            size = np.abs(given).max()
            assert seen.max() == pytest.approx(given.max(), abs=1e-4 * size), (preset, number)
            assert seen.min() == pytest.approx(given.min(), abs=1e-4 * size), (preset, number)
            assert settings.n_instants >= number


@pytest.mark.parametrize("scene", CATALOGUE)
def test_instants_on_which_all_presets_turn_stay_evenly_spread(scene):
    settings = CATALOGUE[scene].settings.checked({})
    even = np.linspace(0.0, settings.duration, settings.instants)
    np.testing.assert_array_equal(settings.times(), even)


def friction_of(changes: dict[str, Any]) -> float:
    """Solve the bar; give what friction takes, J."""
    settings = CATALOGUE["bar"].settings.checked(changes)
    problem = discretise(settings)
    solution = solve(problem, method_of(settings), watch=False)
    assert solution.status.ending is Ending.CONVERGED
    fields = solution.iterate
    moved = np.diff(fields.displacement, axis=1)
    return float(-(fields.friction_force[:, 1:] * moved).sum())


def test_a_pull_between_two_instants_of_the_bar_is_solved():
    assert friction_of({"load": SPIKE}) == pytest.approx(
        friction_of({"load": SPIKE, "instants": 1001}), rel=0.02
    )


def test_a_burst_takes_the_same_whatever_the_number_of_instants():
    times = np.linspace(0.0, 1.0, 501)
    burst = 900.0 * np.sin(2.0 * np.pi * 37.0 * times)
    table = [[float(a), float(b)] for a, b in zip(times, burst, strict=True)]
    small = {"load": table, "elements": 20, "substructures": 2}
    few, many = (friction_of({**small, "instants": count}) for count in (101, 501))
    assert few == pytest.approx(many, rel=1e-9)
    assert few > 1.0


def noisy(points: int) -> list[list[float]]:
    """A pull of a slow wave, one narrow peak, and noise that hardly counts."""
    times = np.linspace(0.0, 1.0, points)
    wave = 900.0 * np.sin(2.0 * np.pi * times)
    wave += 0.2 * np.random.default_rng(1).uniform(-1.0, 1.0, points)
    wave[points // 3] = 1400.0
    return [[float(a), float(b)] for a, b in zip(times, wave, strict=True)]


def test_a_large_problem_keeps_the_peaks_of_a_long_table_and_says_what_it_leaves_out():
    table = noisy(60_001)
    settings = CATALOGUE["bar"].settings.checked({"load": table})
    times, given = np.array(table).T
    seen = settings.path("load")
    assert settings.n_nodes * settings.n_instants < EVERY_POINT
    assert (seen.max(), seen.min()) == (given.max(), given.min())
    off = np.abs(np.interp(times, settings.times(), seen) - given).max()
    assert 0.0 < off <= THINNED * np.ptp(given)
    (message,) = left_out(settings)
    assert message.startswith("load: 5")
    assert "of 60001 points are left out" in message


def test_memory_is_checked_for_the_instants_that_there_are():
    jagged = [[n / 60_000.0, 900.0 * (n % 2)] for n in range(60_001)]
    elements = LARGEST_FIELD // 60_001 + 1
    with pytest.raises(SettingError, match="60001"):
        CATALOGUE["bar"].settings.checked({"load": jagged, "elements": elements})


def test_a_peak_on_a_long_problem_reaches_its_reference():
    changes = {"top_tangential_load": [[0.3, 0.0], [0.5005, 2e-5], [0.5007, -1e-5], [0.501, 0.0]]}
    small = {"elements": 16, "elements_up": 8, "substructures": 2, "instants": 17}
    settings = CATALOGUE["block"].settings.checked({**small, **changes})
    problem = discretise(settings)
    force = solve(problem, method_of(settings), watch=False).iterate.contact_force
    assert force == pytest.approx(reference_of(problem).contact_force, abs=1e-8 * abs(force).max())


def test_a_fluid_spreads_alike_on_even_and_uneven_instants():
    place, even = np.linspace(0.0, 3.0, 7), np.linspace(0.0, 1.0, 201)
    given = np.interp(even, [0.0, 0.3, 0.35, 1.0], [2.0, 1.0, 3.0, 0.0])
    some = np.sort(np.concatenate([[0, 60, 70, 200], np.arange(3, 200, 11)]))
    uneven = spread(place, even[some], given[some], 0.5)
    np.testing.assert_allclose(uneven, spread(place, even, given, 0.5)[:, some], atol=1e-9)
