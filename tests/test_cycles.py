"""A run is cut into the cycles of its load, and a word for them is said only where it is earned."""

from __future__ import annotations

import functools
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver.scenes import CATALOGUE
from solver.study.quantities.cycles import LoadCycles, cycles_in, cycles_of, turning_points
from solver.study.quantities.finished import FinishedRun, finished_run
from solver.study.quantities.quantities import QUANTITIES, reading
from solver.study.quantities.shakedown import fate_of

STIFFNESS, BOUND = 210e9 * 3.14e-6, 1500.0
TIMES = {"load": "cycles", "instants": 161}
SMALL = {"elements": 20, "substructures": 2}
LESSON = Path(__file__).parents[1] / "app/lessons/shakedown.toml"
ROCKED = {
    "gap": "flat",
    "elements": 16,
    "elements_up": 8,
    "substructures": 1,
    "instants": 121,
    "top": "traction",
    "body_force_y": -2e8,
    "top_normal_traction": -1e6,
    "top_normal_load": "cycles",
    "top_tangential_load": "hold",
}
"""A block that its weight holds down, rocked from above."""


@functools.cache
def made(scene: str, changes: tuple[tuple[str, Any], ...]) -> FinishedRun:
    settings = CATALOGUE[scene].settings.checked(dict(changes))
    return finished_run(settings, errors=False, indicators=False)


def ran(scene: str, **changes: Any) -> FinishedRun:
    return made(scene, tuple(changes.items()))


def cut(run: FinishedRun) -> LoadCycles:
    return cycles_of(run.settings, run.iterate)


def of(slip: list[list[float]], net: list[list[float]] | None = None, **more: Any) -> LoadCycles:
    """Make cycles of points whose slip, and what is left of it, is given."""
    slips = np.array(slip, dtype=float)
    values = {
        "ends": list(range(slips.shape[1] + 1)),
        "energy": slips.sum(axis=0),
        "slip": slips,
        "net": np.zeros_like(slips) if net is None else np.array(net, dtype=float),
        "work": slips,
        "before": np.ones(len(slips)),
        "is_repeated": True,
    }
    return LoadCycles(**{**values, **more})


def word(cycles: LoadCycles) -> str | None:
    fate = fate_of(cycles)
    return None if fate is None else fate.word


@pytest.mark.parametrize(
    ("slip", "said"),
    [
        ([[2, 1, 0, 0]], "elastic shakedown"),
        ([[2, 1, 0.5]], "shakedown with slip that dies"),
        ([[8, 4, 1]], "shakedown with slip that dies"),
        ([[2, 2, 2]], "steady slip"),
        ([[9, 2, 2, 2]], "steady slip"),
        # It falls, but to what it will not fall below; or too slowly to tell.
        ([[2, 1.5, 1.25]], None),
        ([[1, 0.97, 0.941]], None),
        ([[1, 2, 3]], None),
        ([[2, 2]], None),
        # Each point for itself: what is largest says nothing of where.
        ([[2, 1, 2], [1, 2, 1]], None),
    ],
)
def test_slip_is_called_what_it_has_been_for_three_cycles(
    slip: list[list[float]], said: str | None
) -> None:
    assert word(of(slip)) == said


@pytest.mark.parametrize(
    ("net", "said"),
    [
        ([1, 1, 1], "ratcheting"),
        ([-1, -1, -1], "ratcheting"),
        ([1, 0.1, 0.01], "steady slip"),
        ([1, -1, 1], "steady slip"),
        ([1, 0.8, 0.6], "steady slip"),
    ],
)
def test_only_what_goes_on_one_way_ratchets(net: list[float], said: str) -> None:
    fate = fate_of(of([[2, 2, 2]], [net]))
    assert fate is not None
    assert (fate.word, fate.net) == (said, net[-1])


def test_nothing_is_said_of_what_never_slips_or_of_cycles_that_differ() -> None:
    still = of([[0, 0, 0]])
    assert word(still) == "elastic shakedown"
    assert word(of([[0, 0, 0]], before=np.zeros(1))) is None
    assert word(of([[2, 2, 2]], is_repeated=False)) is None


@pytest.mark.parametrize("peak", [600.0, 900.0, 1200.0])
def test_every_cycle_of_the_bar_takes_what_the_closed_form_says(peak: float) -> None:
    run = ran("bar", peak=peak, **TIMES)
    cycles = cut(run)
    exact = 2.0 * peak**3 / (3.0 * STIFFNESS * BOUND)
    np.testing.assert_allclose(cycles.energy, exact, rtol=3e-3)
    assert [reading(f"dissipation@{n}")(run) for n in range(1, 6)] == pytest.approx(cycles.energy)
    assert math.isnan(reading("dissipation@6")(run))
    # The end moves by u to one side and the other, and so twice to and fro.
    assert cycles.slip[-1] == pytest.approx(4.0 * peak**2 / (2.0 * STIFFNESS * BOUND), rel=1e-6)


def test_work_along_the_bar_is_friction_times_slip() -> None:
    """Within the front, at mu p: w(x) = mu p s(x), and s falls with the square of the distance."""
    cycles = cut(ran("bar", peak=900.0, **TIMES))
    x = np.linspace(0.0, 1.0, 51)
    slip = 4.0 * BOUND / (2.0 * STIFFNESS) * np.maximum(x - 1.0 + 900.0 / BOUND, 0.0) ** 2
    weights = np.full(51, 0.02)
    weights[[0, -1]] = 0.01
    np.testing.assert_allclose(cycles.slip[:, -1], slip, atol=2e-3 * slip.max())
    np.testing.assert_allclose(cycles.work[:, -1], BOUND * weights * cycles.slip[:, -1], rtol=1e-9)
    assert np.abs(cycles.net).max() < 1e-12 * slip.max()


