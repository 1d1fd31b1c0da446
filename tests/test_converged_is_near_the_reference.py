"""A run that is called converged has its contact forces within the accuracy, however it went."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from solver.discrete import Problem
from solver.latin import Ending, solve
from solver.reference.choice import reference_of
from solver.reference.distance import Distance, distance_to
from solver.reference.fingerprint import fingerprint
from solver.reference.states import rules_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.block import BlockSettings
from solver.scenes.method import method_of

ACCURACY = 0.01
FEW = {"instants": 21}
CASES = [
    ("bar", {}),
    ("bar", {"peak": 10.0}),
    ("bar", {"friction": 100.0}),
    ("bar", {"load": "decaying"}),
    ("strand", {"wires": 10, **FEW}),
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
    ("strand", FEW),
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


@pytest.mark.parametrize("friction", [0.02, 0.05])
@pytest.mark.parametrize("finish", ["none", "at-once"])
def test_friction_does_not_hide_behind_a_large_pressure(finish, friction):
    values = {"accuracy": 1e-3, "elements": 24, "elements_up": 12, "instants": 41}
    settings = BlockSettings.checked({**values, "finish": finish, "friction": friction})
    problem = discretise(settings)
    reference = reference_of(problem)
    solution = solve(problem, method_of(settings), watch=False)
    normal = rules_of(problem).normal
    for kind in (normal, ~normal):
        exact = reference.contact_force[kind]
        off = np.linalg.norm(solution.iterate.contact_force[kind] - exact)
        assert off < 1e-3 * np.linalg.norm(exact)


@pytest.mark.parametrize(("size", "error"), [(0.1, 0.5), (1e-3, 0.05), (0.0, 0.0)])
def test_an_error_is_that_of_friction_and_one_of_next_to_nothing_counts_beside_the_pressure(
    size, error
):
    problem = discretise(BlockSettings.checked({"elements": 4, "elements_up": 2, "instants": 5}))
    normal = rules_of(problem).normal[:, None]
    exact = np.where(normal, 1.0, size) * np.ones(problem.n_instants)
    wrong = np.where(normal, 1.0, 1.5 * size) * np.ones(problem.n_instants)
    nowhere = np.zeros((problem.n_dofs, problem.n_instants))
    distance = distance_to(SimpleNamespace(displacement=nowhere, contact_force=exact), problem)
    fields = SimpleNamespace(displacement=nowhere, contact_force=wrong)
    assert distance.of_friction_force(fields) == pytest.approx(error, rel=1e-2)


@pytest.mark.parametrize(("scene", "values"), RUNS, ids=str)
def test_what_is_called_converged_is_within_one_percent(distances, scene, values):
    settings = CATALOGUE[scene].settings.checked(values)
    problem = discretise(settings)
    solution = solve(problem, method_of(settings), watch=False)
    distance = distances(problem)
    assert solution.status.ending is Ending.CONVERGED
    assert distance.of_displacement(solution.iterate) < ACCURACY
    assert distance.of_friction_force(solution.iterate) < ACCURACY
