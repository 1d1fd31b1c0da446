"""Iterations come at the pace that is chosen, and a search lasts as long whatever its count."""

from __future__ import annotations

import pytest

from app.wire.orders import WHOLE, Rate
from app.worker import tempo
from app.worker.tempo import LATE, Tempo


class Watch:
    """A clock that stands still unless a test moves it."""

    def __init__(self) -> None:
        self.now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def watch(monkeypatch: pytest.MonkeyPatch) -> Watch:
    made = Watch()
    monkeypatch.setattr(tempo, "time", made)
    return made


def played(watch: Watch, pace: Rate, count: int, takes: float = 0.0) -> list[float]:
    """Give when each of so many iterations begins, if each takes so long."""
    found, one = [], Tempo(pace, None)
    for done in range(1, count + 1):
        rest = one.rest(done)
        assert rest is not None
        watch.now += rest
        found.append(watch.now)
        one.count(done)
        watch.now += takes
    return found


@pytest.mark.parametrize("count", [30, 100, 1000])
def test_a_whole_search_lasts_three_seconds_however_many_iterations_it_takes(
    watch: Watch, count: int
) -> None:
    times = played(watch, WHOLE, count)
    assert times[0] == pytest.approx(0.25)
    assert times[-1] == pytest.approx(3.0 * (1.0 - (1.0 - 0.25 / 3.0) ** count))


def test_a_slow_search_takes_what_its_iterations_take(watch: Watch) -> None:
    times = played(watch, WHOLE, 100, takes=0.5)
    assert times[-1] - times[-51] == pytest.approx(25.0)


def test_iterations_catch_up_on_a_picture_and_on_no_more(watch: Watch) -> None:
    one = Tempo(20.0, None)
    for late, rest in ((0.08, 0.0), (5.0, 0.0)):
        watch.now += late
        assert one.rest(1) == rest
        one.count(1)
    assert one._due == pytest.approx(watch.now - LATE + 0.05)
