"""The paper's figures as the page has them made, and shows them."""

from __future__ import annotations

import pickle
import re
import threading
from collections.abc import Iterator, Sequence
from html import escape
from typing import Any

import numpy as np
import panel as pn
import pytest
from bokeh.document import Document
from bokeh.io.doc import patch_curdoc
from jobs import refuse, sleep
from panel.io.state import set_curdoc
from processes import PATIENCE, wait_for

from app.charts.draw import draw
from app.picture.glossary import explained
from app.reports import reports
from app.reports.reports import PaperFigures
from app.session.report_executor import ReportExecutor
from app.session.report_folder import SECTIONS, ReportFolder, said
from app.session.report_job import Found, ReportJob
from app.session.studies import figures_of_the_paper
from solver.study.chart import Panel
from solver.study.figures.paper_runs import PaperRuns
from solver.study.page import PlotSection, Section


@pytest.fixture(scope="module")
def told() -> list[float]:
    """Give the shares that were told while `found` was made."""
    return []


@pytest.fixture(scope="module")
def seen() -> list[int]:
    """Give how many sections there were after each figure."""
    return []


@pytest.fixture(scope="module")
def found(
    tmp_path_factory: pytest.TempPathFactory,
    paper_runs: PaperRuns,
    told: list[float],
    seen: list[int],
) -> Found:
    folder = tmp_path_factory.mktemp("figures")

    class Spied(ReportFolder):
        def tell(self, doing: str, share: float) -> None:
            told.append(share)

        def show(self, sections: Sequence[Section]) -> None:
            super().show(sections)
            seen.append(len(sections))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.session.studies.ReportFolder", Spied)
        patch.setattr("app.session.studies.PaperRuns", lambda: paper_runs)
        figures_of_the_paper(folder)
    return Found("any", pickle.loads(said(folder, SECTIONS)))


@pytest.fixture(scope="module")
def panels(found: Found) -> list[Panel]:
    return [
        panel for plot in found.sections if isinstance(plot, PlotSection) for panel in plot.charts
    ]


@pytest.fixture(autouse=True)
def computed(monkeypatch: pytest.MonkeyPatch) -> list[Found]:
    """Give what the server has computed: nothing yet."""
    nothing: list[Found] = []
    monkeypatch.setattr(reports, "COMPUTED", nothing)
    return nothing


@pytest.fixture
def job() -> Iterator[ReportJob]:
    with ReportExecutor() as executor:
        made = ReportJob(executor)
        yield made
        made.cancel()


@pytest.fixture
def view(job: ReportJob) -> Iterator[PaperFigures]:
    made = PaperFigures(job)
    made.view.visible = True
    yield made
    # Or they would still be drawn beside the tests of other files.
    for _, drawing in made._drawings:
        drawing.cancel()


def test_they_come_one_by_one_and_say_how_far_they_are(
    found: Found, told: list[float], seen: list[int]
) -> None:
    each = len(found.sections) // 6
    assert seen == [each * count for count in range(1, 7)]
    assert told == sorted(told)
    assert told[0] == 0.0


def test_every_curve_is_drawn_with_its_values(panels: list[Panel]) -> None:
    for panel in panels:
        drawn = draw(panel)
        for place, curve in enumerate(panel.curves):
            part = drawn.select_one({"name": f"curve-{place}"}).data
            assert np.array_equal(part["x"], curve.x)
            values = part["y"]
            fits = (curve.y > 0.0) if panel.y.logarithmic else np.ones(len(curve.y), bool)
            assert np.array_equal(values[fits], curve.y[fits])
            assert np.isnan(values[~fits]).all()


def test_a_plot_can_be_read_and_enlarged_but_does_not_hold_a_page_that_is_scrolled(
    panels: list[Panel],
) -> None:
    drawn = draw(panels[0])
    kinds = {type(tool).__name__ for tool in drawn.tools}
    assert {"HoverTool", "BoxZoomTool", "PanTool", "WheelZoomTool", "ResetTool"} <= kinds
    assert drawn.toolbar.active_drag is None
    assert drawn.toolbar.active_scroll in (None, "auto")


