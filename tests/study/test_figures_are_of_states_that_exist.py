"""Figures of a run are the largest of states that exist, by the catalogue's names."""

from __future__ import annotations

import functools
import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.frame import LOCAL, Frame, Selection
from app.messages import Needs
from app.state import PageState
from app.status import OWNER, figures_line, status_line
from app.worker.sampling import Sampler
from solver.commands.cli import main
from solver.laws import OPEN
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE
from solver.settings.values import SettingError
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.finished import FinishedRun, figures_of
from solver.study.scene_run import finished_run

COARSE = {"elements": 8, "elements_up": 4, "substructures": 1}
STIFFNESS = 210e9 * 3.14e-6
LOOSENED = {
    "load": "hold",
    "peak": 600.0,
    "pressure_load": [[0, 5000], [0.5, 5000], [1, 3750]],
    "elements": 100,
    "substructures": 1,
    "instants": 21,
}
"""A bar whose pressure goes, to three quarters, while its load stands."""
WARM = {
    "right_end": "free",
    "load": [[0, 0], [1, 0]],
    "temperature": 30.0,
    "instants": 11,
}
FALLS = {
    "top": "pulled",
    "traction": 8e5,
    "bricks": 2,
    "courses": 2,
    "instants": 11,
}
"""A wall that tips over while it is pulled."""


@functools.cache
def _made(scene: str, changes: str) -> FinishedRun:
    settings = CATALOGUE[scene].checked(json.loads(changes))
    return finished_run(settings, errors=False)


def ran(scene: str, **changes: Any) -> FinishedRun:
    return _made(scene, json.dumps(changes))


def given(changes: dict[str, Any]) -> list[str]:
    """Arguments of a command that give settings."""
    arguments = []
    for name, value in changes.items():
        if isinstance(value, str):
            text = value
        else:
            text = json.dumps(value)
        arguments += ["--set", f"{name}={text}"]
    return arguments


def printed(
    capsys: pytest.CaptureFixture[str], scene: str, *options: str, **changes: Any
) -> Any:
    main(["run", scene, *given(changes), "--json", *options])
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize("instants", [12, 20, 33])
def test_a_block_on_a_slope_is_held_up_to_the_angle_of_friction(instants: int) -> None:
    """Friction at the steepest slope is mu W cos(atan(mu)), whatever the instants."""
    run = ran("incline", slope_load="ramp", instants=instants, **COARSE)
    exact = 0.3 * 1000.0 * math.cos(math.atan(0.3))
    assert reading("holding_force")(run) == pytest.approx(exact, rel=5e-4)


@pytest.mark.parametrize("instants", [12, 20, 33])
def test_a_block_that_is_pulled_back_is_held_most_where_the_ground_is_level(
    instants: int,
) -> None:
    run = ran("incline", instants=instants, **COARSE)
    assert reading("holding_force")(run) == pytest.approx(300.0, rel=1e-9)


@pytest.mark.parametrize("instants", [8, 21])
def test_a_block_that_slides_while_it_is_pressed_is_held_by_all_that_presses_in_the_end(
    instants: int,
) -> None:
    pushed = {
        "left": "pushed",
        "left_normal_displacement": 3e-4,
        "left_normal_load": "ramp",
    }
    pressed = {
        "gap": "flat",
        "top": "traction",
        "top_normal_traction": -1e7,
        "friction": 0.3,
    }
    run = ran("block", **pushed, **pressed, instants=instants, **COARSE)
    assert reading("holding_force")(run) == pytest.approx(0.3 * 1e7 * 0.1, rel=1e-6)


def test_of_friction_that_changes_with_slip_no_force_is_said_to_hold() -> None:
    changes = {"friction_law": "slip-dependent", "friction_ratio": 1.5}
    run = ran("bar", **changes, elements=20, substructures=1, instants=11)
    assert math.isnan(reading("holding_force")(run))
    assert math.isnan(reading("holding_friction")(run))


