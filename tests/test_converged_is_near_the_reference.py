"""A run that is called converged has its contact forces within the accuracy, however it went."""

from __future__ import annotations

import pytest

from solver.discrete import Problem
from solver.latin import Ending, solve
from solver.reference.choice import reference_of
from solver.reference.distance import Distance, distance_to
from solver.reference.fingerprint import fingerprint
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

ACCURACY = 0.01
FEW = {"instants": 21}
CASES = [
    ("bar", {}),
    ("bar", {"elements": 200}),
    ("bar", {"peak": 10.0}),
    ("bar", {"friction": 100.0}),
    ("bar", {"load": "decaying"}),
    ("strand", {}),
    ("strand", {"wires": 10, **FEW}),
    ("strand", {"wires": 15, **FEW}),
    ("block", {}),
    ("block", {"top_normal_displacement": 4e-5}),
    ("block", {"interpolation": "biquadratic", "elements": 24, "elements_up": 12, **FEW}),
    ("layers", {}),
    ("layers", {"layers": 6, "friction": 1.0, **FEW}),
]
PAPER = [
    ("bar", {}),
    ("bar", {"peak": 10.0}),
    ("bar", {"friction": 100.0}),
    ("strand", {}),
    ("block", {}),
    ("block", {"top_normal_displacement": 4e-5}),
]
RUNS = [
    *CASES,
    *((scene, {"finish": "none", **values}) for scene, values in CASES),
    *((scene, {"method": "paper", **values}) for scene, values in PAPER),
]


@pytest.fixture(scope="module")
def distances():
    """Give the distance to the reference of a problem, solved once for all runs of it."""
    found: dict[bytes, Distance] = {}

    def distance(problem: Problem) -> Distance:
        key = fingerprint(problem)
        if key not in found:
            found[key] = distance_to(reference_of(problem), problem)
        return found[key]

    return distance


@pytest.mark.parametrize(("scene", "values"), RUNS, ids=str)
def test_what_is_called_converged_is_within_one_percent(distances, scene, values):
    settings = CATALOGUE[scene].settings.checked(values)
    problem = discretise(settings)
    solution = solve(problem, method_of(settings), watch=False)
    distance = distances(problem)
    assert solution.status.ending is Ending.CONVERGED
    assert distance.of_displacement(solution.iterate) < ACCURACY
    assert distance.of_friction_force(solution.iterate) < ACCURACY
