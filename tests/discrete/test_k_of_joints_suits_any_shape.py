"""The search direction of joints suits bodies of any shape, however finely meshed."""

from __future__ import annotations

import numpy as np
import pytest
from shaped_bodies import (
    arch,
    belt,
    block_on_ground,
    distorted,
    grid,
    in_triangles,
    leaf,
    leaf_spring,
    sides,
)

from solver.arrays import Array
from solver.discrete import Beam, Bodies, Body, Held, Joint, Load, Problem, discretise
from solver.latin import Latin, iterations
from solver.latin.direction.directions import automatic
from solver.laws import NodalStiffness
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of

GOAL = 0.01
TIME = np.linspace(0.0, 1.0, 11)


def iterations_to_goal(problem: Problem, most: int) -> int:
    """Iterations of the linear and local stage alone to 1 % of the contact force."""
    distance = distance_to(reference_of(problem), problem)
    for iterate in iterations(problem, Latin(finish=None)):
        if distance.of_friction_force(iterate) < GOAL or iterate.number > most:
            return iterate.number
    raise AssertionError("the iteration ended by itself")


def test_k_along_a_belt_is_that_of_the_whole_belt_whatever_the_mesh() -> None:
    for nodes in (31, 121):
        problem = discretise(belt(np.pi, 0.3, 2.0, nodes=nodes))
        law = problem.contacts["drum"]
        scale = problem.scales.force / problem.scales.displacement
        k = automatic(problem)[law.tangent.above][1:-1] * scale
        # Of the mean of E A / l n and 2 E A / h (MATHEMATICS.md, 19).
        wanted = 2.0 * np.sqrt(2.0) * 1e7 / (0.1 * np.pi)
        assert k == pytest.approx(wanted, rel=0.03)


@pytest.mark.parametrize(("nodes", "most"), [(31, 50), (121, 120)])
@pytest.mark.parametrize(("friction", "wrap"), [(0.3, np.pi), (0.1, 4.0 * np.pi)])
def test_belts_converge(friction: float, wrap: float, nodes: int, most: int) -> None:
    ratio = np.exp(0.7 * friction * wrap)
    problem = discretise(belt(wrap, friction, ratio, nodes=nodes))
    # With the k of bodies 5 to 13 % are left after 200 iterations.
    assert iterations_to_goal(problem, most) <= most


@pytest.mark.parametrize("across", [1, 2, 4])
def test_arches_converge_however_they_are_meshed(across: int) -> None:
    problem = discretise(arch(31, across=across, spread=2e-5, instants=11))
    assert iterations_to_goal(problem, 50) <= 50


@pytest.mark.parametrize("count", [4, 16])
def test_blocks_of_triangles_converge_however_fine_they_are(count: int) -> None:
    half = count // 2
    block = grid(np.linspace(0.0, 0.1, count + 1), np.linspace(0.0, 0.05, half + 1))
    mesh = in_triangles(distorted(block, 0.01 / count))
    chains = sides(block, count, half)
    chains = {name: mesh.along(chain[::2]) for name, chain in chains.items()}
    problem = discretise(block_on_ground(mesh, chains))
    assert iterations_to_goal(problem, 15) <= 15


def strip_on_block(press: Array, tug: Array) -> Bodies:
    """A line of beams on a block, pressed, and tugged at its end, (n_instants,), N."""
    block = grid(np.linspace(0.0, 0.1, 5), np.linspace(0.0, 0.05, 4))
    chains = sides(block, 4, 3)
    top = chains["top"]
    strip = Body("strip", Beam(block.nodes[top], 1e-3, 1e-10), 2e11)
    up = np.tile([0.0, 1.0], (len(top), 1))
    on_block = np.arange(len(top))
    bed = Joint("bed", 1, on_block, 0, top, up, friction=0.3)
    still = 0.0 * press
    foot = chains["bottom"]
    held = [Held("x", 0, foot, 0, still), Held("y", 0, foot, 1, still)]
    down = np.stack([still, -press / 0.1])
    loads = [
        Load.of_traction("press", 1, strip, on_block, down),
        Load("tug", 1, on_block[-1:], np.stack([tug, still])[None]),
    ]
    bodies = [Body("block", block, 1e10, 0.3), strip]
    return Bodies(bodies, [bed], held, loads, TIME, 1.0)


def test_a_line_of_beams_rubs_on_a_mesh() -> None:
    press = 1e5 * np.minimum(3.0 * TIME, 1.0)
    tug = 2e4 * np.sin(2.0 * np.pi * np.clip(1.5 * TIME - 0.5, 0.0, 1.0))
    problem = discretise(strip_on_block(press, tug))
    reference = reference_of(problem)
    assert reference.converged.all()
    contact = reference.contact("bed")
    assert np.asarray(contact.normal_force).sum(axis=0) == pytest.approx(press)
    rubbing = np.asarray(contact.tangential_force).sum(axis=0)
    assert rubbing == pytest.approx(-tug, abs=1e-6)
    assert np.any(contact.status == 1)
    assert iterations_to_goal(problem, 60) <= 60


@pytest.mark.parametrize(("elements", "count", "most"), [(50, 2, 60), (100, 2, 90)])
def test_leaves_that_slide_on_each_other_converge(
    elements: int, count: int, most: int
) -> None:
    problem = discretise(leaf(elements, friction=0.3, count=count))
    # With the k of bodies it takes 144 and 217 iterations.
    assert iterations_to_goal(problem, most) <= most


@pytest.mark.parametrize(("elements", "count", "most"), [(80, 2, 20), (40, 3, 30)])
def test_leaves_that_bend_together_converge(
    elements: int, count: int, most: int
) -> None:
    problem = discretise(leaf_spring(elements, count))
    # With macro forces of degree 1 it takes more than 120 iterations.
    assert iterations_to_goal(problem, most) <= most


def test_lines_rest_on_each_other_where_no_mesh_is_between() -> None:
    """A strip on a block has the k of bodies, a leaf on the ground that of a belt."""
    alone = discretise(leaf(20, friction=0.3)).contacts["ground"]
    stacked = discretise(leaf(20, friction=0.3, count=3)).contacts["ground"]
    path = np.minimum(3.0 * TIME, 1.0)
    bed = discretise(strip_on_block(path, path)).contacts["bed"]
    for law, count in ((alone, 0), (stacked, 3), (bed, 0)):
        beside = law.stiffness_beside
        assert isinstance(beside, NodalStiffness)
        assert np.all(beside.lines == count)