def lesson(**changes: Any) -> FinishedRun:
    settings = tomllib.loads(LESSON.read_text(encoding="utf-8"))["settings"]
    frozen = {name: _frozen(value) for name, value in settings.items()}
    return ran("block", **{**frozen, **changes})


def _frozen(value: Any) -> Any:
    return tuple(tuple(one) for one in value) if isinstance(value, list) else value


def test_the_lesson_on_shakedown_shows_slip_that_dies_and_slip_that_does_not() -> None:
    dying, steady = fate_of(cut(lesson())), fate_of(cut(lesson(friction=0.15)))
    assert dying is not None
    assert steady is not None
    assert (dying.word, steady.word) == ("shakedown with slip that dies", "steady slip")
    assert dying.ratio < 0.9 < 0.99 < steady.ratio < 1.01
    assert fate_of(cut(lesson(friction=0.6))) is None


def test_a_rocked_block_walks_the_way_it_is_sheared() -> None:
    """Below its friction at every instant, and yet farther in each cycle, at all points alike."""
    moved = []
    for shear in (2e6, -2e6):
        run = ran(
            "block",
            **ROCKED,
            top_normal_slope=math.copysign(10.0, shear),
            top_tangential_traction=shear,
        )
        cycles = cut(run)
        assert word(cycles) == "ratcheting"
        assert np.ptp(cycles.net[:, -1]) < 0.3 * np.abs(cycles.net[:, -1]).max()
        moved.append(cycles.net[:, -1])
    assert moved[0].min() > 0.0
    np.testing.assert_allclose(moved[1], -moved[0][::-1], rtol=1e-6)
    assert reading("ratchet")(run) == np.abs(moved[1]).max()


def test_rocked_less_it_comes_to_rest() -> None:
    cycles = cut(ran("block", **ROCKED, top_normal_slope=5.0))
    assert word(cycles) == "shakedown with slip that dies"
    shares = cycles.slip.max(axis=0)[1:] / cycles.slip.max(axis=0)[:-1]
    assert shares.max() < 0.4
    assert shares[-1] == pytest.approx(shares[-2], abs=1e-3)


def test_friction_that_still_hardens_gets_no_word_until_it_has_hardened() -> None:
    law = {"friction_law": "slip-dependent", "friction_ratio": 3.0}
    words = [
        word(cut(ran("bar", peak=900.0, slip_length=length, **law, **TIMES, **SMALL)))
        for length in (1e-3, 1e-5)
    ]
    assert words == [None, "steady slip"]


COMES_BACK = {"fault": {"injection_load": "pulses"}}
"""Of scenes whose usual load does not, one that does."""


@pytest.mark.parametrize("scene", CATALOGUE)
def test_every_scene_has_as_many_cycles_as_it_is_asked_for(scene: str) -> None:
    """One more of the preset is always so many cycles more of the load."""
    settings = CATALOGUE[scene].settings
    values = {"instants": 401, **COMES_BACK.get(scene, {})}
    counted = [cycles_in(settings.checked({**values, "cycles": n})) for n in (2, 3, 9)]
    more = counted[1] - counted[0]
    assert more >= 1
    assert counted[2] == counted[0] + 7 * more


def test_what_does_not_come_back_is_not_repeated() -> None:
    bar = CATALOGUE["bar"].settings
    for load in ("ramp", "hold", "random"):
        assert not bar.checked({"load": load}).applies("cycles")
        paths = [bar.checked({"load": load, "cycles": n}).path("load") for n in (1, 7)]
        np.testing.assert_array_equal(*paths)


def test_a_load_that_stands_still_has_no_cycles() -> None:
    """Rounding makes a constant weight swing by a few digits of the last place."""
    path = 1e3 + np.array([0.0, 1e-13, 0.0, -1e-13] * 5)
    assert not turning_points(path)
    assert cycles_in(CATALOGUE["incline"].settings.checked({})) == 0


def test_a_load_that_grows_or_wanders_is_not_repeated() -> None:
    growing = tuple((0.1 * n, n * (-1.0) ** n * 50.0) for n in range(11))
    assert not cut(ran("bar", load=growing, **SMALL)).is_repeated
    assert cut(ran("bar", peak=900.0, **TIMES)).is_repeated


@pytest.mark.parametrize(("peak", "share"), [(750.0, 0.5), (1600.0, 1.0)])
def test_the_share_that_slides_is_how_far_the_front_comes(peak: float, share: float) -> None:
    run = ran("bar", peak=peak, elements=100, substructures=2, **TIMES)
    found = reading("sliding_share")(run)
    assert found == (share if share == 1.0 else pytest.approx(share, abs=0.02))


NAMES = "cycle_energy_ratio", "ratchet", "sliding_share", "shakedown_factor"


@pytest.mark.parametrize("name", NAMES)
def test_a_quantity_of_cycles_applies_where_a_run_has_it(name: str) -> None:
    cases = [
        ran("bar", **SMALL),
        ran("bar", peak=900.0, **TIMES),
        ran("strand", **TIMES, **SMALL),
        lesson(),
        ran("bar", peak=900.0, friction_law="slip-dependent", **TIMES, **SMALL),
        lesson(gap="parabola"),
    ]
    for run in cases:
        assert QUANTITIES[name].applies(run.settings) == (not math.isnan(reading(name)(run)))
