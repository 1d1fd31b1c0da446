"""A body on which nothing acts rests: the page says so, on axes of its own size."""

from __future__ import annotations

from typing import Any

import pytest
from test_views_say_what_they_draw import recorded

from app.views.deformed import Deformed
from app.views.drawing import Picture
from app.views.loop import Loop
from app.words import status_line
from solver.discrete import discretise
from solver.discrete.idle import nothing_acts
from solver.scenes import CATALOGUE

IDLE: dict[str, dict[str, Any]] = {
    "bar": {"peak": 0.0},
    "strand": {"peak": 0.0},
    "block": {"top": "traction"},
    "layers": {"pressure": 0.0, "deflection": 0.0},
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


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_the_status_line_says_that_nothing_acts_and_not_that_it_converged(scene: str) -> None:
    line = status_line(recorded(scene, 1, **IDLE[scene]), True, None)
    assert "at rest" in line
    assert "Nothing acts" in line
    assert "converged" not in line
    assert "Nothing acts" not in status_line(recorded(scene, 1), True, None)


def test_axes_of_a_body_at_rest_are_those_of_its_size() -> None:
    run = recorded("block", 1, watch=frozenset({"mesh"}), **IDLE["block"])
    picture = Picture(run, None, (), run.newest, 5)
    bodies = Deformed(lambda: None)
    bodies.draw(picture)
    assert bodies._box.data["edge"] == pytest.approx([-0.002, 0.102, -0.002, 0.052])
    loop = Loop()
    loop.draw(picture)
    assert loop.figure.xaxis[0].axis_label == "Displacement of the top (µm)"
    assert loop.figure.x_range.end == 1.0
