"""Benchmarks count the iterations of runs, and other programs agree with us."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from benchmarks import ahead, by_getfem, cycles, race
from benchmarks.public_solvers import PUBLIC, Public, solve_by
from benchmarks.sparse_newton import SparseNewton

from solver.discrete.problem import Problem
from solver.latin import iterations, solve
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.settings.scene import Settings

TINY = {"elements": 24, "instants": 21, "substructures": 3}
REACHED = {"PIQP": 1e-6, "OSQP": 1e-7, "DAQP": 1e-9, "Clarabel": 1e-5}
"""Errors that each public solver comes below at the last of its tolerances."""


def first_within(problem: Problem, settings: Settings, goal: float) -> int:
    """Iterations until the contact force of a run is as near as that."""
    distance = distance_to(reference_of(problem), problem)
    for iterate in iterations(problem, method_of(settings.replace(finish="none"))):
        if distance.of_friction_force(iterate) <= goal:
            return iterate.number
    raise AssertionError("it never is")


def test_iterations_beside_the_incremental_solver_are_those_of_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(ahead, "REPEATS", 1)
    *_, number, found_at, own, known = ahead.measure("bar", TINY)
    settings = CATALOGUE["bar"].checked(TINY)
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    records = solve(problem, method_of(settings), distance=distance).records
    assert int(number) == len(records)
    assert float(found_at.split()[0]) == pytest.approx(
        100.0 * records[-2].error_force, rel=0.05
    )
    first = first_within(problem, settings, ahead.GOAL)
    assert int(own.split()[0]) == first
    assert int(known.split()[0]) >= first
    assert known.endswith("certified")


def test_iterations_of_cycles_are_those_to_the_goal_and_slabs_hold_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sizes = {"elements": 16, "elements_up": 8, "substructures": 2}
    monkeypatch.setattr(cycles, "PROBLEMS", {"tiny": ("block", sizes, 2)})
    monkeypatch.setattr(cycles, "REPEATS", 1)
    lines, ways = cycles.measure("tiny", 2, list(cycles.WAYS))
    assert ways == list(cycles.WAYS)
    counts, modes, megabytes = (
        [float(value) for value in re.findall(pattern, "\n".join(lines))]
        for pattern in (r"(\d+) iterations", r"(\d+) modes", r"(\S+) MB")
    )
    settings = cycles.settings_of("tiny", 2)
    assert counts[0] == first_within(discretise(settings), settings, cycles.GOAL)
    assert modes[1] > 0
    assert megabytes[2] < megabytes[0]


@pytest.mark.parametrize("bond", ["running", "stack"])
def test_the_sparse_rival_on_a_wall_comes_to_the_same(bond: str) -> None:
    sizes = {
        "bricks": 3,
        "courses": 3,
        "elements": 4,
        "elements_up": 2,
        "displacement": 5e-5,
    }
    problem = discretise(CATALOGUE["wall"].checked({**sizes, "bond": bond}))
    found = SparseNewton(problem).march()
    reference = reference_of(problem)
    assert found.solved.all()
    for name in ("displacement", "contact_force"):
        known = getattr(reference, name)
        assert np.abs(getattr(found, name) - known).max() < 1e-10 * np.abs(known).max()


@pytest.mark.parametrize(("scene", "size"), [("arch", 7), ("wall", 3)])
def test_a_race_counts_iterations_until_the_answer_of_its_rivals(
    scene: str, size: int
) -> None:
    settings = race.settings_of(scene, size, {})
    problem = discretise(settings)
    truth = race.answer_of(problem, race.INCREMENTAL)
    assert truth.difference(race.answer_of(problem, race.SPARSE)) < race.SAME
    count, error = race.count_of(scene, size, "LATIN", truth)
    assert count == first_within(problem, settings, race.GOAL)
    assert error <= race.GOAL


def test_a_race_tells_what_does_not_arrive() -> None:
    size = 7
    monoscale = "LATIN, monoscale"
    problem = discretise(race.settings_of("arch", size, {}))
    truth = race.answer_of(problem, race.INCREMENTAL)
    count, error = race.count_of("arch", size, monoscale, truth)
    assert count == 0
    assert error > race.GOAL
    some = truth.solved.copy()
    some[-1] = False
    rival = race.Entry(race.SPARSE, ())
    rival.samples = [race.Sample(1.0, 1.0, 1.0)]
    rival.answer = race.Answer(truth.displacement, truth.contact_force, some)
    assert not rival.arrives
    assert race.truth_of([rival])[0] is None
    assert f"solves {len(some) - 1} of {len(some)}" in rival.line(1.0)


@pytest.mark.parametrize("public", PUBLIC, ids=lambda public: public.name)
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"pressure_profile": "gap"},
        {"support_displacement": 1e-4},
        {"body_force": 500.0},
    ],
    ids=str,
)
def test_public_solvers_agree_with_the_incremental_solver(
    public: Public, changes: dict[str, Any]
) -> None:
    if not public.installed:
        pytest.skip(f"{public.name} is not installed")
    sizes = {"elements": 20, "instants": 21}
    problem = discretise(BarSettings.checked({"method": "paper"} | sizes | changes))
    fields = solve_by(public, problem, public.tolerances[-1])
    distance = distance_to(reference_of(problem), problem)
    assert distance.of_friction_force(fields) < REACHED[public.name]
    assert distance.of_displacement(fields) < REACHED[public.name]


def test_getfem_finds_the_same_at_all_nodes_and_instants() -> None:
    python = by_getfem.interpreter()
    if python is None:
        pytest.skip("GetFEM is not installed")
    settings = CATALOGUE["block"].checked({**by_getfem.SHEARED, "plane": "stress"})
    for name, difference in by_getfem.differences(settings, python).items():
        assert difference < 1e-9, name
