"""A page begins its run for each visitor, and is told nothing of other pages."""

from __future__ import annotations

import math
import re
import runpy
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import panel as pn
import panel_material_ui as pmui
import pytest
from bokeh.document import Document
from bokeh.document.models import DocumentModelManager
from bokeh.models import ImportedStyleSheet
from bokeh.plotting import figure
from panel.links import Callback
from panel.util import edit_readonly

import app.supervisor
from app.browser import Browser
from app.command import APP
from app.lessons.catalogue import LESSONS, settings_of
from app.messages import WHOLE, Needs, NewFrame, Order, Pace, Start
from app.page import BARE, COMPACT, Page, open_page
from app.server import PAGES, share_looks
from app.state import TABS, PageState, default_settings
from app.status import status_line
from app.views.parts import come_last, laid_out_alone
from app.worker.references import ReferenceCache
from app.worker.runner import Runner


@pytest.fixture
def orders(monkeypatch: pytest.MonkeyPatch) -> list[Order]:
    """Orders that a page's worker gets."""
    told: list[Order] = []
    worker = SimpleNamespace(send=told.append, end=lambda: None, hangs=False)
    monkeypatch.setattr(app.supervisor, "Worker", lambda on_report, others: worker)
    return told


def test_a_first_run_goes_on_once_its_first_picture_is_painted(
    orders: list[Order], document: Document
) -> None:
    page = Page(PageState(default_settings("bar")))
    (start,) = (order for order in orders if isinstance(order, Start))
    assert (start.pace, start.steps) == (0.0, 1)
    page.loaded()
    assert not any(isinstance(order, Pace) for order in orders)
    pulse = document.get_model_by_name("pulse")
    pulse.painted = 1
    pulse.painted = 2
    assert [order for order in orders if isinstance(order, Pace)] == [Pace(WHOLE)]


def small_page() -> tuple[Page, Runner]:
    """A page of a small bar, and what its worker would run."""
    settings = default_settings("bar").replace(elements=10, instants=11)
    page = Page(PageState(settings))
    start = Start(page.state.number, settings, math.inf)
    return page, Runner(start, ReferenceCache(), lambda: False)


@pytest.mark.usefixtures("orders")
def test_figures_that_come_in_sight_are_painted_once_the_browser_has_laid_them_out(
    document: Document,
) -> None:
    page, runner = small_page()
    state = page.state
    pulse = document.get_model_by_name("pulse")
    live = page._live

    def held() -> list[str]:
        """Names of the figures in sight that wait with painting."""
        views = live.display.views
        return [view.name for view in views if view.figure.hold_render]

    runner._iterate()
    page.loaded()
    assert len(held()) == len(live.display.views) == 4
    state.take(NewFrame(runner.frame(Needs())))
    assert len(held()) == 4
    pulse.painted = pulse.sent
    assert not held()
    state.plots = ["Loop"]
    assert held() == ["Loop"]
    pulse.painted = pulse.sent
    assert not held()
    # The same figures in other cards: they wait for a picture, which is sent.
    cards = [(type(card.seen),) for card in live._cards]
    live.arrange(tuple(kind for (kind,) in cards))
    assert len(held()) == 2
    assert pulse.painted < pulse.sent
    pulse.painted = pulse.sent
    assert not held()


def opened(document: Document) -> Page:
    """A page as a browser has it, before its first picture."""
    page, _ = small_page()
    page.template.server_doc(doc=document)
    page._fill()
    return page


