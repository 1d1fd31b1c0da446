"""Where slip changes what presses, two points cease to slip or not by their start.

A slip that could stay is necessary for that, and no more: Melan's theorem does not hold.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver.discrete.problem import Problem
from solver.reference.shakedown.melan import shakedown_limit
from solver.reference.shakedown.slip_space import largest_swing, room_of_two, slip_space
from solver.scenes import CATALOGUE, discretise
from solver.study.quantities.cycles import cycles_of, ends_of
from solver.study.quantities.finished import FinishedRun, finished_run
from solver.study.quantities.shakedown import Fate, fate_of

LESSON = Path(__file__).parents[1] / "app/lessons/two-points.toml"
GIVEN = tomllib.loads(LESSON.read_text(encoding="utf-8"))["settings"]
SWING, PUSH = 4e-5, -8e-5
PATH = "top_tangential_load"


def path(first: float | None, swing: float = SWING) -> tuple[tuple[float, float], ...]:
    """Give five cycles, after a first push or none."""
    pushed = [(2.0, 0.0)] if first is None else [(2.0, 0.0), (2.5, first)]
    turns = [(3.25 + 0.5 * n, swing * (-1.0) ** n) for n in range(10)]
    return (*pushed, (3.0, 0.0), *turns, (8.0, 0.0))


def settings(**changes: Any) -> Any:
    return CATALOGUE["block"].settings.checked({**GIVEN, **changes})


def problem(**changes: Any) -> Problem:
    return discretise(settings(**changes))


def last_cycle(**changes: Any) -> slice:
    ends = ends_of(settings(**changes))
    return slice(ends[-2], ends[-1] + 1)


def ran(**changes: Any) -> FinishedRun:
    return finished_run(settings(**changes), errors=True, indicators=False)


def fate(run: FinishedRun) -> Fate:
    found = fate_of(cycles_of(run.settings, run.iterate))
    assert found is not None
    return found


def slips_for_ever(**changes: Any) -> bool:
    run = ran(**changes)
    return bool(cycles_of(run.settings, run.iterate).slip[:, -1].any())


@pytest.mark.parametrize("first", [0.0, 2.0 * SWING])
def test_from_rest_or_the_right_it_ceases(first: float) -> None:
    run = ran(**{PATH: path(first)})
    assert fate(run).word == "elastic shakedown"
    assert run.solution.records[-1].error_force < 1e-9


def test_after_a_push_to_the_left_it_never_ceases() -> None:
    """The point that is pressed less slips alone, as far after any push: the other attractor."""
    far = []
    for push in (PUSH, 1.5 * PUSH):
        run = ran(**{PATH: path(push)})
        found, cycles = fate(run), cycles_of(run.settings, run.iterate)
        assert found.word == "steady slip"
        assert found.ratio == pytest.approx(1.0, abs=1e-9)
        assert run.solution.records[-1].error_force < 1e-9
        assert cycles.slip[1, -1] == 0.0
        far.append(cycles.slip[0, -1])
    assert far[0] == pytest.approx(far[1], rel=1e-9)


def test_yet_there_is_a_slip_that_could_stay() -> None:
    space = slip_space(problem())
    factor, slip = largest_swing(space, last_cycle())
    # As the lesson tells it.
    assert factor * SWING == pytest.approx(44.4e-6, abs=0.05e-6)
    room = room_of_two(space, last_cycle())
    within = space.matrix @ room.mean(axis=0)
    assert np.all(within[:, None] <= space.limit[:, last_cycle()])
    assert room.min(axis=0)[0] < slip[0] < room.max(axis=0)[0]


@pytest.mark.parametrize(("first", "share", "goes_on"), [(0.0, 0.995, False), (0.0, 1.005, True)])
def test_above_the_program_all_starts_slip_and_below_it_the_best_does_not(
    first: float, share: float, goes_on: bool
) -> None:
    factor, _ = largest_swing(slip_space(problem(**{PATH: path(first)})), last_cycle())
    assert slips_for_ever(**{PATH: path(first, share * factor * SWING)}) is goes_on
    assert slips_for_ever(**{PATH: path(PUSH, share * factor * SWING)})


@pytest.mark.parametrize(
    ("scene", "changes"), [("bar", {"peak": 900.0}), ("strand", {"peak": 300.0, "broken": 1})]
)
def test_where_slip_presses_nothing_it_is_the_limit_of_the_theorem(
    scene: str, changes: dict[str, Any]
) -> None:
    mesh = {"elements": 20, "instants": 161, "substructures": 2, "load": "cycles"}
    rods = CATALOGUE[scene].settings.checked({**mesh, **changes})
    ends = ends_of(rods)
    some = slice(ends[-2], ends[-1] + 1)
    theorem = shakedown_limit(discretise(rods), some).factor
    assert largest_swing(slip_space(discretise(rods)), some)[0] == pytest.approx(theorem, rel=1e-6)
