"""A worker obeys orders between iterations, those of its own run alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worker_line import PATIENCE, SHORT, Line

from app.worker.orders import Pace, Run, Seek, Step, Watch
from app.worker.reports import End, Frame, Progress, Reference, Refused, Taken, Waiting
from solver.latin import Ending


def test_paused_run_does_one_iteration_a_step(line: Line) -> None:
    line.send(Run(1, "bar", SHORT, pause_after=5))
    line.until(Waiting)
    assert line.records()[-1].iteration == 5
    line.send(Step(1), Step(1), Step(1))
    while line.records()[-1].iteration < 8:
        line.until(Progress)
    line.until(Waiting)
    assert line.all(Frame)[-1].iteration == 8
    line.send(Pace(1, None))
    line.until(End)
    assert [record.iteration for record in line.records()] == list(range(1, 51))


def test_pace_zero_waits_after_the_first_iteration(line: Line) -> None:
    line.send(Run(1, "bar", SHORT, pace=0))
    line.until(Waiting)
    assert [record.iteration for record in line.records()] == [1]


def test_frames_carry_spectra_only_when_watched(line: Line) -> None:
    line.send(Run(1, "bar", {"elements": 52, "substructures": 10}, pause_after=3))
    line.until(Waiting)
    assert all(frame.spectra is None for frame in line.all(Frame))
    line.send(Watch(1, frozenset({"spectra"})))
    frame = line.until(Frame)
    assert frame.spectra.shape == (10, 7)
    assert np.isnan(frame.spectra[2:, 6:]).all()
    assert not np.isnan(frame.spectra[:, :6]).any()
    line.send(Watch(1, frozenset()))
    assert line.until(Frame).spectra is None


@pytest.mark.parametrize(
    ("scene", "values", "words"),
    [
        ("bar", {"elements": 0}, "elements = 0 is refused; allowed: a whole number from 1"),
        ("bar", {"friktion": 0.3}, "did you mean friction?"),
        ("bridge", {}, 'scene = "bridge" is refused; allowed: bar'),
        ("bar", None, "The run broke (AttributeError"),
    ],
)
def test_refused_settings_leave_the_process_alive(
    line: Line, scene: str, values: Any, words: str
) -> None:
    line.send(Run(1, scene, values))
    assert words in line.until(Refused).reason
    line.send(Run(2, "bar", SHORT))
    assert line.until(End, ticket=2).status.ending is Ending.EXHAUSTED


def test_new_run_takes_the_place_of_the_one_at_work(line: Line) -> None:
    line.send(Run(1, "bar", SHORT, pace=1.0))
    line.until(Reference)
    line.send(Run(2, "bar", SHORT))
    line.until(End, ticket=2)
    assert not line.all(End)
    assert len(line.records(2)) == 50


def test_orders_of_other_runs_are_ignored(line: Line) -> None:
    line.send(Run(7, "bar", SHORT, pause_after=2), Pace(6, None), Step(6), Seek(6, 1))
    line.until(Waiting, ticket=7)
    assert len(line.records(7)) == 2


def test_long_reference_gives_way_to_a_new_run(line: Line) -> None:
    long = {"elements": 300, "instants": 4000, "load": "random"}
    line.send(Run(1, "bar", long))
    line.until(Frame)
    line.send(Run(2, "bar", SHORT))
    line.until(End, ticket=2)
    assert not line.all(Reference, ticket=1)


def test_a_run_that_is_slow_to_set_up_gives_way_to_a_new_run(line: Line) -> None:
    line.send(Run(1, "bar", {"elements": 5000, "instants": 2001, "substructures": 500}))
    line.until(Taken)
    line.send(Run(2, "bar", SHORT))
    line.until(End, ticket=2)
    assert not line.all(Frame, ticket=1)


@pytest.mark.parametrize("busy", [False, True])
def test_process_ends_with_its_pipe_whatever_it_does(line: Line, busy: bool) -> None:
    if busy:
        line.send(Run(1, "bar", {"elements": 5000, "instants": 2001, "substructures": 500}))
        line.until(Taken)
    line.connection.close()
    line.process.join(PATIENCE)
    assert line.process.exitcode == 0