@pytest.mark.usefixtures("orders")
def test_bokeh_goes_through_a_page_once_for_all_controls_of_a_scene(
    document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = opened(document)
    searched: list[object] = []
    search = DocumentModelManager.recompute

    def counted(models: DocumentModelManager) -> None:
        searched.append(models)
        search(models)

    monkeypatch.setattr(DocumentModelManager, "recompute", counted)
    page.state.settings = default_settings("block")
    assert searched == [document.models]
    for root in document.roots:
        assert {model.document for model in root.references()} == {document}


def test_figures_come_to_a_page_after_what_comes_meanwhile(document: Document) -> None:
    plot = figure()
    pane = laid_out_alone(plot)
    around = pn.Column()
    around.server_doc(doc=document)
    with come_last([pane], document):
        around.append(pane)
        assert not pane.object.elements
    assert pane.object.document is plot.document is document
    (root,) = pane.object.elements
    assert root.elements == [plot]


@pytest.mark.usefixtures("orders")
def test_panel_looks_for_callbacks_in_pages_that_were_in_a_lesson_alone(
    document: Document,
) -> None:
    page = opened(document)
    (text,) = [
        model
        for model in document.models
        if "lesson" in getattr(model, "css_classes", [])
    ]
    page.loaded()
    assert page._guide.view not in Callback.registry
    assert not text.js_property_callbacks
    for name in list(LESSONS)[:2]:
        page._guide._open("lesson", name)
        # A first text comes before its callback, and is seen after that.
        assert set(text.js_property_callbacks) == {"change:children", "change:visible"}
        assert text.visible


@pytest.mark.usefixtures("orders")
def test_the_slider_names_the_iterate_of_the_status_line(document: Document) -> None:
    page, runner = small_page()
    state = page.state
    pulse = document.get_model_by_name("pulse")
    last = 0
    for count in (2, 5, 9):
        while len(runner.history) < count:
            runner._iterate()
        # Also where frames follow each other more quickly than the slider's value.
        state.take(NewFrame(runner.frame(Needs())))
        pulse.painted = pulse.sent
        words = status_line(state)
        found = re.search(r"iteration(?:</abbr>)? (\d+)", words)
        assert found, words
        assert last < int(found[1]) == state.newest.iteration
        last = int(found[1])
        assert page._live.transport.iterate.text == f"Iteration {last} of {last}"


@pytest.mark.usefixtures("orders")
def test_what_a_person_does_ends_a_first_visit_before_the_browser_hears_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # A slider that is dragged has not the document's lock: what is told then comes to
    # the browser alone.
    monkeypatch.setattr(Browser, "tell", lambda browser, **values: None)
    page, _ = small_page()
    page.state.is_new = True
    page.state.drag("peak", 1000.0)
    assert not page.state.is_new


def test_a_projected_tab_keeps_the_header_unless_the_bar_of_a_run_leads_back() -> None:
    page = Page(PageState(default_settings("bar"), view="present"))
    assert page.template.sx == BARE
    page.state.tab = "Fit"
    assert page.template.sx == COMPACT
    page.state.tab = "Live"
    assert page.template.sx == BARE


def count_of(words: str, page: Page) -> int:
    """Number of texts above the tab in sight, or in its status line, with words."""
    texts = [str(each.object) for each in page._main.select(pn.pane.HTML)]
    if page.state.tab == "Live":
        texts.append(status_line(page.state))
    return sum(words in text for text in texts)


@pytest.mark.parametrize("tab", TABS)
def test_a_refusal_is_told_once_on_whichever_tab_is_in_sight(tab: str) -> None:
    """A refusal of an address stood in the status line of the tab Live alone."""
    page = Page(PageState(default_settings("bar"), refusal="No moon.", tab=tab))
    assert count_of("No moon.", page) == 1
    page.state.refusal = "No sun."
    assert (count_of("No sun.", page), count_of("No moon.", page)) == (1, 0)
    page.state.refusal = ""
    assert count_of("No sun.", page) == 0


@pytest.mark.usefixtures("orders")
def test_what_gives_an_answer_away_is_hidden_until_the_question_is_answered() -> None:
    lesson = LESSONS["broken-wire"]
    state = PageState(settings_of(lesson), lesson=lesson.name)
    page = Page(state)
    page.loaded()
    assert "asked" in page._live.view.css_classes
    state.prediction = lesson.right
    assert "asked" not in page._live.view.css_classes


def test_the_first_frame_has_what_the_views_that_are_named_need(
    orders: list[Order],
) -> None:
    Page(PageState(default_settings("wall"), plots=["Pieces"]))
    begins = next(n for n, order in enumerate(orders) if isinstance(order, Start))
    before = [order for order in orders[:begins] if isinstance(order, Needs)]
    assert "pieces" in before[-1].extras
    assert not [order for order in orders[begins:] if isinstance(order, Needs)]


def test_the_page_of_a_full_server_is_not_watched_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def watchers() -> list[Any]:
        return pn.state.param.watchers.get("value", {}).get("busy", [])

    monkeypatch.setenv("SLIPFRONT_PAGES", "1")
    monkeypatch.setattr(PAGES, "count", 1)
    before = len(watchers())
    page = open_page()
    assert page.title == "Slipfront"
    assert len(watchers()) == before


@pytest.mark.parametrize(
    ("variable", "value", "allowed"),
    [
        ("SLIPFRONT_PAGES", "many", "whole numbers from 1 on"),
        ("SLIPFRONT_PAGES", "0", "whole numbers from 1 on"),
        ("SLIPFRONT_PAGES", "2.5", "whole numbers from 1 on"),
        ("SLIPFRONT_EXECUTOR", "moon", "processes, processes:COUNT, or dask"),
        ("SLIPFRONT_EXECUTOR", "processes:0", "processes, processes:COUNT, or dask"),
    ],
)
def test_a_server_with_a_foolish_environment_does_not_start_and_says_why(
    monkeypatch: pytest.MonkeyPatch, variable: str, value: str, allowed: str
) -> None:
    monkeypatch.setenv(variable, value)
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(APP / "app_hooks.py"))
    said = f'{variable} = "{value}" is refused; allowed: {allowed}'
    assert str(ended.value).startswith(said)


