"""A sentence says what a scene is: what lies where, what rubs, and what is done to it."""

from __future__ import annotations

import colorsys
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shown_pages import SMALL
from test_views_say_what_they_draw import looked_at

from app.views.bodies import picture
from app.views.catalogue import VIEWS
from app.views.drawing.colors import BACKWARD, FORWARD, SLIP
from app.views.drawing.legend import card_title
from app.worker.telling import told
from solver.scenes import CATALOGUE, words_of
from solver.scenes.words import acting, counted

LONGEST = 140
"""Letters that a line has room for across a page of 1280 pixels, beside its controls."""


def words(scene: str, changes: dict[str, Any]) -> str:
    return words_of(CATALOGUE[scene].settings.checked(changes))


@pytest.mark.parametrize(
    ("scene", "changes", "said"),
    [
        ("bar", {}, "A steel bar lies on a rough table, held at its left end; "),
        ("bar", {}, "its right end is pulled to and fro."),
        ("bar", {"peak": -900.0, "load": "hold"}, "its right end is pushed."),
        ("bar", {"peak": 0.0}, "its right end is not pulled."),
        ("bar", {"friction": 0.0}, "a smooth table"),
        ("bar", {"pressure_profile": "gap"}, "a partly rough table"),
        ("bar", {"support_displacement": 1e-4}, "its left end is moved to and fro"),
        ("strand", {}, "Three steel wires, number 2 broken, rub on each other; "),
        ("strand", {"broken": 0, "wires": 20}, "20 steel wires rub on each other"),
        ("strand", {"load": "triangle"}, "pulled and let go."),
        ("block", {}, "a round rough support; it is pressed and moved to and fro at its top"),
        ("block", {"gap": "flat", "left": "clamped"}, "a flat rough support"),
        ("incline", {}, "a rough slope that rises and falls; a spring catches it"),
        ("fault", {}, "A fluid is let in at the left end of a sheared fault, and slip spreads"),
        ("fault", {"injection_load": "stopped"}, "A fluid is let in and stopped"),
        ("layers", {}, "Four steel layers, held at the left, are pressed together and rub; "),
        ("layers", {"layers": 2, "pull": 1e6}, "bent up and down, and pulled."),
    ],
)
def test_a_scene_says_what_it_is(scene: str, changes: dict[str, Any], said: str) -> None:
    assert said in words(scene, changes)


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_by_default_it_is_one_line_and_the_picture_and_who_does_not_see_it_have_the_same(
    scene: str,
) -> None:
    assert len(f"{words(scene, {})} {SLIP}") <= LONGEST
    drawing = picture.draw(looked_at(scene), None)
    assert drawing.sentence == f"{words(scene, SMALL[scene])} {SLIP}"
    view = next(one for one in VIEWS if one.draw is picture.draw)
    assert told(view, drawing).startswith(drawing.sentence)
    assert drawing.sentence in card_title(view.name, drawing.keys, drawing.sentence)


@given(st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=30))
def test_what_is_done_is_done_by_a_load_of_that_sign(path: list[float]) -> None:
    said = acting(np.array(path), "pulled", "pushed")
    assert ("to and fro" in said) == (min(path) < 0.0 < max(path))
    assert ("pushed" in said) == (min(path) < 0.0 >= max(path))
    assert said.startswith("not") == (not any(path))


def test_few_are_counted_in_words() -> None:
    assert counted(2, "{} wires") == "two wires"
    assert counted(20, "{} wires") == "20 wires"


def test_colours_are_called_what_they_are() -> None:
    """Blue is around 200 to 220 degrees, orange around 30 to 45."""
    for color, low, high, name in ((BACKWARD, 195, 225, "Blue"), (FORWARD, 25, 45, "orange")):
        red, green, blue = (int(color[at : at + 2], 16) / 255 for at in (1, 3, 5))
        assert low <= 360 * colorsys.rgb_to_hsv(red, green, blue)[0] <= high
        assert name in SLIP
