"""`benchmark --cycles` bills LATIN and LATIN-PGD for many cycles, at once and in slabs."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from typing import Any

import pytest

from solver.cli import main
from solver.latin import iterations
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.benchmarks import cycles
from solver.study.benchmarks.ahead import GOAL
from solver.study.benchmarks.cycles_problems import FEW, GROUPS, MANY, PROBLEMS, CyclesProblem

BLOCK = PROBLEMS[0]
TINY = replace(BLOCK, label="tiny", changes={"elements": 16, "elements_up": 8, "substructures": 2})


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    """Give what two cycles of a tiny block take."""
    names = [way.name for way in cycles.WAYS]
    asked = {"scene": "block", "changes": TINY.settings(2), "repeats": 1, "ways": names}
    return cycles.answer(asked)


def test_iterations_are_those_to_the_goal(found: dict[str, Any]) -> None:
    settings = CATALOGUE["block"].settings.checked(TINY.settings(2))
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    for iterate in iterations(problem, method_of(settings)):
        if distance.of_friction_force(iterate) <= GOAL:
            break
    assert found["taken"]["LATIN"]["iterations"] == iterate.number


def test_all_ways_are_billed(found: dict[str, Any]) -> None:
    assert found["incremental"] > 0.0
    assert set(found["taken"]) == {way.name for way in cycles.WAYS}
    for own in found["taken"].values():
        assert own["seconds"] > 0.0
        assert 0.0 < own["local"] < 1.0
    held = {name: own["megabytes"] for name, own in found["taken"].items()}
    assert held["LATIN in slabs"] < held["LATIN"]
    assert found["taken"]["LATIN-PGD"]["modes"] > 0


def test_what_does_not_come_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cycles, "MOST", 2)
    asked = {"scene": "block", "changes": TINY.settings(1), "repeats": 1, "ways": ["LATIN"]}
    assert cycles.answer(asked)["taken"] == {}


def row(number: int, *seconds: float) -> cycles.Cycles:
    """Make a row; the incremental solver takes 8 s."""
    taken = {
        way.name: replace(cycles.NOT_THERE, seconds=own)
        for way, own in zip(cycles.WAYS, seconds, strict=True)
    }
    return cycles.Cycles(number, 8.0, taken)


def test_the_command_prints_rows_and_writes_them_with_a_chart(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[list[str]] = []

    def measure(
        problem: CyclesProblem, number: int, repeats: int, ways: list[str]
    ) -> cycles.Cycles:
        asked.append(ways)
        return row(number, 4.0, math.nan if number > 1 else 2.0, 1.0, 3.0)

    monkeypatch.setattr("solver.study.benchmarks.cycles_report.cycles_of", measure)
    monkeypatch.setattr("solver.study.page.renderer", lambda: None)
    monkeypatch.setattr("solver.study.benchmarks.cycles_problems.PROBLEMS", (TINY,))
    out = tmp_path / "new"
    assert main(["benchmark", "--cycles", "--only", "block", "--out", str(out)]) == 0
    assert [len(ways) for ways in asked] == [4, 4, 3, 3]
    printed = capsys.readouterr().out
    assert sum(line.startswith(tuple(map(str, FEW))) for line in printed.splitlines()) >= len(FEW)
    with (out / "cycles.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 5 * len(FEW)
    last = {one["way"]: one["seconds"] for one in rows if one["cycles"] == str(FEW[-1])}
    assert last["incremental solver"] == "8.0"
    assert last["LATIN-PGD"] == ""
    assert "tiny" in (out / "cycles.html").read_text("utf-8")


def test_every_problem_is_allowed_for_any_number_of_cycles() -> None:
    for one in PROBLEMS:
        for number in (own for own in MANY if own <= one.most):
            settings = CATALOGUE[one.scene].settings.checked(one.settings(number))
            assert settings.instants == 40 * number + 1


def test_other_groups_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["benchmark", "--cycles", "--only", "layers"]) == 2
    assert " or ".join(GROUPS) in capsys.readouterr().err
