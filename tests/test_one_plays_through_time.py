"""Time is played from the chosen instant to the end, until one stops it or chooses another."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from clock import Clock
from lone_link import lone_session

from app.shell import transport as module
from app.shell.transport import PLAYED_IN, Transport
from solver.scenes.bar import BarSettings


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: made.now))
    return made


@pytest.fixture
def transport(clock: Clock) -> Transport:
    session = lone_session(BarSettings.checked({"instants": 11, "load": "triangle"}), clock)
    session.watch(phase=0.4)
    return Transport(session)


def phase(transport: Transport) -> float:
    return transport._session.look.phase


def test_it_goes_on_from_the_chosen_instant_to_the_end_and_then_begins_again(
    transport: Transport, clock: Clock
) -> None:
    transport.play()
    seen = []
    for _ in range(7):
        clock.pass_(PLAYED_IN / 10 if seen else 1e-3)
        seen.append(round(phase(transport), 3))
    assert seen == [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    assert not transport._instant.playing
    transport.play()
    clock.pass_(0.0)
    assert phase(transport) == 0.0


def test_another_press_stops_it(transport: Transport, clock: Clock) -> None:
    transport.play()
    clock.pass_(0.0)
    transport.play()
    clock.pass_(PLAYED_IN)
    assert phase(transport) == 0.4
    assert not transport._instant.playing


def test_who_chooses_an_instant_stops_it(transport: Transport, clock: Clock) -> None:
    transport.play()
    transport.move_instant(1)
    clock.pass_(PLAYED_IN)
    assert phase(transport) == 0.5


def test_steps_through_time_end_at_both_ends(transport: Transport) -> None:
    for by, end in ((20, 1.0), (-20, 0.0)):
        transport.move_instant(by)
        assert phase(transport) == end
