"""Sessions share processes fairly, and a slow, a frozen or a dead one is hardly noticed."""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import queue
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.worker import post as posts
from app.worker import seat as seats
from app.worker.orders import Leave, Pace, Park, Run, Seek, Step, Watch
from app.worker.pool import Pool
from app.worker.reports import (
    Begun,
    Died,
    End,
    Frame,
    Parked,
    Progress,
    Ready,
    Reference,
    Refused,
    Report,
    Taken,
    Unrivalled,
    Waiting,
)
from app.worker.roster import Roster
from solver.discrete import discretise
from solver.latin import Record, solve
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes.bar import BarSettings

PATIENCE = 60.0
SOON = 2.0
SHORT = {"elements": 20, "substructures": 4, "tolerance": 1e-30, "max_iterations": 60}
ENDLESS = {"elements": 20, "substructures": 4, "tolerance": 1e-30, "max_iterations": 150}
SLOW_TO_SET_UP = {"elements": 5000, "instants": 2001, "substructures": 500}


class Session:
    """A seat and what its listener heard, with the time."""

    def __init__(self, pool: Pool) -> None:
        self.heard: queue.SimpleQueue[Report] = queue.SimpleQueue()
        self.reports: list[Report] = []
        self.times: dict[int, float] = {}
        self.seat = pool.seat(self._hear)

    def _hear(self, report: Report) -> None:
        if isinstance(report, Progress):
            self.times.update(
                dict.fromkeys((r.iteration for r in report.records), time.monotonic())
            )
        self.heard.put(report)

    def until(self, *kinds: type, ticket: int = 1, patience: float = PATIENCE) -> Any:
        """Listen until a report of one of these kinds comes."""
        end = time.monotonic() + patience
        while True:
            try:
                report = self.heard.get(timeout=max(end - time.monotonic(), 0.0))
            except queue.Empty:
                said = [type(report).__name__ for report in self.reports]
                pytest.fail(f"no report of kind {kinds} after {said}", pytrace=False)
            self.reports.append(report)
            if isinstance(report, kinds) and report.ticket == ticket:
                return report

    def records(self, ticket: int = 1) -> list[Record]:
        """Give the records since the process last died."""
        found: list[Record] = []
        for report in self.reports:
            if report.ticket == ticket and isinstance(report, Died):
                found.clear()
            elif report.ticket == ticket and isinstance(report, Progress):
                found.extend(replace(record, seconds=0.0) for record in report.records)
        return found

    @property
    def pid(self) -> int:
        assert self.seat.post is not None
        assert self.seat.post.member.pid is not None
        return self.seat.post.member.pid


@pytest.fixture
def pool() -> Iterator[Pool]:
    with contextlib.closing(Pool(2)) as opened:
        yield opened


@pytest.fixture
def session(pool: Pool) -> Session:
    return Session(pool)


def direct(values: dict[str, Any]) -> list[Record]:
    chosen = BarSettings.checked(values)
    problem = discretise(chosen)
    solution = solve(problem, chosen, distance=distance_to(incremental(problem), problem))
    return [replace(record, seconds=0.0) for record in solution.records]


def is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def wait_for(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_run_gives_the_numbers_of_a_direct_solution(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT))
    session.until(End)
    assert session.records() == direct(SHORT)


WARM = {**SHORT, "friction": 0.3001}


def test_warm_run_starts_from_the_run_of_its_seat_before(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT))
    session.until(End)
    session.seat.run(Run(2, "bar", WARM, warm=True))
    assert session.until(Begun, ticket=2).start.is_previous


def test_warm_run_starts_from_a_run_that_had_to_make_room() -> None:
    with contextlib.closing(Pool(1)) as narrow:
        session, other = Session(narrow), Session(narrow)
        session.seat.run(Run(1, "bar", SHORT))
        session.until(End)
        other.seat.run(Run(1, "bar", SHORT))
        other.until(End)
        wait_for(lambda: session.seat.post is None)
        session.seat.run(Run(2, "bar", WARM, warm=True))
        assert session.until(Begun, ticket=2).start.is_previous


