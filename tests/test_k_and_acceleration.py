"""Automatic k and its update, Anderson, nested meshes: a shorter path to the same limit."""

from __future__ import annotations

from itertools import groupby, islice, takewhile

import numpy as np
import pytest
from bars import measured

from solver.latin import Ending, from_status, iterations
from solver.latin.directions import sliding_share
from solver.latin.from_status import CALM, TRIAL
from solver.loads import PRESETS
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

FAST = {"search_direction": "auto", "acceleration": "anderson", "start": "nested"}


def options(**changes: object) -> BarSettings:
    return BarSettings.checked({"method": "paper", **FAST, **changes})


def within(solution, level: float) -> int:
    return next(entry.iteration for entry in solution.records if entry.error_force <= level)


@pytest.mark.parametrize(
    "changes", [*({"load": load} for load in PRESETS), {"peak": 300.0}, {"peak": 2400.0}], ids=str
)
def test_all_together_reach_one_percent_of_friction_force_early(changes):
    assert within(measured(options(max_iterations=30, **changes)), 0.01) <= 30


@pytest.mark.parametrize(
    ("setting", "sizes", "most"),
    [("substructures", (1, 5, 50), 1.2), ("elements", (50, 200), 2.0)],
    ids=str,
)
def test_iterations_to_one_percent_hardly_depend_on(setting, sizes, most):
    early = {"tolerance": 1e-20, "max_iterations": 60}
    found = [within(measured(options(**early, **{setting: size})), 0.01) for size in sizes]
    assert max(found) <= most * min(found)


@pytest.mark.parametrize("change", [{}, {"load": "random"}], ids=str)
def test_the_limit_is_the_same(change):
    solution = measured(options(tolerance=1e-24, max_iterations=3000, **change))
    assert solution.status.ending is Ending.CONVERGED
    assert solution.records[-1].error_force < 1e-8
    assert solution.records[-1].error_displacement < 1e-8


@pytest.mark.parametrize(
    ("change", "share"),
    [
        ({}, 0.6),
        ({"peak": 300.0}, 0.2),
        ({"peak": -300.0}, 0.2),
        ({"peak": 4000.0}, 1.0),
        ({"peak": 0.0}, 2.0 / 51.0),
        ({"friction": 0.0}, 1.0),
        ({"support_displacement": 1e-3}, 1.0),
        ({"load": "ramp", "peak": 300.0, "body_force": 300.0}, 0.4),
    ],
    ids=str,
)
def test_the_sliding_share_is_load_over_capacity(change, share):
    assert sliding_share(discretise(options(**change))) == pytest.approx(share)


def updating(**changes: object) -> BarSettings:
    return BarSettings.checked({"method": "paper", "k_update": "status", **changes})


def sample(settings: BarSettings, number: int):
    return list(islice(iterations(discretise(settings), method_of(settings)), number))


def iterations_to(settings: BarSettings, level: float) -> int:
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    found = islice(iterations(problem, method_of(settings)), settings.max_iterations)
    return 1 + sum(1 for _ in takewhile(lambda it: distance.of_friction_force(it) > level, found))


@pytest.mark.parametrize("load", PRESETS)
def test_a_millionth_of_friction_force_takes_at_most_150_iterations(load):
    chosen = updating(**FAST, load=load, relaxation=1.0, max_iterations=200)
    assert iterations_to(chosen, 1e-6) <= 150


@pytest.mark.parametrize("substructures", [1, 10])
def test_it_makes_the_plain_iteration_shorter(substructures):
    chosen = updating(substructures=substructures, max_iterations=500)
    assert iterations_to(chosen, 1e-3) < iterations_to(chosen.replace(k_update="none"), 1e-3)


@pytest.mark.parametrize(
    "change", [{"load": "random"}, {"multiscale": False, "substructures": 3}], ids=str
)
def test_the_limit_is_the_same_once_k_is_updated(change):
    solution = measured(updating(**FAST, tolerance=1e-24, max_iterations=3000, **change))
    assert solution.iterate.course.phase == "updated"
    assert solution.status.ending is Ending.CONVERGED
    assert solution.records[-1].error_force < 1e-8


@pytest.mark.parametrize("acceleration", ["none", "anderson"])
def test_a_harmful_update_is_taken_back_once_and_for_all(monkeypatch, acceleration):
    monkeypatch.setattr(from_status, "SLIDING", 1e-9)
    chosen = updating(**{**FAST, "acceleration": acceleration})
    problem = discretise(chosen)
    constant = sample(chosen.replace(k_update="none"), CALM + 20)
    found = sample(chosen, 600)
    phases = [iterate.course.phase for iterate in found]
    assert [phase for phase, _ in groupby(phases)] == ["first", "updated", "returned"]
    # An iterate says what follows: the next is the first with the new k.
    start, back = phases.index("updated") + 1, phases.index("returned") + 1
    assert (back - start) % TRIAL == 0
    assert np.array_equal(found[back].k, constant[0].k)
    if back - start == TRIAL:  # from the state before the update, as if it had never been
        assert np.allclose(found[back].local_incoming, constant[start].local_incoming, atol=1e-15)
    distance = distance_to(reference_of(problem), problem)
    assert distance.of_friction_force(found[-1]) < 1e-3


@pytest.mark.parametrize("harm", [1.0, 1e-9])
def test_a_run_without_acceleration_goes_on_from_any_checkpoint_to_the_bit(monkeypatch, harm):
    monkeypatch.setattr(from_status, "SLIDING", harm * from_status.SLIDING)
    chosen = updating(**{**FAST, "acceleration": "none"})
    problem = discretise(chosen)
    straight = sample(chosen, CALM + TRIAL + 20)
    for place in (2, CALM, CALM + 1, CALM + TRIAL):
        rest = len(straight) - place - 1
        again = list(
            islice(iterations(problem, method_of(chosen), straight[place].checkpoint), rest)
        )
        for one, other in zip(again, straight[place + 1 :], strict=True):
            assert one.course.phase == other.course.phase
            assert np.array_equal(one.outgoing, other.outgoing)
            assert np.array_equal(one.local_incoming, other.local_incoming)
