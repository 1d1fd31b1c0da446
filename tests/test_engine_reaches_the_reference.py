"""Driven on, the iteration reaches the incremental reference, whatever path it takes there."""

from __future__ import annotations

import dataclasses
import importlib
from dataclasses import replace
from itertools import islice, pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from solver.discrete import discretise
from solver.latin import Checkpoint, Ending, Iterate, iterations, solve
from solver.latin.direction import search_direction
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.laws import Dirichlet, Friction, Neumann
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes.bar import BarSettings

SMALL = {"elements": 30, "instants": 41, "substructures": 6}
LOOK = 20
PATHS = ["ramp", "triangle", "cycle", "sine", "decaying", "random"]


def options(**values):
    return BarSettings.checked({"tolerance": 1e-26, "max_iterations": 20_000, **values})


def balanced(substructures, **values):
    """Give options whose friction k is 100 ES/L^2 per length for any number of substructures."""
    factor = 100.0 / substructures**2
    return options(substructures=substructures, k_friction_scale=factor, **values)


def table(forces):
    times = np.linspace(0.0, 1.0, len(forces))
    return [[float(t), float(f)] for t, f in zip(times, forces, strict=True)]


def driven(chosen):
    """Iterate until the LATIN indicator, looked at now and then, is below the tolerance."""
    problem = discretise(chosen)
    for iterate in islice(iterations(problem, chosen), LOOK - 1, chosen.max_iterations, LOOK):
        if latin_indicator(iterate) <= chosen.tolerance:
            return iterate
    pytest.fail(f"eta is {latin_indicator(iterate)} after {iterate.number} iterations")


def assert_reached(chosen):
    iterate = driven(chosen)
    reference = incremental(iterate.problem)
    distance = distance_to(reference, iterate.problem)
    assert distance.of_friction_force(iterate) < 1e-8
    assert distance.of_displacement(iterate) < 1e-9
    return iterate


def sample(chosen, number):
    """Give the iterate of some number."""
    return next(islice(iterations(discretise(chosen), chosen), number - 1, None))


def relative(found, expected):
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def boundary_of(problem, reference):
    """Give W and F of a reference on every row, scaled: what elasticity leaves goes to the ends."""
    law = problem.friction
    displacement = reference.displacement / problem.scales.displacement
    friction = reference.friction_force / problem.scales.force
    share = law.bound / np.bincount(law.points, weights=law.bound)[law.points]
    force = np.zeros((problem.n_rows, problem.n_instants))
    force[law.rows] = share[:, None] * friction[law.points]
    for part in problem.substructures:
        own = np.isin(part.rows, law.rows)
        rest = part.elasticity.stiffness @ displacement[part.dofs]
        if part.body_force is not None:
            rest -= part.body_force
        rest[part.elasticity.trace[own]] -= force[part.rows[own]]
        force[part.rows[~own]] = rest[part.elasticity.trace[~own]]
    return displacement[problem.row_dofs], force


def iterate_of(problem, k, displacement, force):
    """Make the iterate whose linear and local stage both are one pair of fields."""
    incoming = displacement - force / k[:, None]
    return Iterate(
        number=1,
        seconds=0.0,
        problem=problem,
        k=k,
        outgoing=displacement + force / k[:, None],
        incoming=incoming,
        local_displacement=displacement,
        local_incoming=incoming,
    )


def test_the_default_reaches_the_reference_in_fields_and_statuses():
    chosen = options()
    problem = discretise(chosen)
    reference = incremental(problem)
    solution = solve(problem, chosen, distance=distance_to(reference, problem))
    assert solution.status.ending is Ending.CONVERGED
    last = solution.records[-1]
    assert last.indicator <= 1e-26
    assert last.error_force < 1e-8
    assert last.error_displacement < 1e-9
    assert np.array_equal(solution.iterate.status, reference.status)


@pytest.mark.parametrize("load", PATHS)
@pytest.mark.parametrize("peak", [900.0, 2000.0])
def test_every_load_path_reaches_the_reference(load, peak):
    assert_reached(options(**SMALL, load=load, peak=peak))


@pytest.mark.parametrize("seed", range(8))
def test_random_tables_of_points_reach_the_reference(seed):
    forces = np.random.default_rng(seed).uniform(-1800.0, 1800.0, 9)
    assert_reached(options(**SMALL, load=table(forces)))


@pytest.mark.parametrize("seed", range(2, 6))
def test_random_walks_reach_the_reference(seed):
    assert_reached(options(**SMALL, load="random", seed=seed, peak=1300.0))


