"""`finish=accuracy`: the method's own iterates come within the accuracy, then stands the answer."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from solver.files import settings_from_command, summary
from solver.latin import Ending, Solution, solve
from solver.latin.status_step import StepResult
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings import Settings

SMALL = {"elements": 16, "instants": 21, "substructures": 2}


def options(scene: str = "bar", **changes: Any) -> Settings:
    return CATALOGUE[scene].settings.checked({**SMALL, "finish": "accuracy", **changes})


@cache
def ended(settings: Settings) -> Solution:
    problem = discretise(settings)
    return solve(problem, method_of(settings), distance=distance_to(reference_of(problem), problem))


@cache
def searched(scene: str) -> Solution:
    return ended(options(scene))


@pytest.mark.parametrize("scene", CATALOGUE)
def test_the_search_ends_with_its_first_iterate_within_the_accuracy(scene: str) -> None:
    *iterates, answer = searched(scene).records
    assert [one.is_answer for one in iterates] == [False] * len(iterates)
    # A run knows how far it is once a step has held; small ones know before they are near.
    assert [one.error_force <= 0.01 for one in iterates] == [False] * (len(iterates) - 1) + [True]
    assert answer.is_answer
    assert answer.error_force < 1e-7


def test_its_iterates_are_those_of_a_run_that_only_iterates() -> None:
    alone = ended(options(finish="none"))
    own = [one.error_force for one in searched("bar").records if not one.is_answer]
    assert own == [one.error_force for one in alone.records[: len(own)]]


def test_the_answer_is_no_iteration() -> None:
    solution = searched("bar")
    assert solution.is_certified
    assert solution.iterate.iterations == len(solution.records) - 1
    assert summary(options(), solution)["iterations"] == len(solution.records) - 1


def test_iterations_depend_on_k_and_the_answer_does_not() -> None:
    counts = {}
    for k in (0.1, 1.0, 10.0):
        solution = ended(options("strand", k_scale=k))
        counts[k] = solution.iterate.iterations
        answer = searched("strand").iterate.contact_force
        assert np.allclose(solution.iterate.contact_force, answer, atol=1e-9 * np.abs(answer).max())
    assert counts[0.1] > 1.5 * counts[1.0] < counts[10.0]


def test_a_search_that_gives_up_says_how_far_it_was_and_what_to_try() -> None:
    solution = ended(options(k_scale=100.0, max_iterations=4))
    assert (solution.iterate.iterations, solution.is_certified) == (4, True)
    assert solution.status.ending is Ending.CONVERGED
    wrong = float(f"{100 * solution.records[-2].error_force:.2g}")
    assert f"{wrong:g} %" in solution.status.advice
    assert "Raise max_iterations" in solution.status.advice


def test_without_an_answer_it_ends_as_a_run_that_only_iterates(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("solver.latin.estimate.status_step", lambda *_: StepResult(None, False))
    ends = []
    for finish in ("accuracy", "none"):
        settings = options("block", finish=finish)
        solution = solve(discretise(settings), method_of(settings))
        assert not solution.is_certified
        ends.append((solution.iterate.number, solution.status))
    assert ends[0] == ends[1]


@pytest.mark.parametrize("said", ["at-once", "at once", "status"])
def test_files_and_commands_may_say_at_once_as_they_did(said: str) -> None:
    assert settings_from_command("bar", [f"finish={said}"])[0].finish == "at-once"
