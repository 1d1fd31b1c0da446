"""A run knows its error, heeds accuracy and limit, and bills every second."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from itertools import islice
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from runs import distance_of, solved

from solver.commands.cli import main
from solver.latin import (
    Answer,
    Ending,
    Iterate,
    Solution,
    StopState,
    iterations,
    judged,
    stop_rules,
)
from solver.latin.end import status
from solver.latin.end.estimate import ErrorEstimate
from solver.latin.stop_rules import StallCheck
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings

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
    return CATALOGUE[scene].checked(SMALL[scene] | changes)


@pytest.mark.parametrize("scene", SMALL)
@pytest.mark.parametrize("method", METHODS)
def test_once_there_is_a_certificate_the_estimate_is_the_true_error(
    scene: str, method: str
) -> None:
    settings = small(
        scene, method=method, finish="none", tolerance=1e-8, max_iterations=400
    )
    problem = discretise(settings)
    distance = distance_of(problem)
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
    solution = solved(small(scene, method=method, accuracy=accuracy, **changes))
    assert solution.status.ending is Ending.CONVERGED
    last = solution.records[-1]
    assert last.error_force <= accuracy / LOW
    assert last.estimated_error <= accuracy


@pytest.mark.parametrize("scene", SMALL)
def test_the_default_run_ends_with_a_certificate_whatever_accuracy_is_asked(
    scene: str,
) -> None:
    for accuracy in (1e-2, 1e-6):
        solution = solved(small(scene, accuracy=accuracy))
        assert solution.status.ending is Ending.CONVERGED
        assert solution.is_certified
        assert solution.records[-1].error_force < ROUNDING
        assert isinstance(solution.iterate, Answer)
        assert solution.records[-1].estimated_error == solution.iterate.residual


@pytest.mark.parametrize(
    ("scene", "is_by_increments"), [("bar", False), ("layers", True)]
)
def test_a_run_says_from_which_iterate_its_answer_was_found(
    scene: str, is_by_increments: bool
) -> None:
    found = solved(CATALOGUE[scene]())
    before = found.records[-2]
    advice = found.status.advice
    assert f"iterate {before.iteration}, whose" in advice
    said = float(advice.removesuffix(" % away from it.").split()[-1])
    assert said == pytest.approx(100.0 * before.error_force, rel=0.1)
    assert (before.error_force > status.FAR) == is_by_increments
    assert ("incremental solver's answer" in advice) == is_by_increments


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
@pytest.mark.parametrize("has_certificate", [False, True])
def test_numbers_that_are_not_finite_end_a_run_and_it_says_so(
    wrong: float, has_certificate: bool
) -> None:
    settings = small("bar", finish="none")
    rules = StopState(method_of(settings))
    number = 20 if has_certificate else 1
    for iterate in islice(
        iterations(discretise(settings), method_of(settings)), number
    ):
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


def test_seconds_include_all_that_the_stop_rules_take(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 0.0

    def clock() -> float:
        nonlocal now
        now += 100.0
        return now

    monkeypatch.setattr(stop_rules, "time", SimpleNamespace(perf_counter=clock))
    settings = small("bar")
    found = list(judged(discretise(settings), method_of(settings)))
    rules = [verdict.seconds - iterate.seconds for iterate, verdict in found]
    assert isinstance(found[-1][0], Answer)
    assert rules == pytest.approx(
        [100.0 * number for number in range(1, len(found) + 1)]
    )


@pytest.mark.parametrize("method", METHODS)
def test_estimates_during_a_run_are_no_less_than_the_error(method: str) -> None:
    found = solved(small("bar", method=method), watch=True)
    assert found.is_certified == (method == "fast")
    estimated, truth = np.transpose(
        [[one.estimated_error, one.error_force] for one in found.records]
    )
    known = np.isfinite(estimated)
    assert known[-1]
    assert np.all(estimated[known] >= LOW * truth[known] - ROUNDING)


SHORT = {"elements": 16, "instants": 21, "substructures": 2}


FEW = {
    "wall": {"bricks": 3, "courses": 3, "displacement": 5e-5},
    "arch": {"voussoirs": 7, "elements": 2},
    "bundle": {"rings": 1, "elements": 2},
}
"""Few bodies, of which a step is soon worth a trial."""


def options(scene: str = "bar", **changes: Any) -> Settings:
    sizes = SHORT | FEW.get(scene, {})
    kind = CATALOGUE[scene]
    # A mesh of a file has no number of elements.
    sizes = {name: sizes[name] for name in sizes if name in kind.definitions()}
    return kind.checked(sizes | {"finish": "accuracy"} | changes)


@cache
def ended(settings: Settings) -> Solution:
    return solved(settings)


@cache
def searched(scene: str) -> Solution:
    return ended(options(scene))


@pytest.mark.parametrize("scene", CATALOGUE)
def test_the_search_ends_with_its_first_iterate_within_the_accuracy(scene: str) -> None:
    *iterates, answer = searched(scene).records
    assert [one.is_answer for one in iterates] == [False] * len(iterates)
    within = [one.error_force <= 0.01 for one in iterates]
    known = [one.estimated_error <= 0.01 for one in iterates]
    assert known == [False] * (len(iterates) - 1) + [True]
    assert within[-1]
    # A run knows how far it is once a step has held; small ones know before they are
    # near, but where a few iterations cost less than a step.
    assert within == known or scene in ("fault", "strand")
    assert answer.is_answer
    assert answer.error_force < 1e-7


def test_iterations_depend_on_k_and_the_answer_does_not() -> None:
    counts = {}
    for k in (0.1, 1.0, 10.0):
        solution = ended(options("strand", k_scale=k))
        counts[k] = solution.iterate.iterations
        answer = searched("strand").iterate.contact_force
        assert np.allclose(
            solution.iterate.contact_force, answer, atol=1e-9 * np.abs(answer).max()
        )
    assert counts[0.1] > 1.5 * counts[1.0] < counts[10.0]


def test_a_search_that_gives_up_says_how_far_it_was_and_what_to_try() -> None:
    solution = ended(options(k_scale=100.0, max_iterations=4))
    assert (solution.iterate.iterations, solution.is_certified) == (4, True)
    assert solution.status.ending is Ending.CONVERGED
    wrong = float(f"{100 * solution.records[-2].error_force:.2g}")
    assert f"{wrong:g} %" in solution.status.advice
    assert "Raise max_iterations" in solution.status.advice


SMALL_BAR = {"elements": 40, "instants": 21, "substructures": 4}


def test_the_command_ends_with_a_file_and_the_code_of_a_run_that_has_not_converged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changes = [f"--set={name}={value}" for name, value in SMALL_BAR.items()]
    file = tmp_path / "limited.npz"
    assert main(["run", "bar", *changes, "--limit", "1e-9", "--out", str(file)]) == 1
    out, err = capsys.readouterr()
    assert "exhausted" in out
    assert "the reference takes longer" in err
    with np.load(file) as saved:
        assert len(saved["seconds"]) == 1
        assert np.isfinite(saved["friction_force"]).all()


def test_a_status_step_that_is_halted_is_tried_again_at_the_next_iterate() -> None:
    settings = small("block", finish="at-once")
    problem = discretise(settings)
    method = method_of(settings)
    asked: list[int] = []
    at_once = list(judged(problem, method, interrupted=lambda: bool(asked.append(0))))
    certified = at_once[-1][0].number
    assert len(asked) > problem.n_instants
    is_halted = True
    run = judged(problem, method, interrupted=lambda: is_halted)
    halted = [decision for _, decision in islice(run, certified + 2)]
    assert all(decision.certificate is None for decision in halted)
    is_halted = False
    iterate, decision = next(run)
    assert iterate.number == certified + 3
    assert decision.certificate is not None


@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_a_time_limit_is_positive(
    value: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "bar", "--limit", value]) == 2
    assert "--limit" in capsys.readouterr().err


def test_a_run_is_judged_at_iterations_that_grow_by_a_sixteenth_and_at_its_last(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    judged_at: list[int] = []

    def unknown(_estimate: ErrorEstimate, iterate: Iterate) -> float:
        judged_at.append(iterate.number)
        return math.nan

    monkeypatch.setattr(ErrorEstimate, "__call__", unknown)
    monkeypatch.setattr(ErrorEstimate, "is_step_worthwhile", lambda *_: False)
    last = 75
    solved(small("bar", finish="none", accuracy=1e-6, max_iterations=last))
    assert judged_at[:16] == list(range(1, 17))
    assert judged_at[-1] == last
    gaps = np.diff(judged_at[:-1])
    assert np.array_equal(gaps, 1 + np.array(judged_at[:-2]) // 16)


@pytest.mark.parametrize(("lowest", "ends"), [(20, 100), (60, 120), (150, 300)])
def test_a_run_stalls_where_its_indicator_was_lowest_in_its_first_half(
    lowest: int, ends: int
) -> None:
    check = StallCheck()
    k = np.ones(1)

    def has_stalled(number: int) -> bool:
        indicator = float(abs(number - lowest))
        iterate: Any = SimpleNamespace(number=number, k=k, indicator=indicator)
        return check.has_stalled(iterate)

    assert next(number for number in range(1, 1000) if has_stalled(number)) == ends


def test_an_indicator_for_another_k_is_no_measure_of_a_stall() -> None:
    """The indicator falls to 1 for a first k, and is 2 from a second one on."""
    check = StallCheck()
    first = np.ones(1)
    second = np.ones(1)
    ends = None
    for number in range(1, 400):
        iterate: Any = SimpleNamespace(number=number, k=first, indicator=140.0 - number)
        if number >= 140:
            iterate = SimpleNamespace(number=number, k=second, indicator=2.0)
        if check.has_stalled(iterate):
            ends = number
            break
    assert ends == 2 * 140


def test_the_error_of_a_bar_that_does_not_move_is_a_share_in_any_unit() -> None:
    """Metres were called a share: 0.001 % of a bar of 1 m at first."""
    errors = []
    for size in (1.0, 64.0):
        settings = CATALOGUE["bar"].checked(
            {
                "temperature": 50.0,
                "peak": 0.0,
                "right_end": "held",
                "length": size,
                "section": 3.14e-6 * size**2,
                "pressure": 5e3 * size,
                "elements": 10,
                "substructures": 5,
                "instants": 5,
                "start": "zero",
                "method": "paper",
            }
        )
        problem = discretise(settings)
        reference = reference_of(problem)
        assert not reference.displacement.any()
        distance = distance_to(reference, problem)
        search = islice(iterations(problem, method_of(settings)), 5)
        errors.append([distance.of_displacement(iterate) for iterate in search])
    assert errors[0] == pytest.approx(errors[1], rel=1e-9)
    assert max(errors[0]) > 0.01
