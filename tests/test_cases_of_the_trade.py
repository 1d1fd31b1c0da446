"""Cases of the trade are runs whose known number comes out, and files that anybody may write."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from solver.cli import main
from solver.definitions import SettingError
from solver.scenes import CATALOGUE
from solver.study.cases.case import Case, all_cases, case_from_file
from solver.study.proof import report
from solver.study.proof.case import known_case, rows_of

CASES = all_cases()
OWN = """scene = "bar"
load = [[0, 0], [1, 900]]
{setting}
[case]
order = 1
title = "Mine"
question = "How far does it move?"
source = "From first principles."
quantity = "{quantity}"
known = 4.095e-4
tolerance = {tolerance}
formula = "u = F^2 / (2 E S μ p)"
how = "Equilibrium of what slips."
change = "The load."
controls = {controls}
"""
USUAL = {
    **{"setting": "", "quantity": "end_displacement", "tolerance": "0.001"},
    "controls": '["load"]',
}


def written(folder: Path, **changes: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(OWN.format(**{**USUAL, **changes}), encoding="utf-8")
    return path


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_known_number_of_a_case_comes_out(case: Case) -> None:
    (row,) = rows_of(known_case(case))
    assert row.holds, (row.exact, row.found)


def test_they_join_the_proof() -> None:
    assert {case.title for case in CASES} <= {known.title for known in report.cases()}


def test_there_is_one_of_every_order_and_each_says_who_knows() -> None:
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
    assert case.picture == CATALOGUE["bar"].emblem
    assert (case.name, case.known, case.controls) == ("mine", 4.095e-4, ("load",))


def test_the_proof_takes_a_case_of_ones_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path)
    assert main(["proof", str(path), "--out", str(tmp_path / "proof")]) == 0
    assert "1 of 1 numbers hold." in capsys.readouterr().out
    path.write_text(path.read_text(encoding="utf-8").replace("4.095e-4", "4.2e-4"), "utf-8")
    assert main(["proof", str(path), "--out", str(tmp_path / "proof")]) == 1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"setting": "peek = 3"}, ["peek = 3", "did you mean peak?"]),
        ({"quantity": "luck"}, ["case: quantity", "end_displacement"]),
        ({"tolerance": "2"}, ["case: tolerance = 2", "below 1"]),
        ({"controls": '["peak"]'}, ["case: controls", "does something here"]),
        ({"controls": '"load"'}, ['case: controls = "load"', "a list"]),
        ({"setting": "[picture]"}, ["picture"]),
    ],
)
def test_what_is_wrong_with_a_case_is_said_with_its_file_and_place(
    tmp_path: Path, changes: dict[str, str], words: list[str]
) -> None:
    with pytest.raises(SettingError) as refused:
        case_from_file(written(tmp_path, **changes))
    message = str(refused.value)
    assert message.startswith("mine.toml: ")
    assert "\n" not in message
    assert not [word for word in words if word not in message], message


def test_a_file_of_settings_alone_is_no_case(tmp_path: Path) -> None:
    path = tmp_path / "settings.toml"
    path.write_text('scene = "bar"\n', encoding="utf-8")
    with pytest.raises(SettingError, match=r"write \[case\] below the settings"):
        case_from_file(path)
