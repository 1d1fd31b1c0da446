"""Settings of plane scenes say what is meant, are refused, and reach the files."""

from __future__ import annotations

import json

import numpy as np
import pytest

from solver.commands.cli import main
from solver.scenes import CATALOGUE, discretise
from solver.scenes.block import BlockSettings
from solver.scenes.layers import LayersSettings
from solver.settings.values import SettingError

PRESSED = {"top": "traction", "top_normal_traction": -7e7}
SMALL = {"elements": 8, "elements_up": 4, "instants": 11}
DRAGGED = {
    "gap": "flat",
    "height": 0.3,
    "top": "dragged",
    "top_normal_traction": -1e6,
    "top_tangential_displacement": 0.0,
}


def refusal(kind, **values):
    with pytest.raises(SettingError) as caught:
        kind.checked(values)
    return str(caught.value)


@pytest.mark.parametrize(
    ("side", "sign"), [("left", -1.0), ("right", 1.0), ("top", 1.0)]
)
def test_normal_values_are_positive_outward_and_tangential_ones_along_the_axis(
    side, sign
):
    settings = BlockSettings.checked(
        {
            side: "displacement",
            f"{side}_normal_displacement": 2e-5,
            f"{side}_normal_load": "ramp",
            f"{side}_tangential_displacement": 3e-5,
            f"{side}_tangential_load": "ramp",
            f"{side}_tangential_slope": 0.5,
        }
    )
    given = settings.side(side)
    if side == "top":
        normal = given.y
        tangential = given.x
    else:
        normal = given.x
        tangential = given.y
    assert normal.mean[-1] == pytest.approx(sign * 2e-5)
    assert tangential.mean[-1] == pytest.approx(3e-5)
    assert tangential.slope[-1] == pytest.approx(0.5 * 3e-5)
    assert not normal.slope.any()


def test_only_settings_of_the_kind_of_a_side_apply():
    settings = BlockSettings.checked({"left": "pushed", "right": "free"})
    applies = {name for name in settings.definitions() if settings.applies(name)}
    assert {"left_normal_displacement", "left_tangential_traction"} <= applies
    assert not {"left_normal_traction", "left_tangential_displacement"} & applies
    assert not [name for name in applies if name.startswith("right_")]
    assert "start" not in applies


@pytest.mark.parametrize(
    ("values", "word"),
    [
        ({**PRESSED, "top_normal_traction": 7e7}, "lift it off"),
        ({**PRESSED, "top_tangential_traction": 3e7}, "friction cannot hold"),
        ({**PRESSED, "top_normal_slope": 3.1}, "tips over"),
        ({**PRESSED, "top_normal_slope": -3.1}, "tips over"),
        ({**DRAGGED, "body_force_x": 4e6, "friction": 0.1}, "tips over"),
        (
            {"top": "pushed", "friction": 0.0, "top_tangential_traction": 1e6},
            "friction cannot",
        ),
        (
            {"top": "free", "body_force_x": 1.0, "body_force_y": -2.0},
            "friction cannot hold",
        ),
    ],
)
def test_loads_that_contact_alone_cannot_hold_are_refused(values, word):
    assert word in refusal(BlockSettings, **values)


@pytest.mark.parametrize("shear", [0.8e6, 1e6, 5e6])
def test_a_tall_block_is_said_to_tip_when_it_does_and_not_when_it_would_slide(shear):
    """A sheared block tips at b / (2 h) of the pressing force, and slides at mu."""
    tall = {
        "gap": "flat",
        "length": 0.05,
        "height": 0.1,
        "friction": 0.9,
        "instants": 1001,
    }
    sheared = {"top_tangential_traction": shear, "top_tangential_load": "ramp"}
    pressed = {"top": "traction", "top_normal_load": ((0.0, -1e6),)}
    message = refusal(BlockSettings, **tall, **sheared, **pressed)
    assert "tips over" in message
    assert "take a longer or lower body" in message
    told = float(message.split("from ")[1].split(" s on")[0])
    assert told == pytest.approx(0.25e6 / shear, abs=2e-3)
    at_once = {"top_tangential_load": ((0.0, shear),)}
    assert "tips over" in refusal(BlockSettings, **(tall | sheared | pressed | at_once))


@pytest.mark.parametrize(
    ("kind", "values", "name"),
    [
        (BlockSettings, {"substructures": 49}, "substructures"),
        (LayersSettings, {"substructures_up": 3}, "substructures_up"),
        (
            BlockSettings,
            {"elements": 2000, "elements_up": 1000, "substructures": 99},
            "instants",
        ),
        (
            BlockSettings,
            {"elements": 400, "elements_up": 400, "instants": 2},
            "parts smaller",
        ),
        (BlockSettings, {"start": "nested"}, "start"),
        (BlockSettings, {"gap": [[0.1, 0.0], [0.0, 0.0]]}, "must increase"),
        (BlockSettings, {"radius": 0.0}, "radius"),
        (LayersSettings, {"layers": 1}, "layers"),
        (LayersSettings, {"thickness": 1e-6, "length": 1e3}, "thickness"),
        (BlockSettings, {"height": 1e4}, "no side is more than 10000 times the other"),
    ],
)
def test_inconsistent_settings_are_refused_by_name(kind, values, name):
    assert name in refusal(kind, **values)


@pytest.mark.parametrize("scene", ["block", "layers"])
def test_a_run_from_the_command_line_writes_every_contact(scene, tmp_path, capsys):
    file = tmp_path / "result.npz"
    changes = [f"{name}={value}" for name, value in SMALL.items()]
    command = ["run", scene, "--json", "--out", str(file)]
    for change in changes:
        command += ["--set", change]
    assert main(command) == 0
    assert json.loads(capsys.readouterr().out)["error_force"] < 1e-2
    kept = np.load(file)
    nodes = len(kept["x"])
    instants = len(kept["t"])
    assert kept["displacement"].shape == (nodes, 2, instants)
    names = {name.split("/")[1] for name in kept if name.startswith("interface/")}
    assert names == set(discretise(CATALOGUE[scene].checked(SMALL)).contacts)
    for name in names:
        points = len(kept[f"interface/{name}/points"])
        for field in ("normal_force", "tangential_force", "gap", "slip", "status"):
            assert kept[f"interface/{name}/{field}"].shape == (points, instants)
        pressing = kept[f"interface/{name}/normal_force"]
        assert pressing.min() > -1e-3 * pressing.max()
