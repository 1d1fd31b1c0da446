"""Joints of a wall, its cap, and ground that settles below a part of it."""

from __future__ import annotations

import numpy as np
import pytest

from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.plane.rectangles.cap_and_ground import strips_below
from solver.discrete.probes import reaction
from solver.latin import solve
from solver.laws import OPEN
from solver.reference.distance import distance_to, kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.values import SettingError
from solver.study.trade_case import cases_by_name

BRICK = 2e4 * 0.25 * 0.12
"""Weight of a brick, N."""
SMALL = {
    "bricks": 5,
    "courses": 4,
    "elements": 4,
    "elements_up": 2,
    "instants": 13,
    "pressure": 1e5,
}
FEW = {"bricks": 3, "courses": 3}
SETTLES = SMALL | {
    "top": "pulled",
    "traction": 0.0,
    "settlement": 1e-4,
    "settled_from": 0.5,
    "settled_length": 0.25,
}


def made(**values):
    """Settings of a wall, its problem, and the answer of the incremental solver."""
    settings = CATALOGUE["wall"].checked(values)
    problem = discretise(settings)
    answer = reference_of(problem)
    assert answer.converged.all()
    return settings, problem, answer


def carried(problem, answer, names="support and"):
    """Pressing force on the ground, (n_instants,), N."""
    forces = [
        answer.contact(name).normal_force.sum(axis=0)
        for name in problem.contacts
        if names in name
    ]
    return np.sum(forces, axis=0)


def friction_of_ground(problem, answer):
    """Friction force of the ground, (n_instants,), N."""
    forces = [
        answer.contact(name).tangential_force.sum(axis=0)
        for name in problem.contacts
        if "support" in name
    ]
    return np.sum(forces, axis=0)


def test_a_brick_falls_with_the_ground_and_the_wall_bridges_it():
    """The reaction falls to the weight of the brick; sums stay the weight."""
    settings, problem, answer = made(**SETTLES)
    settled, force = settings.bodies.loop(problem).along(answer)
    stands = settled == 0.0
    assert force[stands].max() > 20.0 * BRICK
    np.testing.assert_allclose(force[-1], BRICK, rtol=1e-9)
    np.testing.assert_allclose(
        force, carried(problem, answer, "settled support"), rtol=1e-12
    )
    whole = 18 * BRICK + 4 * 0.5 * BRICK + 1e5 * 1.25
    np.testing.assert_allclose(carried(problem, answer)[-1], whole, rtol=1e-9)
    # The course above has left the brick that fell.
    fallen = "brick 3 and brick 8"
    assert np.all(answer.contact(fallen).status[:, -1] == OPEN)


def test_latin_finds_the_arch_over_settled_ground():
    settings, problem, answer = made(**SETTLES)
    run = solve(
        problem, method_of(settings), distance=distance_to(answer, problem), watch=False
    )
    assert run.is_certified
    assert run.records[-1].error_force < 1e-9
    assert kkt_residual(run.iterate, problem) < 1e-9


def test_ground_that_settles_as_a_whole_moves_the_wall_and_changes_no_force():
    whole = SETTLES | {"settled_from": 0.0, "settled_length": 1.25}
    _, problem, answer = made(**whole)
    settings, _, deeper = made(**(whole | {"settlement": 1e-3}))
    for name in problem.contacts:
        np.testing.assert_allclose(
            deeper.contact(name).normal_force,
            answer.contact(name).normal_force,
            atol=1e-6 * BRICK,
        )
    further = deeper.displacement - answer.displacement
    inside = problem.inside
    assert inside is not None
    moved = np.outer(inside.directions[:, 1], -0.9 * settings.path("settlement_load"))
    np.testing.assert_allclose(further, moved, atol=1e-12)


def test_strips_below_a_wall_end_with_bricks_and_with_what_settles():
    bricks = [Brick(0, 0, 4, 2), Brick(6, 0, 4, 2), Brick(0, 2, 4, 2)]
    strips = strips_below(bricks, (1, 8))
    expected = [(0, 1), (1, 3), (6, 2), (8, 2)]
    assert [(strip.x, strip.columns) for strip in strips] == expected
    assert {strip.rows for strip in strips} == {1}


def test_ground_that_settles_beside_the_wall_changes_nothing():
    beside = SMALL | {"settlement": 1e-3, "settled_from": 2.0}
    settings = CATALOGUE["wall"].checked(beside)
    assert not settings.bodies.strips


def test_bricks_may_have_more_elements_up_than_the_wall_has_along():
    sizes = {"bricks": 3, "courses": 2, "elements": 2, "elements_up": 12}
    _, problem, answer = made(**SETTLES | sizes)
    weight = 3 * 2 * BRICK
    pressed = SMALL["pressure"] * 0.25 * 3
    assert carried(problem, answer)[-1] == pytest.approx(weight + pressed, rel=1e-9)


def test_each_kind_of_joint_has_its_friction():
    factors = {"friction": 0.5, "head_friction": 0.5, "ground_friction": 2.0}
    for values in (SMALL, SETTLES):
        settings = CATALOGUE["wall"].checked(values | factors)
        rubbing = discretise(settings).contacts
        heads = rubbing["brick 1 and brick 2"].tangential.friction
        beds = rubbing["brick 1 and brick 6"].tangential.friction
        ground = rubbing["support and brick 1"].tangential.friction
        assert set(heads) == {0.25}
        assert set(beds) == {0.5}
        assert set(ground) == {1.0}


