"""A control of every kind moves to an end and back; whatever applies in a scene has a control."""

from __future__ import annotations

from page_tour import Tour
from pages import Visit

from solver.scenes import CATALOGUE


def test_one_of_each_kind_moves_and_all_that_applies_in_any_scene_has_a_control(
    open_page: Visit,
) -> None:
    tour = Tour(open_page, "bar")
    tour.go()
    for scene in CATALOGUE.values():
        tour.assert_there_is_a_control_for_all_that_applies(scene)
