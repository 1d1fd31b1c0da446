"""Any iterate of a run is shown again exactly, and the run does not move."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from direct_runs import direct, iterate_number
from shown_pages import ALL, Shown
from test_worker_process import same
from worker_line import SHORT, STALLING

from app.picture.sampler import Frame, Sampler
from app.wire.orders import Pace, Seek
from app.worker.seeking import Checkpoints
from solver.latin import Checkpoint
from solver.scenes.bar import BarSettings


def expected(number: int, values: dict[str, Any]) -> Frame:
    iterate = iterate_number(number, values)
    sampler = Sampler(iterate.problem, BarSettings.checked(values), ALL)
    return sampler.frame(iterate, ALL)


@pytest.mark.parametrize("number", [1, 2, 30, 49])
def test_seek_shows_the_exact_iterate(number: int) -> None:
    shown = Shown()
    shown.run(1, "bar", SHORT)
    shown.obey(Seek(1, number))
    frame, other = shown.frame(), expected(number, SHORT)
    assert frame.iteration == shown.pictures[-1].facts.iteration == number
    assert np.array_equal(frame.fields.friction, other.fields.friction)
    assert np.array_equal(frame.fields.status, other.fields.status)
    assert f"showing iteration {number}" in shown.words


@pytest.mark.parametrize(("wanted", "answer"), [(-5, 1), (0, 1), (10**9, 50)])
def test_seek_out_of_range_shows_the_nearest_iterate(wanted: int, answer: int) -> None:
    shown = Shown()
    shown.run(1, "bar", SHORT)
    shown.obey(Seek(1, wanted))
    assert shown.pictures[-1].facts.iteration == answer


def test_newer_seek_takes_the_place_of_an_older() -> None:
    shown = Shown(is_quick=True)
    shown.run(1, "bar", SHORT)
    shown.obey(Seek(1, 39), Seek(1, 3))
    assert shown.pictures[-1].facts.iteration == 3
    assert 39 not in [picture.facts.iteration for picture in shown.pictures[-2:]]


def test_seek_does_not_move_the_run() -> None:
    shown = Shown()
    shown.run(1, "bar", STALLING, pause_after=20)
    for number in (1, 5, 2):
        shown.obey(Seek(1, number))
    shown.obey(Pace(1, None))
    assert same(shown.recording.history, direct(STALLING).records)


@pytest.mark.parametrize("budget", [0, 800, 8000, 10**9])
def test_recording_stays_within_its_memory_and_finds_the_nearest_checkpoint(budget: int) -> None:
    recording = Checkpoints(budget)
    for number in range(1, 1001):
        recording.keep(Checkpoint(number, 0.0, np.zeros((10, 10))))
    found = [recording.before(number) for number in range(1, 1002)]
    kept = {start.number for start in found if start}
    assert len(kept) * 800 <= budget
    assert len(kept) >= min(budget // 800 // 2, 1000)
    assert all(
        (start.number if start else 0) == max((n for n in kept if n < number), default=0)
        for number, start in enumerate(found, start=1)
    )
