"""A run says what it will take, and beside its result what one has to know."""

from __future__ import annotations

import json
import re
from functools import cache
from typing import Any

import numpy as np
import pytest
from small_scenes import SMALL

from solver.commands.cli import main
from solver.latin import run_cost as costs
from solver.latin.run_cost import LARGE, LONG, RunCost, run_cost
from solver.reference.incremental import reference_of
from solver.reference.other_positions import other_positions
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.scenes.remarks import (
    MOST_GROWTH,
    beyond_small_strain,
    contact_growth,
    largest_strain,
    remarks_on,
)
from solver.study.quantities.finished import FinishedRun
from solver.study.scene_run import finished_run

TALL = {
    "gap": "flat",
    "length": 0.05,
    "height": 0.1,
    "elements": 6,
    "elements_up": 12,
    "top": "dragged",
    "top_normal_traction": -1e6,
    "instants": 21,
    "top_tangential_displacement": 1e-4,
    "top_tangential_load": "ramp",
}
PRESSED = {
    "gap": "parabola",
    "radius": 30.0,
    "friction": 0.5,
    "top_normal_displacement": -2e-5,
    "elements": 96,
    "elements_up": 16,
}


@cache
def _ran(scene: str, given: tuple[tuple[str, Any], ...]) -> FinishedRun:
    settings = CATALOGUE[scene].checked(dict(given))
    return finished_run(settings, errors=False, indicators=False)


def ran(scene: str, **given: Any) -> FinishedRun:
    return _ran(scene, tuple(given.items()))


def remarks(run: FinishedRun) -> list[str]:
    return remarks_on(run.settings, run.iterate)


@pytest.mark.parametrize("scene", CATALOGUE)
def test_nothing_is_remarked_on_a_scene_as_it_stands(scene: str) -> None:
    assert remarks(ran(scene)) == []


def test_a_tall_block_whose_top_is_dragged_tips_at_the_force_of_its_lever_arms() -> (
    None
):
    run = ran("block", **TALL, friction=0.9)
    assert run.force[-1] == pytest.approx(1e6 * 0.05 * 0.05 / (2.0 * 0.1), rel=1e-9)
    (remark,) = remarks(run)
    assert "tips" in remark
    assert remarks(ran("block", **TALL, friction=0.2)) == []


