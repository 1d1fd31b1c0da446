"""A run that the defaults call converged has its contact forces within two per cent."""

from __future__ import annotations

import pytest

from solver.discrete import discretise
from solver.latin import Ending, solve
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE

FAST = {"search_direction": "auto", "acceleration": "anderson", "start": "nested"}
FEW = {"instants": 21}
CASES = [
    ("bar", {}),
    ("bar", FAST),
    ("bar", {**FAST, "elements": 200}),
    ("bar", {"peak": 10.0}),
    ("bar", {"friction": 100.0}),
    ("bar", {"load": "decaying", **FAST}),
    ("strand", {}),
    ("strand", {"wires": 10, **FEW}),
    ("strand", {"wires": 20, **FEW}),
    ("block", {}),
    ("block", {"top_normal_displacement": 4e-5}),
    ("block", {"interpolation": "biquadratic", "elements": 24, "elements_up": 12, **FEW}),
    ("layers", {}),
    ("layers", {"layers": 6, "friction": 1.0, **FEW}),
]


@pytest.mark.parametrize(("scene", "values"), CASES, ids=str)
def test_what_the_default_tolerance_calls_converged_is_within_two_percent(scene, values):
    settings = CATALOGUE[scene].settings.checked(values)
    problem = discretise(settings)
    solution = solve(problem, settings, distance=distance_to(reference_of(problem), problem))
    assert solution.status.ending is Ending.CONVERGED
    assert solution.records[-1].error_displacement < 1e-3
    assert solution.records[-1].error_force < 0.02
