"""A run with a limit in seconds ends by then with what it has, whatever it is at."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver.cli import main
from solver.latin import Ending, Latin, Stop, iterations, solve
from solver.latin import estimate as estimates
from solver.latin.estimate import ErrorEstimate
from solver.latin.start import Nested
from solver.scenes import CATALOGUE, coarser_problems, discretise

SMALL = {"elements": 40, "instants": 21, "substructures": 4}


def bar() -> Any:
    return discretise(CATALOGUE["bar"].settings.checked(SMALL))


def test_a_run_ends_with_its_iterate_and_says_what_helps() -> None:
    solution = solve(bar(), Latin(finish=None, stop=Stop(accuracy=1e-9, seconds=1e-9)))
    assert solution.status.ending is Ending.EXHAUSTED
    assert "longer" in solution.status.advice
    assert solution.iterate.number == 1


def test_a_start_that_takes_too_long_is_given_up() -> None:
    problem = bar()
    start = Nested(coarser_problems(CATALOGUE["bar"].settings.checked(SMALL)))
    k = Latin().direction.of(problem)
    assert start.of(problem, k) is not None
    assert start.of(problem, k, seconds=0.0) is None


def test_a_status_step_that_would_take_too_long_is_not_begun(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    iterate = next(iterations(bar(), Latin()))
    estimate = ErrorEstimate(0.01)
    assert estimate.can_be_proven(iterate, patience=1000.0)
    estimate.deadline = time.perf_counter()
    monkeypatch.setattr(estimates, "incremental_solver", lambda *_: pytest.fail("begun"))
    assert not estimate.try_step(iterate, patience=1000.0)


def test_a_status_step_is_given_up_on_its_way(monkeypatch: pytest.MonkeyPatch) -> None:
    iterate = next(iterations(bar(), Latin()))
    estimate = ErrorEstimate(0.01)
    assert estimate.try_step(iterate, patience=1000.0)
    estimate = ErrorEstimate(0.01)
    estimate.deadline = 0.0
    monkeypatch.setattr(estimate, "_is_in_time", lambda _: True)  # by a wrong estimate
    assert not estimate.try_step(iterate, patience=1000.0)
    assert estimate.certificate is None


def test_the_command_ends_with_a_file_and_the_code_of_a_run_that_has_not_converged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changes = [word for name, value in SMALL.items() for word in ("--set", f"{name}={value}")]
    file = tmp_path / "limited.npz"
    assert main(["run", "bar", *changes, "--limit", "1e-9", "--out", str(file)]) == 1
    out, err = capsys.readouterr()
    assert "exhausted" in out
    assert "the reference takes longer" in err
    with np.load(file) as saved:
        assert len(saved["seconds"]) == 1
        assert np.isfinite(saved["friction_force"]).all()


@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_a_limit_is_some_time(value: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "bar", "--limit", value]) == 2
    assert "--limit" in capsys.readouterr().err
