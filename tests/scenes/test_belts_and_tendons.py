"""A band on a guide holds, slips, stretches and draws in as Euler's law says."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from wedges import drawn_in, loss

from solver import discrete
from solver.discrete.plane.makers.band import PULL, TAIL
from solver.latin import iterations, solve
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.reference.newton import FEWEST_STEPS, Newton
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.values import SettingError
from solver.study.outcomes import AT_ROUNDING, run
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.finished import FinishedRun
from solver.study.verdicts import Verdict, judge

TENDON = {
    "guide": "duct",
    "driven": "jacked",
    "pull_load": "jack",
    "pull": 2e6,
    "wrap": 18.0,
    "friction": 0.2,
    "young": 195e9,
    "section": 1.8e-3,
    "tail": "held",
    "instants": 9,
}


def settings_of(**changes):
    return CATALOGUE["belt"].checked(changes)


def solved(settings):
    """Problem, reference, and tensions of all elements, (n_elements, n_instants)."""
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    return problem, reference, settings.structure().tensions(problem, reference)


def finished(settings):
    problem = discretise(settings)
    return FinishedRun(settings, solve(problem, method_of(settings)))


def pulled_to(share, friction, wrap):
    """Values of a rope that is pulled to a share of the ratio that friction carries."""
    limit = math.exp(friction * math.radians(wrap))
    pull = (share * limit - 1.0) * 1000.0
    return {
        "friction": friction,
        "wrap": wrap,
        "pull_load": [[0.0, 0.0], [0.25, 0.0], [1.0, pull]],
        "elements": 120,
        "instants": 9,
    }


@pytest.mark.parametrize(("friction", "wrap"), [(0.3, 180.0), (0.2, 270.0)])
def test_a_rope_holds_up_to_the_exponential_of_its_angle(friction, wrap):
    held = settings_of(**pulled_to(0.99, friction, wrap))
    solved(held)
    with pytest.raises(SettingError, match="more no friction carries"):
        settings_of(**pulled_to(1.01, friction, wrap))
    # Without the refusal no forces are found, either.
    more = held.path("pull_load") * (1.01 / 0.99)
    guide = held.curve
    loads = [
        guide.load(PULL, held.tail_tension + more),
        guide.load(TAIL, held.tail_tension),
    ]
    lost = replace(held.structure(), loads=loads)
    assert not reference_of(discrete.discretise(lost)).converged.all()


def test_tension_friction_and_the_way_of_the_end_are_those_of_closed_form():
    settings = settings_of(elements=120, instants=13)
    problem, reference, tensions = solved(settings)
    exact = {curve.of: curve for curve in settings.exact(problem, reference)}
    middles = (np.arange(120) + 0.5) / 120 * settings.curve.length
    for column in (-1, 9):
        known = np.interp(
            middles, exact["axial force"].across, exact["axial force"].up[:, column]
        )
        assert tensions[1:-1, column] == pytest.approx(known, rel=5e-3)
    moved, _ = settings.structure().loop(problem).along(reference)
    assert moved == pytest.approx(exact["loop"].across, rel=1e-3, abs=1e-9)
    friction = reference.contact("guide").tangential_force.sum(axis=0)
    assert friction == pytest.approx(-settings.path("pull_load"), abs=1e-6)


def test_the_way_of_a_pulled_end_is_its_own_where_the_other_is_held():
    """The loop was over the way of the end that is held: none."""
    settings = settings_of(tail="held", elements=120, instants=9)
    problem, reference, _ = solved(settings)
    moved, tension = settings.structure().loop(problem).along(reference)
    exact = settings.capstan.displacement(settings.tension, None)
    assert exact.max() == pytest.approx(5.8e-4, rel=0.01)
    assert moved == pytest.approx(exact, abs=1e-3 * exact.max())
    assert tension == pytest.approx(settings.tension)


def test_a_rope_that_runs_has_the_ratio_of_its_angle_both_ways():
    path = [[0.0, 0.0], [0.25, 0.0], [0.6, 0.003], [1.0, -0.003]]
    settings = settings_of(driven="moved", pull_load=path, elements=120, instants=41)
    run = finished(settings)
    assert run.solution.is_certified
    limit = math.exp(0.3 * math.pi)
    ratio = QUANTITIES["tension_ratio"](run)
    assert ratio == pytest.approx(limit, rel=1e-3)
    back = reading("tension_ratio@1")(run)
    assert back == pytest.approx(1.0 / limit, rel=1e-3)
    torque = QUANTITIES["torque"](run)
    assert torque == pytest.approx(1000.0 * (limit - 1.0) * 0.1, rel=2e-3)
    # 3.1 mm of each metre that passes.
    creep = QUANTITIES["creep"](run)
    assert creep == pytest.approx(1000.0 * (limit - 1.0) / (5e9 * 1e-4), rel=2e-3)


@pytest.mark.parametrize("friction", [0.6, 0.3])
@pytest.mark.parametrize("pull", [700.0, 1400.0])
def test_the_friction_that_holds_a_rope_is_eulers_whatever_mu_the_run_has(
    friction, pull
):
    """From the sums of friction and pressure it was 0.38 at a mu of 0.6, not 0.28."""
    run = finished(
        settings_of(
            friction=friction, pull=pull, elements=60, instants=5, tail="pulled"
        )
    )
    assert run.solution.is_certified
    needed = math.log((1000.0 + pull) / 1000.0) / math.pi
    assert QUANTITIES["holding_friction"](run) == pytest.approx(needed, rel=1e-6)
    held = 1000.0 * math.expm1(friction * math.pi)
    assert QUANTITIES["holding_force"](run) == pytest.approx(held, rel=1e-6)


def test_errors_of_a_belt_are_the_same_whatever_the_unit_of_length():
    """Turns of beams, in rad, were displacements, in m, of errors and indicators."""
    errors = []
    indicators = []
    for size in (1.0, 128.0):
        settings = settings_of(
            drum_radius=0.1 * size,
            section=1e-4 * size,
            young=5e9 / size,
            elements=20,
            instants=9,
            start="zero",
        )
        problem = discretise(settings)
        distance = distance_to(reference_of(problem), problem)
        search = islice(iterations(problem, method_of(settings)), 6)
        iterates = list(search)
        errors.append([distance.of_displacement(iterate) for iterate in iterates])
        indicators.append([iterate.violation for iterate in iterates])
    assert errors[0] == pytest.approx(errors[1], rel=1e-6)
    assert indicators[0] == pytest.approx(indicators[1], rel=1e-6)


def test_a_drum_carries_nothing_of_ends_that_are_pulled_alike():
    """Rounding of the tensions was a torque of 4e-13 N m."""
    run = finished(settings_of(tail="alike", elements=20, instants=5))
    assert QUANTITIES["torque"](run) == 0.0
    assert QUANTITIES["creep"](run) == 0.0


def test_a_jack_reads_its_force_and_wedges_leave_the_known_one():
    settings = settings_of(**TENDON, elements=160)
    problem, reference, tensions = solved(settings)
    _, force = settings.structure().loop(problem).along(reference)
    jacked = np.argmin(np.abs(settings.times() - 0.5))
    assert force[jacked] == pytest.approx(2e6, rel=3e-4)
    assert tensions[0, jacked] == pytest.approx(1768.8e3, rel=5e-4)
    drawn = drawn_in(settings.capstan, 2e6, 0.006)
    assert tensions[:, -1].max() == pytest.approx(drawn.largest, rel=1e-3)
    assert force[-1] == pytest.approx(drawn.at_anchor, rel=2e-3)


def test_a_tendon_jacked_from_both_ends_has_the_most_in_its_middle_left():
    settings = settings_of(**TENDON | {"tail": "alike", "draw_in": 0.0}, elements=80)
    _, reference, tensions = solved(settings)
    assert tensions[41, -1] == pytest.approx(1880.9e3, rel=1e-3)
    assert tensions[:, -1] == pytest.approx(tensions[::-1, -1], rel=1e-6)
    slip = reference.contact("guide").slip[:, -1]
    assert slip == pytest.approx(-slip[::-1], rel=1e-4, abs=1e-9)


def test_unintended_angles_press_as_those_of_the_curve_do():
    wobbling = settings_of(**TENDON)
    angle = 18.0 + math.degrees(0.0075 * 40.0)
    bent = settings_of(**TENDON | {"wrap": angle, "wobble": 0.0})
    assert loss(wobbling.capstan) == pytest.approx(0.0030708, rel=1e-5)
    *_, first = solved(wobbling)
    *_, second = solved(bent)
    assert first == pytest.approx(second, rel=1e-9, abs=1e-3)


def test_a_rope_of_turns_is_cut_along_itself_and_the_answer_stays():
    tensions = []
    for substructures in (1, 5):
        settings = settings_of(
            wrap=800.0,
            pull=20_000.0,
            elements=100,
            substructures=substructures,
            instants=9,
        )
        problem, _, found = solved(settings)
        tensions.append(found)
        assert len(problem.substructures) == substructures
    assert tensions[0] == pytest.approx(tensions[1], rel=1e-7, abs=1e-5)


@pytest.mark.parametrize(
    ("changes", "most"),
    [
        ({}, 60),
        ({"elements": 20}, 60),
        (TENDON | {"instants": 21}, 60),
        # Ends that are moved far beyond the elongation, so that all of it slides.
        ({"driven": "jacked"}, 60),
        ({"driven": "jacked", "draw_in": 0.02}, 60),
        ({"driven": "moved", "displacement": 0.005}, 60),
        ({"driven": "moved", "displacement": -0.005}, 60),
    ],
)
def test_the_search_needs_few_iterations_whatever_the_mesh(changes, most):
    settings = settings_of(finish="none", **changes)
    problem = discretise(settings)
    reference = reference_of(problem)
    distance = distance_to(reference, problem)
    for iterate in iterations(problem, method_of(settings)):
        if distance.of_friction_force(iterate) <= 0.01:
            break
        assert iterate.number < most


@pytest.mark.parametrize("moved", [0.005, -0.005])
def test_a_belt_that_runs_starts_from_a_turn_near_its_solution(moved):
    settings = settings_of(driven="moved", displacement=moved, elements=80)
    problem, reference, _ = solved(settings)
    slide = settings.structure().slide()
    # Rigid: no part of the band is strained, in units of what a tension strains.
    size = max(
        np.abs(part.elasticity.stiffness).max() for part in problem.substructures
    )
    for part in problem.substructures:
        force = part.elasticity.stiffness @ problem.rest[part.dofs]
        assert np.abs(force).max() <= 1e-12 * size * np.abs(problem.rest).max()
    slip = reference.contact("guide").slip
    assert slide[0] == slip[0, 0] == 0.0
    elongation = 1000.0 * settings.capstan.ratio / 5e5 * settings.curve.length
    assert np.abs(slip - slide).max() < elongation
    assert np.abs(slip).max() > 3.0 * elongation


@pytest.mark.parametrize(
    "changes", [{}, {"tail": "held"}, {"driven": "jacked", "tail": "alike"}]
)
def test_a_belt_that_cannot_run_starts_from_zero(changes):
    assert discretise(settings_of(**changes)).rest is None


def test_a_front_of_slip_is_followed_along_a_long_belt(monkeypatch):
    seek = Newton.seek
    counts = []

    def counted(self, system, guess, sides):
        before = self.system.solutions
        found = seek(self, system, guess, sides)
        if found is not None:
            counts.append(self.system.solutions - before)
        return found

    monkeypatch.setattr(Newton, "seek", counted)
    solved(settings_of(elements=120, instants=5))
    assert max(counts) > FEWEST_STEPS


def test_friction_that_grows_with_slip_carries_by_its_largest():
    law = {"friction_law": "slip-dependent", "friction_ratio": 1.5}
    settings_of(**law, **pulled_to(1.2, 0.3, 180.0))
    with pytest.raises(SettingError, match="more no friction carries"):
        settings_of(**law, **pulled_to(1.7, 0.3, 180.0))


def test_elements_over_which_the_guide_turns_far_are_refused():
    with pytest.raises(SettingError, match="at least 36"):
        settings_of(wrap=1080.0, elements=35)


def test_a_belt_that_flies_off_is_right_up_to_what_its_certificate_states():
    # Pushed off its drum it leans on one contact, as a lever, 1e4 m away.
    values = {
        "substructures": 2,
        "driven": "moved",
        "displacement": -1.2e-3,
        "pull_load": "cycle",
        "tail_load": [[0.33, -11.9]],
        "elements": 14,
    }
    outcome = run("belt", values)
    assert outcome.certified
    assert AT_ROUNDING < outcome.laws < outcome.residual < 1e-5
    assert judge(outcome, 0.01).verdict == Verdict.RIGHT
