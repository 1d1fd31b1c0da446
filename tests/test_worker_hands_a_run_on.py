"""A run that is parked goes on in another process as if it had never moved."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from direct_runs import direct, timeless
from worker_line import SHORT, STALLING, Line, is_same_picture, shown

from app.worker.orders import Park, Run, Seek
from app.worker.reports import Begun, End, Frame, Parked, Reference, Waiting
from solver.reference.closed_form import closed_form
from solver.scenes.bar import BarSettings, bar


@pytest.mark.parametrize("parked_at", [1, 2, 37])
def test_parked_run_goes_on_in_another_process_to_the_bit(
    lines: list[Line], parked_at: int
) -> None:
    first, second = lines
    first.send(Run(1, "bar", STALLING, pause_after=parked_at))
    first.until(Waiting)
    first.send(Park(1))
    order = first.until(Parked).order
    assert order.waits
    second.send(replace(order, pause_after=None))
    second.until(End)
    expected = direct(STALLING)
    assert len(first.records()) == parked_at
    assert timeless(first.records() + second.records()) == timeless(expected.records)
    assert is_same_picture(second.all(Frame)[0], first.all(Frame)[-1])
    assert is_same_picture(second.all(Frame)[-1], shown(expected.iterate))


def test_every_record_comes_once_however_often_a_run_is_parked(lines: list[Line]) -> None:
    order: Run = Run(1, "bar", STALLING, pace=200.0)
    for turn in range(12):
        line = lines[turn % 2]
        line.send(order)
        line.until(Begun)
        time.sleep(0.01 * turn)
        line.send(Park(1))
        order = line.until(Parked).order
    lines[0].send(replace(order, pace=None))
    lines[0].until(Waiting)
    records = sorted(lines[0].records() + lines[1].records(), key=lambda entry: entry.iteration)
    assert timeless(records) == timeless(direct(STALLING).records)


def test_turn_that_is_cut_short_still_brings_an_iteration(lines: list[Line]) -> None:
    order: Run = Run(1, "bar", SHORT, pause_after=3)
    lines[0].send(order)
    lines[0].until(Waiting)
    lines[0].send(Park(1))
    order = replace(lines[0].until(Parked).order, pause_after=None)
    lines[1].send(order)
    lines[1].until(Reference)
    lines[1].send(Park(1))
    assert lines[1].until(Parked).order.resume.iteration >= 4
    assert lines[1].records()[0].iteration == 4


def test_parked_run_that_has_ended_only_answers(lines: list[Line]) -> None:
    lines[0].send(Run(1, "bar", SHORT))
    lines[0].until(Waiting)
    lines[0].send(Park(1))
    order = lines[0].until(Parked).order
    lines[1].send(order, Seek(1, 20))
    lines[1].until(Waiting)
    assert order.waits
    assert not lines[1].all(End)
    assert not lines[1].records()
    assert [frame.iteration for frame in lines[1].all(Frame)] == [50, 20]


@pytest.mark.parametrize("values", [{}, {"linear_stage": "pgd", "max_iterations": 20}], ids=str)
def test_parked_run_of_the_fast_method_shows_its_end_again(
    lines: list[Line], values: dict[str, Any]
) -> None:
    lines[0].send(Run(1, "bar", values))
    lines[0].until(Waiting)
    lines[0].send(Park(1))
    lines[1].send(lines[0].until(Parked).order)
    lines[1].until(Waiting)
    assert lines[0].all(End)
    assert is_same_picture(lines[1].all(Frame)[-1], lines[0].all(Frame)[-1])


def test_run_that_goes_on_never_takes_back_its_closed_form(lines: list[Line]) -> None:
    lines[0].send(Run(1, "bar", SHORT, pause_after=2))
    lines[0].until(Waiting)
    lines[0].send(Park(1))
    lines[1].send(lines[0].until(Parked).order)
    lines[1].until(Waiting)
    (resumed,) = lines[1].all(Begun)
    assert np.array_equal(resumed.closed_form, lines[0].all(Begun)[-1].closed_form)
    exact = closed_form(bar(BarSettings.checked(SHORT)))
    assert exact is not None
    assert resumed.closed_form_end == pytest.approx(exact.end_displacement, rel=1e-6)
