"""A run knows its error: the estimate beside the truth, accuracy heeded, every second billed."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import islice, pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.cli import main
from solver.latin import Ending, StopState, iterations, judged, solve, status, stop
from solver.latin.estimate import ROOM, SETTLED, ErrorEstimate
from solver.latin.force_changes import ForceChanges
from solver.latin.status_step import states_of
from solver.latin.step_cost import Costs, costs_of, moving_share
from solver.reference.choice import reference_of
from solver.reference.distance import Distance, distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

SMALL: dict[str, dict[str, Any]] = {
    "bar": {"elements": 30, "instants": 41, "substructures": 5},
    "strand": {"elements": 20, "instants": 21},
    "block": {"elements": 16, "elements_up": 6, "instants": 13},
    "layers": {"elements": 16, "layers": 2, "instants": 13},
}
METHODS = ["paper", "fast"]
LOW = 0.97
"""Share of the true error that a proven estimate is never below."""
ROUNDING = 1e-9


def small(scene: str, **changes: Any) -> Any:
    return CATALOGUE[scene].settings.checked({**SMALL[scene], **changes})


def true_distance(problem: Any) -> Distance:
    return distance_to(reference_of(problem), problem)


@pytest.mark.parametrize("scene", SMALL)
@pytest.mark.parametrize("method", METHODS)
def test_once_there_is_a_certificate_the_estimate_is_the_true_error(
    scene: str, method: str
) -> None:
    settings = small(scene, method=method, finish="none", tolerance=1e-8, max_iterations=400)
    problem = discretise(settings)
    distance = true_distance(problem)
    proven = 0
    for iterate, verdict in judged(problem, method_of(settings)):
        if verdict.certificate is not None:
            proven += 1
            estimate = verdict.certificate.distance.of_friction_force(iterate)
            truth = distance.of_friction_force(iterate)
            assert estimate == pytest.approx(truth, rel=1.0 - LOW, abs=ROUNDING)
        if verdict.status is not None:
            break
    assert proven > 3


@pytest.mark.parametrize("scene", SMALL)
@pytest.mark.parametrize("method", METHODS)
def test_a_certificate_is_the_solution_of_the_incremental_solver(scene: str, method: str) -> None:
    settings = small(scene, method=method, max_iterations=400)
    problem = discretise(settings)
    reference = reference_of(problem)
    found = next(
        verdict.certificate
        for _, verdict in judged(problem, method_of(settings))
        if verdict.certificate is not None or verdict.status is not None
    )
    assert found is not None
    assert found.residual < 1e-8
    distance = distance_to(reference, problem)
    assert distance.of_friction_force(found) < ROUNDING
    assert distance.of_displacement(found) < ROUNDING


@pytest.mark.parametrize("scene", SMALL)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("accuracy", [1e-1, 1e-6])
def test_a_run_that_converges_is_as_accurate_as_was_asked(
    scene: str, method: str, accuracy: float
) -> None:
    changes = {"finish": "none", "tolerance": 1e-3, "max_iterations": 2000}
    settings = small(scene, method=method, accuracy=accuracy, **changes)
    problem = discretise(settings)
    solution = solve(problem, method_of(settings), distance=true_distance(problem))
    assert solution.status.ending is Ending.CONVERGED
    last = solution.records[-1]
    assert last.error_force <= accuracy / LOW
    assert last.estimated_error <= accuracy


def test_a_smaller_accuracy_takes_more_iterations() -> None:
    settings = small("bar", finish="none")
    problem = discretise(settings)
    counts = [
        solve(problem, method_of(settings.replace(accuracy=accuracy))).iterate.number
        for accuracy in (1e-1, 1e-3, 1e-6)
    ]
    assert counts == sorted(set(counts))


@pytest.mark.parametrize("scene", SMALL)
def test_the_default_run_ends_with_a_certificate_whatever_accuracy_is_asked(scene: str) -> None:
    for accuracy in (1e-2, 1e-6):
        settings = small(scene, accuracy=accuracy)
        problem = discretise(settings)
        solution = solve(problem, method_of(settings), distance=true_distance(problem))
        assert solution.status.ending is Ending.CONVERGED
        assert solution.is_certified
        assert solution.records[-1].error_force < ROUNDING
        assert solution.records[-1].estimated_error == solution.iterate.residual


def test_a_status_step_is_tried_once_the_whole_force_settles_though_friction_has_not() -> None:
    settings = small("layers", friction=0.1)
    estimate, changes = ErrorEstimate(0.01), ForceChanges()
    for iterate in islice(iterations(discretise(settings), method_of(settings)), 60):
        assert estimate.certificate is None
        estimate(iterate, math.nan)
        changes.left(iterate)
        if changes.last.whole <= SETTLED:
            break
    assert changes.last.worst > SETTLED
    assert estimate.certificate is not None


@pytest.mark.parametrize(("scene", "is_by_increments"), [("bar", False), ("layers", True)])
def test_a_run_says_from_what_iterate_its_answer_is_and_whose(
    scene: str, is_by_increments: bool
) -> None:
    settings = CATALOGUE[scene].settings()
    problem = discretise(settings)
    found = solve(problem, method_of(settings), distance=true_distance(problem))
    before = found.records[-2]
    advice = found.status.advice
    assert f"iterate {before.iteration}, whose" in advice
    said = float(advice.removesuffix(" % away from it.").split()[-1])
    assert said == pytest.approx(100.0 * before.error_force, rel=0.1)
    assert (before.error_force > status.FAR) == is_by_increments
    assert ("incremental solver's answer" in advice) == is_by_increments


@pytest.mark.parametrize(("distance", "said"), [(0.05, "5"), (0.5, "50"), (130.0, "more than 100")])
def test_a_certified_answer_is_not_called_wrong_by_how_far_its_start_was(
    distance: float, said: str
) -> None:
    settings = CATALOGUE["bar"].settings()
    answer = solve(discretise(settings), method_of(settings), watch=False).iterate
    advice = status.certified(answer, None, distance).advice
    assert advice.endswith(f" {said} % away from it.")
    assert "wrong" not in advice


def test_a_limit_comes_near_when_there_is_time_for_one_step() -> None:
    problem = discretise(small("block"))
    first = next(iterations(problem, method_of(small("block", start="zero"))))
    step = costs_of(problem, moving_share(states_of(first))).step
    found = []
    for times in (math.inf, 2.0 * ROOM, 0.5 * ROOM):
        estimate = ErrorEstimate(0.01)
        estimate.deadline = times * step
        estimate._left = lambda estimate=estimate: estimate.deadline  # type: ignore[method-assign]
        found.append(estimate.is_last_chance(first))
    assert found == [False, False, True]


@pytest.mark.parametrize("finish", ["at-once", "none"])
def test_at_its_last_chance_a_run_that_may_end_with_a_step_tries_one(
    finish: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ErrorEstimate, "is_last_chance", lambda *_: True)
    monkeypatch.setattr(Costs, "afford", lambda _, iterations, least=0.0: math.isinf(least))
    settings = small("block", finish=finish, start="zero")
    _, verdict = next(judged(discretise(settings), method_of(settings)))
    assert (verdict.certificate is not None) == (finish == "at-once")


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
@pytest.mark.parametrize("has_certificate", [False, True])
def test_numbers_that_are_not_finite_end_a_run_and_it_says_so(
    wrong: float, has_certificate: bool
) -> None:
    settings = small("bar", finish="none")
    rules = StopState(method_of(settings))
    number = 20 if has_certificate else 1
    for iterate in islice(iterations(discretise(settings), method_of(settings)), number):
        known = rules.judge(iterate).certificate is not None
    assert known == has_certificate
    field = iterate.incoming.copy()
    field[3, 4] = wrong
    verdict = rules.judge(replace(iterate, number=number + 1, incoming=field))
    assert verdict.status is not None
    assert verdict.status.ending is Ending.DIVERGED
    assert f"stopped being finite at iteration {number + 1}" in verdict.status.advice
    assert math.isnan(verdict.estimated_error)
    assert verdict.finished is None


@pytest.mark.parametrize("scene", SMALL)
@pytest.mark.parametrize("method", METHODS)
def test_seconds_increase_from_record_to_record(scene: str, method: str) -> None:
    settings = small(scene, method=method, max_iterations=10)
    solution = solve(discretise(settings), method_of(settings))
    assert all(one.seconds < other.seconds for one, other in pairwise(solution.records))


def test_seconds_include_all_that_the_stop_rules_take(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0

    def clock() -> float:
        nonlocal now
        now += 100.0
        return now

    monkeypatch.setattr(stop, "time", SimpleNamespace(perf_counter=clock))
    settings = small("bar")
    found = list(judged(discretise(settings), method_of(settings)))
    rules = [verdict.seconds - iterate.seconds for iterate, verdict in found]
    assert found[-1][0].residual is not None
    assert rules == pytest.approx([100.0 * number for number in range(1, len(found) + 1)])


@pytest.mark.parametrize("method", METHODS)
def test_the_result_file_says_what_is_known_of_its_error(
    tmp_path: Any, capsys: pytest.CaptureFixture[str], method: str
) -> None:
    file = tmp_path / "result.npz"
    words = [text for name, value in SMALL["bar"].items() for text in ("--set", f"{name}={value}")]
    words += ["--set", f"method={method}", "--out", str(file), "--json"]
    assert main(["run", "bar", *words]) == 0
    told = json.loads(capsys.readouterr().out)
    with np.load(file, allow_pickle=False) as found:
        arrays = dict(found)
    certified = method == "fast"
    assert bool(arrays["certified"]) == told["certified"] == certified
    assert math.isnan(arrays["residual"]) != certified
    assert (told["residual"] is not None) == certified
    estimated, truth = arrays["estimated_error"], arrays["error_force"]
    assert len(estimated) == told["iterations"]
    assert np.isfinite(estimated[-1])
    known = np.isfinite(estimated)
    assert np.all(estimated[known] >= LOW * truth[known] - ROUNDING)
    assert told["estimated_error"] == estimated[-1] <= BarSettings.checked({}).accuracy
    # The clamped end shares its force with the support; all other points have their own.
    assert not arrays["determinate"][0].any()
    assert arrays["determinate"][1:].all()


def test_without_a_reference_the_estimate_is_still_there(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for method in METHODS:
        words = ["--set=elements=30", "--set", f"method={method}", "--no-reference", "--json"]
        assert main(["run", "bar", *words]) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["error_force"] is None
        assert told["estimated_error"] <= 0.01
