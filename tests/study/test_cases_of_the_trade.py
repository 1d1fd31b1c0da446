"""Cases of the trade are runs with a known number, and files anybody may write."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from solver.commands.cli import main
from solver.scenes import CATALOGUE
from solver.settings.values import SettingError
from solver.study import proof
from solver.study.quantities import reading
from solver.study.scene_run import finished_run
from solver.study.trade_case import case_from_file, cases_by_name

CASES = list(cases_by_name().values())
OWN = """scene = "bar"
load = [[0, 0], [1, 900]]
{setting}
[case]
order = 1
title = "Mine"
question = "How far does it move?"
source = "From first principles."
quantity = "{quantity}"
known = {known}
tolerance = {tolerance}
formula = "u = F^2 / (2 E S μ p)"
how = "Equilibrium of what slips."
change = "The load."
controls = {controls}
"""
USUAL = {
    "setting": "",
    "quantity": "end_displacement",
    "known": "4.095e-4",
    "tolerance": "0.001",
    "controls": '["load"]',
}


def written(folder: Path, **changes: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(OWN.format(**(USUAL | changes)), encoding="utf-8")
    return path


CHANGED: list[tuple[str, dict[str, Any], str, float, float]] = [
    ("lap-joint", {"peak": 4e3}, "dissipation@2", 0.1249 * 56.44e-3, 0.1251 * 56.44e-3),
    ("lap-joint", {"pressure": 1.2e6}, "dissipation@2", 0.0, 0.51 * 56.44e-3),
    ("press-fit", {"friction": 0.099}, "slipped_share", 0.98, 1.0),
    ("shakedown", {"peak": 10.4e3}, "dissipation@5", 1e-3, 1.0),
    ("cattaneo", {"friction": 0.4}, "dissipation@1", 0.0, 0.4),
    ("broken-wire", {"pressure": 2500}, "recovery_length", 0.398, 0.402),
    ("rope-clamp", {"curvature": 0.016}, "wire_slip", 0.0, 0.0),
    ("rope-clamp", {"curvature": 0.018}, "wire_slip", 1e-9, 1.0),
    ("rail", {"temperature_load": "triangle"}, "peak_displacement", 17.0e-3, 17.1e-3),
    ("pile", {"instants": 41, "elements": 200}, "axial_force", -1.131e6, -1.1e6),
    ("tendon", {"friction": 0.05}, "axial_force@1", 0.0, 2.29e6),
    ("pull-out", {"length": 0.6}, "peak_friction", 1.2 * 159.1e3, 1.27 * 159.1e3),
    ("elastic-bond", {"cohesion": 0.84e6}, "slipped_share", 0.0, 0.0),
    ("elastic-bond", {"cohesion": 0.8e6}, "slipped_share", 1e-9, 1.0),
    ("crate", {"height": 0.7}, "peak_friction", 0.399 * 840, 0.401 * 840),
    ("fault", {"shear_stress": 4.8e6}, "slipped_share", 0.51, 1.0),
    ("heap-of-logs", {"unit_weight": 24e3}, "peak_pressure", 2.32e6, 2.46e6),
]
"""What the cases say of their first changes: settings, quantity, and both ends of its
value."""


@pytest.mark.parametrize(("name", "changes", "quantity", "low", "high"), CHANGED)
def test_the_first_change_does_what_a_case_says(name, changes, quantity, low, high):
    (case,) = [case for case in CASES if case.name == name]
    run = finished_run(case.settings.replace(**changes), errors=False, indicators=False)
    assert low <= reading(quantity)(run) <= high


def test_cases_are_part_of_the_proof() -> None:
    assert {case.title for case in CASES} <= {known.title for known in proof.cases()}


def test_cases_have_orders_of_their_own_and_a_source() -> None:
    assert [case.order for case in CASES] == list(range(1, len(CASES) + 1))
    assert len({case.title for case in CASES}) == len({case.picture for case in CASES})
    for case in CASES:
        assert case.question.count("?") == 1 or case.question.endswith("?"), case.name
        assert len(case.source) > 20, case.name
        assert case.controls, case.name


def test_a_case_is_a_file_of_settings_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path)
    assert main(["run", str(path), "--json", "--no-reference"]) == 0
    assert json.loads(capsys.readouterr().out)["scene"] == "bar"
    case = case_from_file(path)
    assert case.picture == CATALOGUE["bar"].icon
    assert (case.name, case.known, case.controls) == ("mine", 4.095e-4, ("load",))


def test_the_proof_takes_a_case_of_ones_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path)
    assert main(["proof", str(path), "--out", str(tmp_path / "proof")]) == 0
    assert "1 of 1 numbers hold." in capsys.readouterr().out
    path.write_text(
        path.read_text(encoding="utf-8").replace("4.095e-4", "4.2e-4"), "utf-8"
    )
    assert main(["proof", str(path), "--out", str(tmp_path / "proof")]) == 1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"setting": "peek = 3"}, ["peek = 3", "did you mean peak ("]),
        ({"quantity": "luck"}, ["case: quantity", "end_displacement"]),
        ({"known": "0"}, ["case: known = 0", "finite"]),
        ({"known": "nan"}, ["case: known = NaN", "finite"]),
        ({"tolerance": "2"}, ["case: tolerance = 2", "below 1"]),
        ({"controls": '["peak"]'}, ["case: controls", "does something here"]),
        ({"controls": '"load"'}, ['case: controls = "load"', "a list"]),
        ({"setting": "[picture]"}, ["picture"]),
    ],
)
def test_errors_in_a_case_are_reported_with_file_and_place(
    tmp_path: Path, changes: dict[str, str], words: list[str]
) -> None:
    with pytest.raises(SettingError) as refused:
        case_from_file(written(tmp_path, **changes))
    message = str(refused.value)
    assert message.startswith("mine.toml: ")
    assert "\n" not in message
    assert not [word for word in words if word not in message], message


def test_the_strength_at_which_a_glued_rod_slips_is_that_of_shear_lag() -> None:
    case = cases_by_name()["elastic-bond"]
    given = case.settings.values()
    stiffness = given["young"] * given["section"]
    decay = math.sqrt(given["tangential_stiffness"] / stiffness)
    # Friction along the rod grows as sinh, and is largest at the loaded end.
    strength = decay * given["peak"] * math.tanh(decay * given["length"])
    assert f"Below {1e-6 * strength:.2f} MN/m of strength" in case.change
    for share, slips in ((0.99, True), (1.01, False)):
        changed = case.settings.replace(cohesion=share * strength)
        slipped = reading("slipped_share")(finished_run(changed))
        assert (slipped > 0.0) is slips


def test_a_file_of_settings_alone_is_no_case(tmp_path: Path) -> None:
    path = tmp_path / "settings.toml"
    path.write_text('scene = "bar"\n', encoding="utf-8")
    with pytest.raises(SettingError, match=r"write \[case\] below the settings"):
        case_from_file(path)