def test_warm_run_without_a_run_before_starts_as_its_settings_say(
    pool: Pool, session: Session
) -> None:
    other = Session(pool)
    other.seat.run(Run(1, "bar", SHORT))
    other.until(End)
    session.seat.run(Run(1, "bar", SHORT, warm=True))
    session.until(End)
    assert session.records() == direct(SHORT)
    assert session.reports[0].start is None


def test_those_at_work_beside_a_seat_are_counted(pool: Pool, session: Session) -> None:
    other = Session(pool)
    assert session.seat.others_at_work == 0
    other.seat.run(Run(1, "bar", ENDLESS, pace=1.0))
    session.seat.run(Run(1, "bar", ENDLESS, pace=1.0))
    other.until(Progress)
    session.until(Progress)
    assert session.seat.others_at_work == 1
    other.seat.send(Pace(1, 0.0))
    wait_for(lambda: session.seat.others_at_work == 0)


def test_session_hears_nothing_of_the_pools_own_business(pool: Pool, session: Session) -> None:
    others = [Session(pool) for _ in range(3)]
    for each in (session, *others):
        each.seat.run(Run(1, "bar", SHORT, pause_after=3))
    for each in (session, *others):
        each.until(Progress)
        each.seat.send(Pace(1, None))
    for each in (session, *others):
        each.until(End)
        kinds = {type(report) for report in each.reports}
        assert kinds <= {Begun, Frame, Reference, Progress, End}


def test_only_the_last_of_many_runs_is_finished(session: Session) -> None:
    for ticket in range(1, 30):
        session.seat.run(Run(ticket, "bar", ENDLESS))
        time.sleep(0.003 * (ticket % 4))
    session.seat.run(Run(30, "bar", SHORT))
    session.until(End, ticket=30)
    assert [report.ticket for report in session.reports if isinstance(report, End)] == [30]
    assert session.records(30) == direct(SHORT)


def test_run_that_is_slow_to_set_up_does_not_hold_up_the_next(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT))
    session.until(End)
    session.seat.run(Run(2, "bar", SLOW_TO_SET_UP))
    time.sleep(0.05)
    session.seat.run(Run(3, "bar", SHORT))
    session.until(Frame, ticket=3, patience=SOON)
    assert not any(isinstance(report, Died) for report in session.reports)


def test_killed_worker_is_replaced_and_the_run_starts_again(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT, pace=200.0))
    session.until(Progress)
    time.sleep(0.1)
    os.kill(session.pid, signal.SIGKILL)
    died = session.until(Died)
    session.until(End)
    assert died.again
    assert "started again" in died.reason
    assert session.records() == direct(SHORT)


def test_run_whose_workers_keep_dying_is_given_up(session: Session) -> None:
    session.seat.run(Run(1, "bar", ENDLESS, pace=10.0))
    fates = []
    for _ in range(3):
        session.until(Progress)
        os.kill(session.pid, signal.SIGKILL)
        fates.append(session.until(Died).again)
    assert fates == [True, True, False]
    session.seat.run(Run(2, "bar", SHORT))
    session.until(End, ticket=2)


def test_paused_run_is_still_paused_after_its_worker_died(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT, pause_after=3))
    wait_for(lambda: session.seat.post is not None and session.seat.post.idle)
    session.seat.send(Step(1))
    while len(session.records()) < 4:
        session.until(Progress)
    os.kill(session.pid, signal.SIGKILL)
    session.until(Died)
    while len(session.records()) < 4:
        session.until(Progress)
    wait_for(lambda: session.seat.post is not None and session.seat.post.idle)
    assert [record.iteration for record in session.records()] == [1, 2, 3, 4]


def test_frozen_worker_is_replaced_when_a_new_run_is_ordered(session: Session) -> None:
    session.seat.run(Run(1, "bar", ENDLESS, pace=10.0))
    session.until(Progress)
    frozen = session.pid
    os.kill(frozen, signal.SIGSTOP)
    session.seat.run(Run(2, "bar", SHORT))
    session.seat.send(Watch(2, frozenset({"spectra"})))
    session.until(Frame, ticket=2, patience=SOON)
    session.until(End, ticket=2)
    assert not is_alive(frozen)
    assert not any(isinstance(report, Died) for report in session.reports)
    frames = [report for report in session.reports if isinstance(report, Frame)]
    assert frames[-1].spectra is not None


