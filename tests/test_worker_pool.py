"""Sessions share processes fairly, and a slow one is hardly noticed."""

from __future__ import annotations

import contextlib
import logging
import time

import pytest
from direct_runs import direct, timeless
from pool_sessions import ENDLESS, SHORT, SOON, Session
from processes import wait_for

from app.worker import post as posts
from app.worker.orders import Pace, Run, Seek, Step
from app.worker.pool import Pool
from app.worker.reports import Begun, Died, End, Frame, Progress, Reference, Refused, Report

SLOW_TO_SET_UP = {"elements": 5000, "instants": 2001, "substructures": 500}


def test_run_gives_the_numbers_of_a_direct_solution(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT))
    session.until(End)
    assert session.records() == timeless(direct(SHORT).records)


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
    assert session.records() == timeless(direct(SHORT).records)
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
    assert session.records(30) == timeless(direct(SHORT).records)


def test_run_that_is_slow_to_set_up_does_not_hold_up_the_next(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT))
    session.until(End)
    session.seat.run(Run(2, "bar", SLOW_TO_SET_UP))
    time.sleep(0.05)
    session.seat.run(Run(3, "bar", SHORT))
    session.until(Frame, ticket=3, patience=SOON)
    assert not any(isinstance(report, Died) for report in session.reports)


def test_eight_sessions_on_two_processes_progress_together(pool: Pool) -> None:
    sessions = [Session(pool) for _ in range(8)]
    for each in sessions:
        each.seat.run(Run(1, "bar", SHORT, pace=60.0))
    for each in sessions:
        each.until(End)
    expected = timeless(direct(SHORT).records)
    assert all(each.records() == expected for each in sessions)
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
    expected = timeless(direct(SHORT).records)
    for each in sessions:
        each.until(End)
        assert each.records() == expected


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
