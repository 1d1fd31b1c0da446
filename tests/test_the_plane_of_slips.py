"""The plane of slips draws two points between the lines at which they slip."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from shown_pages import Shown, keys

from app.views.catalogue import fitting
from app.views.interface import slip_plane
from app.views.scene import Scene
from solver.scenes import CATALOGUE

LESSON = Path(__file__).parents[1] / "app/lessons/two-points.toml"
GIVEN = tomllib.loads(LESSON.read_text(encoding="utf-8"))["settings"]
FREE = "free in the last cycle"


def looked_at(**changes: Any) -> Scene:
    shown = Shown()
    shown.run(1, "block", {**GIVEN, "finish": "at-once", **changes})
    return shown.scene()


def test_the_place_is_between_the_lines_that_are_drawn_and_they_are_where_it_slips() -> None:
    scene = looked_at()
    found, instant = scene.frame.slips, scene.instant
    assert found is not None
    drawing = slip_plane.draw(scene, None)
    assert [float(one) for one in (drawing.marks[0].x[0], drawing.marks[0].y[0])] == pytest.approx(
        found.slip[:, instant].tolist()
    )
    slack = 1e-5 * np.abs(found.limit).max()
    assert np.all(found.matrix @ found.slip <= found.limit + slack)
    slips = np.abs(np.diff(found.slip, axis=1)) > 1e-9
    held = found.matrix @ found.slip < found.limit - slack
    assert not np.any(slips & held[:2, 1:] & held[2:, 1:])
    lines = [one for one in drawing.curves if one.color in slip_plane.COLORS]
    for point, line in enumerate(lines):
        both = np.array([line.x, line.y])
        for row, part in ((point, both[:, :2]), (point + 2, both[:, 3:5])):
            on = np.full(2, found.limit[row, instant])
            np.testing.assert_allclose(found.matrix[row] @ part, on, atol=1e-6 * found.limit.max())


def test_a_field_is_drawn_where_one_is_left() -> None:
    kept = slip_plane.draw(looked_at(), None)
    assert FREE in keys(kept)
    gone = slip_plane.draw(
        looked_at(top_tangential_load="cycles", top_tangential_displacement=4.6e-5), None
    )
    assert FREE not in keys(gone)
    assert kept.sentence != gone.sentence
    none = slip_plane.draw(looked_at(top_tangential_load="hold"), None)
    assert FREE not in keys(none)


def test_it_applies_where_two_points_rub_by_coulombs_law() -> None:
    block = CATALOGUE["block"].settings
    for changes, applies in (
        ({}, True),
        ({"elements": 2}, False),
        ({"friction_law": "compliant"}, False),
    ):
        views = fitting(block.checked({**GIVEN, **changes}))
        assert (slip_plane.VIEW in views) == applies


def test_without_lines_there_are_empty_axes() -> None:
    """A block that contact alone holds: its place is no function of slip."""
    pressed = {"top": "traction", "top_normal_load": ((0.0, 0.0), (2.0, -1e6), (8.0, -1e6))}
    drawing = slip_plane.draw(looked_at(**pressed, top_tangential_load="hold"), None)
    assert not drawing.curves
    assert drawing.sentence == slip_plane.ALONE
