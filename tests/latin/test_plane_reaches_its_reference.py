"""LATIN in the plane comes soon to the reference, in any decomposition."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from contact_problems import block
from plane import whole_force_error
from runs import errors, sample, settings_of

from solver.discrete import discretise
from solver.discrete.plane.rectangles.sides import Side, SideComponent
from solver.latin import iterations
from solver.laws import OPEN
from solver.reference.distance import determinate_forces, distance_to, kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

SMALL = {"elements": 32, "elements_up": 16, "instants": 41}


def errors_of(scene, most, **values):
    if scene == "block":
        size = SMALL
    else:
        size = {"instants": 41}
    return errors(settings_of(scene, **(size | values)), most)


def within(found, level):
    """Iteration from which all errors are below a level."""
    above = np.flatnonzero(found > level)
    return (above[-1] if len(above) else -1) + 2


@pytest.mark.parametrize("acceleration", ["anderson", "none"])
@pytest.mark.parametrize("gap", ["parabola", "flat"])
def test_twenty_thousand_unknowns_come_within_one_percent_in_fifteen_iterations(
    gap, acceleration
):
    settings = settings_of(
        "block",
        elements=96,
        elements_up=96,
        substructures=4,
        substructures_up=4,
        instants=100,
        gap=gap,
        acceleration=acceleration,
    )
    last = sample(settings, 15)
    assert whole_force_error(reference_of(last.problem), last) <= 0.01


@pytest.mark.parametrize(("scene", "most"), [("block", 45), ("layers", 160)])
def test_the_iteration_ends_at_the_reference(scene, most):
    assert errors_of(scene, most)[-1] < 1e-6


def test_iterations_to_one_percent_hardly_grow_from_four_to_sixty_four_substructures():
    cuts = [(2, 2), (4, 4), (8, 8)]
    found = [
        within(errors_of("block", 30, substructures=along, substructures_up=up), 0.01)
        for along, up in cuts
    ]
    assert max(found) <= 1.5 * min(found)


HERE = np.linspace(0.0, 1.0, 17)
LEANING = Side(
    SideComponent(True, 1e-4 * HERE, 0.0 * HERE),
    SideComponent(False, 0.0 * HERE, 0.0 * HERE),
)
"""A side whose horizontal displacement is prescribed: it rubs on the support as it
moves."""
CASES = {
    "pressed, then sheared back and forth": {},
    "much friction": {"friction": 1.0, "shear": 0.5},
    "tilted until it lifts off": {"shear": 0.0, "slope": 2.0},
    "two bodies": {"bodies": 2, "height": 0.3, "elements": (12, 4), "cuts": (2, 1)},
    "a side that moves": {"left": LEANING, "shear": 0.1},
}


@pytest.fixture(scope="module", params=CASES)
def case(request):
    problem = discretise(block(**CASES[request.param]))
    settings = BarSettings.checked({"method": "paper"}).replace(relaxation=0.9)
    iterate = next(islice(iterations(problem, method_of(settings)), 399, None))
    return problem, reference_of(problem), iterate


def test_converged_latin_is_the_reference_and_shows_the_same_at_every_interface(case):
    problem, reference, iterate = case
    distance = distance_to(reference, problem)
    assert reference.converged.all()
    assert kkt_residual(reference, problem) <= 1e-12
    assert distance.of_displacement(iterate) < 1e-6
    assert distance.of_friction_force(iterate) < 1e-6
    size = np.abs(reference.displacement).max()
    for name in problem.contacts:
        ours = iterate.contact(name)
        theirs = reference.contact(name)
        np.testing.assert_allclose(ours.opening, theirs.opening, atol=1e-5 * size)
        np.testing.assert_allclose(ours.slip, theirs.slip, atol=1e-5 * size)


def test_the_tilted_block_lifts_off_and_comes_back():
    reference = reference_of(discretise(block(**CASES["tilted until it lifts off"])))
    status = reference.contact("support").status
    opened = np.diff((status == OPEN).astype(int), axis=1) > 0
    closed = status[:, -1] != OPEN
    assert (opened[:, 3:].any(axis=1) & closed).sum() > 3


def test_only_forces_that_a_support_does_not_share_are_compared():
    wall = Side(
        SideComponent(True, 0.0 * HERE, 0.0 * HERE),
        SideComponent(True, -1e-4 * HERE, 0.0 * HERE),
    )
    for side, points in ((LEANING, 13), (wall, 12)):
        problem = discretise(block(left=side))
        assert len(problem.contacts["support"].positions) == points
        places = problem.contacts.forces["support"]
        assert all(determinate_forces(problem)[place][:, 1:].all() for place in places)
