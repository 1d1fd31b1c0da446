"""`benchmark --ahead` sets LATIN beside the incremental solver, each on its own."""

from __future__ import annotations

import csv
import math
from typing import Any

import pytest

from solver import report_commands
from solver.cli import main
from solver.latin import solve
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.benchmarks import ahead
from solver.study.benchmarks.ahead_problems import GROUPS, PROBLEMS, AheadProblem, chosen_problems

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


def test_what_is_too_large_for_the_incremental_solver_is_measured_without_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def none_of(problem: Any) -> None:
        raise NoReferenceError("too large")

    monkeypatch.setattr(ahead, "reference_of", none_of)
    row = ahead.Ahead(**ahead.answer({**ASKED, "repeats": 1}))
    assert math.isnan(row.incremental)
    assert math.isnan(row.own_iterations)
    assert row.latin > 0.0
    assert row.known > 0.0


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


def test_its_options_mean_nothing_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["benchmark", "--large"]) == 2
    assert "only with --ahead or --cycles" in capsys.readouterr().err
