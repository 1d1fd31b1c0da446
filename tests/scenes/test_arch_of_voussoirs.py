"""An arch of voussoirs stands, falls, opens and thrusts as statics says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from solver import discrete
from solver.discrete.plane.makers.voussoirs import LIVE
from solver.latin import Latin, iterations, solve
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.reference.limit_analysis import collapse_of, load_factors
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.quantities import QUANTITIES
from solver.study.quantities.finished import FinishedRun

STILL = {"displacement": 0.0, "instants": 5}
MOVED = [[0.0, 0.0], [0.25, 0.0], [1.0, 2e-3]]


def settings_of(**changes):
    return CATALOGUE["arch"].checked(changes)


def weight_of(settings):
    """Weight of all that stands on the abutments at the end, N."""
    return float(settings.structure().downwards[-1])


def thrust_of(settings):
    """Thrust over weight at all instants, by the incremental solver."""
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    _, thrust = settings.structure().loop(problem).along(reference)
    return thrust / weight_of(settings)


@pytest.mark.parametrize(
    ("changes", "stands"),
    [
        ({"thickness": 0.1085, "friction": 0.8}, True),
        ({"thickness": 0.1065, "friction": 0.8}, False),
        ({"thickness": 0.2, "friction": 0.31}, True),
        ({"thickness": 0.2, "friction": 0.3}, False),
    ],
)
def test_an_arch_falls_where_no_forces_in_its_joints_balance_its_weight(
    changes, stands
):
    """Statics: 0.10717 of the radius, and a coefficient of friction of 0.3084."""
    settings = settings_of(young=1e12, elements=4, **STILL, **changes)
    problem = discretise(settings)
    assert (collapse_of(problem) is None) is stands
    assert (settings.statics.reserve >= 0.0) is stands
    if stands:
        assert reference_of(problem).converged.all()


@pytest.mark.parametrize("elements", [2, 4])
def test_the_thrust_is_the_least_once_an_abutment_has_moved_apart(elements):
    settings = settings_of(
        voussoirs=25, elements=elements, friction=0.7, instants=5, abutment_load=MOVED
    )
    least, _ = settings.statics.thrusts()
    assert least == pytest.approx(0.17474, abs=6e-6)
    assert thrust_of(settings)[-1] == pytest.approx(least, rel=1e-3)


def test_the_thrust_is_the_largest_once_an_abutment_has_moved_inwards():
    inwards = [[0.0, 0.0], [0.25, 0.0], [1.0, -2e-3]]
    settings = settings_of(
        voussoirs=25, friction=0.7, instants=5, abutment_load=inwards
    )
    _, largest = settings.statics.thrusts()
    assert largest == pytest.approx(0.22722, abs=6e-6)
    assert thrust_of(settings)[-1] == pytest.approx(largest, rel=2e-3)


def test_the_thrust_under_a_fill_is_that_of_its_columns():
    settings = settings_of(
        voussoirs=25,
        friction=0.9,
        instants=5,
        abutment_load=MOVED,
        fill=1e4,
        cover=0.3,
    )
    statics = settings.statics
    assert weight_of(settings) == pytest.approx(statics.weight * 2e4, rel=2e-3)
    assert thrust_of(settings)[-1] == pytest.approx(statics.thrusts()[0], rel=3e-3)


def test_the_thrust_of_a_moved_arch_stays_between_both_bounds():
    settings = settings_of()
    thrust = thrust_of(settings)[settings.times() >= 0.25]
    least, largest = settings.statics.thrusts()
    assert least <= thrust.min() < 0.98 * thrust[0]
    assert 1.02 * thrust[0] < thrust.max() <= largest


@pytest.mark.parametrize("voussoirs", [31, 61])
def test_the_search_takes_no_longer_with_more_voussoirs(voussoirs):
    """Without the coarse problem news creeps from stone to stone."""
    problem = discretise(settings_of(voussoirs=voussoirs, instants=21))
    distance = distance_to(reference_of(problem), problem)
    errors = []
    for method in (Latin(finish=None), Latin(finish=None, multiscale=False)):
        for iterate in iterations(problem, method):
            error = distance.of_friction_force(iterate)
            if error < 0.01 or iterate.number == 60:
                break
        errors.append(error)
    with_coarse, without = errors
    assert with_coarse < 0.01
    assert without > 0.5


def run_of(**changes):
    settings = settings_of(**changes)
    return FinishedRun(settings, solve(discretise(settings), method_of(settings)))


def test_an_abutment_that_moves_apart_makes_three_hinges():
    run = run_of(voussoirs=16, friction=0.9, instants=5, abutment_load=MOVED)
    assert run.solution.is_certified
    assert QUANTITIES["hinges"](run) == 3.0
    least, _ = run.settings.statics.thrusts()
    assert QUANTITIES["thrust"](run) == pytest.approx(least, rel=2e-3)


def rigid_forces(ring, angle, weight):
    """Forces along and up, and moment about the centre, at all joints, (n_joints, 5).

    On the part at the left of each, as rows times the force and moment at the left
    springing, the load at the angle, and 1.
    """
    middles = 0.5 * (ring.angles[:-1] + ring.angles[1:])
    half = 0.5 * ring.span / ring.voussoirs
    inner = ring.outer - ring.thickness
    mean = (ring.outer**3 - inner**3) / (ring.outer**2 - inner**2)
    levers = 2.0 / 3.0 * mean * np.sin(half) / half * np.sin(middles)
    stones = (middles < ring.angles[:, None]) * weight / ring.voussoirs
    passed = 1.0 * (ring.angles > angle)
    zero = np.zeros_like(passed)
    along = [zero - 1.0, zero, zero, zero, zero]
    up = [zero, zero - 1.0, zero, passed, stones.sum(axis=1)]
    lever = ring.outer * np.sin(angle)
    moment = [zero, zero, zero - 1.0, lever * passed, stones @ levers]
    return [np.stack(columns, axis=1) for columns in (along, up, moment)]


def rigid_factor(ring, angle, weight):
    """Largest load at an angle from the crown over the weight that rigid stones carry.

    A linear program in the force and moment at the left springing, and the load.
    """
    along, up, moment = rigid_forces(ring, angle, weight)
    cosine = np.cos(ring.angles)[:, None]
    sine = np.sin(ring.angles)[:, None]
    pressing = sine * up - cosine * along
    inner = ring.outer - ring.thickness
    # A pressing force N at the radius r has the moment N r.
    rows = np.concatenate([inner * pressing - moment, moment - ring.outer * pressing])
    bounds = [(None, None), (None, None), (None, None), (0.0, None)]
    goal = [0.0, 0.0, 0.0, -1.0]
    return -linprog(goal, rows[:, :4], -rows[:, 4], bounds=bounds).fun / weight


@pytest.mark.parametrize("place", [0.5, 0.3])
def test_the_limit_of_a_load_is_that_of_rigid_stones(place):
    changes = {"voussoirs": 11, "thickness": 0.2, "friction": 5.0, "live": 100.0}
    settings = settings_of(
        place=place, place_load=[[0.0, place]], displacement=0.0, instants=3, **changes
    )
    bare = settings.structure().without(LIVE)
    factors = load_factors(discretise(settings), discrete.discretise(bare))
    ring = settings.ring
    weight = bare.downwards[-1]
    limit = rigid_factor(ring, ring.span * (place - 0.5), weight)
    assert factors[-1] * 100.0 / weight == pytest.approx(limit, rel=0.01)


def test_a_load_that_passes_brings_down_at_its_factor_and_not_before():
    changes = {"voussoirs": 15, "displacement": 0.0, "instants": 21}
    factor = QUANTITIES["live_factor"](run_of(live=200.0, **changes))
    assert factor > 1.0
    for share, falls in ((0.99, False), (1.01, True)):
        heavier = settings_of(live=200.0 * share * factor, **changes)
        assert (collapse_of(discretise(heavier)) is not None) is falls


def test_limits_of_an_arch_are_quantities_of_its_run():
    run = run_of(voussoirs=31, thickness=0.2)
    assert QUANTITIES["thinnest"](run) == pytest.approx(0.10717, abs=1e-5)
    assert QUANTITIES["least_friction"](run) == pytest.approx(0.3084, abs=1e-4)
    for change in ({"live": 100.0}, {"unit_weight": 0.0}):
        assert not QUANTITIES["thinnest"].applies(settings_of(**change))


@pytest.mark.parametrize(
    ("law", "falls"),
    [
        ({"friction": 0.2, "friction_law": "general", "cohesion": 1e5}, False),
        ({"friction": 0.6, "friction_law": "general", "friction_cap": 1e3}, True),
    ],
)
def test_statics_tells_no_limits_of_an_arch_that_other_friction_holds(law, falls):
    """A mu of 0.35 was called the least; one of 0.2 stood, and one of 0.6 fell."""
    changes = {
        "voussoirs": 15,
        "thickness": 0.15,
        "instants": 5,
        "abutment_load": MOVED,
    }
    settings = settings_of(**changes, **law)
    problem = discretise(settings)
    assert (collapse_of(problem) is not None) is falls
    for name in ("thinnest", "least_friction"):
        assert QUANTITIES[name].applies(settings_of(**changes))
        assert not QUANTITIES[name].applies(settings)
    assert list(settings_of(**changes, friction=0.6).exact(problem))
    assert not list(settings.replace(friction=0.6).exact(problem))


def test_the_closed_form_is_the_thrust_of_an_arch_with_hinges():
    settings = settings_of(voussoirs=15, instants=5, abutment_load=MOVED)
    problem = discretise(settings)
    (exact,) = settings.exact(problem)
    moved, thrust = settings.structure().loop(problem).along(reference_of(problem))
    assert exact.across[-1] == pytest.approx(moved[-1])
    assert thrust[-1] == pytest.approx(exact.up[-1], rel=2e-3)
    # An elastic arch has no hinges yet, and one under a passing load has others.
    assert not list(settings_of().exact(problem))
    assert not list(settings.replace(live=100.0).exact(problem))


def test_a_load_acts_at_its_place_whatever_the_mesh():
    settings = settings_of(voussoirs=4, elements=3, live=100.0, displacement=0.0)
    shares = settings.ring.under_load(settings.path("place_load"))
    np.testing.assert_allclose(shares.sum(axis=(0, 1)), 1.0)
    x = np.einsum("vnt,vn->t", shares, settings.ring.backs[:, :, 0])
    assert x[0] == pytest.approx(-1.075)
    assert x[-1] == pytest.approx(1.075)
    assert np.all(np.diff(x) >= 0.0)


def test_a_load_that_the_arch_cannot_carry_is_told():
    run = run_of(
        voussoirs=7, friction=2.0, live=1e5, displacement=0.0, instants=5, elements=2
    )
    assert not run.solution.is_certified
    assert run.lost_from is not None


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, "its right abutment is moved apart and together"),
        ({"live": 100.0}, "a load passes over its back and its right abutment"),
        ({"live": 100.0, "displacement": 0.0}, "a load passes over its back."),
        (
            {"abutment": "down", "abutment_load": "ramp"},
            "its right abutment is lowered.",
        ),
        ({"span": 90.0}, "A segment of an arch"),
    ],
)
def test_the_sentence_says_what_is_done_to_an_arch(changes, said):
    assert said in settings_of(**changes).sentence()


@pytest.mark.parametrize(("abutment", "title"), [("down", "Settl"), ("apart", "Move")])
def test_what_an_abutment_does_downwards_is_no_movement_but_a_settlement(
    abutment, title
):
    """A movement of -42 um stood beside the arrow of a displacement of +42 um."""
    (across, _), _ = settings_of(abutment=abutment).structure().axes
    assert across.startswith(title)
