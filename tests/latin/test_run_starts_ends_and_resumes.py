"""Runs start, end and resume as they should, and refuse what they cannot do."""

from __future__ import annotations

import dataclasses
import importlib
import math
from collections.abc import Callable
from dataclasses import replace
from itertools import islice
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from bars import SMALL, boundary_of, options
from numpy.linalg import LinAlgError
from runs import assert_goes_on, sample, settings_of
from scipy import sparse
from threadpoolctl import threadpool_info, threadpool_limits

from solver.arrays import sparse_factor
from solver.latin import (
    PGD,
    Auto,
    Checkpoint,
    Ending,
    Latin,
    Paper,
    Stop,
    iterations,
    solve,
)
from solver.latin.end.status_step import states_of
from solver.latin.iteration import Iteration
from solver.latin.stages import coarse, response
from solver.latin.stages.blocks import Blocks, one_blas_thread
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.reference.rules import HELD
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of


@pytest.mark.parametrize("multiscale", [True, False])
def test_without_load_the_run_stops_at_once(multiscale):
    chosen = options(peak=0.0, multiscale=multiscale)
    solution = solve(discretise(chosen), method_of(chosen), watch=False)
    assert solution.status.ending is Ending.CONVERGED
    assert solution.iterate.number == 1
    assert solution.records[-1].indicator == 0.0
    assert solution.records[-1].behaviour == 0.0
    assert not solution.iterate.displacement.any()


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"multiscale": False},
        {"substructures": 1},
        {"elements": 53, "substructures": 7},
        {"load": "random", "peak": 2400.0},
        {
            "body_force": 1000.0,
            "support_displacement": 5e-4,
            "friction_profile": "rising",
        },
    ],
    ids=str,
)
def test_started_at_the_reference_the_run_stops_at_once(change):
    chosen = options(**change, k_scale=2.0)
    problem = discretise(chosen)
    reference = reference_of(problem)
    displacement, force = boundary_of(problem, reference)
    k = method_of(chosen).direction.of(problem)
    start = Checkpoint(0, 0.0, displacement + force / k[:, None])
    solution = solve(
        problem,
        method_of(chosen.replace(tolerance=1e-20)),
        start=start,
        distance=distance_to(reference, problem),
        watch=False,
    )
    assert solution.status.ending is Ending.CONVERGED
    assert solution.iterate.number == 1
    assert solution.records[-1].error_displacement < 1e-10
    assert solution.records[-1].error_force < 1e-8


@pytest.mark.parametrize(
    "change", [{}, {"multiscale": False}, {"body_force": 500.0}], ids=str
)
@pytest.mark.parametrize("elements", [30, 32])
def test_resuming_from_a_checkpoint_continues_bit_by_bit(change, elements):
    assert_goes_on(options(**{**SMALL, "elements": elements}, **change), 12, 6)


def test_the_clock_stands_still_while_the_consumer_looks(monkeypatch):
    now = 0.0

    def clock():
        nonlocal now
        now += 1.0
        return now

    module = importlib.import_module("solver.latin.iteration")
    monkeypatch.setattr(module, "time", SimpleNamespace(perf_counter=clock))
    chosen = options(**SMALL)
    seconds = []
    for iterate in islice(iterations(discretise(chosen), method_of(chosen)), 5):
        seconds.append(iterate.seconds)
        now += 1e6
    assert seconds == [1.0, 2.0, 3.0, 4.0, 5.0]


