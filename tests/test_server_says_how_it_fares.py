"""Whoever serves the page is told how late its event loop is, and what its pages do."""

from __future__ import annotations

import asyncio
import gc
import inspect
import logging
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.document import Document
from bokeh.server.views import ws
from lone_link import LoneLink
from panel.io import document as panel_document
from panel.io.state import set_curdoc
from tornado.websocket import WebSocketClosedError
from web_pages import run_apart

from app.server import lateness, serve
from app.server.lateness import LATE, WINDOW, Lateness
from app.session.pages import Pages
from app.session.session import Session
from app.shell.dashboard import Dashboard
from app.shell.log import NOT_SENT, leave_out_the_unsent
from app.wire.reports import Facts, Picture


def test_the_most_and_nearly_the_most_of_the_last_minute_are_told() -> None:
    found = Lateness()
    for late in [0.02] * 237 + [0.2] * 2 + [-0.001]:
        found.note(0.0, late)
    assert found.facts() == {"most": 0.2, "95%": 0.02}
    for _ in range(240):
        found.note(0.0, 0.01)
    assert found.facts() == {"most": 0.01, "95%": 0.01}


def test_lateness_is_logged_once_a_minute(caplog: pytest.LogCaptureFixture) -> None:
    found = Lateness()
    for now, late in [(0.0, 0.5 * LATE), (1.0, 0.4), (2.0, 0.9), (2.0 + WINDOW, 0.5)]:
        found.note(now, late)
    assert ["0.40 s" in one for one in caplog.messages] == [True, False]
    assert "0.50 s" in caplog.messages[1]


def test_the_loop_is_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Lateness()
    monkeypatch.setattr(lateness, "STEP", 0.0)
    noted: list[float] = []
    monkeypatch.setattr(found, "note", lambda now, late: noted.append(late))

    async def watch() -> None:
        task = asyncio.create_task(found.watch())
        while len(noted) < 3:
            await asyncio.sleep(0.0)
        task.cancel()

    run_apart(watch())
    assert min(noted) >= 0.0


def test_nothing_is_said_of_what_a_closed_socket_did_not_take(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def fail(error: Exception) -> None:
        raise error

    async def forget() -> None:
        tasks = [
            asyncio.create_task(fail(one)) for one in (WebSocketClosedError(), OSError("disk"))
        ]
        await asyncio.wait(tasks)
        tasks.clear()
        gc.collect()

    leave_out_the_unsent()
    for module in (ws, panel_document):
        assert NOT_SENT in inspect.getsource(module)
        for words in (NOT_SENT, "else"):
            logging.getLogger(module.__name__).warning(words)
    assert set(caplog.messages) == {"else"}
    caplog.clear()
    run_apart(forget())
    # What other tests have left behind may be collected meanwhile.
    said = [str(one.exc_info) for one in caplog.records if one.name == "asyncio"]
    assert [one for one in said if "disk" in one]
    assert not [one for one in said if "WebSocketClosedError" in one]


def test_events_of_a_page_are_logged(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    link = LoneLink()
    monkeypatch.setattr(serve, "PAGES", Pages(1))
    dashboards: list[Dashboard] = []

    def make(session: Session, **options: Any) -> Dashboard:
        session.worker._hire = link.hire
        dashboards.append(Dashboard(session, **options))
        return dashboards[-1]

    monkeypatch.setattr(serve, "Dashboard", make)
    caplog.set_level(logging.INFO)
    with set_curdoc(Document()) as document:
        serve.open_page()
        (page,) = dashboards
        for facts in (Facts(), Facts(), Facts(is_over=True)):
            link.say(Picture(page.session.ticket, facts, b""))
            page.hear()
        page.session.start()
        link.say(Picture(page.session.ticket, Facts(is_broken=True), b""))
        page.hear()
        serve._end(page, document, SimpleNamespace())
    events = [one.split('"')[1] for one in caplog.messages if "logged" in one]
    assert events == [
        "page opened, 1 in all",
        "run 1 of bar started",
        "run 1 of bar ended",
        "run 2 of bar broke",
        "page closed, 0 left",
    ]
