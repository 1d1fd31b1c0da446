"""A run that broke, ended, waits to be agreed to or lost its process is started again, once."""

from __future__ import annotations

from dataclasses import replace

import pytest
from clock import Clock
from lone_link import LoneLink
from unpacking import unpack

from app.session.page_worker import GIVEN_UP, RESTARTS
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import LEFT_ALONE, Session
from app.shell.transport import Transport
from app.wire.orders import Run, Seek, Step
from app.wire.reports import Died, Facts, Picture, Report
from app.worker.words import REPLAYED
from solver.scenes.bar import BarSettings

BROKEN: list[list[Report]] = [
    [Picture(1, Facts(is_broken=True), b"")],
    [Died()] * (RESTARTS + 1),
]


@pytest.fixture
def lone() -> LoneLink:
    return LoneLink()


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def session(lone: LoneLink, clock: Clock) -> Session:
    settings = BarSettings.checked({"method": "paper"})
    made = Session(Pages(1), ReportExecutor(), settings, lone.hire, clock)
    made.start()
    return made


@pytest.mark.parametrize("reports", BROKEN)
def test_the_button_starts_a_broken_run_again(
    session: Session, lone: LoneLink, reports: list[Report]
) -> None:
    transport = Transport(session)
    assert transport._run.label == "Pause"
    hear(session, lone, reports)
    assert transport._run.label == "Run"
    transport.toggle()
    assert runs(lone)[-1].ticket == 2
    assert runs(lone)[-1].pause_after is None
    assert transport._run.label == "Pause"


def test_a_run_that_has_to_be_agreed_to_begins_by_the_button_alone(
    session: Session, lone: LoneLink
) -> None:
    transport = Transport(session)
    asks: list[Report] = [Picture(1, Facts(is_broken=True, asks=True), b"")]
    hear(session, lone, asks)
    assert transport._run.label == "Run anyway"
    assert "however long" in transport._run.description
    assert len(runs(lone)) == 1
    transport.toggle()
    assert [run.is_agreed for run in runs(lone)] == [False, True]
    hear(session, lone, [Died()])
    assert runs(lone)[-1].is_agreed
    hear(session, lone, [Picture(2, Facts(), b"")])
    session.change("peak", 500.0)
    assert runs(lone)[-1].ticket == 3
    assert not runs(lone)[-1].is_agreed


@pytest.mark.parametrize("reports", BROKEN)
def test_a_step_starts_a_broken_run_again_and_waits(
    session: Session, lone: LoneLink, reports: list[Report]
) -> None:
    session.step()
    assert isinstance(lone.orders[-1], Step)
    hear(session, lone, reports)
    session.step()
    assert runs(lone)[-1].pause_after == 1


ENDED = Picture(1, Facts(iteration=4, done=4, is_over=True), b"")


def test_the_button_replays_a_run_that_has_ended(session: Session, lone: LoneLink) -> None:
    transport = Transport(session)
    hear(session, lone, [ENDED])
    assert transport._run.label == "Replay"
    transport.toggle()
    assert (runs(lone)[-1].ticket, runs(lone)[-1].pause_after) == (2, None)
    assert runs(lone)[-1].notice == REPLAYED
    assert transport._run.label == "Pause"


def test_a_step_shows_what_a_run_that_has_ended_did_next_or_begins_it_anew(
    session: Session, lone: LoneLink
) -> None:
    transport = Transport(session)
    hear(session, lone, [replace(ENDED, facts=replace(ENDED.facts, iteration=2))])
    transport.keys()["s"]()
    assert lone.orders[-1] == Seek(1, 3)
    hear(session, lone, [ENDED])
    transport.keys()["s"]()
    assert (runs(lone)[-1].ticket, runs(lone)[-1].pause_after) == (2, 1)
    assert runs(lone)[-1].notice == REPLAYED


def hear(session: Session, lone: LoneLink, reports: list[Report]) -> None:
    for report in reports:
        lone.say(report)
        session.collect()


def test_a_run_whose_process_died_is_started_again_with_what_holds(
    session: Session, lone: LoneLink
) -> None:
    session.set_pace(7.0)
    hear(session, lone, [Died()])
    assert session.goes_on
    again = runs(lone)[-1]
    assert "started again" in again.notice
    assert (again.ticket, again.pace, again.pause_after) == (session.ticket, 7.0, None)
    assert lone.hired == 2
    session.pause()
    hear(session, lone, [Died()])
    assert runs(lone)[-1].pause_after == 1


def test_what_a_process_said_before_it_died_is_not_heard_of_the_next(
    session: Session, lone: LoneLink
) -> None:
    late = lone.say
    hear(session, lone, [Died()])
    late(Picture(1, Facts(is_broken=True), b""))
    assert session.collect() == []
    assert session.goes_on


def test_a_page_left_alone_gives_its_process_back_and_gets_another(
    session: Session, lone: LoneLink, clock: Clock
) -> None:
    session.rest(True)
    clock.pass_(LEFT_ALONE - 1.0)
    assert not lone.is_closed
    assert not session.is_at_work
    clock.pass_(1.0)
    assert lone.is_closed
    session.rest(False)
    assert (lone.hired, session.is_at_work) == (2, True)
    assert len(runs(lone)) == 2


def runs(lone: LoneLink) -> list[Run]:
    return [order for order in lone.orders if isinstance(order, Run)]


def test_a_death_is_told_and_a_run_that_is_given_up_does_not_run(
    session: Session, lone: LoneLink
) -> None:
    words = []
    for _ in range(RESTARTS + 1):
        lone.say(Died())
        (block,) = session.collect()
        words.append(unpack(block)["status"]["text"])
    assert all("started again" in one for one in words[:-1])
    assert GIVEN_UP in words[-1]
    assert not session.goes_on
