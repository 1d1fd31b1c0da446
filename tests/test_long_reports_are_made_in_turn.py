"""Long reports are made in turn, in a process of their own that ends with whoever asked."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from concurrent.futures import Future
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from jobs import count_to, refuse, sleep, vanish
from lone_link import LoneLink
from processes import PATIENCE, is_alive, wait_for
from report_jobs import until_idle

from app.reports.report import progress
from app.session.inquiry import LENDER
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.report_folder import PROGRESS, SECTIONS, ReportFolder, files, said
from app.session.report_job import KEPT, STARTING, WAITING, ReportJob
from app.session.session import Session
from app.wire.orders import Pace
from solver.running.executors import VARIABLE
from solver.scenes.bar import BarSettings

TINY = {"elements": 8, "substructures": 2, "instants": 5}


def test_a_report_says_how_far_it_is_and_then_what_came_of_it(job: ReportJob) -> None:
    said = []

    def idle() -> bool:
        job.collect()
        said.append((job.doing, job.share))
        return not job.is_busy

    job.ask("any", partial(count_to, 2))
    wait_for(idle)
    every = [(STARTING, 0.0), ("0 done", 0.0), ("1 done", 0.5)]
    assert said[-1] == every[-1]
    assert list(dict.fromkeys(said)) == [one for one in every if one in said]
    assert job.last is not None
    assert job.last.files == {"counted.csv": b"1\n"}
    assert job.last.sections == ["<p>1</p>"]


def test_what_grows_is_never_read_half_written(tmp_path: Path) -> None:
    def write(folder: Path) -> None:
        (folder / "one.html").write_text("half")
        assert files(tmp_path) == {}
        (folder / "one.html").write_text("whole")

    assert said(tmp_path, PROGRESS) == b""
    assert said(tmp_path, SECTIONS) == b""
    ReportFolder(tmp_path).publish(write)
    assert files(tmp_path) == {"one.html": b"whole"}
    ReportFolder(tmp_path).tell("writing", 0.5)
    ReportFolder(tmp_path).show(["so far"])
    assert pickle.loads(said(tmp_path, PROGRESS)) == ("writing", 0.5)
    assert pickle.loads(said(tmp_path, SECTIONS)) == ["so far"]
    assert len(files(tmp_path)) == 1


def test_what_a_report_had_written_when_it_was_cancelled_stays_and_its_folder_goes(
    job: ReportJob,
) -> None:
    job.ask("any", write_and_sleep)
    assert job._folder is not None
    folder = Path(job._folder.name)
    wait_for(lambda: job.collect() and job.growing.sections)
    job.cancel()
    assert job.growing.sections == ["so far"]
    assert not folder.exists()


def write_and_sleep(folder: Path) -> None:
    ReportFolder(folder).show(["so far"])
    sleep(folder)


def test_the_executor_is_one_as_the_library_has_them(executor: ReportExecutor) -> None:
    results: list[Future[int]] = [executor.submit(pow, 2, power) for power in (3, 4)]
    assert [one.result(timeout=PATIENCE) for one in results] == [8, 16]
    assert list(executor.map(abs, [-1, 2])) == [1, 2]
    with pytest.raises(ValueError, match="invalid literal"):
        executor.submit(int, "no number").result(timeout=PATIENCE)


@pytest.mark.parametrize(
    ("work", "words"), [(refuse, "ValueError: no such thing"), (vanish, "stopped unexpectedly")]
)
def test_a_job_that_breaks_says_so_and_the_next_one_is_done(
    job: ReportJob, work: Any, words: str
) -> None:
    job.ask("first", work)
    until_idle(job)
    assert words in job.notice
    assert words in progress(job)
    assert job.last is None
    job.ask("second", partial(count_to, 1))
    until_idle(job)
    assert job.notice == ""
    assert job.last is not None
    assert (job.last.title, job.last.sections) == ("second", ["<p>0</p>"])


def test_jobs_of_all_pages_take_turns(executor: ReportExecutor) -> None:
    first, second = ReportJob(executor), ReportJob(executor)
    first.ask("first", sleep)
    second.ask("second", partial(count_to, 3))
    wait_for(lambda: first.collect() and first.doing == "asleep")
    wait_for(lambda: second.collect() and second.doing == WAITING)
    assert first.is_begun
    assert not second.is_begun
    assert WAITING in progress(second)
    first.cancel()
    until_idle(second)
    assert second.growing.sections == ["<p>2</p>"]


def test_a_job_that_nobody_is_before_does_not_say_that_it_waits(job: ReportJob) -> None:
    job.ask("any", partial(count_to, 1))
    assert STARTING in progress(job)
    assert WAITING not in progress(job)


def test_a_cancelled_job_ends_its_process_and_says_nothing_more(
    executor: ReportExecutor, job: ReportJob
) -> None:
    job.ask("any", sleep)
    wait_for(lambda: job.collect() and job.doing == "asleep")
    pid = executor.pid
    assert pid is not None
    job.cancel()
    assert not job.is_busy
    assert job.notice == "Cancelled."
    wait_for(lambda: executor.pid is None)
    assert not is_alive(pid)
    job.collect()
    assert job.last is None


def test_a_job_that_is_cancelled_while_it_waits_is_never_begun(executor: ReportExecutor) -> None:
    first, second = ReportJob(executor), ReportJob(executor)
    first.ask("first", sleep)
    second.ask("second", refuse)
    second.cancel()
    first.cancel()
    wait_for(lambda: executor.pid is None)
    second.collect()
    assert second.notice == "Cancelled."


def test_a_server_whose_setting_names_no_executor_says_so(
    job: ReportJob, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, "cloud")
    job.ask("any", refuse)
    assert job.notice.startswith("--on")
    assert not job.is_busy


def test_closing_the_executor_ends_the_job(executor: ReportExecutor, job: ReportJob) -> None:
    job.ask("any", sleep)
    wait_for(lambda: job.collect() and job.doing == "asleep")
    pid = executor.pid
    executor.shutdown()
    assert pid is not None
    wait_for(lambda: not is_alive(pid))


SERVER = """
import sys
from app.session.report_job import ReportJob
from app.session.report_executor import shared_executor
from report_jobs import until_idle
from jobs import sleep

