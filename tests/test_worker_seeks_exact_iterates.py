"""Any iterate of a run is shown again exactly, and the run does not move."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from direct_runs import direct, iterate_number, timeless
from worker_line import SHORT, STALLING, Line, is_same_picture, shown

from app.worker.checkpoints import Checkpoints
from app.worker.orders import Pace, Run, Seek
from app.worker.reports import End, Frame, Progress, Waiting
from app.worker.rivals import References
from app.worker.run import WorkerRun
from solver.latin import Checkpoint


@pytest.mark.parametrize("number", [1, 2, 30, 49])
def test_seek_shows_the_exact_iterate(line: Line, number: int) -> None:
    line.send(Run(1, "bar", SHORT))
    line.until(Waiting)
    before = len(line.all(Frame))
    line.send(Seek(1, number))
    line.until(Waiting)
    (frame,) = line.all(Frame)[before:]
    assert frame.sought
    assert is_same_picture(frame, shown(iterate_number(number, SHORT)))


@pytest.mark.parametrize(("wanted", "answer"), [(-5, 1), (0, 1), (10**9, 50)])
def test_seek_out_of_range_shows_the_nearest_iterate(line: Line, wanted: int, answer: int) -> None:
    line.send(Run(1, "bar", SHORT))
    line.until(Waiting)
    line.send(Seek(1, wanted))
    line.until(Waiting)
    assert line.all(Frame)[-1].sought
    assert line.all(Frame)[-1].iteration == answer


def test_newer_seek_takes_the_place_of_an_older() -> None:
    said: list[Any] = []
    run = WorkerRun(Run(1, "bar", SHORT), said.append, lambda: False, References())
    done(run)
    run.obey(Seek(1, 39))
    run.obey(Seek(1, 3))
    done(run)
    assert [one.iteration for one in said if isinstance(one, Frame) and one.sought] == [3]


def done(run: WorkerRun) -> None:
    while run.rest() is not None:
        run.advance()


def test_seek_does_not_move_the_run(line: Line) -> None:
    line.send(Run(1, "bar", STALLING, pace=200.0))
    for number in (1, 5, 2):
        line.until(Progress)
        line.send(Seek(1, number))
    line.send(Pace(1, None))
    line.until(End)
    assert timeless(line.records()) == timeless(direct(STALLING).records)


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