def test_a_contact_that_grows_by_leaps_has_friction_in_a_saw_and_says_so() -> None:
    """With steps in which it grows by a point at each end, neighbours rub alike."""
    leaps = []
    saws = []
    for instants in (41, 161):
        run = ran("block", **PRESSED, instants=instants)
        contact = run.iterate.contact("support")
        friction = contact.tangential_force[:, (instants - 1) // 5]
        rubbing = friction[np.flatnonzero(friction)[4:-4]]
        saws.append(np.abs(np.diff(rubbing, 2)).max() / np.abs(friction).max())
        leaps.append(contact_growth(run.iterate))
        assert any("raise instants" in one for one in remarks(run)) == (instants == 41)
    assert leaps[0] > MOST_GROWTH >= leaps[1]
    assert saws[0] > 2.0 * saws[1]


def test_the_command_prints_remarks_with_the_result(
    capsys: pytest.CaptureFixture[str],
) -> None:
    changes = [f"--set={name}={value}" for name, value in TALL.items()]
    command = ["run", "block", *changes, "--set", "friction=0.9", "--no-reference"]
    assert main(command) == 0
    shown = capsys.readouterr().out
    assert "\nremarks              From top_normal_traction = -200000 Pa" in shown
    assert (
        "and top_tangential_displacement = 5e-6 m (0.05 times its largest value)"
        in shown
    )
    assert ", at 0.05 s, the body tips" in shown
    assert main([*command, "--json"]) == 0
    assert "tips" in json.loads(capsys.readouterr().out)["remarks"][0]


SOFT = {
    "bar": {"young": 2.1e6},
    "strand": {"young": 2.1e6},
    "block": {"top_normal_displacement": -1e-2},
    "fault": {"young": 6e7},
    "incline": {"young": 1e5, "weight": 1e4},
    "layers": {"deflection": 0.2},
    "wall": {"young": 1e7},
    "rope": {"curvature": 30.0},
    "arch": {"young": 1e6},
    "belt": {"young": 1e7},
    "bundle": {"displacement": 1e-3},
    "mesh": {"young": 1e7},
}


def beyond(scene: str, changes: dict[str, object]) -> str | None:
    settings = CATALOGUE[scene].checked(SMALL[scene] | changes)
    problem = discretise(settings)
    displacement = reference_of(problem).displacement
    return beyond_small_strain(settings.structure(), problem, displacement)


@pytest.mark.parametrize("scene", CATALOGUE)
def test_scenes_by_default_are_within_small_strain_and_soft_ones_beyond(scene):
    assert beyond(scene, {}) is None
    message = beyond(scene, SOFT[scene])
    assert message is not None
    assert message.startswith("this model does not hold: strains or slopes reach")


@pytest.mark.parametrize("wrap", [180.0, 900.0])
def test_a_belt_that_slides_far_along_its_drum_is_strained_by_its_tension(wrap):
    changes = {
        "driven": "moved",
        "displacement": 0.03,
        "pull_load": "jack",
        "wrap": wrap,
        "instants": 5,
    }
    settings = CATALOGUE["belt"].checked(SMALL["belt"] | {"elements": 60} | changes)
    structure = settings.structure()
    problem = discretise(settings)
    answer = reference_of(problem)
    # It turns by 0.3 with the drum, which strains nothing.
    found = largest_strain(structure, problem, answer.displacement)
    tension = np.abs(structure.tensions(problem, answer)).max()
    assert found == pytest.approx(tension / (settings.young * settings.section))
    assert 0.03 / settings.drum_radius > 0.05


def test_the_strain_of_a_bar_is_force_over_stiffness():
    values = {"friction": 0.0, "load": "ramp", "peak": 900.0}
    settings = CATALOGUE["bar"].checked(values)
    problem = discretise(settings)
    found = largest_strain(
        settings.structure(), problem, reference_of(problem).displacement
    )
    assert found == pytest.approx(900.0 / (210e9 * 3.14e-6))


@pytest.mark.parametrize(
    ("changes", "is_strained"),
    [({"pressure": 1e9, "young": 1e6}, True), ({"pressure": 1.0}, False)],
)
def test_a_bar_is_strained_by_ground_that_settles_only_if_it_sticks(
    changes, is_strained
):
    """Bars that stuck were said to have no strain, those that slipped the ground's."""
    free = {"peak": 0.0, "left_end": "free", "right_end": "free", "settlement": 0.1}
    sizes = {"elements": 10, "instants": 5, "substructures": 1}
    settings = CATALOGUE["bar"].checked(free | sizes | changes)
    iterate = finished_run(settings, errors=False).iterate
    remarks = " ".join(remarks_on(settings, iterate))
    assert ("strains or slopes reach 0.1" in remarks) is is_strained


def test_a_rope_that_slides_freely_may_be_as_far_away_as_its_points():
    """The angle it turns by was told: ten times as much on a drum of 0.1 m."""
    free = {"friction": 0.0, "pull": 0.0, "elements": 20, "instants": 5}
    settings = CATALOGUE["belt"].checked(free)
    iterate = finished_run(settings, errors=False).iterate
    others = other_positions(
        iterate.problem, iterate.displacement, iterate.contact_force
    )
    inside = iterate.problem.inside
    away = 0.0
    for instant, other in others.items():
        apart = (other - iterate.displacement[:, instant])[:, None]
        still = inside.displacement(0.0 * apart, [0])
        moved = inside.displacement(apart, [0]) - still
        away = max(away, float(np.abs(moved).max()))
    (remark,) = remarks_on(settings, iterate)
    told = float(re.search(r"up to (\S+) m away", remark)[1])
    assert told == pytest.approx(away, rel=0.02)


def test_the_slope_of_a_sheared_body_is_its_shear_and_sliding_is_none():
    settings = CATALOGUE["block"].checked(SMALL["block"])
    structure = settings.structure()
    problem = discretise(settings)
    along = problem.inside.directions[:, :1]
    ones = np.ones((1, problem.n_instants))
    assert largest_strain(structure, problem, along * ones) < 1e-12
    settings = CATALOGUE["fault"].checked({**SMALL["fault"], "friction": 10.0})
    problem = discretise(settings)
    strain = largest_strain(
        settings.structure(), problem, reference_of(problem).displacement
    )
    assert strain == pytest.approx(3.6e6 / (6e10 / 2.5), rel=1e-6)


def test_the_command_says_that_a_hundred_giganewtons_are_no_small_strain(capsys):
    command = [
        "run",
        "bar",
        "--set",
        "peak=1e11",
        "--set",
        "max_iterations=20",
        "--no-reference",
    ]
    main([*command, "--json"])
    (remark,) = json.loads(capsys.readouterr().out)["remarks"]
    assert "does not hold" in remark
    main(command)
    assert f"remarks              {remark}" in capsys.readouterr().out


LONG_ONES: dict[str, dict[str, Any]] = {
    "strand": {"wires": 200},
    "layers": {"layers": 50},
    "bar": {"elements": 16_000, "instants": 1500},
}


def cost(scene: str, *, with_reference: bool = True, **values: Any) -> RunCost:
    settings = CATALOGUE[scene].checked(values)
    return run_cost(
        discretise(settings), method_of(settings), with_reference=with_reference
    )


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_the_scenes_defaults_are_neither_long_nor_large(scene: str) -> None:
    run = ran(scene)
    method = method_of(run.settings)
    found = run_cost(run.problem, method, with_reference=True)
    assert 0.0 < found.seconds < 0.15 * LONG
    assert 0.0 < found.memory < 0.1 * LARGE


def test_shifts_of_rigid_bodies_count_where_they_are_made() -> None:
    far: dict[str, Any] = {"displacement": 2e-3, "multiscale": True}
    seconds = cost("arch", **far).seconds
    for plain in ({"displacement": 5e-5}, {"multiscale": False}):
        assert seconds > 2.0 * cost("arch", **(far | plain)).seconds


@pytest.mark.parametrize("scene", list(LONG_ONES))
def test_long_and_large_runs_are_announced(scene: str) -> None:
    assert cost(scene, **LONG_ONES[scene]).is_large


@pytest.mark.parametrize(
    ("scene", "name", "sizes"),
    [
        ("bar", "elements", (50, 400, 3200)),
        ("bar", "instants", (51, 401, 3201)),
        ("strand", "wires", (3, 9, 27)),
        ("layers", "layers", (4, 8, 16)),
        ("block", "elements", (24, 48, 96)),
    ],
)
def test_more_of_anything_takes_more(
    scene: str, name: str, sizes: tuple[int, ...]
) -> None:
    found = [cost(scene, **{name: size}) for size in sizes]
    assert found[0].seconds < found[1].seconds < found[2].seconds
    assert found[0].memory < found[1].memory < found[2].memory


@pytest.mark.parametrize("options", [[], ["--no-reference"]])
def test_the_command_announces_a_run_in_one_line(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
) -> None:
    monkeypatch.setattr(costs, "LONG", 0.0)
    small = ["--set", "layers=3", "--set", "elements=24", "--set", "instants=5"]
    assert main(["run", "layers", *small, *options]) in (0, 1)
    line = capsys.readouterr().err
    assert line.startswith("slipfront: this will take about ")
    assert line.count("\n") == 1


def test_the_announcement_says_what_no_reference_would_save(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(costs, "LONG", 0.0)
    values = [
        "--set",
        "elements=96",
        "--set",
        "instants=5",
        "--set",
        "max_iterations=1",
    ]
    main(["run", "layers", *values])
    assert (
        "for the reference, which --no-reference leaves out" in capsys.readouterr().err
    )


def test_times_are_written_with_the_one_digit_that_they_have() -> None:
    texts = [
        str(RunCost(seconds, 2.34e9, 0.0))
        for seconds in (4.4, 34.0, 81.0, 99.0, 7400.0)
    ]
    assert texts == [
        "4 s and 2 GB",
        "30 s and 2 GB",
        "80 s and 2 GB",
        "2 min and 2 GB",
        "2 h and 2 GB",
    ]


def test_a_certified_arch_whose_hinges_are_free_says_that_it_is_one_of_several() -> (
    None
):
    free = ran("arch", voussoirs=7, thickness=0.4, displacement=-4e-4)
    (remark,) = remarks(free)
    assert "one of several solutions" in remark
    assert remarks(ran("arch", voussoirs=7, thickness=0.4, displacement=-1e-5)) == []
