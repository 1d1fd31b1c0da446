"""Iterations come at the chosen pace; a search lasts as long whatever its count."""

from __future__ import annotations

import pytest

from app.messages import WHOLE
from app.worker import runner
from app.worker.runner import Pacing


class Watch:
    """A clock that stands still unless a test moves it."""

    def __init__(self) -> None:
        self.now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def watch(monkeypatch: pytest.MonkeyPatch) -> Watch:
    made = Watch()
    monkeypatch.setattr(runner, "time", made)
    return made


def played(watch: Watch, pace: float, count: int, takes: float = 0.0) -> list[float]:
    """Times at which a number of iterations of a given length begin."""
    times = []
    paced = Pacing(pace)
    for done in range(1, count + 1):
        rest = paced.rest()
        assert rest is not None
        watch.now += rest
        times.append(watch.now)
        paced.count(done)
        watch.now += takes
    return times


@pytest.mark.parametrize("count", [30, 100, 1000])
def test_a_whole_search_lasts_three_seconds_however_many_iterations_it_takes(
    watch: Watch, count: int
) -> None:
    times = played(watch, WHOLE, count)
    first = 1.0 - 0.25 / 3.0
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(3.0 * (first - first**count))


def test_a_slow_search_takes_what_its_iterations_take(watch: Watch) -> None:
    times = played(watch, WHOLE, 100, takes=0.5)
    assert times[-1] - times[-51] == pytest.approx(25.0)
