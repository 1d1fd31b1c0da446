"""The status that a run shows at its end is that of the solution, not the creep of its stages."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.latin import solve
from solver.latin.iterate import Iterate
from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

SCENES: dict[str, dict[str, Any]] = {
    "bar": {},
    "strand": {"elements": 20, "instants": 51},
    "block": {"elements": 24, "elements_up": 8},
}
METHODS: tuple[dict[str, Any], ...] = ({"method": "paper"}, {"linear_stage": "pgd"})


def end_and_truth(scene: str, **changes: Any) -> tuple[Iterate, np.ndarray]:
    """Give the last iterate of a run that converges, and the status of the solution."""
    settings = CATALOGUE[scene].settings.checked({**SCENES[scene], **changes})
    problem = discretise(settings)
    solution = solve(problem, method_of(settings), watch=False)
    assert solution.status.ending == "converged"
    return solution.iterate, reference_of(problem).status


@pytest.mark.parametrize("changes", METHODS)
@pytest.mark.parametrize("scene", SCENES)
def test_an_iterate_at_the_end_shows_stick_and_slip_of_the_solution(
    scene: str, changes: dict[str, Any]
) -> None:
    iterate, truth = end_and_truth(scene, **changes)
    assert np.mean(iterate.status != truth) < 0.004
