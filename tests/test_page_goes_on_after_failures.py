"""Processes that are killed, break or do not start: the page goes on, and says so."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from processes import PATIENCE, is_alive, wait_for
from shown_pages import Shown

from app.session.page_worker import RESTARTS
from app.session.pages import Pages
from app.session.report_executor import STOPPED, ReportExecutor
from app.session.report_job import ReportJob
from app.session.session import Session
from app.wire.orders import Run
from app.wire.reports import Died, Facts, Report
from app.worker import link
from app.worker.link import Link
from solver.running import calls
from solver.scenes.bar import BarSettings


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
