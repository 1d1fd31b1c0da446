"""Every control of bar and strand moves to an end and back, and the page lives with it."""

from __future__ import annotations

import pytest
from page_tour import Tour
from pages import Visit


@pytest.mark.parametrize("scene", ["bar", "strand"])
def test_every_control_moves_and_errors_come_back(open_page: Visit, scene: str) -> None:
    tour = Tour(open_page, scene)
    tour.go()
    tour.assert_errors_are_small()