executor, job = shared_executor(), ReportJob(shared_executor())
job.ask("any", sleep)
while not (job.collect() and job.doing == "asleep"):
    pass
print(executor.pid, job._folder.name, flush=True)
sys.stdin.readline()
"""


@pytest.mark.parametrize("killed", [False, True])
def test_a_report_ends_with_its_server_which_does_not_wait_for_it(killed: bool) -> None:
    tests = Path(__file__).parent
    server = subprocess.Popen(
        [sys.executable, "-c", SERVER],
        cwd=tests.parent,
        env={**os.environ, "PYTHONPATH": str(tests)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with server:
        assert server.stdout is not None
        number, folder = server.stdout.readline().split()
        pid = int(number)
        assert is_alive(pid)
        assert Path(folder).exists()
        if killed:
            server.kill()
        server.communicate(timeout=PATIENCE)
    wait_for(lambda: not is_alive(pid))
    assert not Path(folder).exists()


def test_a_page_that_closes_ends_its_jobs(executor: ReportExecutor) -> None:
    with closing(
        Session(Pages(1), executor, BarSettings.checked({"method": "paper", **TINY}))
    ) as session:
        session.asked.stability.ask("any", sleep)
        wait_for(lambda: session.attend() and session.asked.stability.doing == "asleep")
        pid = executor.pid
        session.close()
        assert pid is not None
        wait_for(lambda: not is_alive(pid))


def test_results_stay_and_the_oldest_go(job: ReportJob) -> None:
    for number in range(KEPT + 1):
        job.ask(str(number), partial(count_to, number))
        until_idle(job)
    assert [found.title for found in job.found] == [str(n) for n in range(1, KEPT + 1)]


def test_the_run_of_the_page_stands_still_while_a_study_is_timed(executor: ReportExecutor) -> None:
    pages, link = Pages(2), LoneLink()
    settings = BarSettings.checked({"method": "paper"})
    session = Session(pages, executor, settings, link.hire)
    other = Session(pages, executor, settings, LoneLink().hire)
    session.start()
    assert pages.at_work_beside(other) == 1
    session.asked.study.ask("any", sleep)
    wait_for(lambda: session.attend() and session.is_held)
    assert pages.at_work_beside(other) == 0
    with LENDER.lent():
        assert pages.at_work_beside(other) == 1
    assert link.orders[-1] == Pace(1, 0.0, is_held=True)
    session.start(session.settings.with_change("friction", 0.31))
    assert (link.orders[-1].pause_after, link.orders[-1].is_held) == (1, True)
    session.asked.study.cancel()
    session.attend()
    assert not session.is_held
    assert link.orders[-1] == Pace(2, session.pace)
    session.close()
