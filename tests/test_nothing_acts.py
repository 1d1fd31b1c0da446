"""What acts on a body is known, and where nothing does."""

from __future__ import annotations

from typing import Any

import pytest

from solver.discrete.idle import nothing_acts
from solver.scenes import CATALOGUE, discretise

IDLE: dict[str, dict[str, Any]] = {
    "bar": {"peak": 0.0},
    "strand": {"peak": 0.0},
    "block": {"top": "traction"},
    "layers": {"pressure": 0.0, "deflection": 0.0},
    "fault": {"shear_stress": 0.0},
    "incline": {"weight": 0.0},
    "rope": {"curvature": 0.0},
}


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_nothing_acts_where_all_that_is_given_is_zero(scene: str) -> None:
    kind = CATALOGUE[scene].settings
    assert nothing_acts(discretise(kind.checked({**IDLE[scene], "instants": 5})))
    assert not nothing_acts(discretise(kind.checked({"instants": 5})))


@pytest.mark.parametrize(
    "change",
    [{"gap": [[0.0, -1e-6], [0.1, -1e-6]], "top": "free"}, {"top": "free", "body_force_y": -1e6}],
    ids=["overlap", "weight"],
)
def test_an_overlap_acts_and_so_does_weight(change: dict[str, Any]) -> None:
    settings = CATALOGUE["block"].settings.checked({"gap": "flat", "instants": 5, **change})
    assert not nothing_acts(discretise(settings))
