"""A run starts from the run before it where that is better, and can be repeated exactly."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest

from solver.discrete.problem import Problem
from solver.latin import Iterate, Latin, iterations
from solver.latin.indicators import behaviour_indicator
from solver.latin.warm import CLEARLY, StartChoice, carry, choose_start, iterations_from
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

SIZE = {"elements": 20, "substructures": 4, "instants": 41}
FORMS: dict[str, dict[str, Any]] = {
    "paper": {},
    "anderson": {"search_direction": "auto", "acceleration": "anderson"},
    "nested": {"start": "nested"},
    "pgd": {"linear_stage": "pgd"},
}


def made(**changes: Any) -> tuple[Problem, Latin]:
    settings = BarSettings.checked({"method": "paper", **SIZE, **changes})
    return discretise(settings), method_of(settings)


def solved(number: int = 300, **changes: Any) -> Iterate:
    return list(islice(iterations(*made(**changes)), number))[-1]


@pytest.fixture(scope="module")
def before() -> Iterate:
    return solved()


def same(one: Iterate, other: Iterate) -> bool:
    return (
        one.number == other.number
        and np.array_equal(one.outgoing, other.outgoing)
        and np.array_equal(one.incoming, other.incoming)
        and np.array_equal(one.local_displacement, other.local_displacement)
    )


@pytest.mark.parametrize(
    "changes",
    [
        {"peak": 905.0},
        {"friction": 0.302},
        {"k_scale": 30.0},
        {"substructures": 5},
        {"multiscale": False},
        {"elements": 24},
        {"elements": 24, "substructures": 3, "instants": 61},
        {"instants": 31},
    ],
    ids=str,
)
def test_a_small_change_starts_from_the_solution_before(before: Iterate, changes: Any) -> None:
    problem, latin = made(**changes)
    start, run = choose_start(problem, latin, before)
    first = next(run)
    assert start.choice.is_previous
    assert first.number == 1
    assert start.choice.previous == behaviour_indicator(first)
    zero = next(iterations(problem, latin))
    assert start.choice.own == behaviour_indicator(zero)


@pytest.mark.parametrize(
    "changes", [{"peak": -900.0}, {"load": "triangle"}, {"peak": 0.0}, {"friction": 0.9}], ids=str
)
@pytest.mark.parametrize("form", FORMS)
def test_a_large_change_starts_as_if_there_had_been_no_run_before(
    before: Iterate, changes: Any, form: str
) -> None:
    problem, latin = made(**FORMS[form], **changes)
    start, run = choose_start(problem, latin, before)
    assert not start.choice.is_previous
    for one, other in zip(islice(run, 5), iterations(problem, latin), strict=False):
        assert same(one, other)


@pytest.mark.parametrize("form", FORMS)
def test_a_run_is_repeated_from_its_start_and_goes_on_from_anywhere_to_the_bit(
    before: Iterate, form: str
) -> None:
    problem, latin = made(**FORMS[form], friction=0.3001)
    start, run = choose_start(problem, latin, before)
    iterates = list(islice(run, 8))
    assert start.choice.is_previous
    again = islice(iterations_from(problem, latin, start, None), 8)
    assert all(same(one, other) for one, other in zip(iterates, again, strict=True))
    rest = islice(iterations_from(problem, latin, start, iterates[2].checkpoint), 5)
    assert all(same(one, other) for one, other in zip(iterates[3:], rest, strict=True))


@pytest.mark.parametrize("peak", [905.0, -900.0])
def test_both_first_iterations_are_on_the_clock(before: Iterate, peak: float) -> None:
    problem, latin = made(peak=peak)
    start, run = choose_start(problem, latin, before)
    iterates = list(islice(run, 4))
    seconds = [iterate.seconds for iterate in iterates]
    assert 0.0 < start.seconds < seconds[0]
    assert seconds == sorted(seconds)
    later = next(iterations_from(problem, latin, start, iterates[1].checkpoint))
    assert later.seconds > seconds[1]


def test_what_is_carried_keeps_its_si_values_whatever_the_scales(before: Iterate) -> None:
    problem, _ = made(young=3e9, peak=2000.0, pressure=9000.0)
    old, new = before.problem.scales, problem.scales
    assert old != new
    far = carry(before, problem, np.full(problem.n_rows, 1e300))
    assert far * new.displacement == pytest.approx(before.boundary_displacement * old.displacement)
    forces = carry(before, problem, np.ones(problem.n_rows)) - far
    assert forces * new.force == pytest.approx(before.boundary_force * old.force)


def test_one_instant_and_many_are_carried_into_each_other(before: Iterate) -> None:
    problem, latin = made(instants=1)
    one = next(choose_start(problem, latin, before)[1])
    assert np.isfinite(one.outgoing).all()
    back = next(choose_start(*made(), one)[1])
    assert np.isfinite(back.outgoing).all()


def test_fields_that_are_not_finite_are_never_taken(before: Iterate) -> None:
    broken = replace(before, outgoing=np.full_like(before.outgoing, np.nan))
    problem, latin = made()
    start, run = choose_start(problem, latin, broken)
    assert not start.choice.is_previous
    assert same(next(run), next(iterations(problem, latin)))


@pytest.mark.parametrize(
    ("previous", "own", "taken"),
    [
        (0.0, 0.0, True),
        (CLEARLY, 1.0, True),
        (1.01 * CLEARLY, 1.0, False),
        (0.1, 0.0, False),
        (float("nan"), 1.0, False),
        (float("inf"), float("inf"), False),
        (1.0, float("nan"), True),
    ],
)
def test_the_previous_solution_has_to_be_clearly_better(
    previous: float, own: float, taken: bool
) -> None:
    assert StartChoice(previous, own).is_previous is taken
