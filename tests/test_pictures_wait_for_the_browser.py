"""No picture is sent faster than the browser paints."""

from __future__ import annotations

import pytest

from app import painter
from app.painter import Painter
from app.pulse import Pulse


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(painter.time, "monotonic", lambda: now[0])
    return now


@pytest.fixture
def pulse() -> Pulse:
    return Pulse()


@pytest.fixture
def made(pulse: Pulse, clock: list[float]) -> Painter:
    found = Painter(pulse)
    found.mark()
    return found


def test_a_picture_waits_until_the_last_is_painted(made: Painter, pulse: Pulse) -> None:
    assert made.is_due()
    made.send()
    made.mark()
    assert not made.is_due()
    pulse.painted = 1
    assert made.is_due()


def test_the_browser_has_a_fifth_of_the_time_that_it_painted_to_itself(
    made: Painter, clock: list[float], pulse: Pulse
) -> None:
    made.send()
    made.mark()
    clock[0] += 0.1
    pulse.painted = 1
    clock[0] += 0.019
    assert not made.is_due()
    clock[0] += 0.002
    assert made.is_due()


def test_a_picture_that_was_lost_holds_nothing_up_for_long(
    made: Painter, clock: list[float]
) -> None:
    made.send()
    made.mark()
    clock[0] += painter.LOST_AFTER + 0.1
    assert made.is_due()


def test_nothing_new_is_not_sent(made: Painter, pulse: Pulse) -> None:
    made.send()
    pulse.painted = 1
    assert not made.is_due()
