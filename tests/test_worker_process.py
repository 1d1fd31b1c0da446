"""A worker computes what `solve` computes, obeys orders between iterations, and outlives errors."""

from __future__ import annotations

import math
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.worker import member, run
from app.worker.checkpoints import Checkpoints
from app.worker.orders import Leave, Look, Order, Pace, Park, Run, Seek, Step, Watch
from app.worker.reports import (
    Begun,
    End,
    Frame,
    Parked,
    Progress,
    Ready,
    Reference,
    Refused,
    Report,
    Taken,
    Waiting,
)
from app.worker.rivals import References
from app.worker.run import WorkerRun
from app.worker.sampler import Sampler
from solver import latin
from solver.discrete import discretise
from solver.latin import Checkpoint, Ending, Iterate, Record, Solution, iterations, record, solve
from solver.latin.warm import choose_start
from solver.reference.closed_form import closed_form
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes.bar import BarSettings, bar

PATIENCE = 60.0
SHORT = {"tolerance": 1e-8, "max_iterations": 50}
STALLING = {"tolerance": 1e-30, "elements": 20, "substructures": 4}


class Line:
    """A worker process and all that it has said."""

    def __init__(self) -> None:
        self.process, self.connection = member.start()
        self.reports: list[Report] = []
        assert isinstance(self.connection.recv(), Ready)

    def send(self, *orders: Order) -> None:
        for order in orders:
            self.connection.send(order)

    def until(self, *kinds: type, ticket: int = 1) -> Any:
        """Listen until a report of one of these kinds comes."""
        end = time.monotonic() + PATIENCE
        while self.connection.poll(max(end - time.monotonic(), 0.0)):
            report: Any = self.connection.recv()
            self.reports.append(report)
            if report.ticket == ticket and isinstance(report, kinds):
                return report
        pytest.fail(f"no report of kind {kinds}")

    def all(self, kind: type, ticket: int = 1) -> list[Any]:
        said: list[Any] = [report for report in self.reports if isinstance(report, kind)]
        return [report for report in said if report.ticket == ticket]

    def records(self, ticket: int = 1) -> list[Record]:
        return [record for part in self.all(Progress, ticket) for record in part.records]


@pytest.fixture
def lines() -> Iterator[list[Line]]:
    opened = [Line(), Line()]
    yield opened
    for line in opened:
        line.process.kill()
        line.process.join()
        line.connection.close()


@pytest.fixture
def line(lines: list[Line]) -> Line:
    return lines[0]


def direct(values: dict[str, Any]) -> Solution:
    settings = BarSettings.checked(values)
    problem = discretise(settings)
    return solve(problem, settings, distance=distance_to(incremental(problem), problem))


def iterate_number(number: int, values: dict[str, Any]) -> Iterate:
    settings = BarSettings.checked(values)
    for iterate in iterations(discretise(settings), settings):
        if iterate.number == number:
            return iterate
    raise AssertionError


def timeless(records: list[Record]) -> list[Record]:
    return [replace(entry, seconds=0.0) for entry in records]


def shown(iterate: Iterate) -> Frame:
    sampler = Sampler(iterate.problem, BarSettings.checked({}), Look())
    return sampler.frame(1, iterate, frozenset(), Look())


def is_same_picture(frame: Frame, other: Frame) -> bool:
    return (
        frame.iteration == other.iteration
        and np.array_equal(frame.friction, other.friction)
        and np.array_equal(frame.status, other.status)
        and np.array_equal(frame.end_displacement, other.end_displacement)
    )


@pytest.mark.parametrize("values", [{}, STALLING, {"substructures": 1}])
def test_worker_gives_the_numbers_of_a_direct_solution(line: Line, values: dict[str, Any]) -> None:
    line.send(Run(1, "bar", values))
    end = line.until(End, Refused)
    line.until(Waiting)
    expected = direct(values)
    assert end == End(1, expected.status, expected.iterate.number)
    assert timeless(line.records()) == timeless(expected.records)
    assert is_same_picture(line.all(Frame)[-1], shown(expected.iterate))


def test_first_picture_comes_before_the_reference_and_every_record_after_it(line: Line) -> None:
    line.send(Run(1, "bar", SHORT))
    line.until(End)
    kinds = [type(report) for report in line.reports]
    assert kinds[:6] == [Taken, Begun, Frame, Begun, Reference, Progress]
    assert [begun.closed_form is not None for begun in line.all(Begun)] == [False, True]
    assert line.all(Frame)[0].iteration == 1
    assert [record.iteration for record in line.records()] == list(range(1, 51))
    assert not any(math.isnan(record.error_force) for record in line.records())


def test_run_that_ends_at_its_first_iteration_sends_its_record_and_its_end(line: Line) -> None:
    line.send(Run(1, "bar", {"peak": 0.0}))
    line.until(Waiting)
    assert [record.iteration for record in line.records()] == [1]
    assert [frame.iteration for frame in line.all(Frame)] == [1]
    assert line.all(End)[0].iteration == 1


