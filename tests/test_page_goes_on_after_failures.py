"""What broke can be started again, and what cannot start says so."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest
from lone_seat import Seat

from app.errand import Errand
from app.session import Session
from app.transport import Transport
from app.words import status_line
from app.worker import job, member
from app.worker.bench import Bench
from app.worker.job import STOPPED
from app.worker.member import Member
from app.worker.orders import Run, Step
from app.worker.reports import Died, Refused, Report
from solver.scenes.bar import BarSettings

PATIENCE = 60.0
BROKEN = [Refused(1, "too large"), Died(1, "given up", again=False)]


@pytest.fixture
def seat() -> Seat:
    return Seat()


@pytest.fixture
def session(seat: Seat) -> Session:
    made = Session(seat, Bench(), BarSettings.checked({"method": "paper"}))
    made.start()
    return made


@pytest.mark.parametrize("report", BROKEN)
def test_the_button_starts_a_broken_run_again(session: Session, seat: Seat, report: Report) -> None:
    transport = Transport(session, lambda: None)
    transport.show()
    assert transport._run.label == "Pause"
    seat.say(report)
    session.collect()
    transport.show()
    assert transport._run.label == "Run"
    transport.toggle()
    assert isinstance(seat.orders[-1], Run)
    assert seat.orders[-1].ticket == 2
    assert seat.orders[-1].pause_after is None
    transport.show()
    assert transport._run.label == "Pause"


@pytest.mark.parametrize("report", BROKEN)
def test_a_step_starts_a_broken_run_again_and_waits(
    session: Session, seat: Seat, report: Report
) -> None:
    session.step()
    assert isinstance(seat.orders[-1], Step)
    seat.say(report)
    session.collect()
    session.step()
    assert isinstance(seat.orders[-1], Run)
    assert seat.orders[-1].pause_after == 1


def test_a_run_that_the_pool_itself_starts_again_goes_on(session: Session, seat: Seat) -> None:
    seat.say(Died(1, "started again", again=True))
    session.collect()
    assert session.goes_on


@pytest.mark.parametrize("report", BROKEN)
def test_no_word_says_that_a_broken_run_runs(session: Session, seat: Seat, report: Report) -> None:
    seat.say(report)
    session.collect()
    words = status_line(session.run, True, None)
    assert "running" not in words
    assert report.reason in words


def no_fork_server(*arguments: Any) -> Any:
    raise EOFError


def test_a_job_whose_process_does_not_start_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(job, "start", no_fork_server)
    errand = Errand(Bench())
    errand.ask("any", print)
    end = time.monotonic() + PATIENCE
    while errand.is_busy:
        assert time.monotonic() < end
        errand.collect()
        time.sleep(0.01)
    assert errand.notice == STOPPED


def test_a_worker_whose_process_does_not_start_counts_as_gone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(member, "start", no_fork_server)
    gone = threading.Event()
    hired = Member(lambda member, report: None, lambda member: gone.set())
    assert gone.wait(PATIENCE)
    hired.join(PATIENCE)
    assert hired.pid is None
