"""A pointed arch is two arcs that meet at the crown, and stands as statics says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from solver import discrete
from solver.discrete.plane.makers.voussoirs import LEFT, LIVE, RIGHT
from solver.discrete.probes import reaction
from solver.latin import solve
from solver.reference.incremental import reference_of
from solver.reference.limit_analysis import collapse_of, load_factors
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.quantities import QUANTITIES
from solver.study.quantities.finished import FinishedRun

EQUILATERAL = {"centres": 1.0, "friction": 0.9}
STILL = {"displacement": 0.0, "instants": 5}


def settings_of(**changes):
    return CATALOGUE["arch"].checked(EQUILATERAL | changes)


def moved(distance):
    """Path of the abutment, which moves once the weight acts."""
    return [[0.0, 0.0], [0.25, 0.0], [1.0, distance]]


def centre_of(points):
    """Centre of the circle through three points."""
    first, second, third = points
    rows = 2.0 * np.array([second - first, third - first])
    squares = (points**2).sum(axis=1)
    return np.linalg.solve(rows, squares[1:] - squares[0])


@pytest.mark.parametrize("voussoirs", [8, 9])
@pytest.mark.parametrize(("centres", "span"), [(1.0, 180.0), (0.4, 120.0), (2.0, 60.0)])
def test_centres_are_as_far_apart_as_is_said(voussoirs, centres, span):
    settings = settings_of(voussoirs=voussoirs, centres=centres, span=span)
    structure = settings.structure()
    inner = [
        structure.bodies[joint.above].nodes[joint.nodes[0]]
        for joint in structure.joints[1:-1]
    ]
    left = centre_of(np.array(inner[:3]))
    right = centre_of(np.array(inner[-3:]))
    # The left block stands with its left end outwards.
    ends = [
        structure.bodies[joint.below].nodes[joint.nodes_below[0]]
        for joint in (structure.joints[0], structure.joints[-1])
    ]
    clear = ends[1] - ends[0]
    assert (left - right)[0] == pytest.approx(centres * clear[0])
    np.testing.assert_allclose([left[1], right[1], clear[1]], 0.0, atol=1e-12)
    if centres == 1.0:
        # Each side of an equilateral arch is drawn from the foot of the other.
        assert ends[0] == pytest.approx(right)
        assert ends[1] == pytest.approx(left)


@pytest.mark.parametrize("voussoirs", [2, 3, 10, 11])
@pytest.mark.parametrize("centres", [0.3, 2.0, 10.0])
@pytest.mark.parametrize("span", [60.0, 180.0])
@pytest.mark.parametrize("thickness", [0.05, 0.4, 1.0])
def test_neighbours_meet_in_their_joint(voussoirs, centres, span, thickness):
    settings = settings_of(
        voussoirs=voussoirs, centres=centres, span=span, thickness=thickness
    )
    structure = settings.structure()
    for joint in structure.joints:
        above = structure.bodies[joint.above].nodes[joint.nodes]
        below = structure.bodies[joint.below].nodes[joint.nodes_below]
        np.testing.assert_allclose(above, below, atol=1e-12)
        outward = structure.bodies[joint.below].outward(joint.nodes_below)
        np.testing.assert_allclose(outward, joint.normals, atol=1e-9)


@pytest.mark.parametrize("voussoirs", [8, 9])
def test_both_halves_are_mirror_images(voussoirs):
    bodies = settings_of(voussoirs=voussoirs).structure().bodies
    for left, right in zip(bodies, reversed(bodies), strict=True):
        image = right.nodes * [-1.0, 1.0]
        distances = np.linalg.norm(left.nodes[:, None] - image, axis=2)
        assert distances.min(axis=0).max() < 1e-12
    points = [body.nodes[:, 0] for body in bodies]
    assert np.min(np.abs(np.concatenate(points))) == 0.0


@pytest.mark.parametrize("voussoirs", [12, 13])
def test_fine_stones_weigh_as_statics_says(voussoirs):
    settings = settings_of(voussoirs=voussoirs, elements=16, fill=1e4, cover=0.3)
    weight = settings.structure().downwards[-1] / settings.unit_weight
    assert weight == pytest.approx(settings.statics.weight, rel=2e-4)


@pytest.mark.parametrize(("voussoirs", "centres"), [(30, 1.0), (31, 1.0), (30, 0.5)])
@pytest.mark.parametrize("name", ["thickness", "friction"])
def test_a_pointed_arch_falls_where_no_forces_in_its_joints_balance_its_weight(
    voussoirs, centres, name
):
    settings = settings_of(
        voussoirs=voussoirs, centres=centres, young=1e12, elements=4, **STILL
    )
    statics = settings.statics
    limits = {"thickness": statics.thinnest, "friction": statics.least_friction}
    limit = limits[name]()
    for share, stands in ((0.98, False), (1.02, True)):
        near = settings.replace(**{name: share * limit})
        assert (collapse_of(discretise(near)) is None) is stands
        assert (near.statics.reserve >= 0.0) is stands


@pytest.mark.parametrize("voussoirs", [24, 25])
@pytest.mark.parametrize("distance", [2e-3, -2e-3])
def test_abutments_that_move_take_the_thrust_to_its_bounds(voussoirs, distance):
    settings = settings_of(
        voussoirs=voussoirs, instants=5, abutment_load=moved(distance)
    )
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    structure = settings.structure()
    _, thrust = structure.loop(problem).along(reference)
    least, largest = settings.statics.thrusts()
    known = least
    if distance < 0.0:
        known = largest
    assert thrust[-1] / structure.downwards[-1] == pytest.approx(known, rel=3e-3)


def test_a_pointed_arch_pushes_less_than_a_round_one():
    bounds = [
        settings_of(voussoirs=24, centres=centres).statics.thrusts()
        for centres in (0.0, 0.5, 1.0, 2.0)
    ]
    assert np.all(np.diff(bounds, axis=0) < 0.0)


@pytest.mark.parametrize("voussoirs", [10, 11])
def test_forces_under_a_fill_are_symmetric_and_balance(voussoirs):
    settings = settings_of(voussoirs=voussoirs, fill=1e4, **STILL)
    problem = discretise(settings)
    reference = reference_of(problem)
    pushes = []
    carried = []
    for name in (LEFT, RIGHT):
        push = reaction(problem, f"{name} x", 0)
        up = reaction(problem, f"{name} y", 1)
        pushes.append(push.of(reference)[-1])
        carried.append(up.of(reference)[-1])
    assert pushes[0] == pytest.approx(-pushes[1])
    assert carried[0] == pytest.approx(carried[1])
    whole = settings.structure().downwards[-1]
    assert sum(carried) == pytest.approx(whole)


def stones_of(structure):
    """Areas, (n,), and centres, (n, 2), of polygons between joints."""
    areas = []
    centres = []
    for body in structure.bodies[1:-1]:
        sizes = body.shape.areas
        middles = body.shape.centres @ body.rotation.T + body.origin
        areas.append(sizes.sum())
        centres.append(sizes @ middles / sizes.sum())
    return np.array(areas), np.array(centres)


def rigid_load(structure, stone, along, unit_weight):
    """Largest load on a stone at a position along x that rigid stones carry, N.

    A linear program in the force and moment at the left springing, and the load. What
    presses on a joint turns the part at the left about both ends of the joint, one way
    and the other.
    """
    areas, centres = stones_of(structure)
    rows = []
    for number, joint in enumerate(structure.joints):
        ends = structure.bodies[joint.above].nodes[joint.nodes[[0, -1]]]
        if number == len(structure.joints) - 1:
            ends = structure.bodies[joint.below].nodes[joint.nodes_below[[0, -1]]]
        weights = unit_weight * areas[:number]
        for sign, (x, y) in zip((1.0, -1.0), ends, strict=True):
            # Moments about the end: of the springing, the load, and the weights.
            load = -(along - x) * (number > stone)
            own = -(centres[:number, 0] - x) @ weights
            rows.append(sign * np.array([y, -x, 1.0, load, own]))
    rows = np.array(rows)
    limits = [(None, None), (None, None), (None, None), (0.0, None)]
    goal = [0.0, 0.0, 0.0, -1.0]
    return -linprog(goal, rows[:, :4], -rows[:, 4], bounds=limits).fun


@pytest.mark.parametrize("voussoirs", [10, 11])
@pytest.mark.parametrize("place", [0.4, 0.3])
def test_the_limit_of_a_load_is_that_of_rigid_stones(voussoirs, place):
    settings = settings_of(
        voussoirs=voussoirs,
        thickness=0.2,
        friction=5.0,
        live=100.0,
        place=place,
        place_load=[[0.0, place]],
        displacement=0.0,
        instants=3,
    )
    bare = settings.structure().without(LIVE)
    factors = load_factors(discretise(settings), discrete.discretise(bare))
    shares = settings.ring.under_load(np.array([place]))[:, :, 0]
    along = np.sum(shares * settings.ring.backs[:, :, 0])
    stone = int(shares.any(axis=1).argmax())
    limit = rigid_load(bare, stone, along, settings.unit_weight)
    assert factors[-1] * 100.0 == pytest.approx(limit, rel=0.01)


def test_hinges_are_three_and_certified():
    settings = settings_of(voussoirs=16, instants=5, abutment_load=moved(2e-3))
    run = FinishedRun(
        settings, solve(discretise(settings), method_of(settings), watch=False)
    )
    assert run.solution.is_certified
    least, _ = settings.statics.thrusts()
    assert QUANTITIES["thrust"](run) == pytest.approx(least, rel=3e-3)
    assert QUANTITIES["hinges"](run) >= 3.0


def test_the_sentence_says_that_it_is_pointed():
    assert settings_of().sentence().startswith("A pointed arch of 31 stones")
    assert settings_of(span=100.0).sentence().startswith("A pointed arch of 31 stones")
