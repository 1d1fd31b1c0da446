"""Uniform states, resultants and sliding, in any decomposition, on every mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contact_problems import block
from plane import lengths, reaction, solved, stress

from solver import discrete
from solver.discrete import Side, SideComponent, Spring, Support
from solver.discrete.loose_bodies import loose_bodies
from solver.discrete.plane.rectangles.rigid_stack import rigid_rest
from solver.latin import Ending, solve
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError
from solver.scenes import discretise
from solver.scenes.block import BlockSettings
from solver.scenes.method import method_of
from solver.settings.values import SettingError

PRESSURE = 1e6
SHEAR = 4e5
DECOMPOSITIONS = [(1, 1), (10, 7)]
PATCH = {
    "gap": "flat",
    "length": 0.1,
    "height": 0.07,
    "elements": 10,
    "elements_up": 7,
    "instants": 5,
    "top": "traction",
    "top_normal_traction": -PRESSURE,
    "violation": 1e-10,
}
SHEARED = {
    "left": "traction",
    "right": "traction",
    "left_tangential_traction": -SHEAR,
    "left_tangential_load": "hold",
    "right_tangential_traction": SHEAR,
    "right_tangential_load": "hold",
    "top_tangential_traction": SHEAR,
    "top_tangential_load": "hold",
}


def cut(decomposition):
    return dict(zip(("substructures", "substructures_up"), decomposition, strict=True))


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("decomposition", DECOMPOSITIONS)
def test_pressing_without_friction_leaves_a_uniform_stress(decomposition, plane):
    iterate = solved(
        "block", friction=0.0, left="roller", plane=plane, **PATCH, **cut(decomposition)
    )
    pressure = iterate.contact("support").normal_force[:, -1:] / lengths(iterate)
    np.testing.assert_allclose(pressure, PRESSURE, rtol=1e-8)
    found = stress(iterate)
    np.testing.assert_allclose(
        found, np.broadcast_to([0.0, -PRESSURE, 0.0], found.shape), atol=1e-8 * PRESSURE
    )


@pytest.mark.parametrize("decomposition", DECOMPOSITIONS)
def test_a_stuck_block_without_lateral_strain_is_sheared_uniformly(decomposition):
    case = PATCH | SHEARED | cut(decomposition) | {"violation": 1e-13}
    iterate = solved("block", friction=1.0, poisson=0.0, **case)
    fields = iterate.contact("support")
    friction = fields.tangential_force[:, -1:] / lengths(iterate)
    np.testing.assert_allclose(friction, -SHEAR, rtol=1e-6)
    found = stress(iterate)
    np.testing.assert_allclose(
        found,
        np.broadcast_to([0.0, -PRESSURE, SHEAR], found.shape),
        atol=1e-6 * PRESSURE,
    )
    assert not fields.status[:, -1].any()


def test_a_block_dragged_far_slides_everywhere_and_its_reaction_balances_friction():
    iterate = solved(
        "block",
        gap="flat",
        elements=16,
        elements_up=8,
        instants=9,
        top_normal_displacement=-1e-5,
        top_tangential_displacement=1e-3,
        top_tangential_load="ramp",
        violation=1e-10,
    )
    fields = iterate.contact("support")
    pressing = fields.normal_force[:, -1]
    friction = fields.tangential_force[:, -1]
    assert np.all(fields.status[:, -1] == 1)
    np.testing.assert_allclose(friction, -0.3 * pressing, atol=1e-8 * pressing.max())
    along, up = reaction(iterate, "top")
    np.testing.assert_allclose(along[-1], 0.3 * pressing.sum(), rtol=1e-8)
    np.testing.assert_allclose(up[-1], -pressing.sum(), rtol=1e-8)


@pytest.mark.parametrize("elements", [8, 16, 32])
def test_pressure_under_a_tilting_block_balances_force_and_moment(elements):
    iterate = solved(
        "block",
        gap="flat",
        length=0.1,
        height=0.1,
        elements=elements,
        elements_up=elements,
        substructures=2,
        instants=3,
        top="traction",
        top_normal_traction=-PRESSURE,
        top_normal_slope=2.0,
        top_tangential_traction=0.1 * PRESSURE,
        top_tangential_load="hold",
        violation=1e-10,
    )
    fields = iterate.contact("support")
    x = iterate.problem.contacts["support"].positions
    pressing = fields.normal_force[:, -1]
    # 1e5 N at the middle plus slope * length / 6, and 1e4 N along x at a height of 0.1
    # m.
    moment = 1e5 * (0.05 + 2.0 * 0.1 / 6.0) + 1e4 * 0.1
    np.testing.assert_allclose(pressing.sum(), 1e5, rtol=1e-8)
    np.testing.assert_allclose(pressing @ x, moment, rtol=1e-8)
    np.testing.assert_allclose(fields.tangential_force[:, -1].sum(), -1e4, rtol=1e-8)
    lifted = x[fields.status[:, -1] == 2].max()
    assert 0.05 < lifted < 0.1
    assert np.all(fields.opening[x <= lifted, -1] > 0.0)


@pytest.mark.parametrize("depth", [0.0, 4e-5])
def test_a_body_that_never_touches_moves_as_a_whole_and_the_run_converges(depth):
    settings = BlockSettings.checked(
        {
            "gap": ((0.0, 1e-3), (0.1, 1e-3)),
            "top_normal_displacement": -depth,
            "elements": 16,
        }
    )
    solution = solve(discretise(settings), method_of(settings), watch=False)
    assert solution.status.ending is Ending.CONVERGED
    fields = solution.iterate.contact("support")
    assert np.all(fields.status == 2)
    np.testing.assert_allclose(fields.opening[:, -1], 1e-3 - depth, atol=1e-12)


@pytest.mark.parametrize(
    "gap",
    [
        [[0.0, 1e-2]],
        [[0.0, 1e-3], [0.1, 5e-3]],
        [[0.0, 8e-3], [0.1, 0.0]],
    ],
)
def test_a_body_falls_on_its_support_and_stands_there_as_if_it_had_been_there(gap):
    values = {"top": "traction", "top_normal_traction": -PRESSURE, "elements": 16}
    flat, fallen = (
        BlockSettings.checked({**values, "instants": 21, "gap": one})
        for one in ("flat", gap)
    )
    solution = solve(discretise(fallen), method_of(fallen))
    assert solution.status.ending is Ending.CONVERGED
    assert len(solution.records) < 40
    wanted = (
        solve(discretise(flat), method_of(flat)).iterate.contact("support").normal_force
    )
    found = solution.iterate.contact("support").normal_force
    np.testing.assert_allclose(found, wanted, atol=1e-3 * wanted.max())


def test_a_rigid_body_rests_under_its_load_and_a_roller_keeps_it_upright():
    values = {"gap": "parabola", "top": "traction", "top_normal_traction": -PRESSURE}
    level, tilted, held = (
        rigid_rest(BlockSettings.checked(values | change).structure())
        for change in (
            {},
            {"top_normal_slope": 0.6},
            {"top_normal_slope": 0.6, "left": "roller"},
        )
    )
    assert abs(level[1, -1]) < 1e-9
    # The resultant acts a tenth of the length beside the middle, where the parabola has
    # this slope.
    assert tilted[1, -1] == pytest.approx(-0.01 / 5.0, rel=0.05)
    assert held[0, -1] < 0.0
    assert not held[1].any()
    assert (
        rigid_rest(BlockSettings.checked({"gap": ((0.0, 1e-3),)}).structure()) is None
    )


@pytest.mark.parametrize("scene", ["block", "layers"])
def test_the_number_of_substructures_does_not_change_the_answer(scene):
    found = []
    for decomposition in ((2, 1), (5, 2)):
        size = {"elements": 20, "elements_up": 4, "instants": 21}
        iterate = solved(scene, violation=1e-7, **size, **cut(decomposition))
        inside = iterate.problem.inside
        found.append(
            (inside.displacement(iterate.displacement, slice(None)), inside.nodes)
        )
        forces = [
            iterate.contact(name).normal_force for name in iterate.problem.contacts
        ]
        found[-1] += (np.stack(forces),)
    (one, nodes, pressing), (other, same_nodes, same_pressing) = found
    np.testing.assert_array_equal(nodes, same_nodes)
    np.testing.assert_allclose(one, other, atol=1e-5 * np.abs(one).max())
    np.testing.assert_allclose(pressing, same_pressing, atol=1e-4 * pressing.max())


SMALL = {"elements": 16, "elements_up": 8, "instants": 11}


def test_a_contact_ends_before_a_side_that_holds_its_normal_displacement():
    for left, right, first, last in (
        ("free", "roller", 0, 16),
        ("clamped", "dragged", 1, 15),
    ):
        iterate = solved("block", left=left, right=right, violation=1e-4, **SMALL)
        x = iterate.problem.contacts["support"].positions / 0.1 * 16
        np.testing.assert_allclose(x, np.arange(first, last + 1), atol=1e-9)


@pytest.mark.parametrize("left", ["roller", "clamped", "displacement"])
def test_a_corner_that_two_sides_prescribe_follows_the_top(left):
    iterate = solved("block", left=left, **SMALL)
    inside = iterate.problem.inside
    moved = inside.displacement(iterate.displacement, [4])[:, :, 0]
    top = inside.nodes[:, 1] > 0.0499
    corner = top & (inside.nodes[:, 0] < 1e-9)
    assert corner.sum() == 1
    np.testing.assert_allclose(moved[corner][0], moved[top][-1], atol=1e-12)


HINGE = {
    "gap": "flat",
    "top": "dragged",
    "elements": 8,
    "elements_up": 4,
    "instants": 5,
    "top_tangential_displacement": 0.0,
}


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_hinge_is_refused_where_its_load_turns_it_off_the_support(side):
    """The top holds x and one side y: the body may only turn about that corner."""
    hinge = {**HINGE, side: "dragged", "friction": 0.0}
    pressed = BlockSettings.checked({**hinge, "top_normal_traction": -1e4})
    problem = discretise(pressed)
    found = reference_of(problem)
    assert found.converged.all()
    corner = pressed.length
    if side == "left":
        corner = 0.0
    lever = np.abs(problem.contacts["support"].positions - corner)
    moment = lever @ found.contact("support").normal_force[:, -1]
    assert moment == pytest.approx(0.5 * 1e4 * pressed.length**2, rel=1e-9)
    with pytest.raises(SettingError, match="turns about the side that holds it up"):
        BlockSettings.checked({**hinge, "top_normal_traction": 1e4})
    # Friction may wedge the body between its side and the support.
    BlockSettings.checked({**hinge, "friction": 0.3, "top_normal_traction": 1e4})


def test_both_sides_that_hold_a_body_up_keep_it_from_turning():
    held = {**HINGE, "left": "dragged", "right": "dragged", "friction": 0.0}
    values = BlockSettings.checked({**held, "top_normal_traction": 1e4})
    found = reference_of(discretise(values))
    assert found.converged.all()
    assert not found.contact("support").normal_force.any()


STILL = SideComponent(True, np.zeros(17))
FREE = SideComponent(False, np.zeros(17))
KNOWN = Support(np.zeros(7), 0.3, strength=np.full((7, 17), 1e5))
LOOSE = {
    "a hinge": (1, None, {"top": Side(STILL, FREE), "left": Side(FREE, STILL)}),
    "two bodies on a hinge": (
        2,
        None,
        {"top": Side(STILL, FREE), "left": Side(FREE, STILL)},
    ),
    "nothing held": (1, None, {}),
    "on a support that presses as much as is known": (
        1,
        KNOWN,
        {"left": Side(STILL, FREE)},
    ),
}


@pytest.mark.parametrize("name", LOOSE)
def test_bodies_that_no_side_and_no_contact_can_hold_are_refused(name):
    bodies, support, sides = LOOSE[name]
    stack = block(elements=(6, 4), cuts=(2, 1), bodies=bodies)
    stack = replace(stack, support=support, sides=sides)
    with pytest.raises(RefusedError, match=r"Stack\.sides.*free to move or to turn"):
        discrete.discretise(stack)
    # One side more, and nothing moves.
    more = replace(stack, sides={**sides, "right": Side(STILL, STILL)})
    assert not len(loose_bodies(discrete.discretise(more)))


def test_a_spring_and_a_hinge_together_hold_a_body_that_a_hinge_alone_does_not():
    """The spring's foot moves along x as the body turns about its upper corner."""
    sides = {"top": Side(STILL, FREE), "left": Side(FREE, STILL)}
    stack = block(elements=(6, 4), cuts=(2, 1))
    stack = replace(stack, support=None, sides=sides, spring=Spring(0.0, 1e6))
    assert not len(loose_bodies(discrete.discretise(stack)))