def test_eight_sessions_on_two_processes_progress_together(pool: Pool) -> None:
    sessions = [Session(pool) for _ in range(8)]
    for each in sessions:
        each.seat.run(Run(1, "bar", SHORT, pace=60.0))
    for each in sessions:
        each.until(End)
    assert all(each.records() == direct(SHORT) for each in sessions)
    assert max(each.times[1] for each in sessions) < min(each.times[60] for each in sessions)
    assert len(pool.pids) <= 3


def test_pace_slower_than_the_turns_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(posts, "QUANTUM", 0.05)
    with contextlib.closing(Pool(1)) as pool:
        sessions = [Session(pool) for _ in range(3)]
        for each in sessions:
            each.seat.run(Run(1, "bar", SHORT, pace=4.0))
        for each in sessions:
            while len(each.records()) < 4:
                each.until(Progress)
            assert each.times[4] - each.times[1] > 0.6


def test_waiting_run_makes_room_and_still_answers(pool: Pool) -> None:
    sessions = [Session(pool) for _ in range(5)]
    for each in sessions:
        each.seat.run(Run(1, "bar", SHORT, pause_after=10))
    for each in sessions:
        while len(each.records()) < 10:
            each.until(Progress)
    for each in sessions:
        each.seat.send(Seek(1, 4))
        while not (frame := each.until(Frame)).sought:
            continue
        assert frame.iteration == 4
    for each in sessions:
        each.seat.send(Step(1))
        each.seat.send(Step(1))
    for each in sessions:
        while len(each.records()) < 12:
            each.until(Progress)
        each.seat.send(Pace(1, None))
    for each in sessions:
        each.until(End)
        assert each.records() == direct(SHORT)


def test_refused_run_frees_its_worker(pool: Pool) -> None:
    sessions = [Session(pool) for _ in range(5)]
    for each in sessions:
        each.seat.run(Run(1, "bar", {"elements": -1}))
    for each in sessions:
        assert "elements" in each.until(Refused).reason
        each.seat.run(Run(2, "bar", SHORT))
        each.until(End, ticket=2)


def test_closed_seat_frees_its_worker_and_is_silent(pool: Pool) -> None:
    first, second = Session(pool), Session(pool)
    for each in (first, second):
        each.seat.run(Run(1, "bar", ENDLESS, pace=10.0))
        each.until(Progress)
    first.seat.close()
    first.seat.close()
    time.sleep(0.1)
    heard = first.heard.qsize()
    first.seat.run(Run(2, "bar", SHORT))
    first.seat.send(Step(1))
    third = Session(pool)
    third.seat.run(Run(1, "bar", SHORT))
    third.until(End)
    assert first.heard.qsize() == heard
    assert first.seat.post is None


def test_listener_that_fails_harms_nobody(pool: Pool, caplog: pytest.LogCaptureFixture) -> None:
    def fail(report: Report) -> None:
        raise ValueError("a page with a fault")

    with caplog.at_level(logging.ERROR):
        pool.seat(fail).run(Run(1, "bar", SHORT))
        other = Session(pool)
        other.seat.run(Run(1, "bar", SHORT))
        other.until(End)
        wait_for(lambda: "A session failed to take a report." in caplog.messages)


@pytest.mark.parametrize("frozen", [False, True])
def test_closed_pool_leaves_no_process(frozen: bool) -> None:
    pool = Pool(2)
    sessions = [Session(pool) for _ in range(4)]
    for each in sessions:
        each.seat.run(Run(1, "bar", ENDLESS, pace=10.0))
    sessions[0].until(Progress)
    sessions[3].seat.close()
    pids = pool.pids
    if frozen:
        os.kill(sessions[0].pid, signal.SIGSTOP)
    pool.close()
    pool.close()
    sessions[1].seat.run(Run(2, "bar", SHORT))
    sessions[1].seat.close()
    assert len(pids) >= 2
    assert not any(is_alive(pid) for pid in pids)
    assert not multiprocessing.active_children()
    assert not pool.pids