@pytest.mark.parametrize(
    "change",
    [
        {"friction_profile": "rising"},
        {"friction_profile": "falling", "pressure_profile": "gap"},
        {"pressure_profile": [[0.0, 1.0], [0.5, 0.0], [1.0, 3.0]]},
        {"friction": 0.0},
        {"support_displacement": 5e-4},
        {"support_displacement": -2e-3, "support_load": "cycle", "peak": 0.0},
        {"body_force": 1000.0},
        {"body_force": -3000.0, "body_load": "decaying", "support_displacement": 1e-4},
        {"instants": 1, "load": "ramp"},
        {"instants": 2, "load": "ramp"},
    ],
    ids=str,
)
def test_every_kind_of_bar_reaches_the_reference(change):
    assert_reached(options(**{**SMALL, **change}))


@pytest.mark.parametrize("substructures", [1, 3, 7, 10, 25, 50])
def test_the_decomposition_changes_the_path_and_not_the_limit(substructures):
    chosen = balanced(substructures)
    other = balanced(5)
    assert_reached(chosen)
    assert relative(sample(chosen, 5).displacement, sample(other, 5).displacement) > 1e-3


@pytest.mark.parametrize("substructures", [4, 6, 10])
def test_substructures_of_unequal_size_reach_the_reference(substructures):
    assert_reached(options(elements=53, substructures=substructures, instants=31))


@pytest.mark.parametrize("k_scale", [0.3, 0.6, 1.7, 3.0])
def test_k_changes_the_path_and_not_the_limit(k_scale):
    chosen = options(**SMALL, k_scale=k_scale)
    assert_reached(chosen)
    plain = options(**SMALL)
    assert relative(sample(chosen, 5).displacement, sample(plain, 5).displacement) > 1e-3


@pytest.mark.parametrize("relaxation", [0.5, 0.95])
def test_relaxation_does_not_change_the_limit(relaxation):
    assert_reached(options(**SMALL, relaxation=relaxation))


@pytest.mark.parametrize("substructures", [3, 6, 10])
def test_monoscale_and_multiscale_differ_on_the_way_and_agree_in_the_limit(substructures):
    multi, mono = (
        options(**{**SMALL, "substructures": substructures}, multiscale=multiscale)
        for multiscale in (True, False)
    )
    assert relative(sample(mono, 5).displacement, sample(multi, 5).displacement) > 1e-3
    ends = [assert_reached(chosen) for chosen in (multi, mono)]
    assert relative(ends[1].displacement, ends[0].displacement) < 1e-9


def test_one_substructure_has_neither_cuts_nor_a_coarse_problem():
    multi, mono = (
        options(**{**SMALL, "substructures": 1}, multiscale=multiscale)
        for multiscale in (True, False)
    )
    problem = discretise(multi)
    assert not problem.has_cuts
    assert set(problem.interfaces) == {"friction", "support", "load"}
    for number in (1, 5):
        assert np.array_equal(sample(multi, number).outgoing, sample(mono, number).outgoing)


