"""A worker starts a run from the one before it where it is told to."""

from __future__ import annotations

from itertools import islice

from direct_runs import direct, timeless
from worker_line import STALLING, Line, is_same_picture, shown

from app.worker.orders import Run, Seek
from app.worker.reports import Begun, End, Frame, Progress, Waiting
from solver.discrete import discretise
from solver.latin import Record, StopRules, record
from solver.latin.warm import choose_start
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes.bar import BarSettings

NEAR = {**STALLING, "friction": 0.3001}


def warm_records(number: int) -> list[Record]:
    """Give the records of NEAR, started from the end of STALLING, without the worker."""
    settings = BarSettings.checked(NEAR)
    problem = discretise(settings)
    distance = distance_to(incremental(problem), problem)
    start, run = choose_start(problem, settings, direct(STALLING).iterate)
    assert start.choice.is_previous
    rules = StopRules(settings)
    found = (record(iterate, rules.judge(iterate), distance) for iterate in islice(run, number))
    return timeless(found)


def test_warm_run_starts_from_the_run_that_it_takes_the_place_of(line: Line) -> None:
    line.send(Run(1, "bar", STALLING))
    line.until(End)
    line.send(Run(2, "bar", NEAR, warm=True, pause_after=30))
    line.until(Waiting, ticket=2)
    assert timeless(line.records(2)) == warm_records(30)
    assert all(begun.start.is_previous for begun in line.all(Begun, ticket=2))
    for number in (1, 17):
        line.send(Seek(2, number))
        line.until(Waiting, ticket=2)
    settings = BarSettings.checked(NEAR)
    _, run = choose_start(discretise(settings), settings, direct(STALLING).iterate)
    iterates = list(islice(run, 17))
    sought = [frame for frame in line.all(Frame, ticket=2) if frame.sought]
    for frame, iterate in zip(sought, (iterates[0], iterates[16]), strict=True):
        assert is_same_picture(frame, shown(iterate))


def test_warm_run_that_is_replaced_at_once_hands_on_what_it_was_given(line: Line) -> None:
    line.send(Run(1, "bar", STALLING))
    line.until(End)
    line.send(
        Run(2, "bar", {**NEAR, "peak": 901.0}, warm=True),
        Run(3, "bar", NEAR, warm=True, pause_after=5),
    )
    line.until(Waiting, ticket=3)
    assert line.all(Begun, ticket=3)[0].start.is_previous


def test_run_starts_as_its_settings_say_otherwise(line: Line) -> None:
    line.send(Run(1, "bar", STALLING))
    line.until(End)
    line.send(Run(2, "bar", NEAR))
    line.until(End, ticket=2)
    assert timeless(line.records(2)) == timeless(direct(NEAR).records)
    assert line.all(Begun, ticket=2)[0].start is None


def test_a_first_run_that_may_be_warm_starts_as_its_settings_say(line: Line) -> None:
    line.send(Run(1, "bar", NEAR, warm=True))
    line.until(End)
    assert line.all(Begun)[0].start is None


def test_full_stage_beside_a_warm_run_starts_where_that_does(line: Line) -> None:
    reduced = {**NEAR, "linear_stage": "pgd"}
    line.send(Run(1, "bar", STALLING))
    line.until(End)
    line.send(Run(2, "bar", reduced, warm=True, pause_after=5))
    line.until(Waiting, ticket=2)
    beside = [entry for part in line.all(Progress, ticket=2) for entry in part.beside]
    assert timeless(beside) == warm_records(5)
