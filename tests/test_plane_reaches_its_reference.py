"""LATIN in the plane comes to the incremental reference, soon, and whatever the decomposition."""

from __future__ import annotations

from functools import cache
from itertools import islice

import numpy as np
import pytest
from plane import whole_force_error

from solver.latin import iterations
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

SMALL = {"elements": 32, "elements_up": 16, "instants": 41}


def problem_of(scene, **values):
    settings = CATALOGUE[scene].settings.checked(values)
    return settings, discretise(settings)


@cache
def known(scene):
    """Give the distance to the reference of a small scene; it is the same however it is cut."""
    size = SMALL if scene == "block" else {"instants": 41}
    _, problem = problem_of(scene, **size)
    reference = reference_of(problem)
    assert reference.converged.all()
    assert not reference.ambiguous.any()
    return distance_to(reference, problem)


def errors(scene, most, **values):
    """Give the error of the contact force after every iteration."""
    size = SMALL if scene == "block" else {"instants": 41}
    settings, problem = problem_of(scene, **{**size, **values})
    distance = known(scene)
    found = islice(iterations(problem, method_of(settings)), most)
    return np.array([distance.of_friction_force(one) for one in found])


def within(found, level):
    """Give the iteration from which all errors are below a level."""
    above = np.flatnonzero(found > level)
    return (above[-1] if len(above) else -1) + 2


@pytest.mark.parametrize("acceleration", ["anderson", "none"])
@pytest.mark.parametrize("gap", ["parabola", "flat"])
def test_twenty_thousand_unknowns_come_within_one_percent_in_fifteen_iterations(gap, acceleration):
    settings, problem = problem_of(
        "block",
        elements=96,
        elements_up=96,
        substructures=4,
        substructures_up=4,
        instants=100,
        gap=gap,
        acceleration=acceleration,
    )
    *_, last = islice(iterations(problem, method_of(settings)), 15)
    assert whole_force_error(reference_of(problem), last) <= 0.01


@pytest.mark.parametrize(("scene", "most"), [("block", 45), ("layers", 160)])
def test_the_iteration_ends_at_the_reference(scene, most):
    assert errors(scene, most)[-1] < 1e-6


def test_iterations_to_one_percent_hardly_grow_from_four_to_sixty_four_substructures():
    cuts = [(2, 2), (4, 4), (8, 8)]
    found = [
        within(errors("block", 30, substructures=along, substructures_up=up), 0.01)
        for along, up in cuts
    ]
    assert max(found) <= 1.5 * min(found)


@pytest.mark.parametrize("scene", ["block", "layers"])
def test_a_generous_basis_iterates_like_the_full_stage(scene):
    common = {"acceleration": "none", "relaxation": 0.8}
    full = errors(scene, 25, **common)
    generous = {"pgd_modes": 100, "pgd_tolerance": 1e-10, "pgd_pairs": 40}
    reduced = errors(scene, 25, linear_stage="pgd", **generous, **common)
    assert reduced[-1] < 1.1 * full[-1] + 1e-3
