"""Long reports are made in turn, in a process of their own that ends with whoever asked."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import closing
from functools import partial
from typing import Any

import pytest
from jobs import count_to, refuse, sleep, vanish
from lone_link import LoneLink
from processes import is_alive, wait_for

from app.errand import KEPT, STARTING, WAITING, Errand
from app.pages import Pages
from app.session import Session
from app.views.report import progress
from app.views.stability import matrix
from app.views.study import StudyReport, company, title_of
from app.worker.bench import Bench
from app.worker.job import Doing, Done, Part, Started
from app.worker.orders import Pace
from app.worker.studies import stability_of, study_of
from solver.scenes.bar import BarSettings
from solver.scenes.layers import LayersSettings
from solver.study.stability import Row, Verdict, judge, run_case
from solver.study.stability_cases import Case

TINY = {"elements": 8, "substructures": 2, "instants": 5}


@pytest.fixture
def bench() -> Iterator[Bench]:
    with closing(Bench()) as opened:
        yield opened


@pytest.fixture
def errand(bench: Bench) -> Errand:
    return Errand(bench)


def until_idle(errand: Errand) -> None:
    def idle() -> bool:
        errand.collect()
        return not errand.is_busy

    wait_for(idle)


def test_a_job_says_how_far_it_is_and_then_what_came_of_it(bench: Bench) -> None:
    said: list[Any] = []
    bench.ask(partial(count_to, 2), said.append)
    wait_for(lambda: said and isinstance(said[-1], Done))
    assert said == [
        Started(),
        Doing("0 done", 0.0),
        Part(0),
        Doing("1 done", 0.5),
        Part(1),
        Done(2),
    ]


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
    assert (errand.last.title, errand.last.result) == ("second", 1)


def test_jobs_of_all_pages_take_turns(bench: Bench) -> None:
    first, second = Errand(bench), Errand(bench)
    first.ask("first", sleep)
    second.ask("second", partial(count_to, 3))
    wait_for(lambda: first.collect() and first.doing == "asleep")
    second.collect()
    assert first.is_begun
    assert not second.is_begun
    assert WAITING in progress(second)
    first.cancel()
    until_idle(second)
    assert second.parts == [0, 1, 2]


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


def test_closing_the_bench_ends_the_job(bench: Bench, errand: Errand) -> None:
    errand.ask("any", sleep)
    wait_for(lambda: errand.collect() and errand.doing == "asleep")
    pid = bench.pid
    bench.close()
    assert pid is not None
    wait_for(lambda: not is_alive(pid))


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
    assert link.orders[-1] == Pace(1, 0.0, is_held=True)
    session.start(session.settings.with_change("friction", 0.31))
    assert (link.orders[-1].pause_after, link.orders[-1].is_held) == (1, True)
    session.study.cancel()
    session.attend()
    assert not session.is_held
    assert link.orders[-1] == Pace(2, session.pace)
    session.close()


def test_a_study_gives_the_files_of_the_command_line(bench: Bench) -> None:
    errand = Errand(bench)
    errand.ask("tiny", partial(study_of, "bar", TINY, 1, False))
    until_idle(errand)
    assert errand.last is not None, errand.notice
    found = errand.last.result
    assert set(found.files) == {"curves.csv", "levels.csv", "study.html"}
    rows = list(csv.DictReader(found.files["curves.csv"].decode().splitlines()))
    assert {row["method"] for row in rows} == {course.method for course in found.study.courses}
    assert found.study.settings.values() == BarSettings.checked(TINY).values()
    assert found.study.machine.count("BLAS threads: 1;") == 1


def test_stability_sends_every_row_and_gives_them_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    few = [Case("size", "tiny", TINY), Case("size", "small", {**TINY, "elements": 10})]
    monkeypatch.setattr("app.worker.studies.cases_of", lambda quick: few)
    said: list[Any] = []
    found = stability_of(False, said.append)
    parts = [one.value for one in said if isinstance(one, Part)]
    assert parts == found.rows
    assert len(parts) == 4
    assert set(found.files) == {"stability.csv", "stability.html"}
    shares = [one.share for one in said if isinstance(one, Doing)]
    assert shares == sorted(shares)


def row(**changes: Any) -> Row:
    case = Case("size", "tiny", {**TINY, **changes})
    outcome = run_case(case, "paper")
    return Row(case, "paper", outcome, judge(outcome))


def test_the_matrix_says_each_verdict_in_a_word_and_hides_only_what_is_right() -> None:
    rows = [row(), row(k_scale=1e-6, max_iterations=20)]
    assert [one.verdict for one in rows] == [Verdict.RIGHT, Verdict.TOLD]
    every, wrong = matrix(rows, only_wrong=False), matrix(rows, only_wrong=True)
    assert every.count("<tr>") == 3
    assert wrong.count("<tr>") == 2
    assert ">right</td>" in every
    assert ">told</td>" in wrong
    assert ">right</td>" not in wrong
    assert "1 of 2 runs pass" in every
    assert "1 of 2 runs pass" in wrong
    assert rows[1].outcome.advice.split(".")[0] in wrong


def test_a_study_is_named_by_what_is_changed_and_says_who_else_was_at_work() -> None:
    assert title_of(BarSettings.checked({})) == "defaults"
    assert title_of(BarSettings.checked({"friction": 0.4})) == "friction 0.4"
    assert title_of(BarSettings.checked({"method": "paper"})) == "method paper"
    assert "no other page" in company(0)
    assert "a run of another page was" in company(1)
    assert "3 runs of other pages were" in company(3)


def test_a_study_is_not_offered_where_the_reference_would_take_too_long(errand: Errand) -> None:
    for layers, refused in ((3, False), (20, True)):
        settings = LayersSettings.checked({"layers": layers, "instants": 11})
        report = StudyReport(errand, "", lambda chosen=settings: chosen, lambda: 0)
        report.open()
        assert report._start.disabled == refused
        assert ("would take too long here" in report._progress.object) == refused