def test_friction_is_sent_as_force_per_length_within_its_bound(line: Line) -> None:
    line.send(Run(1, "bar", {"elements": 3000, "instants": 31, "max_iterations": 2}))
    line.until(End)
    begun, reference = line.all(Begun)[0], line.all(Reference)[0]
    assert reference.friction.shape == (400, 31) == (len(begun.positions), len(begun.instants))
    assert np.all(np.abs(reference.friction) <= begun.bound[:, None] * (1.0 + 1e-6))
    assert np.abs(reference.friction).max() == pytest.approx(1500.0)
    assert begun.positions[[0, -1]] == pytest.approx([0.0, 1.0])


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


NEAR = {**STALLING, "friction": 0.3001}


def warm_records(number: int) -> list[Record]:
    """Give the records of NEAR, started from the end of STALLING, without the worker."""
    settings = BarSettings.checked(NEAR)
    problem = discretise(settings)
    distance = distance_to(incremental(problem), problem)
    start, run = choose_start(problem, settings, direct(STALLING).iterate)
    assert start.choice.is_previous
    return timeless([record(iterate, distance) for iterate in islice(run, number)])


def test_warm_run_starts_from_the_run_that_it_takes_the_place_of(line: Line) -> None:
    line.send(Run(1, "bar", STALLING))
    line.until(End)
    line.send(Run(2, "bar", NEAR, warm=True, after=1, pause_after=30))
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


@pytest.mark.parametrize("parked_at", [1, 2, 20])
def test_warm_run_is_parked_and_goes_on_to_the_bit(lines: list[Line], parked_at: int) -> None:
    first, second = lines
    first.send(Run(1, "bar", STALLING))
    first.until(End)
    first.send(Run(2, "bar", NEAR, warm=True, after=1, pause_after=parked_at))
    first.until(Waiting, ticket=2)
    first.send(Park(2))
    order = replace(first.until(Parked, ticket=2).order, pause_after=30)
    second.send(order)
    second.until(Waiting, ticket=2)
    records = first.records(2) + second.records(2)
    assert timeless(records) == warm_records(30)
    seconds = [entry.seconds for entry in records]
    assert seconds == sorted(seconds)
    assert second.all(Begun, ticket=2)[0].start.is_previous
    second.send(Seek(2, 1))
    second.until(Waiting, ticket=2)
    assert is_same_picture(second.all(Frame, ticket=2)[-1], first.all(Frame, ticket=2)[0])


def test_warm_run_starts_from_a_run_that_was_parked(lines: list[Line]) -> None:
    first, second = lines
    first.send(Run(1, "bar", STALLING))
    first.until(End)
    first.send(Park(1))
    parked = first.until(Parked).order
    second.send(Run(2, "bar", NEAR, warm=True, previous=parked, pause_after=30))
    second.until(Waiting, ticket=2)
    assert timeless(second.records(2)) == warm_records(30)


@pytest.mark.parametrize(
    "order",
    [Run(2, "bar", NEAR, after=1), Run(2, "bar", NEAR, warm=True, after=7)],
    ids=["not warm", "another session's"],
)
def test_run_starts_as_its_settings_say_otherwise(line: Line, order: Run) -> None:
    line.send(Run(1, "bar", STALLING))
    line.until(End)
    line.send(order)
    line.until(End, ticket=2)
    assert timeless(line.records(2)) == timeless(direct(NEAR).records)
    assert line.all(Begun, ticket=2)[0].start is None


def test_warm_run_that_is_replaced_at_once_hands_on_what_it_was_given(line: Line) -> None:
    line.send(Run(1, "bar", STALLING))
    line.until(End)
    line.send(
        Run(2, "bar", {**NEAR, "peak": 901.0}, warm=True, after=1),
        Run(3, "bar", NEAR, warm=True, after=2, pause_after=5),
    )
    line.until(Waiting, ticket=3)
    assert line.all(Begun, ticket=3)[0].start.is_previous


def test_full_stage_beside_a_warm_run_starts_where_that_does(line: Line) -> None:
    reduced = {**NEAR, "linear_stage": "pgd"}
    line.send(Run(1, "bar", STALLING))
    line.until(End)
    line.send(Run(2, "bar", reduced, warm=True, after=1, pause_after=5))
    line.until(Waiting, ticket=2)
    beside = [entry for part in line.all(Progress, ticket=2) for entry in part.beside]
    assert timeless(beside) == warm_records(5)


def test_every_record_comes_once_however_often_a_run_is_parked(lines: list[Line]) -> None:
    order: Run = Run(1, "bar", STALLING, pace=400.0)
    for turn in range(12):
        line = lines[turn % 2]
        line.send(order)
        line.until(Begun)
        time.sleep(0.02 * turn)
        line.send(Park(1))
        order = line.until(Parked).order
    lines[0].send(replace(order, pace=None))
    lines[0].until(End)
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