def test_where_friction_goes_under_a_steady_load_the_displacement_is_the_last() -> None:
    """F^2 / (2 E A q), with the last q, of a bar that slips no farther than at once."""
    run = ran("bar", **LOOSENED)
    displacement, force = figures_of(run)
    exact = 600.0**2 / (2.0 * STIFFNESS * 0.3 * 3750.0)
    assert displacement.largest == pytest.approx(exact, rel=0.01)
    assert displacement.instant == len(run.problem.instants) - 1
    assert displacement.last == displacement.largest
    assert force.largest == pytest.approx(600.0)
    assert reading("end_displacement")(run) == displacement.largest
    assert reading("displacement")(run) == displacement.largest
    assert reading("displacement@0.5")(run) == pytest.approx(0.75 * exact, rel=0.01)


def test_the_key_figures_of_a_fault_that_slips_are_not_those_before_it_slips() -> None:
    run = ran("fault", elements=24, elements_up=12, substructures=1, instants=6)
    displacement, _ = figures_of(run)
    assert displacement.largest > 0.0
    assert displacement.largest == run.displacement.max()


def test_a_bar_that_slips_as_a_whole_slips_at_all_points_that_can() -> None:
    run = ran(
        "bar", load="ramp", peak=1600.0, elements=20, substructures=1, instants=11
    )
    assert run.problem.is_held.any()
    assert reading("slipped_share")(run) == 1.0


def test_displacement_and_force_are_told_where_the_loop_has_them(
    capsys: pytest.CaptureFixture[str],
) -> None:
    asked = "displacement,force,slipped_share,dissipation,peak_displacement"
    warm = printed(capsys, "bar", "--no-reference", "--of", asked, **WARM)
    assert "force" not in warm
    assert warm["quantities"]["force"] is None
    assert warm["strain"] == pytest.approx(1.2e-5 * 30.0, rel=0.1)
    assert warm["displacement"] == pytest.approx(
        warm["quantities"]["peak_displacement"]
    )
    pulled = printed(capsys, "bar", "--no-reference", "--of", asked, **LOOSENED)
    for found in (warm, pulled):
        for name in asked.split(",")[:-1]:
            assert found.get(name) == found["quantities"][name]
    told = pulled["key_figures"]["displacement"]
    assert (told["largest"], told["largest_at"]) == (pulled["displacement"], 1.0)
    strand = printed(capsys, "rope", "--no-reference", elements=10, instants=11)
    assert {"curvature", "moment"} < strand.keys()
    assert not {"displacement", "force"} & strand.keys()


def test_what_is_asked_twice_is_told_twice(capsys: pytest.CaptureFixture[str]) -> None:
    """Of options that were given again the last one alone counted."""
    asked = ("--of", "peak_slip,force", "--of", "stiffness")
    found = printed(capsys, "bar", "--no-reference", *asked, elements=10, instants=11)
    assert list(found["quantities"]) == ["peak_slip", "force", "stiffness"]


@pytest.mark.parametrize("options", [{}, {"finish": "none", "max_iterations": 3}])
def test_of_a_wall_that_falls_no_state_is_told_that_does_not_exist(
    capsys: pytest.CaptureFixture[str], options: dict[str, Any]
) -> None:
    """The search alone need not know; then the reference does."""
    asked = "force,peak_displacement,holding_force,iterations"
    found = printed(capsys, "wall", "--of", asked, **FALLS, **options)
    falls = reference_of(ran("wall", **FALLS).problem).collapse
    assert falls is not None
    assert found["lost_from"] == ran("wall", **FALLS).problem.instants[falls.instant]
    assert not {"displacement", "force", "slipped_share", "dissipation"} & found.keys()
    assert found["key_figures"] == {}
    values = found["quantities"]
    assert values.pop("iterations") > 0
    assert set(values.values()) == {None}


