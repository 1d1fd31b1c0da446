"""Bodies of any shape on a spring, with joints of known strength, and of lattices."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from shaped_bodies import grid, sides

from solver import Latin, solve
from solver.discrete import (
    Bodies,
    Body,
    Held,
    Joint,
    Lattice,
    Load,
    NodeSpring,
    Side,
    SideComponent,
    Stack,
    discretise,
)
from solver.discrete.loose_bodies import LooseBodiesError
from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.probes import side_mean
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError

LENGTH = 0.4
HEIGHT = 0.2
TIMES = np.linspace(0.0, 1.0, 11)
ZERO = np.zeros_like(TIMES)
PRESS = -1e5 * np.minimum(5.0 * TIMES, 1.0)
PUSH = -4e3 * np.clip(2.0 * TIMES - 0.5, 0.0, 1.0)
SLACK = 1e-4
SPRING = 1e7
X = np.linspace(0.0, LENGTH, 5)
Y = np.linspace(0.0, HEIGHT, 3)
MESH = grid(X, Y)
CHAINS = sides(MESH, 4, 2)
LATTICE = Lattice(4, 2, LENGTH / 4, HEIGHT / 2)
UP = np.array([0.0, 1.0])


def block(body: Body, friction: float, **changes: Any) -> Bodies:
    """A block on the ground, pressed, and pushed to the left against a spring."""
    foot = CHAINS["bottom"]
    top = CHAINS["top"]
    if isinstance(body.shape, Lattice):
        foot = body.shape.side("bottom")
        top = body.shape.side("top")
    normals = np.tile(UP, (len(foot), 1))
    ground = Joint("ground", 0, foot, None, None, normals, friction=friction)
    pressed = np.stack([PUSH / LENGTH, PRESS / LENGTH])
    fields: dict[str, Any] = {
        "bodies": [body],
        "joints": [ground],
        "held": [],
        "loads": [Load.of_traction("load", 0, body, top, pressed)],
        "instants": TIMES,
        "duration": 1.0,
        "springs": [NodeSpring("spring", 0, int(foot[-1]), SLACK, SPRING, 0.05)],
    }
    return Bodies(**fields | changes)


SHAPES = {"mesh": MESH, "lattice": LATTICE}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_spring_carries_what_no_friction_does(shape: str) -> None:
    structure = block(Body("block", SHAPES[shape], 2e10, 0.3), friction=0.0)
    problem = discretise(structure)
    assert problem.contacts.names == ("ground", "spring")
    found = reference_of(problem)
    force = np.asarray(found.contact("spring").normal_force)[0]
    assert force == pytest.approx(-PUSH, abs=1e-6)
    pulled = force > 1.0
    opening = np.asarray(found.contact("spring").opening)[0]
    assert opening[pulled] == pytest.approx(-force[pulled] / SPRING, rel=1e-9)
    assert found.contact("spring").slip.shape == (1, len(TIMES))


@pytest.mark.parametrize("shape", SHAPES)
def test_friction_on_the_ground_holds_before_the_spring(shape: str) -> None:
    mu = 0.02
    structure = block(Body("block", SHAPES[shape], 2e10, 0.3), friction=mu)
    run = solve(discretise(structure), Latin(), watch=False)
    assert run.is_certified
    spring = np.asarray(run.iterate.contact("spring").normal_force)[0]
    ground = run.iterate.contact("ground").tangential_force.sum(axis=0)
    assert spring + ground == pytest.approx(-PUSH, abs=1e-6 * np.abs(PUSH).max())
    assert ground[-1] == pytest.approx(-mu * PRESS[-1], rel=1e-9)
    assert spring[-1] == pytest.approx(-PUSH[-1] + mu * PRESS[-1], rel=1e-9)


def sheared(shape: str, **changes: Any) -> Bodies:
    """A block whose top is moved along a ground of known strength."""
    structure = block(Body("block", SHAPES[shape], 2e10, 0.3), friction=0.0)
    (ground,) = structure.joints
    strength = np.full((len(ground.nodes), len(TIMES)), 2e5)
    known = replace(ground, **({"strength": strength} | changes))
    top = CHAINS["top"]
    if shape == "lattice":
        top = LATTICE.side("top")
    held = [
        Held("top", 0, top, 0, 1e-3 * TIMES),
        Held("top", 0, top, 1, ZERO),
    ]
    return replace(structure, joints=[known], held=held, loads=[], springs=())


@pytest.mark.parametrize("shape", SHAPES)
def test_a_known_strength_is_all_that_a_sliding_joint_carries(shape: str) -> None:
    problem = discretise(sheared(shape))
    law = problem.contacts["ground"]
    assert law.normal is None
    found = reference_of(problem).contact("ground")
    assert found.normal_force is None
    assert found.tangential_force.sum(axis=0)[-1] == pytest.approx(-2e5 * LENGTH)
    assert np.all(found.status[:, -1] == 1)


@pytest.mark.parametrize("shape", SHAPES)
def test_slip_on_an_image_is_twice_the_displacement(shape: str) -> None:
    problem = discretise(sheared(shape, is_image=True))
    law = problem.contacts["ground"]
    found = reference_of(problem)
    dofs = problem.row_dofs[law.tangent.above]
    moved = found.displacement[dofs]
    assert found.contact("ground").slip == pytest.approx(2.0 * moved, abs=1e-15)


def on_each_other(shape: str, **changes: Any) -> Bodies:
    """Two blocks beside each other, pressed together; the right one is pulled up."""
    chains = CHAINS
    if shape == "lattice":
        chains = {side: LATTICE.side(side) for side in CHAINS}
    bodies = [
        Body("left", SHAPES[shape], 2e10, 0.3),
        Body("right", SHAPES[shape], 2e10, 0.3, origin=np.array([LENGTH, 0.0])),
    ]
    aside = np.tile([1.0, 0.0], (len(chains["left"]), 1))
    joint = Joint(
        "joint", 1, chains["left"], 0, chains["right"], aside, friction=0.4, **changes
    )
    held = [
        Held("left", 0, chains["left"], 0, ZERO),
        Held("left", 0, chains["left"], 1, ZERO),
        Held("pressed", 1, chains["right"], 0, -2e-6 * np.minimum(4.0 * TIMES, 1.0)),
        Held("pressed", 1, chains["right"], 1, 4e-6 * TIMES),
    ]
    return Bodies(bodies, [joint], held, [], TIMES, 1.0)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_left_handed_joint_has_the_same_forces_the_other_way_round(
    shape: str,
) -> None:
    right = reference_of(discretise(on_each_other(shape))).contact("joint")
    left = reference_of(discretise(on_each_other(shape, is_left_handed=True)))
    other = left.contact("joint")
    size = np.abs(right.tangential_force).max()
    assert size > 0.0
    assert other.tangential_force == pytest.approx(
        -right.tangential_force, abs=1e-9 * size
    )
    assert other.normal_force == pytest.approx(right.normal_force, abs=1e-9 * size)
    assert other.slip == pytest.approx(-right.slip, abs=1e-15)


def test_a_node_without_a_pair_gives_its_length_to_its_neighbour() -> None:
    paired = np.ones(3, dtype=bool)
    paired[0] = False
    whole = discretise(on_each_other("lattice")).contacts["joint"]
    short = discretise(on_each_other("lattice", paired=paired)).contacts["joint"]
    first, second, third = whole.weights
    assert short.weights == pytest.approx([first + second, third])
    assert short.positions == pytest.approx(whole.positions[1:])


@pytest.mark.parametrize("is_left_handed", [False, True])
def test_where_joints_meet_in_a_corner_there_is_no_pair(is_left_handed: bool) -> None:
    """Two blocks beside each other, both on a third one, on which they lie."""
    beside = on_each_other("lattice", is_left_handed=is_left_handed)
    floor = Lattice(8, 2, LENGTH / 4, HEIGHT / 2)
    below = Body("floor", floor, 2e10, 0.3, origin=np.array([0.0, -HEIGHT]))
    foot = LATTICE.side("bottom")
    joints = list(beside.joints)
    for number in (0, 1):
        bed = floor.side("top")[4 * number : 4 * number + 5]
        up = np.tile(UP, (5, 1))
        joints.append(Joint(f"bed {number}", number, foot, 2, bed, up))
    held = [held for held in beside.held if held.name == "pressed"]
    held += [Held("ground", 2, floor.side("bottom"), axis, ZERO) for axis in (0, 1)]
    structure = replace(
        beside, bodies=[*beside.bodies, below], joints=joints, held=held
    )
    problem = discretise(structure)
    sizes = {name: len(law.positions) for name, law in problem.contacts.items()}
    assert sizes == {"joint": 2, "bed 0": 4, "bed 1": 4}
    assert problem.has_short_joints


def test_a_spring_under_a_joint_that_is_turned_round_pulls_to_the_right() -> None:
    """The ground is below the body, but the joint is told as if it were above it."""
    structure = block(Body("block", LATTICE, 2e10, 0.3), friction=0.0)
    floor = Lattice(4, 1, LENGTH / 4, HEIGHT)
    bodies = [*structure.bodies]
    bodies.append(Body("floor", floor, 2e10, 0.3, origin=np.array([0.0, -HEIGHT])))
    foot = LATTICE.side("bottom")
    joint = Joint("joint", 1, floor.side("top"), 0, foot, np.tile(-UP, (5, 1)))
    held = [Held("ground", 1, floor.side("bottom"), axis, ZERO) for axis in (0, 1)]
    problem = discretise(replace(structure, bodies=bodies, joints=[joint], held=held))
    force = np.asarray(reference_of(problem).contact("spring").normal_force)[0]
    assert force == pytest.approx(-PUSH, abs=1e-6)


def test_positions_along_a_joint_begin_at_its_start() -> None:
    moved = discretise(on_each_other("mesh", start=0.7)).contacts["joint"]
    still = discretise(on_each_other("mesh")).contacts["joint"]
    assert moved.positions == pytest.approx(0.7 + still.positions)


@pytest.mark.parametrize("shape", SHAPES)
def test_bodies_of_one_group_pass_no_macro_forces(shape: str) -> None:
    structure = on_each_other(shape)
    apart = discretise(replace(structure, groups=np.array([0, 1])))
    together = discretise(replace(structure, groups=np.array([0, 0])))
    assert apart.contacts["joint"].macro is not None
    assert together.contacts["joint"].macro is None
    found = reference_of(together).contact("joint").normal_force
    wanted = reference_of(apart).contact("joint").normal_force
    assert found == pytest.approx(wanted)


@pytest.mark.parametrize("parts", [[0, 0, 1, 1, 0, 0, 1, 1], [0, 1, 1, 1, 0, 0, 2, 2]])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_body_is_the_same_however_its_elements_are_labelled(
    shape: str, parts: list[int]
) -> None:
    whole = Body("block", SHAPES[shape], 2e10, 0.3)
    labels = np.array(parts)
    count = int(labels.max()) + 1
    cut = replace(whole, substructures=count, parts=labels)
    problem = discretise(block(cut, friction=0.02))
    assert len(problem.substructures) == count
    found = reference_of(problem)
    wanted = reference_of(discretise(block(whole, friction=0.02)))
    for name in ("ground", "spring"):
        force = np.asarray(found.contact(name).normal_force)
        assert force == pytest.approx(
            np.asarray(wanted.contact(name).normal_force), abs=1e-7 * 1e5
        )


def test_a_lattice_is_cut_by_bisection_like_a_mesh() -> None:
    cut = Body("block", LATTICE, 2e10, 0.3, substructures=4)
    problem = discretise(block(cut, friction=0.02))
    sizes = [len(part.dofs) for part in problem.substructures]
    assert len(sizes) == 4
    run = solve(problem, Latin(), watch=False)
    assert run.is_certified


@pytest.mark.parametrize("turn", [0.0, 0.5, 2.0])
def test_a_turned_lattice_joined_with_a_mesh_answers_alike(turn: float) -> None:
    """A lattice on a mesh, all turned by an angle, with the load that turns along."""
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    fine = grid(np.linspace(0.0, LENGTH, 3), Y)
    feet = sides(fine, 2, 2)
    bodies = [
        Body("mesh", fine, 2e10, 0.3, angle=turn),
        Body("lattice", LATTICE, 2e10, 0.3, np.array([0.0, HEIGHT]) @ turned.T, turn),
    ]
    normals = np.tile(turned @ UP, (5, 1))
    joint = Joint(
        "joint", 1, LATTICE.side("bottom"), 0, feet["top"], normals, friction=0.3
    )
    held = [Held(f"foot {axis}", 0, feet["bottom"], axis, ZERO) for axis in (0, 1)]
    traction = turned @ np.stack([-PUSH / LENGTH, PRESS / LENGTH])
    load = Load.of_traction("load", 1, bodies[1], LATTICE.side("top"), traction)
    problem = discretise(Bodies(bodies, [joint], held, [load], TIMES, 1.0))
    found = reference_of(problem).contact("joint")
    assert np.asarray(found.normal_force).sum(axis=0) == pytest.approx(-PRESS, abs=1e-3)
    assert found.tangential_force.sum(axis=0) == pytest.approx(PUSH, abs=1e-3)
    run = solve(problem, Latin(), watch=False)
    assert run.is_certified


def test_a_side_is_that_of_all_bodies_that_reach_it_up_to_rounding() -> None:
    """Half of 0.1 m twice ends elsewhere than a sixth and five: by rounding."""
    end = Side(SideComponent(True, 1e-6 * TIMES), SideComponent(True, ZERO))
    stack = Stack(
        length=0.1,
        height=0.2,
        elements=(6, 2),
        substructures=(1, 1),
        young=2e10,
        poisson=0.3,
        instants=TIMES,
        duration=1.0,
        bricks=[
            Brick(0, 0, 3, 2),
            Brick(3, 0, 3, 2),
            Brick(0, 2, 1, 2),
            Brick(1, 2, 5, 2),
        ],
        sides={"left": Side(end.y, end.y), "right": end},
    )
    problem = discretise(stack)
    assert problem.inside is not None
    x = problem.inside.nodes[:, 0]
    assert len(np.unique(x[np.isclose(x, 0.1)])) == 2
    mean = side_mean(problem, "right", 0)
    assert mean(reference_of(problem).displacement) == pytest.approx(1e-6 * TIMES)
    # Both bodies there have two elements up, and so three nodes each.
    assert np.count_nonzero(mean.weights) == 6


def test_the_softest_body_sets_the_unit_of_stress() -> None:
    """Displacements beside a body of a hundred thousand times its modulus are large."""
    structure = on_each_other("lattice")
    soft, other = structure.bodies
    stiff = replace(other, young=1e5 * soft.young)
    scales = discretise(replace(structure, bodies=[soft, stiff])).scales
    assert scales.force / scales.displacement == pytest.approx(soft.young)


@pytest.mark.parametrize("substructures", [1, 2])
@pytest.mark.parametrize(
    ("nodes", "axes"), [([0], [0]), ([0, 1], [1]), ([0], [0, 1]), ([0, 4], [0])]
)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_body_that_is_held_too_little_is_refused(
    shape: str, nodes: list[int], axes: list[int], substructures: int
) -> None:
    """Whatever its parts keep of it."""
    body = Body("block", SHAPES[shape], 2e10, 0.3, substructures=substructures)
    held = [Held("few", 0, np.array(nodes), axis, ZERO) for axis in axes]
    with pytest.raises(LooseBodiesError, match="block"):
        discretise(Bodies([body], [], held, [], TIMES, 1.0))


def test_three_components_hold_a_body() -> None:
    held = [
        Held("foot", 0, np.array([0, 4]), 1, ZERO),
        Held("left", 0, np.array([0]), 0, ZERO),
    ]
    body = Body("block", LATTICE, 2e10, 0.3)
    load = Load("pull", 0, np.array([4]), np.ones((1, 2, len(TIMES))))
    problem = discretise(Bodies([body], [], held, [load], TIMES, 1.0))
    run = solve(problem, Latin(), watch=False)
    assert np.all(np.isfinite(run.iterate.displacement))


@pytest.mark.parametrize("shape", SHAPES)
def test_a_joint_of_known_strength_does_not_hold_a_body_across(shape: str) -> None:
    size = len(on_each_other(shape).joints[0].nodes)
    structure = on_each_other(shape, strength=np.full((size, len(TIMES)), 1e5))
    left = [held for held in structure.held if held.name == "left"]
    with pytest.raises(LooseBodiesError, match="right"):
        discretise(replace(structure, held=left))


GROUND = block(Body("block", MESH, 2e10, 0.3), 0.1).joints[0]
REFUSED = {
    "an image": (
        "Joint 'ground'.is_image",
        lambda: replace(GROUND, is_image=True),
    ),
    "strength at other nodes": (
        "Joint 'ground'.strength",
        lambda: replace(GROUND, strength=np.ones((2, len(TIMES)))),
    ),
    "strength at other instants": (
        "Joint 'ground'.strength",
        lambda: sheared("mesh", strength=np.ones((len(GROUND.nodes), 3))),
    ),
    "pairs of other nodes": (
        "Joint 'ground'.paired",
        lambda: replace(GROUND, paired=np.ones(2, dtype=bool)),
    ),
    "a node that does not exist": (
        "NodeSpring 'spring'.node",
        lambda: block(
            Body("block", MESH, 2e10, 0.3),
            0.1,
            springs=[NodeSpring("spring", 0, 10**6, 0.0, 1.0, 1.0)],
        ),
    ),
    "a slack below zero": (
        "NodeSpring 'spring'.slack",
        lambda: NodeSpring("spring", 0, 0, -1.0, 1.0, 1.0),
    ),
    "parts without elements": (
        "Body 'block'.parts",
        lambda: Body("block", MESH, 2e10, substructures=3, parts=np.array([0, 2] * 4)),
    ),
    "groups of other bodies": (
        "Bodies.groups",
        lambda: replace(on_each_other("mesh"), groups=np.zeros(3, dtype=int)),
    ),
    "a lattice without columns": (
        "Lattice.columns",
        lambda: Lattice(0, 1, 1.0, 1.0),
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_by_name(case: str) -> None:
    name, make = REFUSED[case]
    with pytest.raises(RefusedError) as refused:
        make()
    assert refused.value.name == name


def test_joints_on_supports_all_have_known_strength_or_none() -> None:
    known = sheared("mesh")
    (ground,) = known.joints
    bodies = [*known.bodies, replace(known.bodies[0], origin=np.array([1.0, 0.0]))]
    bodies[1] = replace(bodies[1], name="other")
    other = replace(GROUND, name="other ground", above=1)
    with pytest.raises(RefusedError, match="of another kind than that of other joints"):
        replace(known, bodies=bodies, joints=[ground, other])
