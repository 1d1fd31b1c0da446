"""Blocks are the same as rectangles of a stack and as meshes, the finer the more."""

from __future__ import annotations

import numpy as np
import pytest
from shaped_bodies import grid, sides

from solver.arrays import Array
from solver.discrete import (
    Bodies,
    Body,
    Held,
    Joint,
    Load,
    Problem,
    Side,
    SideComponent,
    Stack,
    Support,
    discretise,
)
from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.probes import reaction
from solver.reference.incremental import reference_of

LENGTH = 0.1
HEIGHT = 0.05
TIMES = np.linspace(0.0, 1.0, 11)
ZERO = np.zeros_like(TIMES)
PRESSURE = 1e6 * np.minimum(3.0 * TIMES, 1.0)
MOVED = 8e-6 * np.sin(2.0 * np.pi * np.clip(1.5 * TIMES - 0.5, 0.0, 1.0))
MU = 0.3


def as_stack(bodies: int, fine: int) -> Problem:
    """Blocks on each other and on the ground; the top is pressed and moved along."""
    along = 4 * fine
    up = 2 * fine
    top = Side(SideComponent(True, MOVED), SideComponent(False, -PRESSURE))
    stack = Stack(
        length=LENGTH,
        height=HEIGHT,
        elements=(along, up),
        substructures=(1, 1),
        young=2e10,
        poisson=0.3,
        instants=TIMES,
        duration=1.0,
        friction=MU,
        support=Support(np.zeros(along + 1), MU),
        sides={"top": top},
        bricks=[Brick(0, body * up, along, up) for body in range(bodies)],
    )
    return discretise(stack)


def as_meshes(bodies: int, fine: int) -> Problem:
    """The same of quadratic elements, twice as long and as high."""
    x = np.linspace(0.0, LENGTH, 2 * fine + 1)
    mesh = grid(x, np.linspace(0.0, HEIGHT, fine + 1))
    chains = sides(mesh, 2 * fine, fine)
    foot = chains["bottom"]
    top = chains["top"]
    blocks = []
    for number in range(bodies):
        origin = np.array([0.0, number * HEIGHT])
        blocks.append(Body(f"block {number}", mesh, 2e10, 0.3, origin=origin))
    up = np.tile([0.0, 1.0], (len(foot), 1))
    joints = [Joint("ground", 0, foot, None, None, up, friction=MU)]
    for number in range(1, bodies):
        name = f"joint {number}"
        joints.append(Joint(name, number, foot, number - 1, top, up, friction=MU))
    pressed = np.stack([ZERO, -PRESSURE])
    load = Load.of_traction("pressure", bodies - 1, blocks[-1], top, pressed)
    held = Held("top", bodies - 1, top, 0, MOVED)
    return discretise(Bodies(blocks, joints, [held], [load], TIMES, 1.0))


def force_of(problem: Problem) -> Array:
    """Force that moves the top along, (n_instants,), N."""
    return reaction(problem, "top", 0).of(reference_of(problem))


@pytest.mark.parametrize("bodies", [1, 2])
def test_the_same_force_moves_the_top(bodies: int) -> None:
    differences = []
    for fine in (1, 2, 4):
        wanted = force_of(as_meshes(bodies, fine))
        found = force_of(as_stack(bodies, fine))
        differences.append(np.abs(found - wanted).max() / np.abs(wanted).max())
    assert differences[0] < 0.1
    # Each time elements are half as large.
    assert differences[1] < 0.6 * differences[0]
    assert differences[2] < 0.6 * differences[1]


@pytest.mark.parametrize("bodies", [1, 2])
def test_every_contact_carries_the_pressure(bodies: int) -> None:
    for problem in (as_stack(bodies, 2), as_meshes(bodies, 2)):
        solution = reference_of(problem)
        assert len(problem.contacts) == bodies
        for name in problem.contacts:
            pressing = np.asarray(solution.contact(name).normal_force).sum(axis=0)
            assert pressing == pytest.approx(PRESSURE * LENGTH, rel=1e-9, abs=1e-6)


def two_beside_each_other(cuts: int) -> Bodies:
    """Two blocks beside each other on a third one, which is as long as both."""
    small = grid(np.linspace(0.0, LENGTH, 5), np.linspace(0.0, HEIGHT, 3))
    large = grid(np.linspace(0.0, 2.0 * LENGTH, 9), np.linspace(0.0, HEIGHT, 3))
    chains = sides(small, 4, 2)
    feet = sides(large, 8, 2)
    foot = chains["bottom"]
    bodies = [
        Body("below", large, 2e10, 0.3, substructures=cuts),
        Body("left", small, 2e10, origin=np.array([0.0, HEIGHT]), substructures=cuts),
        Body("right", small, 2e10, origin=np.array([LENGTH, HEIGHT])),
    ]
    up = np.tile([0.0, 1.0], (len(foot), 1))
    aside = np.tile([1.0, 0.0], (len(chains["left"]), 1))
    half = len(foot)
    bed = feet["top"]
    joints = [
        Joint("left bed", 1, foot, 0, bed[:half], up),
        Joint("right bed", 2, foot, 0, bed[half - 1 :], up),
        Joint("head", 2, chains["left"], 1, chains["right"], aside),
    ]
    ground = feet["bottom"]
    held = [Held(f"ground {axis}", 0, ground, axis, ZERO) for axis in (0, 1)]
    held += [Held(f"top {body}", body, chains["top"], 0, ZERO) for body in (1, 2)]
    return Bodies(bodies, joints, held, [], TIMES, 1.0)


@pytest.mark.parametrize("cuts", [1, 8])
def test_joints_that_meet_in_a_corner_are_short_however_bodies_are_cut(
    cuts: int,
) -> None:
    assert discretise(two_beside_each_other(cuts)).has_short_joints
    assert not as_meshes(2, 1).has_short_joints