def test_a_wall_that_falls_has_no_distance_to_a_measured_loop(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    times = ran("wall", **FALLS).problem.instants
    rows = [f"{time},{1e-4 * time},{1e5 * time}" for time in times]
    file = tmp_path / "loop.csv"
    file.write_text("\n".join(["time [s],displacement [m],force [N]", *rows]))
    assert main(["compare", "wall", *given(FALLS), "--with", str(file), "--json"]) == 1
    printed = capsys.readouterr()
    found = json.loads(printed.out)
    assert (found["distance"], found["distance_given"]) == (None, None)
    assert "no solution" in printed.err


@pytest.mark.parametrize("moved", [1e-6, 1e-4])
def test_a_block_that_touches_at_a_point_and_that_nothing_presses_has_no_contact(
    moved: float,
) -> None:
    """Forces inside elements that move leave rounding where the block touches."""
    mesh = {"elements": 16, "elements_up": 8, "instants": 21}
    changes = {**mesh, "top_tangential_displacement": moved}
    run = ran("block", top_normal_displacement=0.0, **changes)
    assert run.solution.is_certified
    assert (run.iterate.status == OPEN).all()
    assert not run.iterate.contact_force.any()
    names = "force", "dissipation", "slipped_share", "peak_slip", "contact_width"
    assert [reading(name)(run) for name in names] == [0.0] * 5
    # A block that is pressed by a millionth of its shear rubs at that point.
    pressed = ran("block", top_normal_displacement=-1e-6 * moved, **changes)
    assert pressed.solution.is_certified
    assert reading("force")(pressed) > 0.0
    assert reading("slipped_share")(pressed) > 0.0


def test_no_force_has_no_sign() -> None:
    run = ran("fault", shear_stress=0.0, overpressure=0.0, instants=5, **COARSE)
    _, force = figures_of(run)
    for value in (force.largest, reading("force")(run)):
        assert math.copysign(1.0, value) == 1.0
        assert value == 0.0


def test_removed_names_of_quantities_are_refused_with_the_new_ones() -> None:
    for name, new in (("energy", "dissipation"), ("slipping", "slipped_share")):
        assert name not in QUANTITIES
        with pytest.raises(SettingError, match=f"{name} is called {new}"):
            reading(name)


def shown(run: FinishedRun) -> Frame:
    sampler = Sampler(run.problem, run.settings, 1)
    return sampler.frame(
        run.iterate, run.solution.records, run.solution.status, Needs()
    )


def details(frame: Frame) -> str:
    state = PageState(frame.run.settings)
    state.param.update(frame=frame, newest=frame)
    return status_line(state)


def test_the_page_has_the_largest_and_the_last_value_beside_that_of_the_instant() -> (
    None
):
    frame = shown(ran("bar", **LOOSENED))
    line = figures_line(frame, Selection(phase=0.5))
    assert "End displacement <b>182 µm</b>" in line
    told = "largest 243 µm at 1 s, last 243 µm"
    assert f'title="{told}"' in line
    assert f"End displacement: {told}" in details(frame)


def test_the_page_tells_no_figures_of_a_wall_that_falls() -> None:
    frame = shown(ran("wall", **FALLS))
    line = figures_line(frame, Selection(phase=1.0))
    assert line.count("<b>–</b>") == 4
    assert "no solution" in line
    assert ", last " not in details(frame)


def test_figures_beside_a_local_stage_say_whose_they_are() -> None:
    frame = shown(ran("bar", **LOOSENED))
    assert OWNER in figures_line(frame, Selection(stage=LOCAL))
    assert OWNER not in figures_line(frame, Selection())


def test_before_the_first_estimate_no_error_is_told() -> None:
    frame = shown(ran("bar", **LOOSENED))
    unknown = np.full(len(frame.history["iteration"]), np.nan)
    errors = {"error_force": unknown, "estimated_error": unknown}
    early = replace(frame, status=None, residual=None, history=frame.history | errors)
    (line,) = re.findall('<div class="progress.*', details(early))
    assert "iteration" in line
    assert "wrong" not in line
