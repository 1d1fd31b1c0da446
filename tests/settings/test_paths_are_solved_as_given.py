"""Paths over time and tables along a body are solved as given, or a run says not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.latin import Ending, solve
from solver.reference.assembly import assembled_stiffness
from solver.reference.closed_forms.fluid_driven_slip import spread
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.settings.load import EVERY_POINT, THINNED
from solver.settings.values import SettingError

SPIKE = [[0.0, 0.0], [0.5, 0.0], [0.503, 1200.0], [0.506, 0.0], [1.0, 0.0]]
SCENES_AND_PATHS: list[tuple[str, str]] = []
for scene_name, scene_kind in CATALOGUE.items():
    definitions = scene_kind.definitions()
    SCENES_AND_PATHS += [
        (scene_name, path)
        for path in scene_kind.checked({}).paths
        if hasattr(definitions[path], "presets")
    ]
"""Paths that may be tables, of scenes by default."""


HELD_ENDS: dict[str, dict[str, Any]] = {
    "strand": {"grip": "displacement"},
    "belt": {"driven": "moved"},
}
"""Settings of scenes with which no pull is too large."""


def drawn(scene: str, name: str, seed: int) -> Any:
    """Settings with a table of wide and narrow swings, of other times than instants."""
    random = np.random.default_rng([seed, *name.encode()])
    settings = CATALOGUE[scene].checked(HELD_ENDS.get(scene, {}))
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


@pytest.mark.parametrize(("scene", "name"), SCENES_AND_PATHS)
def test_a_table_is_seen_with_its_extremes_its_integral_and_its_turning_points(
    scene, name
):
    settings = drawn(scene, name, 1)
    times, given = np.array(getattr(settings, name)).T
    seen = settings.path(name)
    instants = settings.times()
    assert (seen.max(), seen.min()) == (given.max(), given.min())
    np.testing.assert_array_equal(turns(seen), turns(given))
    ends = [(0.0 - times[0]) * -given[0], (settings.duration - times[-1]) * given[-1]]
    assert np.trapezoid(seen, instants) == pytest.approx(
        np.trapezoid(given, times) + sum(ends)
    )
    assert list(settings.left_out()) == []


def of_preset(scene: str, name: str, preset: str, **changes: Any) -> Any:
    """Settings with a preset, of ends that are held, so that no pull is too large."""
    grip = HELD_ENDS.get(scene, {})
    return CATALOGUE[scene].checked({name: preset, "seed": 3} | grip | changes)


@pytest.mark.parametrize(("scene", "name"), SCENES_AND_PATHS)
def test_a_preset_is_seen_with_its_extremes_whatever_the_number_of_instants(
    scene, name
):
    fine = np.linspace(0.0, 1.0, 96_001)
    for preset, path in CATALOGUE[scene].definitions()[name].presets.items():
        whole = path.value(fine, 3)
        for number in (1, 2, 7, 38, 41):
            settings = of_preset(scene, name, preset, instants=number)
            given = whole * settings.size_of(name)
            seen = settings.path(name)
            if (
                number == 1
            ):  # it begins at rest: what is between that and its end, is passed
                given, seen = (np.concatenate([[0.0], one]) for one in (given, seen))
            else:
                steps = np.diff(settings.times())
                assert steps.max() <= settings.duration / (number - 1) * (1.0 + 1e-9)
            size = np.abs(given).max()
            assert seen.max() == pytest.approx(given.max(), abs=1e-4 * size), (
                preset,
                number,
            )
            assert seen.min() == pytest.approx(given.min(), abs=1e-4 * size), (
                preset,
                number,
            )
            assert settings.n_instants >= number


def friction_of(changes: dict[str, Any]) -> float:
    """Solve the bar; give what friction takes, J."""
    settings = CATALOGUE["bar"].checked(changes)
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


def noisy(points: int) -> list[list[float]]:
    """A pull of a slow wave, one narrow peak, and noise that hardly counts."""
    times = np.linspace(0.0, 1.0, points)
    wave = 900.0 * np.sin(2.0 * np.pi * times)
    wave += 0.2 * np.random.default_rng(1).uniform(-1.0, 1.0, points)
    wave[points // 3] = 1400.0
    return [[float(a), float(b)] for a, b in zip(times, wave, strict=True)]


def test_a_large_problem_keeps_the_peaks_of_a_long_table_and_says_what_it_leaves_out():
    table = noisy(60_001)
    settings = CATALOGUE["bar"].checked({"load": table})
    times, given = np.array(table).T
    seen = settings.path("load")
    assert settings.n_nodes * settings.n_instants < EVERY_POINT
    assert (seen.max(), seen.min()) == (given.max(), given.min())
    off = np.abs(np.interp(times, settings.times(), seen) - given).max()
    assert 0.0 < off <= THINNED * np.ptp(given)
    (message,) = settings.left_out()
    assert message.startswith("load: 5")
    assert "of 60001 points are left out" in message


def test_a_fluid_spreads_alike_on_even_and_uneven_instants():
    place = np.linspace(0.0, 3.0, 7)
    even = np.linspace(0.0, 1.0, 201)
    given = np.interp(even, [0.0, 0.3, 0.35, 1.0], [2.0, 1.0, 3.0, 0.0])
    some = np.sort(np.concatenate([[0, 60, 70, 200], np.arange(3, 200, 11)]))
    uneven = spread(place, even[some], given[some], 0.5)
    np.testing.assert_allclose(
        uneven, spread(place, even, given, 0.5)[:, some], atol=1e-9
    )


ASPERITY = [[0.0, 1e-5], [0.05, 1e-5], [0.0503, 0.0], [0.0506, 1e-5], [0.1, 1e-5]]
PRESSED = {
    "top": "displacement",
    "top_normal_displacement": -5e-6,
    "top_tangential_displacement": 0.0,
    "instants": 5,
}


def profile(seed: int, length: float, *, least: float = 0.0) -> list[list[float]]:
    """A table of factors with wide and narrow peaks, wherever the nodes are."""
    random = np.random.default_rng(seed)
    middles = random.uniform(0.02, 0.98, 5) * length
    halves = 10.0 ** random.uniform(-5.0, -2.0, 5) * length
    places = np.unique(np.concatenate([middles - halves, middles, middles + halves]))
    factors = random.uniform(least, 2.0, len(places))
    return [[float(a), float(b)] for a, b in zip(places, factors, strict=True)]


def integral(*tables: list[list[float]], over: np.ndarray) -> float:
    """Integrate a product of tables by many middles of each of their pieces."""
    points = np.concatenate([np.array(table)[:, 0] for table in tables])
    ends = np.union1d(points[(points > over[0]) & (points < over[1])], over)
    share = (np.arange(200) + 0.5) / 200
    where = ends[:-1, None] + share * np.diff(ends)[:, None]
    values = np.prod(
        [np.interp(where, *np.transpose(table)) for table in tables], axis=0
    )
    return float((values.mean(axis=1) * np.diff(ends)).sum())


@pytest.mark.parametrize("seed", range(4))
def test_all_friction_of_the_bar_is_there_whatever_the_mesh(seed):
    length = 2.0
    mu = profile(seed, length)
    pressure = profile(seed + 100, length)
    whole = 0.3 * 5000.0 * integral(mu, pressure, over=np.array([0.0, length]))
    for elements in (3, 50, 400):
        changes = {
            "friction_profile": mu,
            "pressure_profile": pressure,
            "length": length,
        }
        settings = CATALOGUE["bar"].checked(
            {**changes, "elements": elements, "substructures": 1}
        )
        problem = discretise(settings)
        (law,) = problem.contacts.values()
        total = settings.structure().strength @ law.weights
        assert total == pytest.approx(whole, rel=1e-4)


def test_all_strength_of_a_fault_is_there_whatever_the_mesh():
    table = profile(5, 600.0, least=0.9)
    whole = 0.6 * 1e7 * integral(table, over=np.array([0.0, 600.0]))
    for elements in (12, 48):
        values = {"normal_profile": table, "elements": elements}
        settings = CATALOGUE["fault"].checked({**values, "overpressure": 0.0})
        (law,) = discretise(settings).contacts.values()
        nodal = settings.largest_friction(settings.places)[:, 0]
        assert nodal @ law.by_point(law.weights[:, None])[:, 0] == pytest.approx(
            whole, rel=1e-4
        )


def test_a_notch_between_nodes_stretches_the_bar():
    notched = [[0.0, 1.0], [0.511, 1.0], [0.512, 0.01], [0.513, 0.01], [0.514, 1.0]]
    ends = []
    for elements in (10, 1000):
        values = {
            "section_profile": notched,
            "friction": 0.0,
            "load": "ramp",
            "instants": 2,
        }
        settings = CATALOGUE["bar"].checked({**values, "elements": elements})
        ends.append(reference_of(discretise(settings)).displacement[-1, -1])
    assert ends[0] == pytest.approx(ends[1], rel=1e-9)


def pressed(elements: int) -> tuple[float, list[str]]:
    """Press the block on an asperity; give the force, and what is said."""
    values = {**PRESSED, "gap": ASPERITY, "elements": elements}
    settings = CATALOGUE["block"].checked(values)
    solution = solve(discretise(settings), method_of(settings), watch=False)
    assert solution.status.ending is Ending.CONVERGED
    force = solution.iterate.contact("support").normal_force[:, -1].sum()
    return abs(float(force)), list(settings.left_out())


def test_an_asperity_between_nodes_touches_and_the_mesh_that_sees_it_is_named():
    coarse, said = pressed(48)
    (message,) = said
    assert "332 elements would see it" in message
    fine, nothing = pressed(332)
    assert nothing == []
    # A point carries in the plane as 1 / log(size): half as much again on shares 7
    # times as wide.
    assert fine < coarse < 1.5 * fine


SMALL = {"elements": 24, "substructures": 4, "instants": 31}
GRADED = [[0.0, 100.0], [0.4, 1.0], [1.0, 3.0]]
NOTCHED = [[0.0, 1.0], [0.51, 1.0], [0.511, 0.01], [0.512, 0.01], [0.513, 1.0]]


def varying(**changes):
    return BarSettings.checked({"method": "paper"} | SMALL | changes)


@pytest.mark.parametrize("table", [GRADED, NOTCHED], ids=["graded", "notched"])
def test_every_element_is_as_stiff_as_all_that_lies_in_it(table):
    chosen = varying(section_profile=table, length=2.0)
    scene = chosen.structure()
    fine = np.linspace(0.0, 2.0, 24 * 20_000 + 1)
    middles = 0.5 * (fine[1:] + fine[:-1])
    compliance = np.mean(
        1.0 / np.interp(middles, *np.transpose(table)).reshape(24, -1), axis=1
    )
    assert scene.stiffness * scene.section == pytest.approx(
        chosen.young * chosen.section / compliance, rel=2e-4
    )
    stiffness = assembled_stiffness(discretise(chosen))
    assert -stiffness.diagonal(1) / 24 == pytest.approx(scene.section)
    assert abs(stiffness.sum(axis=1)).max() <= 1e-13 * abs(stiffness).max()


@pytest.mark.parametrize(
    ("table", "allowed"),
    [
        ([[0.0, 1.0], [1.0, 0.0]], "from 1e-8 to 1e8"),
        ([[0.0, 1.0], [1.0, -2.0]], "from 1e-8 to 1e8"),
        ([[0.0, 1e-9]], "from 1e-8 to 1e8"),
        ([[0.0, 1e-4], [1.0, 1.1e4]], "at most 1e8 times"),
        ("gap", "uniform, rising, falling"),
    ],
)
def test_a_section_that_vanishes_or_is_too_uneven_is_refused(table, allowed):
    with pytest.raises(SettingError, match="section_profile") as refusal:
        varying(section_profile=table)
    assert allowed in str(refusal.value)
    varying(section_profile=[[0.0, 1e-4], [1.0, 1e4]])