def test_the_rate_does_not_matter():
    slow = sample(options(duration=1024.0), 20)
    fast = sample(options(), 20)
    assert np.array_equal(slow.outgoing, fast.outgoing)
    assert np.array_equal(slow.displacement, fast.displacement)
    assert np.array_equal(slow.friction_force, fast.friction_force)
    assert latin_indicator(slow) == pytest.approx(latin_indicator(fast), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_a_path_with_pauses_gives_every_iterate_again_with_pauses(seed):
    forces = np.random.default_rng(seed).uniform(-1500.0, 1500.0, 20)
    quick = options(**{**SMALL, "instants": 20}, load=table(forces))
    times = np.concatenate([[1, 3, 2, 5], np.full(16, 2)])
    paused = np.repeat(forces, times)
    slow = options(**{**SMALL, "instants": len(paused)}, load=table(paused))
    for number in (1, 5, 30):
        expected = np.repeat(sample(quick, number).displacement, times, axis=1)
        assert relative(sample(slow, number).displacement, expected) < 1e-12


@pytest.mark.parametrize("factor", [0.37, 8.0])
def test_scaling_load_and_pressure_scales_the_answer(factor):
    plain, scaled = (
        sample(options(**SMALL, peak=900.0 * c, pressure=5000.0 * c), 20) for c in (1.0, factor)
    )
    assert relative(scaled.displacement, factor * plain.displacement) < 1e-12
    assert relative(scaled.friction_force, factor * plain.friction_force) < 1e-12
    assert latin_indicator(scaled) == pytest.approx(latin_indicator(plain), rel=1e-9)


def test_reversing_the_load_reverses_the_answer():
    plain, reversed_ = (sample(options(**SMALL, peak=peak), 20) for peak in (900.0, -900.0))
    assert relative(reversed_.displacement, -plain.displacement) < 1e-12
    assert np.array_equal(reversed_.status, -plain.status)


def test_the_bar_remembers_its_return_points():
    forces = [0.0, 600.0, 1200.0, 300.0, 900.0, 500.0, 900.0, 300.0, 1200.0, -1200.0, 1200.0]
    chosen = options(**{**SMALL, "instants": len(forces)}, load=table(forces))
    iterate = assert_reached(chosen)
    displacement, friction = iterate.displacement, iterate.friction_force
    for closes, opened in [(6, 4), (7, 3), (8, 2), (10, 2)]:
        assert relative(displacement[:, closes], displacement[:, opened]) < 1e-9
        assert relative(friction[1:, closes], friction[1:, opened]) < 1e-7
    assert relative(displacement[:, 4], displacement[:, 2]) > 1e-2


@pytest.mark.parametrize("multiscale", [True, False])
def test_without_load_the_run_stops_at_once(multiscale):
    chosen = options(peak=0.0, multiscale=multiscale)
    solution = solve(discretise(chosen), chosen)
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
        {"body_force": 1000.0, "support_displacement": 5e-4, "friction_profile": "rising"},
    ],
    ids=str,
)
def test_started_at_the_reference_the_run_stops_at_once(change):
    chosen = options(**change, k_scale=2.0)
    problem = discretise(chosen)
    reference = incremental(problem)
    displacement, force = boundary_of(problem, reference)
    k = search_direction(problem, chosen)
    start = Checkpoint(0, 0.0, displacement + force / k[:, None])
    solution = solve(
        problem,
        chosen.replace(tolerance=1e-20),
        start=start,
        distance=distance_to(reference, problem),
    )
    assert solution.status.ending is Ending.CONVERGED
    assert solution.iterate.number == 1
    assert solution.records[-1].error_displacement < 1e-10
    assert solution.records[-1].error_force < 1e-8


def test_started_where_it_ended_the_run_stops_at_once():
    chosen = options(**SMALL)
    problem = discretise(chosen)
    ended = solve(problem, chosen).iterate
    again = solve(problem, chosen, start=ended.checkpoint)
    assert again.status.ending is Ending.CONVERGED
    assert again.iterate.number == ended.number + 1
    assert again.iterate.seconds > ended.seconds


@pytest.mark.parametrize("change", [{}, {"multiscale": False}, {"body_force": 500.0}], ids=str)
@pytest.mark.parametrize("elements", [30, 32])
def test_resuming_from_a_checkpoint_continues_bit_by_bit(change, elements):
    chosen = options(**{**SMALL, "elements": elements}, **change)
    problem = discretise(chosen)
    straight = list(islice(iterations(problem, chosen), 12))
    resumed = list(islice(iterations(problem, chosen, straight[6].checkpoint), 5))
    for one, other in zip(straight[7:], resumed, strict=True):
        assert one.number == other.number
        for name in ("outgoing", "incoming", "local_displacement", "local_incoming"):
            assert np.array_equal(getattr(one, name), getattr(other, name))


def test_the_clock_stands_still_while_the_consumer_looks(monkeypatch):
    now = 0.0

    def clock():
        nonlocal now
        now += 1.0
        return now

    module = importlib.import_module("solver.latin.iterations")
    monkeypatch.setattr(module, "time", SimpleNamespace(perf_counter=clock))
    chosen = options(**SMALL)
    seconds = []
    for iterate in islice(iterations(discretise(chosen), chosen), 5):
        seconds.append(iterate.seconds)
        now += 1e6
    assert seconds == [2.0, 3.0, 4.0, 5.0, 6.0]