def test_a_wall_slides_on_smooth_ground_before_it_slides_in_its_joints():
    """Friction of the ground is half of that of the joints, and carries no more."""
    low = SMALL | {"courses": 1, "bricks": 3, "friction": 0.6, "bond": "stack"}
    _, problem, answer = made(**low, ground_friction=0.5, displacement=1e-3)
    rubbed = friction_of_ground(problem, answer)
    pressed = carried(problem, answer)
    peak = np.abs(rubbed).argmax()
    np.testing.assert_allclose(abs(rubbed[peak]), 0.3 * pressed[peak], rtol=1e-9)


@pytest.mark.parametrize("cap", ["free", "guided"])
def test_a_cap_stays_straight_and_a_guided_one_level(cap):
    settings, problem, answer = made(**SMALL | FEW, displacement=5e-5, cap=cap)
    inside = problem.inside
    assert inside is not None
    is_top = np.isclose(inside.nodes[:, 1], inside.nodes[:, 1].max())
    x = inside.nodes[is_top, 0]
    moved = inside.displacement(answer.displacement, slice(None))[is_top, 1]
    slope, _ = np.polyfit(x, moved, 1)
    line = np.polynomial.polynomial.polyval(x, np.polyfit(x, moved, 1)[::-1]).T
    turns = np.abs(slope).max() * np.ptp(x)
    assert np.abs(moved - line).max() < 1e-8
    # What moves both ends of a guided cap, too, is drawn at the top alone.
    drawn = [act.symbol for act in settings.bodies.description().acts]
    assert drawn.count("u") == 1
    if cap == "free":
        assert turns > 1e-6
    else:
        assert turns < 1e-7
    _, force = settings.bodies.loop(problem).along(answer)
    rubbed = friction_of_ground(problem, answer)
    np.testing.assert_allclose(force, -rubbed, atol=1e-6 * np.abs(force).max())


def test_a_cap_on_ground_that_settles_carries_the_wall_over_it():
    settings, problem, answer = made(**SETTLES, cap="free")
    _, force = settings.bodies.loop(problem).along(answer)
    # Its neighbours, which the cap presses, hold a part of the brick that falls.
    assert 0.5 * BRICK < force[-1] < BRICK
    fallen = "brick 3 and brick 8"
    assert np.all(answer.contact(fallen).status[:, -1] == OPEN)


def test_a_guided_cap_is_refused_where_the_top_is_pulled():
    with pytest.raises(SettingError, match=r'^cap = "guided"'):
        CATALOGUE["wall"].checked(SMALL | {"cap": "guided", "top": "pulled"})


def test_the_settlement_is_drawn_below_what_settles():
    settings = CATALOGUE["wall"].checked(SETTLES)
    (act,) = [
        act for act in settings.bodies.description().acts if act.where == "bottom y"
    ]
    np.testing.assert_allclose(act.points, [[0.5, 0.0]])
    assert act.towards == (0.0, -1.0)
    np.testing.assert_allclose(act.values, settings.path("settlement_load"))
    assert settings.load_settings()["bottom y"] == "settlement"


def test_the_first_change_of_the_case_does_as_it_says():
    """A twentieth of a millimetre is enough; in stack bond nothing reaches over."""
    case = cases_by_name()["settling-ground"]
    found = {}
    for name, changes in {
        "less": {"settlement": 5e-5},
        "stack": {"bond": "stack"},
    }.items():
        settings, problem, answer = made(**(case.settings.changed() | changes))
        _, force = settings.bodies.loop(problem).along(answer)
        found[name] = force[-1], force.max()
    assert found["less"][0] == pytest.approx(6.0 * BRICK, rel=1e-6)
    last, largest = found["stack"]
    assert 0.9 * largest < last < largest


@pytest.mark.parametrize("values", [{"cap": "guided"}, {"bricks": 1, "courses": 1}])
def test_the_shear_force_on_a_tilted_wall_is_that_of_what_moves_its_top(values):
    """The ground also carries the weight along the slope."""
    tilted = SMALL | FEW | {"slope": 5.0, "displacement": 5e-5}
    settings, problem, answer = made(**tilted | values)
    sides = [name for name in ("top", "left", "right") if name in problem.held_dofs]
    held = sum(reaction(problem, name, 0).of(answer) for name in sides)
    _, force = settings.bodies.loop(problem).along(answer)
    np.testing.assert_allclose(force, held, atol=1e-6 * np.abs(force).max())
    along = settings.bodies.weight[0]
    rubbed = -friction_of_ground(problem, answer)
    np.testing.assert_allclose(rubbed - force, along, atol=1e-9 * np.abs(rubbed).max())
    assert np.abs(along).max() > 1e-3 * np.abs(force).max()


@pytest.mark.parametrize(
    ("start", "length", "remark"),
    [
        (0.5, 0.25, ""),
        (0.5, 0.02, "nothing settles below the wall from 0.5 to 0.52 m"),
        (9.0, 0.25, "nothing settles below the wall from 9 to 9.25 m"),
        (0.51, 0.25, "settles from 0.5 to 0.75 m, as it ends at whole elements"),
    ],
)
def test_a_run_says_where_ground_settles_elsewhere_than_it_should(
    start, length, remark
):
    """Elements are 0.0625 m long."""
    placed = {"settled_from": start, "settled_length": length}
    settings = CATALOGUE["wall"].checked(SETTLES | placed)
    said = [each for each in settings.left_out() if each.startswith("settled_length: ")]
    assert len(said) == bool(remark)
    assert remark in "".join(said)
    is_settled = bool(np.any(settings.bodies.settlement))
    assert is_settled == ("nothing" not in remark)
    assert (settings.bodies.strips > 0) == is_settled
