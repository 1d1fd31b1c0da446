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
from errands import until_idle
from jobs import count_to, refuse, sleep, vanish
from lone_link import LoneLink
from processes import PATIENCE, is_alive, wait_for

from app.reports.report import progress
from app.session.bench import Bench
from app.session.desk import PROGRESS, SECTIONS, Desk, files, said
from app.session.errand import KEPT, STARTING, WAITING, Errand
from app.session.inquiry import LENDER
from app.session.pages import Pages
from app.session.session import Session
from app.wire.orders import Pace
from solver.running.executors import VARIABLE
from solver.scenes.bar import BarSettings

TINY = {"elements": 8, "substructures": 2, "instants": 5}


def test_a_report_says_how_far_it_is_and_then_what_came_of_it(errand: Errand) -> None:
    said = []

    def idle() -> bool:
        errand.collect()
        said.append((errand.doing, errand.share))
        return not errand.is_busy

    errand.ask("any", partial(count_to, 2))
    wait_for(idle)
    every = [(STARTING, 0.0), ("0 done", 0.0), ("1 done", 0.5)]
    assert said[-1] == every[-1]
    assert list(dict.fromkeys(said)) == [one for one in every if one in said]
    assert errand.last is not None
    assert errand.last.files == {"counted.csv": b"1\n"}
    assert errand.last.sections == ["<p>1</p>"]


def test_what_grows_is_never_read_half_written(tmp_path: Path) -> None:
    def write(folder: Path) -> None:
        (folder / "one.html").write_text("half")
        assert files(tmp_path) == {}
        (folder / "one.html").write_text("whole")

    assert said(tmp_path, PROGRESS) == b""
    assert said(tmp_path, SECTIONS) == b""
    Desk(tmp_path).publish(write)
    assert files(tmp_path) == {"one.html": b"whole"}
    Desk(tmp_path).tell("writing", 0.5)
    Desk(tmp_path).show(["so far"])
    assert pickle.loads(said(tmp_path, PROGRESS)) == ("writing", 0.5)
    assert pickle.loads(said(tmp_path, SECTIONS)) == ["so far"]
    assert len(files(tmp_path)) == 1


def test_what_a_report_had_written_when_it_was_cancelled_stays_and_its_folder_goes(
    errand: Errand,
) -> None:
    errand.ask("any", write_and_sleep)
    assert errand._folder is not None
    folder = Path(errand._folder.name)
    wait_for(lambda: errand.collect() and errand.growing.sections)
    errand.cancel()
    assert errand.growing.sections == ["so far"]
    assert not folder.exists()


def write_and_sleep(folder: Path) -> None:
    Desk(folder).show(["so far"])
    sleep(folder)


def test_the_executor_is_one_as_the_library_has_them(bench: Bench) -> None:
    results: list[Future[int]] = [bench.submit(pow, 2, power) for power in (3, 4)]
    assert [one.result(timeout=PATIENCE) for one in results] == [8, 16]
    assert list(bench.map(abs, [-1, 2])) == [1, 2]
    with pytest.raises(ValueError, match="invalid literal"):
        bench.submit(int, "no number").result(timeout=PATIENCE)


@pytest.mark.parametrize(
    ("work", "words"), [(refuse, "ValueError: no such thing"), (vanish, "stopped unexpectedly")]
)
def test_a_job_that_breaks_says_so_and_the_next_one_is_done(
    errand: Errand, work: Any, words: str
) -> None:
    errand.ask("first", work)
    until_idle(errand)
    assert words in errand.notice
    assert words in progress(errand)
    assert errand.last is None
    errand.ask("second", partial(count_to, 1))
    until_idle(errand)
    assert errand.notice == ""
    assert errand.last is not None
    assert (errand.last.title, errand.last.sections) == ("second", ["<p>0</p>"])


def test_jobs_of_all_pages_take_turns(bench: Bench) -> None:
    first, second = Errand(bench), Errand(bench)
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


def test_a_job_that_nobody_is_before_does_not_say_that_it_waits(errand: Errand) -> None:
    errand.ask("any", partial(count_to, 1))
    assert STARTING in progress(errand)
    assert WAITING not in progress(errand)


def test_a_cancelled_job_ends_its_process_and_says_nothing_more(
    bench: Bench, errand: Errand
) -> None:
    errand.ask("any", sleep)
    wait_for(lambda: errand.collect() and errand.doing == "asleep")
    pid = bench.pid
    assert pid is not None
    errand.cancel()
    assert not errand.is_busy
    assert errand.notice == "Cancelled."
    wait_for(lambda: bench.pid is None)
    assert not is_alive(pid)
    errand.collect()
    assert errand.last is None


def test_a_job_that_is_cancelled_while_it_waits_is_never_begun(bench: Bench) -> None:
    first, second = Errand(bench), Errand(bench)
    first.ask("first", sleep)
    second.ask("second", refuse)
    second.cancel()
    first.cancel()
    wait_for(lambda: bench.pid is None)
    second.collect()
    assert second.notice == "Cancelled."


def test_a_server_whose_setting_names_no_executor_says_so(
    errand: Errand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, "cloud")
    errand.ask("any", refuse)
    assert errand.notice.startswith("--on")
    assert not errand.is_busy


def test_closing_the_bench_ends_the_job(bench: Bench, errand: Errand) -> None:
    errand.ask("any", sleep)
    wait_for(lambda: errand.collect() and errand.doing == "asleep")
    pid = bench.pid
    bench.shutdown()
    assert pid is not None
    wait_for(lambda: not is_alive(pid))


SERVER = """
import sys
from app.session.errand import Errand
from app.session.bench import shared_bench
from errands import until_idle
from jobs import sleep

bench, errand = shared_bench(), Errand(shared_bench())
errand.ask("any", sleep)
while not (errand.collect() and errand.doing == "asleep"):
    pass
print(bench.pid, errand._folder.name, flush=True)
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


def test_a_page_that_closes_ends_its_jobs(bench: Bench) -> None:
    with closing(
        Session(Pages(1), bench, BarSettings.checked({"method": "paper", **TINY}))
    ) as session:
        session.stability.ask("any", sleep)
        wait_for(lambda: session.attend() and session.stability.doing == "asleep")
        pid = bench.pid
        session.close()
        assert pid is not None
        wait_for(lambda: not is_alive(pid))


def test_results_stay_and_the_oldest_go(errand: Errand) -> None:
    for number in range(KEPT + 1):
        errand.ask(str(number), partial(count_to, number))
        until_idle(errand)
    assert [found.title for found in errand.found] == [str(n) for n in range(1, KEPT + 1)]


def test_the_run_of_the_page_stands_still_while_a_study_is_timed(bench: Bench) -> None:
    pages, link = Pages(2), LoneLink()
    settings = BarSettings.checked({"method": "paper"})
    session = Session(pages, bench, settings, link.hire)
    other = Session(pages, bench, settings, LoneLink().hire)
    session.start()
    assert pages.at_work_beside(other) == 1
    session.study.ask("any", sleep)
    wait_for(lambda: session.attend() and session.is_held)
    assert pages.at_work_beside(other) == 0
    with LENDER.lent():
        assert pages.at_work_beside(other) == 1
    assert link.orders[-1] == Pace(1, 0.0, is_held=True)
    session.start(session.settings.with_change("friction", 0.31))
    assert (link.orders[-1].pause_after, link.orders[-1].is_held) == (1, True)
    session.study.cancel()
    session.attend()
    assert not session.is_held
    assert link.orders[-1] == Pace(2, session.pace)
    session.close()
