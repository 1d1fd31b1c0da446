"""k set once more from the contact status: sooner at the same limit, and never the worse for it."""

from __future__ import annotations

from itertools import groupby, islice, pairwise, takewhile

import numpy as np
import pytest
from bars import measured

from solver.latin import Ending, directions, iterations
from solver.latin.directions import CALM, TRIAL
from solver.loads import PRESETS
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

FAST = {"search_direction": "auto", "acceleration": "anderson", "start": "nested"}


def options(**changes: object) -> BarSettings:
    return BarSettings.checked({"method": "paper", "k_update": "status", **changes})


def sample(settings: BarSettings, number: int):
    return list(islice(iterations(discretise(settings), method_of(settings)), number))


def within(settings: BarSettings, level: float) -> int:
    problem = discretise(settings)
    distance = distance_to(incremental(problem), problem)
    found = islice(iterations(problem, method_of(settings)), settings.max_iterations)
    return 1 + sum(1 for _ in takewhile(lambda it: distance.of_friction_force(it) > level, found))


@pytest.mark.parametrize("load", PRESETS)
def test_a_millionth_of_friction_force_takes_at_most_150_iterations(load):
    chosen = options(**FAST, load=load, relaxation=1.0, max_iterations=200)
    assert within(chosen, 1e-6) <= 150


@pytest.mark.parametrize("substructures", [1, 10])
def test_it_makes_the_plain_iteration_shorter(substructures):
    chosen = options(substructures=substructures, max_iterations=500)
    assert within(chosen, 1e-3) < within(chosen.replace(k_update="none"), 1e-3)


@pytest.mark.parametrize(
    "change", [{"load": "random"}, {"multiscale": False, "substructures": 3}], ids=str
)
def test_the_limit_is_the_same(change):
    solution = measured(options(**FAST, tolerance=1e-24, max_iterations=3000, **change))
    assert solution.iterate.course.phase == "updated"
    assert solution.status.ending is Ending.CONVERGED
    assert solution.records[-1].error_force < 1e-8


def test_fields_do_not_jump_when_k_does():
    pairs = pairwise(sample(options(**FAST), 60))
    before, after = next(pair for pair in pairs if not np.array_equal(pair[0].k, pair[1].k))
    assert after.course.phase == "updated"
    kept = before.boundary_displacement - before.boundary_force / after.k[:, None]
    assert np.allclose(after.local_incoming, kept, atol=1e-15)


def test_points_that_slip_more_have_a_smaller_k_and_cuts_do_not_see_it():
    chosen = options(**FAST)
    first, last = (sample(chosen, 40)[place] for place in (0, -1))
    law = last.problem.friction
    others = np.setdiff1d(np.arange(last.problem.n_rows), law.tangent.above)
    assert np.array_equal(first.k[others], last.k[others])
    share = np.mean(last.status != 0, axis=1)
    factor = (last.k / first.k)[law.tangent.above]
    stuck, sliding = share[law.points] == 0.0, share[law.points] > 0.9
    assert stuck.any()
    assert sliding.any()
    assert np.allclose(factor[stuck], 1.0)
    assert np.all(factor[sliding] < 0.35)


@pytest.mark.parametrize("acceleration", ["none", "anderson"])
def test_a_harmful_update_is_taken_back_once_and_for_all(monkeypatch, acceleration):
    monkeypatch.setattr(directions, "SLIDING", 1e-9)
    chosen = options(**{**FAST, "acceleration": acceleration})
    problem = discretise(chosen)
    constant = sample(chosen.replace(k_update="none"), CALM + 20)
    found = sample(chosen, 600)
    phases = [iterate.course.phase for iterate in found]
    assert [phase for phase, _ in groupby(phases)] == ["first", "updated", "returned"]
    start, back = phases.index("updated"), phases.index("returned")
    assert (back - start) % TRIAL == 0
    assert np.array_equal(found[back].k, constant[0].k)
    if back - start == TRIAL:  # from the state before the update, as if it had never been
        assert np.allclose(found[back].local_incoming, constant[start].local_incoming, atol=1e-15)
    distance = distance_to(incremental(problem), problem)
    assert distance.of_friction_force(found[-1]) < 1e-3


@pytest.mark.parametrize("harm", [1.0, 1e-9])
@pytest.mark.parametrize("acceleration", ["none", "anderson"])
def test_a_run_goes_on_from_any_checkpoint_to_the_bit(monkeypatch, acceleration, harm):
    monkeypatch.setattr(directions, "SLIDING", harm * directions.SLIDING)
    monkeypatch.setattr("solver.latin.anderson.MEMORY", 4)
    chosen = options(**{**FAST, "acceleration": acceleration})
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


def test_separated_bases_keep_their_k():
    chosen = options(linear_stage="pgd")
    assert not chosen.applies("k_update")
    assert all(one.course.phase == "returned" for one in sample(chosen, 30))


def test_a_compliant_point_below_its_bound_sticks_though_it_moves():
    chosen = options(**FAST, friction_law="compliant", contact_stiffness=100.0, peak=300.0)
    found = sample(chosen, 2)[-1]
    law = found.problem.friction
    moves = np.diff(law.by_point(law.tangent.jump(found.local_displacement)), axis=1) != 0.0
    below = np.abs(found.boundary_local_force[law.tangent.above]) < 0.99 * law.tangential.bound
    below = law.by_point(~below) == 0
    assert np.count_nonzero(moves & below[:, 1:]) > 100
    assert np.array_equal(found.course.status, found.status)
    assert not found.course.status[below].any()