def test_no_thread_touches_the_page_and_its_own_turns_put_each_plot_on_it_in_its_theme(
    view: PaperFigures, found: Found, panels: list[Panel], monkeypatch: pytest.MonkeyPatch
) -> None:
    touched: list[str] = []

    class Touched(Document):
        def __getattribute__(self, name: str) -> Any:
            if threading.current_thread() is not threading.main_thread():
                touched.append(name)
            return super().__getattribute__(name)

    def slowly(panel: Panel) -> Any:
        drawing.set()
        assert go.wait(PATIENCE)
        return draw(panel)

    drawing, go = threading.Event(), threading.Event()
    monkeypatch.setattr("app.charts.filling._draw", slowly)
    page = Touched()
    # As the server has it for all threads while it is at work on a page.
    with patch_curdoc(page), set_curdoc(page):
        view._made()
        view._put(found)
        assert drawing.wait(PATIENCE)
        monkeypatch.setitem(pn.config._session_config, page, {"theme": "dark"})
        go.set()
        boxes = [box for box, _ in view._drawings]
        themes = []
        for box in boxes:
            wait_for(view._drawings[0][1].done)
            put = len(box)
            view.put_drawn()
            assert len(box) == put + 1
            themes.append(box[-1]._design.theme._name)
        view.put_drawn()
    assert touched == []
    assert themes == ["dark"] * len(panels)
    assert [pane.object.title.text for box in dict.fromkeys(boxes) for pane in box[1:]] == [
        panel.title for panel in panels
    ]


def test_the_report_of_the_command_is_shown_where_they_are_found_computed(
    view: PaperFigures, job: ReportJob, computed: list[Found], found: Found
) -> None:
    computed.append(found)
    with set_curdoc(Document()):
        view.open()
    assert not job.is_busy
    assert not view._start.visible
    assert view._card.visible
    for pane, section in zip(view._sheet, found.sections, strict=True):
        if isinstance(section, PlotSection):
            legend = re.sub("</?abbr[^>]*>", "", pane[0].object)
            assert all(escape(c.label) in legend for p in section.charts for c in p.curves)
        else:
            assert pane.object == explained(section)


def test_what_is_drawn_stays_while_a_report_grows(view: PaperFigures, found: Found) -> None:
    grows = Found("any", found.sections[:3])
    with set_curdoc(Document()):
        view._made()
        view._put(grows)
        first = list(view._sheet)
        grows.sections = ["<p>other words</p>", *found.sections[1:6]]
        view._put(grows)
        assert view._sheet[:3] == first
        assert first[0].object == "<p>other words</p>"
        assert len(view._sheet) == 6
        view._put(found)
        assert first[1] not in view._sheet.objects


def test_a_failure_is_told_and_can_be_tried_again(
    view: PaperFigures, job: ReportJob, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reports, "figures_of_the_paper", refuse)
    view.open()
    assert not view._start.visible
    wait_for(lambda: job.collect() and not job.is_busy)
    view.refresh()
    assert "no such thing" in view._progress.object
    assert view._start.visible
    assert not view._start.disabled
    monkeypatch.setattr(reports, "figures_of_the_paper", sleep)
    view._on_start()
    assert job.is_busy
    assert not view._start.visible


def test_it_can_be_cancelled_and_another_page_has_them_later(
    view: PaperFigures,
    job: ReportJob,
    computed: list[Found],
    found: Found,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(reports, "figures_of_the_paper", sleep)
    view.open()
    wait_for(lambda: job.collect() and job.doing == "asleep")
    view.refresh()
    assert view._cancel.visible
    view._on_cancel()
    assert "Cancelled." in view._progress.object
    assert view._start.visible
    computed.append(found)
    with set_curdoc(Document()):
        view.open()
    assert len(view._sheet) == len(found.sections)
    assert not view._start.visible
