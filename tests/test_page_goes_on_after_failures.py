"""What broke or ended can be started again, and what cannot start says so."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from clock import Clock
from lone_link import LoneLink
from processes import PATIENCE, is_alive, wait_for
from shown_pages import Shown
from unpacking import unpack

from app.session.page_worker import GIVEN_UP, RESTARTS
from app.session.pages import Pages
from app.session.report_executor import STOPPED, ReportExecutor
from app.session.report_job import ReportJob
from app.session.session import LEFT_ALONE, Session
from app.shell.transport import Transport
from app.wire.orders import Run, Seek, Step
from app.wire.reports import Died, Facts, Picture, Report
from app.worker import link
from app.worker.link import Link
from app.worker.words import REPLAYED
from solver.running import calls
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


def no_fork_server(*arguments: Any, **options: Any) -> Any:
    raise EOFError


def test_a_job_whose_process_does_not_start_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calls, "start_process", no_fork_server)
    job = ReportJob(ReportExecutor())
    job.ask("any", print)
    await_end(job)
    assert job.notice == STOPPED


def await_end(job: ReportJob) -> None:
    end = time.monotonic() + PATIENCE
    while job.is_busy:
        assert time.monotonic() < end
        job.collect()
        time.sleep(0.01)


def test_a_job_that_breaks_says_so() -> None:
    job = ReportJob(ReportExecutor())
    job.ask("any", _refused)
    await_end(job)
    assert job.notice == "It broke (LookupError: made to break)."


def _refused(send: Any) -> Any:
    raise LookupError("made to break")


def test_a_job_that_cannot_be_sent_says_so() -> None:
    job = ReportJob(ReportExecutor())
    job.ask("any", lambda send: None)
    await_end(job)
    assert "It broke" in job.notice


@pytest.fixture
def session_at_work() -> Iterator[Session]:
    settings = BarSettings.checked({"method": "paper", "tolerance": 1e-30})
    with closing(Session(Pages(1), ReportExecutor(), settings)) as made:
        made.start()
        yield made


def until(session: Session, condition: Callable[[Facts], object]) -> None:
    """Be a page that paints at once, until its facts are so."""

    def is_so() -> bool:
        if session.collect():
            session.ask()
        return session.facts is not None and bool(condition(session.facts))

    wait_for(is_so)


def test_a_killed_process_is_replaced_and_the_run_goes_on(session_at_work: Session) -> None:
    session = session_at_work
    for _ in range(RESTARTS):
        until(session, lambda facts: facts.done > 2)
        before = session.worker.link
        assert before is not None
        assert before.pid is not None
        os.kill(before.pid, signal.SIGKILL)
        wait_for(lambda link=before: session.collect() and session.worker.link is not link)
    until(session, lambda facts: facts.done > 2)


def test_where_a_run_broke_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    shown = Shown()
    nothing: Any = None
    shown.obey(Run(1, nothing))
    assert "AttributeError" in shown.words
    assert "Traceback" in caplog.text
    assert "app/worker/run.py" in caplog.text


def test_a_worker_whose_process_does_not_start_counts_as_gone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(link, "start", no_fork_server)
    said: list[Report] = []
    hired = Link(said.append)
    hired.join(PATIENCE)
    assert said == [Died()]
    assert hired.pid is None


SERVER = """
import sys, time
from app.worker.link import Link
from app.wire.orders import Run
from app.wire.orders import Ready
from app.wire.reports import Picture
from solver.scenes.bar import BarSettings

settings = BarSettings.checked({"method": "paper", "tolerance": 1e-30, "instants": 401})
seen = set()
links = [Link(lambda report, number=number: seen.add((number, type(report)))) for number in (0, 1)]
for link, pace in zip(links, (2.0, None)):
    link.send(Ready())
    link.send(Run(1, settings, pace=pace))
while not {(0, Picture), (1, Picture)} <= seen:
    time.sleep(0.01)
print(*(link.pid for link in links), flush=True)
sys.stdin.readline()
"""


@pytest.mark.parametrize("killed", [False, True])
def test_workers_end_with_their_server(killed: bool) -> None:
    server = subprocess.Popen(
        [sys.executable, "-c", SERVER],
        cwd=Path(__file__).parents[1],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with server:
        assert server.stdout is not None
        pids = [int(word) for word in server.stdout.readline().split()]
        assert all(map(is_alive, pids))
        if killed:
            server.kill()
        _, noise = server.communicate(timeout=PATIENCE)
    assert not noise
    assert server.returncode == (-signal.SIGKILL if killed else 0)
    wait_for(lambda: not any(map(is_alive, pids)))
