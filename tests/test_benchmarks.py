"""`benchmark --ahead` and `--cycles` bill LATIN beside the incremental solver."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from typing import Any

import pytest

from solver import report_commands
from solver.cli import main
from solver.latin import iterations, solve
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.benchmarks import ahead, cycles
from solver.study.benchmarks.ahead import GOAL
from solver.study.benchmarks.ahead_problems import GROUPS, PROBLEMS, AheadProblem, chosen_problems
from solver.study.benchmarks.cycles_problems import (
    FEW,
    MANY,
    CyclesProblem,
)
from solver.study.benchmarks.cycles_problems import (
    PROBLEMS as CYCLE_PROBLEMS,
)

TINY = {"elements": 24, "instants": 21, "substructures": 3}
ASKED: dict[str, Any] = {"scene": "bar", "changes": TINY, "repeats": 2}


@pytest.fixture(scope="module")
def found() -> ahead.Ahead:
    """Give what is found of a tiny bar."""
    return ahead.Ahead(**ahead.answer(ASKED))


def test_the_iterations_are_those_of_runs(found: ahead.Ahead) -> None:
    settings = CATALOGUE["bar"].settings.checked(TINY)
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    own = settings.replace(finish="none", accuracy=1e-6)
    errors = [one.error_force for one in solve(problem, method_of(own), distance=distance).records]
    first = next(number for number, error in enumerate(errors, 1) if error <= ahead.GOAL)
    assert found.own_iterations == first
    by_default = solve(problem, method_of(settings), distance=distance)
    assert found.iterations == len(by_default.records)
    assert found.found_at == pytest.approx(by_default.records[-2].error_force, rel=1e-6)
    assert found.known_iterations >= first
    assert found.known_by == "certified"


def test_the_command_prints_a_row_and_writes_it(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tiny = AheadProblem("bar", "tiny bar", "bar", TINY)
    monkeypatch.setattr(report_commands, "chosen_problems", lambda *_, **__: [tiny])
    assert main(["benchmark", "--ahead", "--repeats", "1", "--out", str(tmp_path / "new")]) == 0
    assert sum(line.startswith("tiny bar ") for line in capsys.readouterr().out.splitlines()) == 1
    with (tmp_path / "new" / "ahead.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["problem"] == "tiny bar"
    assert float(row["latin"]) > 0.0
    assert float(row["incremental"]) > 0.0


def test_every_problem_has_settings_that_are_allowed_and_a_group() -> None:
    for one in PROBLEMS:
        CATALOGUE[one.scene].settings.checked(one.changes)
    assert {one.group for one in chosen_problems(None, with_large=True)} == set(GROUPS)
    small = chosen_problems("layers", with_large=False)
    assert small
    assert not any(one.is_large for one in small)
    assert {one.scene for one in small} == {"layers"}


BLOCK = CYCLE_PROBLEMS[0]
TINY_BLOCK = replace(
    BLOCK, label="tiny", changes={"elements": 16, "elements_up": 8, "substructures": 2}
)


@pytest.fixture(scope="module")
def of_cycles() -> dict[str, Any]:
    """Give what two cycles of a tiny block take."""
    names = [way.name for way in cycles.WAYS]
    asked = {"scene": "block", "changes": TINY_BLOCK.settings(2), "repeats": 1, "ways": names}
    return cycles.answer(asked)


def test_iterations_are_those_to_the_goal(of_cycles: dict[str, Any]) -> None:
    settings = CATALOGUE["block"].settings.checked(TINY_BLOCK.settings(2))
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    for iterate in iterations(problem, method_of(settings)):
        if distance.of_friction_force(iterate) <= GOAL:
            break
    assert of_cycles["taken"]["LATIN"]["iterations"] == iterate.number


def test_all_ways_are_billed(of_cycles: dict[str, Any]) -> None:
    assert of_cycles["incremental"] > 0.0
    assert set(of_cycles["taken"]) == {way.name for way in cycles.WAYS}
    for own in of_cycles["taken"].values():
        assert own["seconds"] > 0.0
        assert 0.0 < own["local"] < 1.0
    held = {name: own["megabytes"] for name, own in of_cycles["taken"].items()}
    assert held["LATIN in slabs"] < held["LATIN"]
    assert of_cycles["taken"]["LATIN-PGD"]["modes"] > 0


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
    monkeypatch.setattr("solver.study.benchmarks.cycles_problems.PROBLEMS", (TINY_BLOCK,))
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
    for one in CYCLE_PROBLEMS:
        for number in (own for own in MANY if own <= one.most):
            settings = CATALOGUE[one.scene].settings.checked(one.settings(number))
            assert settings.instants == 40 * number + 1
