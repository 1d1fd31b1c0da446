"""A body on which nothing acts rests: the page says so, on axes of its own size."""

from __future__ import annotations

from typing import Any

import pytest
from shown_pages import Shown

from app.views.bodies import deformed
from app.views.load import loop
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


def shown_run(scene: str, **changes: Any) -> Shown:
    shown = Shown()
    shown.run(1, scene, {"instants": 11, "max_iterations": 4, **changes})
    return shown


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_the_status_line_says_that_nothing_acts_and_not_that_it_converged(scene: str) -> None:
    words = shown_run(scene, **IDLE[scene]).words
    assert "at rest" in words
    assert "Nothing acts" in words
    assert "converged" not in words
    assert "Nothing acts" not in shown_run(scene).words


def test_axes_of_a_body_at_rest_are_those_of_its_size() -> None:
    scene = shown_run("block", **IDLE["block"]).scene()
    bodies = deformed.draw(scene, None)
    assert bodies is not None
    assert bodies.bodies is not None
    box = bodies.bodies.box
    sides = box.left, box.right, box.low, box.high
    assert sides == pytest.approx((-0.002, 0.102, -0.002, 0.052))
    x = loop.draw(scene, None).x
    assert x is not None
    assert (x.label, x.unit, x.high) == ("Displacement of the top", "m", 1e-6)
