"""No view is sent faster than the browser paints, and every one has its turn."""

from __future__ import annotations

from typing import Any

import pytest

from app import painter
from app.painter import Painter
from app.pulse import Pulse

VIEWS: list[Any] = ["force", "map", "loop", "convergence", "values", "time"]


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(painter.time, "monotonic", lambda: now[0])
    return now


@pytest.fixture
def pulse() -> Pulse:
    return Pulse()


def drawn(made: Painter, ticket: int | None = 1) -> list[Any] | None:
    turn = made.turn(VIEWS, ticket)
    if turn is None:
        return None
    made.send()
    return list(turn.views)


def test_a_run_begins_with_one_view_and_the_others_follow_as_they_are_painted(
    clock: list[float], pulse: Pulse
) -> None:
    made = Painter(pulse)
    made.mark()
    assert drawn(made) == VIEWS[:1]
    assert drawn(made) is None
    pulse.painted = 1
    assert drawn(made) == VIEWS[1:4]
    pulse.painted = 2
    assert drawn(made) == VIEWS[4:]
    pulse.painted = 3
    assert drawn(made) is None


def test_the_browser_has_twice_the_time_that_it_painted_to_itself(
    clock: list[float], pulse: Pulse
) -> None:
    made = Painter(pulse)
    made.mark()
    drawn(made)
    clock[0] += 0.1
    pulse.painted = 1
    clock[0] += 0.19
    assert drawn(made) is None
    clock[0] += 0.02
    assert drawn(made) is not None


@pytest.mark.parametrize("count", [0, 1])
def test_the_rest_of_the_page_follows_the_first_picture_however_few_the_views(
    pulse: Pulse, clock: list[float], count: int
) -> None:
    made = Painter(pulse)
    made.mark()
    first = made.turn(VIEWS[:count], 1)
    assert first is not None
    assert first.is_first
    made.send()
    pulse.painted = 1
    rest = made.turn(VIEWS[:count], 1)
    assert rest is not None
    assert not rest.is_first
    assert list(rest.views) == []
    assert made.turn(VIEWS[:count], 1) is None


def test_the_first_picture_of_a_run_overtakes_what_is_on_its_way(
    clock: list[float], pulse: Pulse
) -> None:
    made = Painter(pulse)
    made.mark()
    drawn(made)
    made.mark()
    assert drawn(made) is None
    assert drawn(made, ticket=2) == VIEWS[:1]
    assert made.has_drawn(2)
    assert not made.has_drawn(1)


def test_a_picture_that_was_lost_holds_nothing_up_for_long(
    clock: list[float], pulse: Pulse
) -> None:
    made = Painter(pulse)
    made.mark()
    drawn(made)
    clock[0] += painter.LOST_AFTER + 0.1
    assert drawn(made) == VIEWS[1:4]


def test_nothing_new_is_not_sent(clock: list[float], pulse: Pulse) -> None:
    assert drawn(Painter(pulse)) is None


def test_before_there_is_anything_to_show_the_words_are_sent_with_the_views(
    clock: list[float], pulse: Pulse
) -> None:
    made = Painter(pulse)
    made.mark()
    turn = made.turn(VIEWS, None)
    assert turn is not None
    assert not turn.is_first
