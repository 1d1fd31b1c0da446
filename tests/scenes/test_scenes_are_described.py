"""A sentence says what a scene is:
what lies where, what rubs, and what is done to it.
"""

from __future__ import annotations

from typing import Any

import pytest

from solver.scenes import CATALOGUE
from solver.settings.definitions import title_of


def words(scene: str, changes: dict[str, Any]) -> str:
    return CATALOGUE[scene].checked(changes).sentence()


@pytest.mark.parametrize(
    ("scene", "changes", "said"),
    [
        ("bar", {}, "A steel bar lies on a rough table, held at its left end; "),
        ("bar", {}, "its right end is pulled to and fro."),
        ("bar", {"peak": -900.0, "load": "hold"}, "its right end is pushed."),
        ("wall", {"cap": "guided"}, "with a stiff cap, pressed from above, only touch"),
        ("wall", {"cap": "free", "pressure": 0.0}, "with a stiff cap, only touch"),
        ("bundle", {"arrangement": "heap", "rings": 1}, "One round wire lies on the"),
        ("bar", {"peak": 0.0}, "its right end is not pulled."),
        ("bar", {"friction": 0.0}, "a smooth table"),
        ("bar", {"pressure_profile": "gap"}, "a partly rough table"),
        ("bar", {"support_displacement": 1e-4}, "its left end is moved to and fro"),
        ("strand", {}, "3 steel wires, number 2 broken, rub on each other; "),
        ("strand", {"broken": 0, "wires": 20}, "20 steel wires rub on each other"),
        ("strand", {"load": "triangle"}, "pulled and let go."),
        (
            "block",
            {},
            "a round rough support; it is pressed and moved to and fro at its top",
        ),
        ("block", {"gap": "flat", "left": "clamped"}, "a flat rough support"),
        ("incline", {}, "a rough slope that rises and falls; a spring catches it"),
        (
            "fault",
            {},
            "A fluid is let in at the left end of a sheared fault, and slip spreads",
        ),
        ("fault", {"injection_load": "stopped"}, "A fluid is let in and stopped"),
        (
            "layers",
            {},
            "4 steel layers, held at the left, are pressed together and rub; ",
        ),
        ("layers", {"layers": 2, "pull": 1e6}, "bent up and down, and pulled."),
        ("layers", {"friction": 0.0}, "are pressed together and slide freely; "),
        ("layers", {"pressure_load": ((0.0, 0.0), (1.0, 0.0))}, "lie on each other; "),
        ("strand", {"friction": 0.0, "broken": 0}, "3 steel wires slide freely on "),
        ("bundle", {"press": 0.0}, "wires lie side by side on the ground, and rub on"),
        ("rope", {"tension": 0.0, "fall_off": 0.1}, "A strand of 37 wires is bent up"),
        ("incline", {"slope": 0.0}, "a rough slope that stays level; a spring"),
        ("belt", {}, "one end is pulled, and a force pulls at the other."),
        ("belt", {"pull": 0.0}, "both ends are pulled alike."),
        ("belt", {"pull": 0.0, "tail_force": 0.0}, "one end is not pulled, and"),
    ],
)
def test_a_scene_says_what_it_is(
    scene: str, changes: dict[str, Any], said: str
) -> None:
    assert said in words(scene, changes)


@pytest.mark.parametrize("scene", CATALOGUE)
def test_settings_of_a_scene_are_told_apart_by_their_titles(scene: str) -> None:
    titles = [title_of(each) for each in CATALOGUE[scene].definitions().values()]
    assert len(set(titles)) == len(titles)
