"""A control of every kind moves to an end and back in every scene; the page lives with it."""

from __future__ import annotations

import pytest
from page_tour import Tour
from pages import Visit
from tour import SIZES


@pytest.mark.parametrize("scene", list(SIZES))
def test_all_that_applies_has_a_control_and_one_of_each_kind_moves(
    open_page: Visit, scene: str
) -> None:
    tour = Tour(open_page, scene)
    tour.assert_there_is_a_control_for_all_that_applies()
    tour.go()
