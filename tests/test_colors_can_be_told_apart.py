"""Legends, lines and values in plots can be read in light and dark, and by the colour-blind."""

from __future__ import annotations

import numpy as np
import pytest
from test_views_say_what_they_draw import looked_at

from app.views.catalogue import fitting
from app.views.drawing.colors import BACKWARD, BLUE, GHOST, GREY, SKY

LIGHT, DARK = "#ffffff", "#121212"
"""What is behind plots, as the themes of the page have it."""
LEAST = 3.0
"""Contrast of what is no text (WCAG 2.2, 1.4.11)."""
EDGED = ("square", "front", "bare")
"""Marks that have an edge of grey, on which the test insists, or are none."""


def luminance(color: str) -> float:
    parts = np.array([int(color[place : place + 2], 16) for place in (1, 3, 5)]) / 255.0
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_contrast_is_that_of_the_guidelines() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)


@pytest.mark.parametrize("background", [LIGHT, DARK])
@pytest.mark.parametrize("scene", ["bar", "strand", "block", "layers", "incline", "rope", "fault"])
def test_every_line_and_mark_of_a_legend_stands_out_in_both_themes(
    scene: str, background: str
) -> None:
    shown = looked_at(scene, {"method": "paper"}, {"method": "paper", "friction": 0.4})
    drawings = {view.name: view.draw(shown, None) for view in fitting(shown.run.settings)}
    for drawing in filter(None, drawings.values()):
        lines = {key.color for key in drawing.keys if key.mark not in EDGED}
        lines |= {curve.color for curve in drawing.curves} | {GREY}
        assert {line for line in lines if contrast(line, background) < LEAST} <= {
            key.color for key in drawing.keys if key.mark in EDGED
        }
        assert all(curve.alpha == 1.0 for curve in drawing.curves if curve.color != GREY)


@pytest.mark.parametrize("scene", ["bar", "strand", "layers"])
def test_what_a_run_is_compared_with_is_not_blue_as_the_run_is(scene: str) -> None:
    shown = looked_at(scene, {"method": "paper"}, {"method": "paper", "friction": 0.4})
    ghosts = [
        key
        for view in fitting(shown.run.settings)
        if (drawing := view.draw(shown, None)) is not None
        for key in drawing.keys
        if key.text == shown.ghost_name and key.mark == "line"
    ]
    assert ghosts
    assert {key.color for key in ghosts} == {GHOST}
    assert not {BLUE, SKY, BACKWARD} & {GHOST}
