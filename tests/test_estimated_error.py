"""A run knows its error: the estimate beside the truth, accuracy heeded, every second billed."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import islice
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.cli import main
from solver.latin import Ending, StopRules, iterations, judged, solve, stop
from solver.latin.criteria.changes import ForceChanges
from solver.latin.criteria.estimate import SETTLED, ErrorEstimate
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
    assert (before.error_force > stop.FAR) == is_by_increments
    assert ("incremental solver's answer" in advice) == is_by_increments


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
@pytest.mark.parametrize("has_certificate", [False, True])
def test_numbers_that_are_not_finite_end_a_run_and_it_says_so(
    wrong: float, has_certificate: bool
) -> None:
    settings = small("bar", finish="none")
    rules = StopRules(method_of(settings))
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