def test_iterates_are_read_only():
    iterate = sample(options(**SMALL), 3)
    for name in ("outgoing", "incoming", "local_displacement", "local_incoming", "k"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(iterate, name)[...] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        iterate.number = 7
    with pytest.raises(ValueError, match="read-only"):
        iterate.checkpoint.outgoing[0, 0] = 1.0


def test_a_cancelled_and_an_exhausted_run_keep_their_last_iterate():
    problem = discretise(options(**SMALL))
    # Without an accuracy no status step asks for the answers.
    latin = Latin(stop=Stop(tolerance=1e-26, iterations=3), finish=None)
    patient = replace(latin, stop=replace(latin.stop, iterations=100))
    answers = iter([False, False, True])
    cancelled = solve(problem, patient, cancelled=lambda: next(answers))
    exhausted = solve(problem, latin)
    assert cancelled.status.ending is Ending.CANCELLED
    assert exhausted.status.ending is Ending.EXHAUSTED
    for solution in (cancelled, exhausted):
        assert solution.iterate.number == 3
        assert [entry.iteration for entry in solution.records] == [1, 2, 3]
        assert solution.status.advice
    assert np.array_equal(cancelled.iterate.outgoing, exhausted.iterate.outgoing)


def test_a_run_whose_numbers_overflow_says_where_and_keeps_the_last_good_iterate():
    chosen = options(**SMALL)
    problem = discretise(chosen)
    start = next(iterations(problem, method_of(chosen))).checkpoint
    huge = replace(start, outgoing=start.outgoing * 1e160)
    with np.errstate(over="ignore", invalid="ignore"):
        solution = solve(problem, method_of(chosen), start=huge, watch=False)
    assert solution.status.ending is Ending.DIVERGED
    assert "at iteration 2" in solution.status.advice


LARGE = {
    "block": {
        "elements": 192,
        "elements_up": 96,
        "substructures": 8,
        "substructures_up": 4,
    },
    "layers": {
        "elements": 192,
        "elements_up": 16,
        "substructures": 8,
        "search_direction": "paper",
    },
    "bar": {"elements": 2000, "acceleration": "anderson"},
    "strand": {"elements": 800},
}


@pytest.mark.parametrize("scene", LARGE)
def test_iterates_are_the_same_to_the_bit_whatever_the_threads(scene):
    settings = settings_of(scene, **LARGE[scene])
    one, several = (sample(settings.replace(threads=threads), 5) for threads in (1, 3))
    assert len(Blocks(one.problem.n_rows, one.problem.n_instants).slices) > 1
    assert np.array_equal(one.outgoing, several.outgoing)
    assert np.array_equal(one.local_displacement, several.local_displacement)


def test_blas_has_one_thread_while_an_iteration_lasts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def threads() -> set[int]:
        return {
            each["num_threads"]
            for each in threadpool_info()
            if each["user_api"] == "blas"
        }

    seen: list[set[int]] = []
    stage = Iteration.linear_stage
    monkeypatch.setattr(
        Iteration, "linear_stage", lambda at: (seen.append(threads()), stage(at))
    )
    settings = BarSettings.checked(SMALL_BAR)
    with threadpool_limits(2, user_api="blas"):
        for _ in islice(iterations(discretise(settings), method_of(settings)), 2):
            assert threads() == {2}
        with one_blas_thread:
            with one_blas_thread:
                pass
            assert threads() == {1}
        assert threads() == {2}
    assert seen == [{1}, {1}]


SMALL_BAR = {
    "elements": 20,
    "instants": 11,
    "substructures": 4,
    "search_direction": "paper",
}


def test_a_sparse_factor_tells_a_singular_matrix_from_memory_that_is_short(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(LinAlgError, match="singular"):
        sparse_factor(sparse.csc_array((3, 3)))

    def short_of_memory(matrix: Any) -> Any:
        raise RuntimeError("SUPERLU_MALLOC fails for buf in intCalloc()")

    monkeypatch.setattr("solver.arrays.splu", short_of_memory)
    with pytest.raises(MemoryError):
        sparse_factor(sparse.eye_array(3, format="csc"))


def singular(*arguments: Any, **options: Any) -> Any:
    raise LinAlgError("Factor is exactly singular")


@pytest.mark.parametrize(
    "module", [response, coarse], ids=["substructure", "coarse problem"]
)
def test_a_sparse_factor_that_fails_is_refused_as_a_dense_one_is(
    module: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = BarSettings.checked(SMALL_BAR)
    monkeypatch.setattr(module, "sparse_factor", singular)
    with pytest.raises(RefusedError, match="k_scale"):
        next(iterations(discretise(settings), method_of(settings)))


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Auto(scale=0.0), "Auto.scale"),
        (lambda: Paper(scale=-1.0), "Paper.scale"),
        (lambda: PGD(modes=0), "PGD.modes"),
        (lambda: PGD(tolerance=math.nan), "PGD.tolerance"),
        (lambda: Stop(accuracy=0.0), "Stop.accuracy"),
        (lambda: Stop(tolerance=-1.0), "Stop.tolerance"),
        (lambda: Stop(iterations=0), "Stop.iterations"),
        (lambda: Latin(relaxation=1.5), "Latin.relaxation"),
        (lambda: Latin(threads=0), "Latin.threads"),
    ],
)
def test_a_part_refuses_its_own_numbers(make: Callable[[], object], name: str) -> None:
    with pytest.raises(
        RefusedError, match=rf"^{name} = .* is refused; allowed: a (whole )?number"
    ):
        make()


def test_where_no_first_iterate_moves_the_status_step_is_tried_at_once():
    sizes = {"elements": 16, "elements_up": 8, "instants": 21, "friction": 2.0}
    settings = CATALOGUE["fault"].checked(sizes)
    problem = discretise(settings)
    method = method_of(settings)
    first = next(iterations(problem, method))
    assert (states_of(first) == HELD).all()
    assert not reference_of(problem).status.any()
    solution = solve(problem, method, watch=False)
    assert solution.is_certified
    assert solution.iterate.number == 2