def test_newer_seek_takes_the_place_of_an_older(line: Line) -> None:
    line.send(Run(1, "bar", {"elements": 200, "instants": 201, "max_iterations": 40}))
    line.until(Waiting)
    line.send(Park(1))
    order = replace(line.until(Parked).order, ticket=2)
    line.send(order, Seek(2, 39), Seek(2, 3))
    line.until(Waiting, ticket=2)
    assert [frame.iteration for frame in line.all(Frame, ticket=2) if frame.sought] == [3]


def test_seek_does_not_move_the_run(line: Line) -> None:
    line.send(Run(1, "bar", STALLING, pace=200.0))
    for number in (1, 5, 2):
        line.until(Progress)
        line.send(Seek(1, number))
    line.send(Pace(1, None))
    line.until(End)
    assert timeless(line.records()) == timeless(direct(STALLING).records)


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
    line.send(Run(7, "bar", SHORT, pause_after=2), Pace(6, None), Step(6), Seek(6, 1), Park(6))
    assert line.until(Parked, ticket=6).order is None
    line.until(Waiting, ticket=7)
    assert len(line.records(7)) == 2


def test_long_reference_gives_way_to_a_new_run(line: Line) -> None:
    long = {"elements": 300, "instants": 4000, "load": "random"}
    line.send(Run(1, "bar", long))
    line.until(Frame)
    line.send(Run(2, "bar", SHORT))
    line.until(End, ticket=2)
    assert not line.all(Reference, ticket=1)


def test_reference_is_computed_once_for_the_same_physics(line: Line) -> None:
    line.send(Run(1, "bar", {"k_scale": 1.0}))
    line.until(End)
    line.send(Run(2, "bar", {"k_scale": 3.0, "substructures": 5}))
    line.until(End, ticket=2)
    line.send(Run(3, "bar", {"friction": 0.31}))
    line.until(End, ticket=3)
    first, second, third = (line.all(Reference, ticket)[0].seconds for ticket in (1, 2, 3))
    assert first == second != third


@pytest.mark.parametrize("busy", [False, True])
def test_process_ends_when_it_shall_leave_or_the_server_is_gone(
    lines: list[Line], busy: bool
) -> None:
    for line in lines:
        if busy:
            line.send(Run(1, "bar", SHORT, pace=50.0))
            line.until(Reference)
    lines[0].send(Leave())
    lines[1].connection.close()
    for line in lines:
        line.process.join(PATIENCE)
        assert line.process.exitcode == 0


def test_run_that_diverges_keeps_its_last_good_iterate(monkeypatch: pytest.MonkeyPatch) -> None:
    def record(iterate: Iterate, distance: Any) -> Record:
        entry = plain(iterate, distance)
        return replace(entry, indicator=math.nan) if iterate.number == 5 else entry

    plain = latin.record
    monkeypatch.setattr(run, "record", record)
    said: list[Any] = []
    work = WorkerRun(Run(1, "bar", SHORT), said.append, lambda: False, References())
    while work.rest() is not None:
        work.advance()
    (end,) = (report for report in said if isinstance(report, End))
    frames = [report for report in said if isinstance(report, Frame)]
    records = [entry for part in said if isinstance(part, Progress) for entry in part.records]
    assert (end.status.ending, end.iteration) == (Ending.DIVERGED, 4)
    assert frames[-1].iteration == 4
    assert [entry.iteration for entry in records] == [1, 2, 3, 4]


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


def test_begun_gives_bound_load_and_cuts_in_si(line: Line) -> None:
    path = {"load": [[0.0, 0.0], [2.0, 700.0]], "duration": 2.0, "instants": 11}
    rod = {"length": 2.0, "young": 1e9, "elements": 20, "substructures": 4}
    line.send(Run(1, "bar", {**path, **rod, "friction": 0.4, "friction_profile": "rising"}))
    line.until(End)
    begun = line.all(Begun)[0]
    assert begun.positions == pytest.approx(np.linspace(0.0, 2.0, 21))
    assert begun.cuts == pytest.approx([0.5, 1.0, 1.5])
    assert begun.load == pytest.approx(np.linspace(0.0, 700.0, 11))
    assert begun.all_instants == pytest.approx(np.linspace(0.0, 2.0, 11))
    factor = np.linspace(0.2, 1.8, 21)
    assert begun.bound == pytest.approx(0.4 * 5000.0 * factor)


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


def test_run_without_a_closed_form_sends_none(line: Line) -> None:
    line.send(Run(1, "bar", {**SHORT, "body_force": 100.0}))
    line.until(Reference)
    assert [begun.closed_form for begun in line.all(Begun)] == [None, None]


def test_worker_loads_no_part_of_the_page() -> None:
    script = (
        "import sys, app.worker.process\n"
        "page = {'panel', 'bokeh', 'holoviews', 'tornado', 'pandas', 'app.session'}\n"
        "print(*sorted(page & set(sys.modules)))"
    )
    root = Path(__file__).parents[1]
    found = subprocess.run(
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, check=True
    )
    assert found.stdout.split() == []
