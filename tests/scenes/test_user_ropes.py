"""A rope of one's own is given by its rows:
wires, diameter, lay angle and Young's modulus.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refusal
from ropes import exact_of, moment_of, settings_of, solved

from solver import solve
from solver.files.saved import settings_from_command
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.scenes.rope import RopeSettings

OWN = [[1, 6e-3, 0.0, 1.1e11], [5, 5e-3, 15.0, 2e11], [12, 4e-3, -25.0, 7e10]]
"""A core of another metal, a layer with room beside its wires, a softer one the other
way round."""


@pytest.mark.parametrize("preset", ["mooring", "seven-wire", "conductor"])
def test_rows_of_a_named_construction_are_that_construction(preset: str) -> None:
    named = settings_of(construction=preset, tension=5e4)
    rows = settings_of(construction=named.points("construction"), tension=5e4)
    for name in ("stiffness", "stuck_bending", "slipping_bending", "diameter", "wires"):
        assert getattr(rows.section, name) == pytest.approx(
            getattr(named.section, name), rel=1e-9
        )
    bounds = [
        [float(wire.strength) for wire in s.structure().wires] for s in (named, rows)
    ]
    assert bounds[1] == pytest.approx(bounds[0], rel=1e-9)


def test_the_axial_stiffness_of_a_rope_is_the_sum_over_its_wires() -> None:
    expected = sum(
        n * young * np.pi * d**2 / 4.0 * np.cos(np.radians(lay)) ** 3
        for n, d, lay, young in OWN
    )
    assert settings_of(construction=OWN).section.stiffness == pytest.approx(
        expected, rel=1e-12
    )


def test_first_bending_and_cycle_of_a_user_rope_meet_the_closed_form() -> None:
    settings = settings_of(construction=OWN, tension=3e4, load="ramp", curvature=0.2)
    scene, found = solved(settings)
    exact = exact_of(settings).moment(scene.curvature)
    assert np.abs(moment_of(scene, found) - exact).max() < 0.005 * exact[-1]
    assert found.status.any()
    settings = settings_of(construction=OWN, tension=3e4, curvature=0.1, instants=301)
    scene, found = solved(settings)
    moment = moment_of(scene, found)
    last = slice(60, None)
    loop = abs(float(np.trapezoid(moment[last], scene.curvature[last])))
    path = 0.1 * np.cos(np.linspace(0.0, 4.0 * np.pi, 801))
    exact = exact_of(settings).along(path)
    energy = abs(float(np.trapezoid(exact[400:], path[400:])))
    assert loop == pytest.approx(energy, rel=0.01)


def test_latin_certifies_a_user_rope_near_a_clamp() -> None:
    clamped = {"bending": "clamp", "elements": 24, "instants": 31, "substructures": 4}
    settings = settings_of(construction=OWN, tension=3e4, **clamped)
    solution = solve(discretise(settings), method_of(settings), watch=False)
    assert solution.is_certified
    assert len(solution.iterate.problem.contacts) == 17


def test_a_rope_is_read_from_a_file_with_units_and_a_message(
    tmp_path: Path,
) -> None:
    path = tmp_path / "rope.csv"
    path.write_text(
        "layer,E [GPa],wires,diameter [mm],lay angle [deg]\n"
        "core,110,1,6,0\ninner,200,5,5,15\nouter,70,12,4,-25\n"
    )
    settings, messages = settings_from_command("rope", [f"construction={path}"])
    np.testing.assert_allclose(
        np.array(settings.values()["construction"]), OWN, rtol=1e-12
    )
    assert messages["construction"] == (
        "wires, diameter in mm, lay angle in deg, E in GPa, 3 points, from 70 to 200 "
        "GPa; passed over: 'layer'"
    )


def changed(row: int, column: int, value: float) -> list[list[float]]:
    rows: list[list[float]] = [list(one) for one in OWN]
    rows[row][column] = value
    return rows


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (changed(2, 0, 19), "row 3: 19 wires of 0.004 m at -25° do not fit"),
        (changed(1, 0, 2.5), "row 2: wires is 2.5, give a whole number from 1 to 500"),
        (
            changed(1, 1, -5e-3),
            "row 2: diameter is -0.005, give a number from 1e-6 m to 1 m",
        ),
        (
            changed(1, 2, 90.0),
            "row 2: lay angle is 90, give a number from -75 ° to 75 °",
        ),
        (changed(1, 2, 0.0), "row 2: give a lay angle of 0.1° or more in size"),
        (changed(2, 3, 0.0), "row 3: modulus is 0, give a number from 1 Pa to 1e18 Pa"),
        (changed(0, 0, 7), "row 1 is the core"),
        (OWN[:1], "add a row for a layer"),
        ([row[:3] for row in OWN], "row 1 must be 4 numbers"),
        ("spiral", "choose a preset, or give a table"),
    ],
)
def test_bad_rows_of_a_rope_are_refused(rows: Any, words: str) -> None:
    text = refusal(lambda: RopeSettings.checked({"construction": rows}))
    assert words in text
    assert "wires" in text


def test_as_many_wires_fit_as_have_room_beside_each_other() -> None:
    """Seven equal wires touch; laid at an angle the outer ones want a thicker core."""
    lay = 17.0
    equal = [[1, 5e-3, 0.0, 2e11], [6, 5e-3, lay, 2e11]]
    text = refusal(lambda: RopeSettings.checked({"construction": equal}))
    assert "do not fit" in text
    section = settings_of(construction=[[1, 5.4e-3, 0.0, 2e11], *equal[1:]]).section
    assert section.smallest_radius(0) <= section.radii[0]
    straight = settings_of(construction=[equal[0], [6, 5e-3, 0.2, 2e11]]).section
    assert straight.smallest_radius(0) == pytest.approx(straight.radii[0], rel=1e-4)