@pytest.mark.usefixtures("orders")
def test_a_page_does_not_follow_how_busy_the_server_is() -> None:
    page = Page(PageState(default_settings("bar")))
    with edit_readonly(pn.state):
        pn.state.busy = True
        assert not page.template.busy
        pn.state.busy = False


@pytest.mark.usefixtures("orders")
def test_pages_leave_time_to_one_that_is_made_until_a_browser_has_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    loads: list[Callable[[], None]] = []
    monkeypatch.setattr(pn.state, "onload", loads.append)
    monkeypatch.setattr(PAGES, "count", 1)
    alone = PAGES.pause(1.0)
    open_page()
    assert PAGES.pause(1.0) > alone + 10.0
    (load,) = loads
    load()
    assert PAGES.pause(1.0) == alone + 1.0


@pytest.mark.usefixtures("orders")
def test_a_page_that_nobody_was_sent_asks_nothing_of_the_internet(
    document: Document,
) -> None:
    # As the socket makes one anew whose session had ended.
    root = open_page().get_root(document)
    PAGES.leave()
    sheets = [sheet.url for sheet in root.select({"type": ImportedStyleSheet})]
    assert sheets
    assert not [url for url in sheets if url.startswith("http")]


@pytest.mark.usefixtures("orders")
@pytest.mark.parametrize("is_narrow", [False, True])
def test_a_sheet_of_controls_has_the_picture_move_up_on_a_phone_alone(
    is_narrow: bool,
) -> None:
    page = Page(PageState(default_settings("fault"), is_narrow=is_narrow))
    page.template.sidebar_open = True
    assert ("with-sheet" in page._live.view.css_classes) == is_narrow
    page.template.sidebar_open = False
    assert "with-sheet" not in page._live.view.css_classes


@pytest.mark.usefixtures("orders")
def test_a_header_has_its_list_of_buttons_once_a_window_is_narrow() -> None:
    page = Page(PageState(default_settings("bar")))
    header = page._header()
    others = list(header)
    for is_narrow in (True, False, True):
        page.state.is_narrow = is_narrow
        (listed,) = header.select(pmui.MenuButton)
        assert [each for each in header if each is not listed] == others
    titles = [item["label"] for item in listed.items]
    assert titles == [each.description for each in header.select(pmui.IconButton)][1:]
    phone = Page(PageState(default_settings("bar"), is_narrow=True))
    assert len(phone._header().select(pmui.MenuButton)) == 1
    assert not any(isinstance(each, pmui.MenuButton) for each in others)


def test_components_share_the_definitions_of_their_looks_and_not_their_looks() -> None:
    share_looks()
    first = pmui.Button()
    second = pmui.Button(sx={"opacity": 1.0})
    first.sx = {"opacity": 0.5}
    assert first.param["sx"] is second.param["sx"]
    assert second.sx == {"opacity": 1.0}
    assert pmui.Button().sx is None
