"""What broke can be started again, and what cannot start says so."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest
from lone_seat import Seat
from pool_sessions import Session as PoolSession

from app.errand import Errand
from app.session import Session
from app.transport import Transport
from app.words import status_line
from app.worker import job, member
from app.worker.bench import Bench
from app.worker.job import STOPPED
from app.worker.member import Member
from app.worker.orders import Run, Step
from app.worker.pool import Pool
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
    await_end(errand)
    assert errand.notice == STOPPED


def await_end(errand: Errand) -> None:
    end = time.monotonic() + PATIENCE
    while errand.is_busy:
        assert time.monotonic() < end
        errand.collect()
        time.sleep(0.01)


def not_to_be_sent(send: Any) -> Any:
    return _CannotBeRead()


class _CannotBeRead:
    def __reduce__(self) -> Any:
        return _refuse, ()


def _refuse() -> None:
    raise LookupError("made to break")


def test_a_job_whose_result_cannot_be_read_says_so_and_is_logged(
    caplog: pytest.LogCaptureFixture,
) -> None:
    bench = Bench()
    errand = Errand(bench)
    errand.ask("any", not_to_be_sent)
    await_end(errand)
    assert "made to break" in errand.notice
    assert "_refuse" in caplog.text
    errand.ask("another", _refused)
    await_end(errand)
    assert "made to break" in errand.notice


def _refused(send: Any) -> Any:
    raise LookupError("made to break")


def test_a_job_that_cannot_be_sent_says_so() -> None:
    errand = Errand(Bench())
    errand.ask("any", lambda send: None)
    await_end(errand)
    assert "It broke" in errand.notice


def test_where_a_run_broke_is_logged(pool: Pool, caplog: pytest.LogCaptureFixture) -> None:
    session = PoolSession(pool)
    nowhere: Any = None
    session.seat.run(Run(1, "bar", {}, look=nowhere))
    refused = session.until(Refused)
    assert "AttributeError" in refused.reason
    assert "Traceback" in caplog.text
    assert "app/worker/run.py" in caplog.text


def test_settings_that_are_refused_leave_no_trace_in_the_log(
    pool: Pool, caplog: pytest.LogCaptureFixture
) -> None:
    session = PoolSession(pool)
    session.seat.run(Run(1, "bar", {"friction": -1.0}))
    session.until(Refused)
    assert caplog.text == ""


def test_a_worker_whose_process_does_not_start_counts_as_gone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(member, "start", no_fork_server)
    gone = threading.Event()
    hired = Member(lambda member, report: None, lambda member: gone.set())
    assert gone.wait(PATIENCE)
    hired.join(PATIENCE)
    assert hired.pid is None