SERVER = """
import sys, time
from app.worker.pool import shared_pool
from app.worker.orders import Run
from app.worker.reports import Frame

pool, seen = shared_pool(), set()
for number in range(2):
    seat = pool.seat(lambda report, number=number: seen.add(number))
    seat.run(Run(1, "bar", {"tolerance": 1e-30, "instants": 401}, pace=[2.0, None][number]))
while len(seen) < 2:
    time.sleep(0.01)
print(*pool.pids, flush=True)
sys.stdin.readline()
"""


@pytest.mark.parametrize("killed", [False, True])
def test_workers_end_with_their_server(killed: bool) -> None:
    root = Path(__file__).parents[1]
    server = subprocess.Popen(
        [sys.executable, "-c", SERVER],
        cwd=root,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with server:
        assert server.stdout is not None
        pids = [int(word) for word in server.stdout.readline().split()]
        assert len(pids) >= 2
        assert all(map(is_alive, pids))
        if killed:
            server.kill()
        _, noise = server.communicate(timeout=PATIENCE)
    assert not noise
    assert server.returncode == (-signal.SIGKILL if killed else 0)
    wait_for(lambda: not any(map(is_alive, pids)))


class Actor:
    """Stands for a worker process, and answers only when it is made to."""

    def __init__(self) -> None:
        self.orders: list[Any] = []
        self.run: Run | None = None
        self.killed = False

    def send(self, order: Any) -> None:
        assert not self.killed
        self.orders.append(order)

    def kill(self) -> None:
        self.killed = True

    def answers(self) -> Any:
        """Read the next order and give the first answer that a worker would give, or None."""
        if not self.orders:
            return None
        match self.orders.pop(0):
            case Run() as order:
                self.run = order
                return Taken(order.ticket)
            case Park(ticket=ticket, keep=keep):
                return Parked(ticket, self.run if keep else None)
            case Leave() | Pace() | Step() | Seek() | Watch():
                return None


class Stage:
    """A roster of actors under a clock that is set by hand."""

    def __init__(self, size: int) -> None:
        self.now = 0.0
        self.actors: list[Actor] = []
        self.roster = Roster(size, self._hire, lambda: self.now)

    def _hire(self) -> Any:
        self.actors.append(Actor())
        return self.actors[-1]

    def seat(self) -> seats.Seat:
        return seats.Seat(None, lambda report: None)  # type: ignore[arg-type]

    def report(self, actor: Any, report: Any) -> Any:
        found = self.roster.report(actor, report)
        self.roster.tend()
        return found

    def take(self, seat: seats.Seat) -> Any:
        """Let the process of a seat get ready and take its run."""
        assert seat.post is not None
        actor: Any = seat.post.member
        self.report(actor, Ready())
        self.report(actor, actor.answers())
        return actor

    def wait(self, seconds: float) -> None:
        self.now += seconds
        self.roster.tend()


def test_busy_process_has_fifty_milliseconds_to_take_a_new_run_and_orders_do_not_add_to_it() -> (
    None
):
    stage, ticket = Stage(1), 1
    seat = stage.seat()
    stage.roster.run(seat, Run(ticket, "bar", {}))
    stage.roster.tend()
    busy = stage.take(seat)
    for ticket in range(2, 7):
        stage.roster.run(seat, Run(ticket, "bar", {}))
        stage.wait(0.009)
    assert not busy.killed
    stage.wait(0.009)
    assert busy.killed
    assert seat.post is not None
    assert seat.post.member is not busy
    assert stage.take(seat).killed is False
    assert seat.next is not None
    assert seat.next.ticket == 6


def test_turns_without_progress_get_longer() -> None:
    stage = Stage(1)
    pair = [stage.seat(), stage.seat()]
    for seat in pair:
        stage.roster.run(seat, Run(1, "bar", {}))
    stage.roster.tend()
    lengths = []
    for turn in range(6):
        seat = pair[turn % 2]
        actor, begun = stage.take(seat), stage.now
        while not actor.orders:
            stage.wait(0.01)
        lengths.append(round(stage.now - begun, 1))
        stage.report(actor, actor.answers())
    assert lengths == [0.5, 0.5, 1.0, 1.0, 2.0, 2.0]


def test_time_for_setting_up_is_not_taken_from_the_turn() -> None:
    stage = Stage(1)
    pair = [stage.seat(), stage.seat()]
    for seat in pair:
        stage.roster.run(seat, Run(1, "bar", {}))
    stage.roster.tend()
    actor, begun = stage.take(pair[0]), stage.now
    stage.wait(0.4)
    assert pair[0].post is not None
    turn = pair[0].post.turn
    stage.report(actor, Unrivalled(turn))
    while not actor.orders:
        stage.wait(0.01)
    assert stage.now - begun == pytest.approx(0.9, abs=0.02)


def test_processes_that_never_start_are_not_hired_forever() -> None:
    stage = Stage(2)
    seat = stage.seat()
    stage.roster.run(seat, Run(1, "bar", {}))
    stage.roster.tend()
    fates = []
    actor: Any
    for actor in stage.actors:
        delivery = stage.roster.gone(actor)
        if delivery is not None:
            fates.append(delivery[1].again)  # type: ignore[union-attr]
            stage.roster.go_on(seat)
        stage.roster.tend()
    assert fates == [True, True, False]
    assert len(stage.actors) <= 4


MOVES = st.lists(
    st.tuples(
        st.sampled_from(["run", "seek", "close", "answer", "wait", "die", "idle", "end", "refuse"]),
        st.integers(0, 4),
        st.sampled_from([0.001, 0.06, 0.6, 40.0]),
    ),
    max_size=80,
)


@settings(derandomize=True, deadline=None, max_examples=300)
@given(moves=MOVES)
def test_whatever_happens_no_run_is_lost_and_no_more_than_size_are_at_work(
    moves: list[tuple[str, int, float]],
) -> None:
    stage = Stage(2)
    five = [stage.seat() for _ in range(5)]
    for ticket, (move, number, seconds) in enumerate(moves, start=1):
        seat = five[number]
        post = seat.post
        actors = [actor for actor in stage.actors if not actor.killed]
        actor: Any = actors[number % len(actors)] if actors else None
        if move == "run":
            stage.roster.run(seat, Run(ticket, "bar", {}))
        elif move == "seek":
            stage.roster.send(seat, Seek(seat.ticket, 1))
        elif move == "close":
            stage.roster.leave(seat)
        elif move == "wait":
            stage.now += seconds
        elif move == "die" and actor:
            actor.killed = True
            delivery = stage.roster.gone(actor)
            if delivery:
                stage.roster.go_on(delivery[0])
        elif move == "answer" and actor:
            stage.roster.report(actor, Ready())
            if (answer := actor.answers()) is not None:
                stage.roster.report(actor, answer)
        elif move == "idle" and post and post.at_work:
            stage.roster.report(post.member, Waiting(post.turn))
        elif move == "refuse" and post and post.at_work:
            stage.roster.report(post.member, Refused(post.turn, ""))
        stage.roster.tend()
        check(stage, five)
    settle(stage, five)


def check(stage: Stage, five: list[seats.Seat]) -> None:
    """Check what always holds."""
    posts = list(stage.roster._posts.values())
    waiting = list(stage.roster._queue)
    assert sum(not post.free for post in posts) <= 2
    assert len(posts) <= 3
    assert len(waiting) == len(set(waiting))
    for seat in five:
        assert (seat.post is not None) + (seat in waiting) <= 1
        assert seat.post is None or (seat.post.seat is seat and seat.post in posts)
        if seat.next is None:
            assert seat.post is None
            assert seat not in waiting


def settle(stage: Stage, five: list[seats.Seat]) -> None:
    """Let all processes answer: then every run gets its turn, and every process can be free."""
    due = {seat for seat in five if seat in stage.roster._queue}
    for _ in range(200):
        for actor in [actor for actor in stage.actors if not actor.killed]:
            stage.report(actor, Ready())
            while (answer := actor.answers()) is not None:
                stage.report(actor, answer)
        due -= {seat for seat in five if seat.post is not None and seat.post.at_work}
        stage.wait(0.6)
    assert not due
    for seat in five:
        stage.roster.leave(seat)
    for actor in [actor for actor in stage.actors if not actor.killed]:
        while actor.orders:
            stage.report(actor, actor.answers())
    assert all(post.free for post in stage.roster._posts.values())
    assert not stage.roster._queue