def test_iterates_are_read_only():
    iterate = sample(options(**SMALL), 3)
    for name in ("outgoing", "incoming", "local_displacement", "local_incoming", "k"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(iterate, name)[...] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        iterate.number = 7
    with pytest.raises(ValueError, match="read-only"):
        iterate.checkpoint.outgoing[0, 0] = 1.0


def test_iterates_stay_as_they_are_when_the_iteration_goes_on():
    chosen = options(**SMALL)
    problem = discretise(chosen)
    kept, copies = [], []
    for iterate in islice(iterations(problem, chosen), 6):
        kept.append(iterate)
        copies.append(
            [iterate.outgoing.copy(), iterate.incoming.copy(), iterate.local_displacement.copy()]
        )
    for iterate, copy in zip(kept, copies, strict=True):
        fields = [iterate.outgoing, iterate.incoming, iterate.local_displacement]
        assert all(np.array_equal(one, other) for one, other in zip(fields, copy, strict=True))
    for before, after in pairwise(kept):
        assert np.array_equal(before.incoming, after.local_incoming)
        assert not np.array_equal(before.outgoing, after.outgoing)


@pytest.mark.parametrize("number", [1, 4, 25])
@pytest.mark.parametrize("multiscale", [True, False])
def test_the_latin_indicator_is_equation_2(number, multiscale):
    iterate = sample(options(**SMALL, multiscale=multiscale, k_scale=2.0), number)
    problem, k = iterate.problem, iterate.k[:, None]
    time_step = 1.0 / (problem.n_instants - 1)

    def squared(displacement, force):
        return np.trapezoid((k * displacement**2 + force**2 / k).sum(axis=0), dx=time_step)

    linear = iterate.boundary_displacement, iterate.boundary_force
    local = iterate.local_displacement, iterate.boundary_local_force
    distance = squared(linear[0] - local[0], linear[1] - local[1])
    expected = distance / (0.5 * (squared(*linear) + squared(*local)))
    assert latin_indicator(iterate) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("load", ["sine", "random"])
@pytest.mark.parametrize(
    "change", [{}, {"body_force": 800.0, "support_displacement": 3e-4}], ids=str
)
def test_the_behaviour_indicator_vanishes_at_the_reference_and_nowhere_near_it(load, change):
    chosen = options(load=load, peak=1300.0, **change)
    problem = discretise(chosen)
    k = search_direction(problem, chosen)
    displacement, force = boundary_of(problem, incremental(problem))
    exact = behaviour_indicator(iterate_of(problem, k, displacement, force))
    assert 0.0 <= exact.total < 1e-8
    assert 0.0 <= exact.largest < 1e-8
    random = np.random.default_rng(5)
    for kind in (Friction, Dirichlet):
        (law,) = problem.of_law(kind)
        moved = displacement.copy()
        moved[law.rows] += 1e-3 * displacement.max() * random.normal(size=moved[law.rows].shape)
        assert behaviour_indicator(iterate_of(problem, k, moved, force)).total > 1e-6
    for kind in (Friction, Neumann):
        (law,) = problem.of_law(kind)
        pulled = force.copy()
        pulled[law.rows] *= 1.01
        assert behaviour_indicator(iterate_of(problem, k, displacement, pulled)).total > 1e-6


@pytest.mark.parametrize("number", [1, 5, 40, 200])
def test_the_behaviour_indicator_sees_no_k(number):
    iterate = sample(options(**SMALL), number)
    displacement, force = iterate.boundary_displacement, iterate.boundary_force
    found = [
        behaviour_indicator(iterate_of(iterate.problem, factor * iterate.k, displacement, force))
        for factor in (1e-3, 1.0, 40.0)
    ]
    assert found[1].total > 0.0
    for other in (found[0], found[2]):
        assert other.total == pytest.approx(found[1].total, rel=1e-9, abs=1e-12)
        np.testing.assert_allclose(other.map, found[1].map, rtol=1e-6, atol=1e-10)


def test_the_behaviour_indicator_falls_with_the_error():
    chosen = options(**SMALL)
    problem = discretise(chosen)
    solution = solve(problem, chosen, distance=distance_to(incremental(problem), problem))
    behaviour = np.array([entry.behaviour for entry in solution.records])
    error = np.array([entry.error_force for entry in solution.records])
    assert np.all(behaviour > 0.0)
    assert behaviour[-1] < 1e-10
    assert np.corrcoef(np.log(behaviour), np.log(error))[0, 1] > 0.9


def test_a_cancelled_and_an_exhausted_run_keep_their_last_iterate():
    chosen = options(**SMALL)
    problem = discretise(chosen)
    answers = iter([False, False, True])
    cancelled = solve(problem, chosen, cancelled=lambda: next(answers))
    exhausted = solve(problem, chosen.replace(max_iterations=3))
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
    start = next(iterations(problem, chosen)).checkpoint
    huge = replace(start, outgoing=start.outgoing * 1e160)
    with np.errstate(over="ignore", invalid="ignore"):
        solution = solve(problem, chosen, start=huge)
    assert solution.status.ending is Ending.DIVERGED
    assert "at iteration 2" in solution.status.advice
