"""The name of a known number stands beside its flag, and off the curves of its plot."""

from __future__ import annotations

import numpy as np
import pytest

from app.views.flags import place_off

TEXT = np.array([80.0, 16.0])
ROOM = np.array([400.0, 160.0])
AT = 200.0


def box(place: object) -> np.ndarray:
    """Lower left and upper right corner of the name at a place, (2, 2), px."""
    shares = {"left": 0.0, "center": 0.5, "right": 1.0}
    left = place.x - shares[place.text_align] * TEXT[0]  # type: ignore[attr-defined]
    foot = 80.0 - place.y_offset  # type: ignore[attr-defined]
    if place.text_baseline == "top":  # type: ignore[attr-defined]
        foot -= TEXT[1]
    return np.array([[left, foot], [left + TEXT[0], foot + TEXT[1]]])


@pytest.mark.parametrize("slope", [0.0, 0.3, 1.0, 3.0, -0.3, -1.0])
def test_the_name_of_a_flag_on_a_line_lies_beside_the_line(slope: float) -> None:
    x = np.linspace(0.0, ROOM[0], 2)
    line = np.stack([x, 80.0 + slope * (x - AT)], axis=1)
    anchors = [(AT, "left"), (AT, "right"), (AT, "center")]
    low, high = box(place_off([line], anchors, 80.0, TEXT, ROOM))
    fine = np.linspace(0.0, ROOM[0], 2000)
    points = np.stack([fine, 80.0 + slope * (fine - AT)], axis=1)
    assert not np.any(np.all((points > low + 2.0) & (points < high - 2.0), axis=1))
    assert np.all(low >= 0.0)
    assert np.all(high <= ROOM)


def test_the_name_of_a_flag_stands_inside_its_plot() -> None:
    anchors = [(395.0, "left"), (395.0, "right")]
    _, high = box(place_off([], anchors, 80.0, TEXT, ROOM))
    assert high[0] <= ROOM[0]
