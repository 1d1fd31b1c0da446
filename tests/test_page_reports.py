"""Long reports are asked for on the page, made elsewhere in turn, and leave nothing behind."""

from __future__ import annotations

import csv
import os
import re
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from functools import partial
from typing import Any

import pytest
from browser import Server
from playwright.sync_api import Page, expect

from app.errand import KEPT, STARTING, WAITING, Errand
from app.session import Session
from app.views.report import progress
from app.views.stability import matrix
from app.views.study import company, title_of
from app.worker.bench import Bench
from app.worker.job import Doing, Done, Part, Send, Started
from app.worker.pool import Pool
from app.worker.studies import stability_of, study_of
from solver.scenes.bar import BarSettings
from solver.study.stability import Row, Verdict, judge, run_case
from solver.study.stability_cases import Case

WAIT = 60_000
PATIENCE = 60.0
TINY = {"elements": 8, "substructures": 2, "instants": 5}
QUERY = "?elements=8&substructures=2&instants=5"


def count_to(number: int, send: Send) -> int:
    for done in range(number):
        send(Doing(f"{done} done", done / number))
        send(Part(done))
    return number


def sleep(send: Send) -> None:
    send(Doing("asleep", 0.5))
    time.sleep(600.0)


def refuse(send: Send) -> None:
    raise ValueError("no such thing")


def vanish(send: Send) -> None:
    os._exit(1)


def wait_for(condition: Callable[[], Any]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


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
    with closing(Pool(1)) as pool:
        session = Session(pool, bench, BarSettings.checked(TINY))
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
    with (
        closing(Pool(1)) as pool,
        closing(Session(pool, bench, BarSettings.checked({"tolerance": 1e-30}))) as session,
    ):
        session.set_pace(100.0)
        session.start()
        wait_for(lambda: session.collect() and session.run.iteration > 2)
        session.study.ask("any", sleep)
        wait_for(lambda: session.attend() and session.is_held)
        other_seat = pool.seat(lambda report: None)
        wait_for(lambda: other_seat.others_at_work == 0)
        session.collect()
        stood_at = session.run.iteration
        session.set_pace(None)
        session.go()
        session.start(session.settings.with_change("friction", 0.31))
        wait_for(lambda: session.collect() and session.run.reference is not None)
        wait_for(lambda: other_seat.others_at_work == 0)
        session.collect()
        assert stood_at > 2
        assert session.run.iteration == 1
        session.study.cancel()
        session.attend()
        assert not session.is_held
        wait_for(lambda: session.collect() and session.run.iteration > 2)


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
    outcome = run_case(case, "default")
    return Row(case, "default", outcome, judge(outcome))


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
    assert "no other page" in company(0)
    assert "a run of another page was" in company(1)
    assert "3 runs of other pages were" in company(3)


def open_tab(page: Page, name: str) -> None:
    expect(page.locator(".status").first).to_contain_text("iteration", timeout=WAIT)
    page.get_by_role("button", name=name, exact=True).click()


def press(page: Page, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).locator("visible=true").click()


def test_the_page_makes_a_study_of_its_settings_when_asked(open_page) -> None:
    page = open_page(QUERY)
    open_tab(page, "Study")
    expect(page.get_by_text("How it was measured")).to_have_count(0)
    press(page, "Start")
    expect(page.get_by_text("How it was measured")).to_be_visible(timeout=WAIT)
    expect(page.get_by_text("Study: substructures 2")).to_be_visible()
    expect(page.get_by_text("incremental solver").first).to_be_visible()
    with page.expect_download() as caught:
        page.get_by_text("levels.csv").click()
    assert caught.value.suggested_filename == "levels.csv"
    page.get_by_role("button", name="Live", exact=True).click()
    expect(page.get_by_text("How it was measured")).to_be_hidden()
    page.get_by_role("button", name="Study", exact=True).click()
    expect(page.get_by_text("How it was measured")).to_be_visible()


def test_the_live_tab_says_that_its_run_waits_and_a_cancelled_study_lets_it_go_on(
    open_page,
) -> None:
    page = open_page("?tolerance=1e-30&max_iterations=100000")
    open_tab(page, "Study")
    page.get_by_text("Growth with the size").click()
    press(page, "Start")
    expect(page.get_by_text(re.compile("Errors of LATIN")).first).to_be_visible(timeout=WAIT)
    page.get_by_role("button", name="Live", exact=True).click()
    expect(page.locator(".status").first).to_contain_text("waits for the study", timeout=WAIT)
    page.get_by_role("button", name="Study", exact=True).click()
    press(page, "Cancel")
    expect(page.get_by_text("Cancelled.")).to_be_visible(timeout=WAIT)
    page.get_by_role("button", name="Live", exact=True).click()
    expect(page.locator(".status").first).to_contain_text("running", timeout=WAIT)


def test_the_stability_table_fills_row_by_row_and_can_be_filtered(open_page) -> None:
    page = open_page()
    open_tab(page, "Stability")
    press(page, "Start")
    cells = page.locator("td.verdict")
    expect(cells.nth(5)).to_be_visible(timeout=WAIT)
    press(page, "Not right")
    expect(page.locator("td.verdict", has_text="right")).to_have_count(0, timeout=WAIT)
    expect(cells.first).to_have_text("told")
    press(page, "Cancel")
    expect(page.get_by_text(re.compile("runs pass"))).to_be_visible()


def test_a_phone_has_all_tabs_in_reach(open_page) -> None:
    page = open_page(width=390, height=844)
    open_tab(page, "Stability")
    expect(page.get_by_text("Stiff and extreme cases of every scene")).to_be_visible(timeout=WAIT)
    open_tab_again = page.get_by_role("button", name="Study", exact=True)
    box = open_tab_again.bounding_box()
    assert box is not None
    assert 0.0 <= box["x"] <= 390.0 - box["width"]


def test_neither_a_closed_page_nor_an_ended_server_leaves_a_study_behind(tmp_path, chrome) -> None:
    server = Server(tmp_path / "log")
    server.wait()
    page = chrome.new_page()
    page.goto(server.address)
    open_tab(page, "Study")
    page.get_by_text("Growth with the size").click()
    press(page, "Start")
    expect(page.get_by_text(re.compile("Errors of LATIN")).first).to_be_visible(timeout=WAIT)
    server.stop()
    page.close()
    wait_for(lambda: server.processes() == [])


def test_a_changed_setting_starts_from_the_run_before_and_says_so(open_page) -> None:
    page = open_page()
    status = page.locator(".status").first
    expect(status).to_contain_text("converged", timeout=WAIT)
    page.get_by_role("switch", name="Start from the run before").click()
    page.get_by_role("slider", name="Peak load").press("ArrowRight")
    expect(status).to_contain_text("Started from the run before it", timeout=WAIT)
    expect(status).to_contain_text("from zero")
    page.locator("body").press("r")
    expect(status).not_to_contain_text("Started from", timeout=WAIT)
