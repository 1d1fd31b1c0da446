"""Balance and laws alone tell a solution from an answer that is nearly one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from small_scenes import SMALL

from solver.latin import Ending, solve
from solver.laws import Neumann, Perfect
from solver.reference.assembly import jumps
from solver.reference.distance import HIDDEN, kkt_residual
from solver.reference.incremental import reference_of
from solver.reference.law_residuals import RowFields, law_residuals
from solver.reference.rules import rules_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.outcomes import AT_ROUNDING

ROUNDED = 1e-10
SEEN = 1e-6
"""A spoiled answer is to be seen clearly above what rounding leaves."""

GENERAL = {"friction_law": "general"}
PRESSED = {**SMALL["block"], "gap": "flat"}
WITH_STRENGTH = {
    "bar": (
        SMALL["bar"]
        | GENERAL
        | {"peak": 1200.0, "strength": [[0.0, 1.0], [2e-4, 1.2], [1e-3, 0.8]]}
    ),
    "block": (PRESSED | GENERAL | {"strength": [[0.0, 1.0], [1e-6, 1.2], [1e-5, 0.8]]}),
}
"""Small runs of a rod and in the plane whose friction grows and falls with slip."""
LAWS = {
    "friction": ("bar", {}, {"friction": 0.301}),
    "stiffness": (
        "bar",
        {**GENERAL, "tangential_stiffness": 1e8},
        {"tangential_stiffness": 1.01e8},
    ),
    "cohesion": ("bar", {**GENERAL, "cohesion": 100.0}, {"cohesion": 101.0}),
    "cap": ("bar", {**GENERAL, "friction_cap": 1000.0}, {"friction_cap": 1010.0}),
    "strength": ("bar", WITH_STRENGTH["bar"], {"strength": [[0.0, 1.0], [2e-4, 1.21]]}),
    "friction of the block": ("block", PRESSED, {"friction": 0.301}),
    "stiffness of the block": (
        "block",
        PRESSED | GENERAL | {"tangential_stiffness": 1e13},
        {"tangential_stiffness": 1.01e13},
    ),
    "stiffness across the block": (
        "block",
        PRESSED | GENERAL | {"normal_stiffness": 1e13},
        {"normal_stiffness": 1.01e13},
    ),
    "cohesion of the block": (
        "block",
        PRESSED | GENERAL | {"cohesion": 1e6},
        {"cohesion": 1.01e6},
    ),
    "cap of the block": (
        "block",
        PRESSED | GENERAL | {"friction_cap": 1e7},
        {"friction_cap": 1.01e7},
    ),
    "strength of the block": (
        "block",
        WITH_STRENGTH["block"],
        {"strength": [[0.0, 1.0], [1e-6, 1.21]]},
    ),
}
"""Scenes, settings, and what makes another law of them, by what differs."""


def problem_of(scene, values):
    return discretise(CATALOGUE[scene].checked(values))


def spoiled(answer, *, displacement=None, force=None):
    """An answer with other displacements or contact forces."""
    if displacement is None:
        new = answer.displacement
    else:
        new = displacement
    if force is None:
        forces = answer.contact_force
    else:
        forces = force
    return dataclasses.replace(answer, displacement=new, contact_force=forces)


def largest_work(problem, answer):
    """Place of the largest friction force, its instant, and the sliding node."""
    along = ~rules_of(problem).normal
    all_jumps = jumps(problem)
    slip = np.diff(all_jumps @ answer.displacement, axis=1, prepend=0.0)
    work = np.abs(slip * answer.contact_force) * along[:, None]
    place, instant = np.unravel_index(np.argmax(work), work.shape)
    return place, instant, all_jumps[[place]].indices[0]


SLENDER = {
    "instants": 3,
    "elements": 30,
    "bricks": 3,
    "courses": 2,
    "opening": 1,
    "opening_height": 1,
    "length": 0.0608,
    "height": 2.664e-4,
    "unit_weight": 4e6,
}
"""Bricks that are 228 times as long as high, over an opening."""


def test_rounding_of_how_far_a_slender_body_has_moved_is_no_force():
    problem = problem_of("wall", SLENDER)
    found = reference_of(problem)
    assert law_residuals(found, problem).largest < AT_ROUNDING
    # A body that has moved as a whole is seen where it touches others.
    further = found.displacement.copy()
    further[:, -1] += found.displacement.max() * problem.rigid_motions[:, 0]
    assert law_residuals(spoiled(found, displacement=further), problem).largest > SEEN


@pytest.fixture(
    params=[*SMALL, "bar with strength", "block with strength"], scope="module"
)
def solved(request):
    """A problem of each scene, and of laws with strength, with its reference."""
    scene = request.param.split()[0]
    values = SMALL[scene]
    if "strength" in request.param:
        values = WITH_STRENGTH[scene]
    problem = problem_of(scene, values)
    return problem, reference_of(problem)


def test_a_solution_obeys_all_laws_up_to_rounding(solved):
    problem, found = solved
    assert law_residuals(found, problem).largest < ROUNDED


def test_forces_that_are_too_small_do_not_balance(solved):
    problem, found = solved
    weaker = spoiled(found, force=0.999 * found.contact_force)
    assert law_residuals(weaker, problem).balance > SEEN


def test_displacements_that_are_too_large_do_not_balance(solved):
    problem, found = solved
    further = spoiled(found, displacement=1.001 * found.displacement)
    assert law_residuals(further, problem).balance > SEEN


def test_friction_along_the_slip_breaks_its_law(solved):
    problem, found = solved
    place, instant, _ = largest_work(problem, found)
    force = found.contact_force.copy()
    force[place, instant] *= -1.0
    turned = law_residuals(spoiled(found, force=force), problem)
    assert turned.friction > SEEN


def test_slip_the_other_way_breaks_the_law_of_friction(solved):
    problem, found = solved
    place, instant, node = largest_work(problem, found)
    displacement = found.displacement.copy()
    jump = jumps(problem)[[place]]
    # The point goes back by twice as much as both sides came.
    (slip,) = jump @ (displacement[:, instant] - displacement[:, instant - 1])
    displacement[node, instant] -= 2.0 * slip / jump[0, node]
    turned = law_residuals(spoiled(found, displacement=displacement), problem)
    assert turned.friction > SEEN


def test_friction_above_its_bound_breaks_its_law(solved):
    problem, found = solved
    place, instant, _ = largest_work(problem, found)
    force = found.contact_force.copy()
    force[place, instant] *= 1.01
    assert law_residuals(spoiled(found, force=force), problem).friction > SEEN


def test_an_instant_that_is_left_out_breaks_a_law(solved):
    problem, found = solved
    _, instant, _ = largest_work(problem, found)
    displacement = found.displacement.copy()
    force = found.contact_force.copy()
    displacement[:, instant] = displacement[:, instant - 1]
    force[:, instant] = force[:, instant - 1]
    stale = spoiled(found, displacement=displacement, force=force)
    assert law_residuals(stale, problem).largest > SEEN


@pytest.mark.parametrize("scene", ["block", "layers", "incline", "wall"])
def test_overlap_and_tension_and_force_at_a_distance_break_the_law_across(scene):
    problem = problem_of(scene, SMALL[scene])
    found = reference_of(problem)
    (name, law) = list(problem.contacts.items())[-1]
    place = problem.contacts.forces[name][0]
    last = problem.n_instants - 1
    point = int(np.argmax(found.contact_force[place, last]))
    assert found.contact_force[place.start + point, last] > 0.0
    node = problem.row_dofs[law.normal.component.above[law.points == point][0]]
    moved = 1e-3 * np.abs(found.displacement).max()
    for way in (-moved, moved):
        displacement = found.displacement.copy()
        displacement[node, last] += way
        apart = law_residuals(spoiled(found, displacement=displacement), problem)
        assert apart.pressing > SEEN
    force = found.contact_force.copy()
    force[place.start + point, last] *= -1e-3
    assert law_residuals(spoiled(found, force=force), problem).pressing > SEEN


@pytest.mark.parametrize("differs", LAWS)
def test_the_answer_to_another_law_of_contact_breaks_this_one(differs):
    scene, values, changes = LAWS[differs]
    all_values = SMALL[scene] | values
    problem = problem_of(scene, all_values)
    other = problem_of(scene, all_values | changes)
    found = reference_of(other)
    own = law_residuals(found, other)
    assert own.largest < ROUNDED
    foreign = law_residuals(found, problem)
    assert max(foreign.friction, foreign.pressing) > SEEN
    assert foreign.balance < ROUNDED


PRESSED_ONLY = [[0.0, 0.0], [0.4, -1.0], [1.0, -1.0]]


def moved(course):
    """Values of a block whose top follows a course, up and down, and is sheared."""
    return (
        PRESSED
        | GENERAL
        | {
            "top": "displacement",
            "top_normal_displacement": 1e-5,
            "top_normal_load": course,
            "top_tangential_displacement": 2e-5,
        }
    )


def test_a_bond_that_has_opened_is_gone_for_good():
    # Lifted until it opens, and then pressed and sheared, where cohesion would carry
    # again.
    values = moved([[0.0, 0.0], [0.4, 1.0], [0.7, -1.0], [1.0, -1.0]])
    bonded = problem_of("block", {**values, "cohesion": 2e7})
    loose = problem_of("block", values)
    assert law_residuals(reference_of(loose), bonded).largest < ROUNDED
    early = moved(PRESSED_ONLY)
    never_opened = problem_of("block", {**early, "cohesion": 2e7})
    found = reference_of(problem_of("block", early))
    assert law_residuals(found, never_opened).friction > SEEN


@pytest.mark.parametrize("cohesion", [0.0, 2e7])
def test_a_bond_that_rounding_may_have_opened_holds_or_is_broken(cohesion):
    # All that the sides are apart, before anything presses, is rounding.
    values = moved(PRESSED_ONLY)
    bonded = problem_of("block", {**values, "cohesion": 2e7})
    found = reference_of(problem_of("block", {**values, "cohesion": cohesion}))
    displacement = found.displacement.copy()
    displacement[:, 0] += 1e-15 * np.abs(displacement).max()
    rounded = spoiled(found, displacement=displacement)
    assert law_residuals(rounded, bonded).friction < ROUNDED


def test_prescribed_displacements_are_to_be_there():
    problem = problem_of("block", SMALL["block"])
    found = reference_of(problem)
    held = problem.prescribed[0][0]
    displacement = found.displacement.copy()
    displacement[held] += 1e-3 * np.abs(displacement).max()
    assert law_residuals(spoiled(found, displacement=displacement), problem).held > SEEN


@pytest.mark.parametrize("scene", ["bar", "block"])
def test_cuts_are_to_agree_in_displacement_and_force(scene):
    settings = CATALOGUE[scene].checked(SMALL[scene])
    problem = discretise(settings)
    iterate = solve(problem, method_of(settings), watch=False).iterate
    displacement = iterate.boundary_displacement
    force = iterate.boundary_force
    whole = law_residuals(iterate, problem, RowFields(displacement, force))
    assert whole.largest < ROUNDED
    cut = [law for law in problem.interfaces.values() if isinstance(law, Perfect)][-1]
    apart = displacement.copy()
    apart[cut.first] *= 1.001
    assert law_residuals(iterate, problem, RowFields(apart, force)).glued > SEEN
    pulled = force.copy()
    pulled[cut.first] *= 1.001
    spoiled_rows = law_residuals(iterate, problem, RowFields(displacement, pulled))
    assert spoiled_rows.glued > SEEN
    assert spoiled_rows.balance > SEEN


class LoadOfOnesOwn(Neumann):
    """A load whose local stage may be another: its class does not say."""


def test_a_law_that_is_not_known_here_is_not_passed_over():
    problem = problem_of("bar", SMALL["bar"])
    found = reference_of(problem)
    name, load = next(
        (name, law) for name, law in problem.interfaces.items() if type(law) is Neumann
    )
    own = LoadOfOnesOwn(load.rows, load.values, load.macro)
    foreign = dataclasses.replace(problem, interfaces={**problem.interfaces, name: own})
    with pytest.raises(TypeError, match=f"{name}, LoadOfOnesOwn"):
        law_residuals(found, foreign)


def test_nan_is_no_small_residual():
    problem = problem_of("bar", SMALL["bar"])
    found = reference_of(problem)
    force = found.contact_force.copy()
    displacement = found.displacement.copy()
    force[3, 4] = np.nan
    displacement[3, 4] = np.nan
    for without_number in (
        spoiled(found, force=force),
        spoiled(found, displacement=displacement),
    ):
        assert not law_residuals(without_number, problem).largest <= 1.0
        assert not kkt_residual(without_number, problem) <= 1.0


def test_a_body_that_flies_away_hides_no_force_that_is_missing():
    values = {**PRESSED, "top": "traction", "top_normal_traction": -1e7}
    problem = problem_of("block", values)
    found = reference_of(problem)
    assert law_residuals(found, problem).largest < ROUNDED
    upward = problem.rigid_motions[:, [1]] * np.ones(problem.n_instants)
    flown = spoiled(found, displacement=1e12 * upward, force=0.0 * found.contact_force)
    assert law_residuals(flown, problem).balance > SEEN
    assert kkt_residual(flown, problem, HIDDEN) > SEEN


def test_a_run_whose_body_flies_away_is_not_called_solved():
    # Held up along its left side and moved along its top, it may turn about their
    # corner: it came to 1e11 m, where rounding hid all that did not balance.
    values = {
        "elements": 8,
        "elements_up": 4,
        "substructures": 1,
        "substructures_up": 2,
        "multiscale": False,
        "cycles": 2,
        "instants": 3,
        "young": 6671583237.097,
        "height": 0.13731224608003947,
        "radius": 7546.249705798802,
        "left": "dragged",
        "left_normal_traction": -20091.111858427146,
        "left_normal_slope": 0.13308225528605333,
        "left_tangential_displacement": -6.070302211682257e-07,
        "top": "dragged",
        "top_normal_traction": -20091.111858427146,
        "top_normal_load": "delayed",
        "top_tangential_displacement": -3.3688562948928447e-07,
        "body_force_y": 622301449.6919417,
    }
    settings = CATALOGUE["block"].checked(values)
    run = solve(discretise(settings), method_of(settings), watch=False)
    assert run.status.ending is not Ending.CONVERGED
    assert not run.is_certified


def test_rounding_of_forces_in_a_spring_far_softer_than_its_body_breaks_no_law():
    settings = CATALOGUE["belt"].checked(
        {
            "friction_law": "general",
            "cohesion": 2.5e6,
            "normal_stiffness": 653.0,
            "wrap": 916.0,
            "pull": 6.3,
            "tail_force": 0.2,
            "elements": 47,
            "substructures": 12,
            "instants": 11,
        }
    )
    problem = discretise(settings)
    answer = solve(problem, method_of(settings), watch=False)
    assert answer.is_certified
    assert law_residuals(answer.iterate, problem).largest < 1e-8
