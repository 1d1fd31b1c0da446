"""The tab *What if* runs what it is asked beside the page, and ends it with the page."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import Any

import pytest
from lone_link import lone_session
from processes import wait_for
from sweeps import TINY, Here, tiny

from app.charts.in_units import in_units, scales_of
from app.picture.units import MM, SI
from app.session.inquiry import CANCELLED, Inquiry, Lender, part_of
from app.session.session import Session
from app.whatif.charted import columns_of, drawn, is_comparable
from app.whatif.fields import form_of
from app.whatif.question import (
    Question,
    Span,
    askable,
)
from app.whatif.ready import bathtub
from app.whatif.whatif import WhatIf
from solver.running.executors import VARIABLE, Processes
from solver.running.pool import Pool
from solver.scenes.bar import BarSettings
from solver.settings import Settings
from solver.study.chart import Panel
from solver.study.sweep import Row

DEFAULTS = BarSettings.checked({})
SLOW = {"elements": 400, "instants": 401, "method": "paper", "tolerance": 1e-30}


@contextmanager
def here() -> Iterator[Pool]:
    yield Here()


def settled(inquiry: Inquiry) -> list[Row]:
    """Wait for the end of a sweep; its rows by number."""

    def idle() -> bool:
        inquiry.collect()
        return not inquiry.is_busy

    wait_for(idle)
    return sorted(inquiry.rows, key=lambda row: row.number)


@pytest.fixture
def session() -> Iterator[Session]:
    with closing(lone_session(BarSettings.checked(TINY))) as opened:
        opened.asked.inquiry._lent = here
        yield opened


def test_a_sweep_gives_its_rows_and_leaves_the_chart_before_as_a_ghost() -> None:
    inquiry = Inquiry(here)
    first = tiny(["peak=300:900:3"], ["peak_displacement"])
    inquiry.ask(first)
    assert [row.holds for row in settled(inquiry)] == [True] * 3
    assert inquiry.before is None
    second = tiny(["peak=200:800:4"], ["peak_displacement"], friction=0.5)
    inquiry.ask(second)
    assert inquiry.before is not None
    assert (inquiry.before[0], len(inquiry.before[1])) == (first, 3)
    assert is_comparable(second, first)
    assert not is_comparable(second, tiny(["peak=200:800:4"], ["seconds"]))
    assert not is_comparable(second, tiny(["friction=0.1,0.2"], ["peak_displacement"]))
    assert len(settled(inquiry)) == 4


def test_a_cancelled_sweep_ends_its_processes_and_keeps_what_has_come() -> None:
    lender, pools = Lender(), list[Pool]()

    @contextmanager
    def lent() -> Iterator[Pool]:
        with lender.lent() as pool:
            pools.append(pool)
            yield pool

    inquiry = Inquiry(lent)
    inquiry.ask(tiny(["max_iterations=1,2,3,1000000,900000"], ["iterations"], **SLOW))
    wait_for(lambda: inquiry.collect() and inquiry.rows)
    inquiry.cancel()
    assert not inquiry.is_busy
    assert inquiry.notice == CANCELLED
    assert 0 < len(inquiry.rows) < 5
    wait_for(lambda: lender.users == 0)
    (pool,) = pools
    assert isinstance(pool, Processes)
    assert not any(thread.is_alive() for thread in pool._threads)


def test_no_page_waits_for_the_runs_of_another() -> None:
    lender = Lender()
    slow, quick = Inquiry(lender.lent), Inquiry(lender.lent)
    slow.ask(tiny(["max_iterations=1000000,900000"], ["iterations"], **SLOW))
    wait_for(lambda: lender.users == 1)
    quick.ask(tiny(["peak=300:900:3"], ["peak_displacement"]))
    assert len(settled(quick)) == 3
    assert slow.is_busy
    slow.cancel()
    wait_for(lambda: lender.users == 0)


@pytest.mark.parametrize(
    ("on", "users", "part"),
    [
        ("processes:6", 1, "processes:6"),
        ("processes:6", 4, "processes:1"),
        ("processes:6", 9, "processes:1"),
        ("processes:0", 1, "processes:0"),
        ("processes:six", 1, "processes:six"),
        ("dask://host:8786", 3, "dask://host:8786"),
    ],
)
def test_the_more_pages_ask_the_fewer_processes_each_of_them_has(
    on: str, users: int, part: str
) -> None:
    assert part_of(on, users) == part


@pytest.mark.parametrize(("there", "taken"), [(1, 1), (2, 2), (3, 2), (8, 7)])
def test_a_processor_is_left_to_the_pages_where_there_are_more_than_two(
    there: int, taken: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.session.inquiry.processors", lambda: there)
    assert part_of("processes", 1) == f"processes:{taken}"
    assert part_of("processes", 8) == "processes:1"


def test_a_closed_page_ends_its_sweep(session: Session) -> None:
    lender = Lender()
    session.asked.inquiry._lent = lender.lent
    session.asked.inquiry.ask(tiny(["friction=0.1:0.5:5"], ["iterations"], **SLOW))
    wait_for(lambda: lender.users == 1)
    session.close()
    wait_for(lambda: lender.users == 0)


def test_a_foolish_executor_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "abacus")
    inquiry = Inquiry(Lender().lent)
    inquiry.ask(tiny(["friction=0.1,0.2"], ["seconds"]))
    assert settled(inquiry) == []
    assert "is refused; allowed: processes" in inquiry.notice


class Tab:
    """The tab of a page that nobody has built, and what it was told to show."""

    def __init__(self, session: Session, question: Question | None = None) -> None:
        self.session, self.shown = session, list[Settings]()
        session.question = question
        self.tab = WhatIf(session, self.shown.append)

    def open(self) -> None:
        self.tab.view.visible = True
        self.tab.open()

    def settle(self) -> dict[str, Any]:
        """Wait until nothing more comes; what the browser was given."""
        settled(self.session.asked.inquiry)
        self.tab.refresh()
        return dict(self.asker.progress)

    @property
    def asker(self) -> Any:
        return self.tab.view[0]


def test_a_ready_question_is_asked_by_one_click_and_a_point_opens_its_run(
    session: Session,
) -> None:
    page = Tab(session)
    assert session.question is None
    page.open()
    assert session.asked.inquiry.plan is None
    page.tab.hear("span", {"place": 0, "span": {"count": "3"}})
    page.tab.hear("start", None)
    assert page.settle()["words"] == "6 of 6 runs: 6 converged."
    page.tab.hear("run", 5)
    assert (page.shown[0].k_scale, page.shown[0].acceleration) == (100.0, "anderson")
    page.tab.hear("run", 77)
    assert len(page.shown) == 1
    page.tab.hear("table", None)
    text, name, _ = page.asker.file
    assert name.endswith(".csv")
    assert text.count("\nconverged") == 0
    assert text.count(",converged,") == 6


def test_a_question_of_the_address_is_asked_when_somebody_looks(session: Session) -> None:
    question = Question((Span("peak", "300", "900", "3"),), "peak_displacement")
    page = Tab(session, question)
    assert session.asked.inquiry.plan is None
    page.open()
    assert session.asked.inquiry.plan is not None
    assert session.question == question
    page.settle()
    page.open()
    assert not session.asked.inquiry.is_busy


def test_a_refused_question_is_not_asked(session: Session) -> None:
    page = Tab(session, Question((Span("peak", "300", "300", "3"),), "seconds"))
    page.open()
    assert session.asked.inquiry.plan is None
    assert "The two ends differ" in page.asker.form["refusals"]["0"]


def test_a_scene_that_knows_nothing_of_the_question_is_proposed_another(session: Session) -> None:
    page = Tab(session, Question((Span("peak", "300", "900", "3"),), "seconds"))
    page.open()
    page.settle()
    session.choose_scene("incline")
    page.tab.refresh()
    assert session.question == bathtub(session.wanted)
    assert page.asker.progress["moved"]


def test_what_is_chosen_is_offered_even_where_it_does_nothing_now() -> None:
    question = Question((Span("pgd_modes", "1", "9", "9"),), "modes")
    form = form_of(question, DEFAULTS)
    assert "pgd_modes" in [one["name"] for one in form["settings"]]
    assert "modes" in [one["name"] for one in form["quantities"]]
    assert "modes" not in askable(DEFAULTS)


def test_fields_and_chart_are_in_the_units_of_the_page(session: Session) -> None:
    session.watch(units=MM)
    page = Tab(session, Question((Span("length", "0.9", "1.1", "3"),), "peak_displacement"))
    page.open()
    page.settle()
    shown = page.asker.form["spans"][0]
    assert (shown["low"], shown["high"], shown["unit"]) == ("900", "1100", "mm")
    page.tab.hear("span", {"place": 0, "span": {"name": "length", "high": "1200", "unit": "mm"}})
    assert session.question.spans[0].text == "length=0.9:1.2:3"
    page.tab.hear("table", None)
    lines = [one for one in page.asker.file[0].splitlines() if not one.startswith("#")]
    assert lines[0].startswith("length (mm),peak_displacement (mm),peak_friction,")
    plan, rows = session.asked.inquiry.plan, session.asked.inquiry.rows
    assert plan is not None
    assert [float(one.split(",")[0]) for one in lines[1:]] == pytest.approx([900, 1000, 1100])
    made = drawn(plan, rows, ("", ""), MM)
    chart = in_units(made, scales_of(made, MM))
    assert isinstance(chart, Panel)
    assert (chart.x.label, chart.y.label) == ("Length L (mm)", "Largest displacement (mm)")
    assert chart.runs is not None
    assert sorted(chart.runs.x) == pytest.approx([900.0, 1000.0, 1100.0])
    assert made.runs is not None
    assert chart.runs.y == pytest.approx(1e3 * made.runs.y)
    assert all(" mm: " in one and one.endswith(" mm") for one in chart.runs.said)


def test_any_two_columns_are_drawn_over_each_other(session: Session) -> None:
    question = Question(
        (Span("peak", "300", "900", "3"), Span("friction", listed="0.2,0.3", spacing="list")),
        "peak_displacement",
    )
    page = Tab(session, question)
    page.open()
    page.settle()
    assert (page.asker.columns["x"], page.asker.columns["y"]) == ("peak", "peak_displacement")
    plan, rows = session.asked.inquiry.plan, session.asked.inquiry.rows
    assert plan is not None
    names = [name for name, _ in page.asker.columns["names"]]
    place = {one.name: number for number, one in enumerate(plan.readings)}
    for x in names:
        for y in names:
            page.tab.hear("columns", {"x": x, "y": y})
            assert (page.asker.columns["x"], page.asker.columns["y"]) == (x, y)
            runs = drawn(plan, rows, (x, y), SI).runs
            assert runs is not None
            assert len(runs.x) == len(runs.y) == len(rows)
    chart = drawn(plan, rows, ("dissipation", "end_displacement"), SI)
    assert isinstance(chart, Panel)
    assert chart.runs is not None
    for at, name in ((chart.runs.x, "dissipation"), (chart.runs.y, "end_displacement")):
        wanted = {row.number: row.values[place[name]] for row in rows}
        assert dict(zip(chart.runs.numbers, at, strict=True)) == pytest.approx(wanted)
    labels = [one.label for one in chart.curves if one.label]
    assert labels == ["Friction coefficient μ 0.2", "Friction coefficient μ 0.3"]
    along = [one.x for one in chart.curves if one.label]
    assert [len(one) for one in along] == [3, 3]


def test_a_column_that_the_table_has_not_gives_the_usual_chart(session: Session) -> None:
    plan = tiny(["peak=300:900:3"], ["peak_displacement"])
    assert columns_of(plan, ("peak", "seconds")) == ("peak", "peak_displacement")
    assert columns_of(plan, ("", "")) == ("peak", "peak_displacement")
