"""Private parts of Panel and Bokeh that the page touches are there, and do what they are for."""

from __future__ import annotations

import asyncio
import inspect
import threading
from functools import partial
from operator import setitem
from types import SimpleNamespace
from typing import Any

import panel as pn
import panel_material_ui as pmui
import pytest
from bokeh.application.application import Application
from bokeh.application.handlers.function import FunctionHandler
from bokeh.core.types import ID
from bokeh.document import Document
from bokeh.server import session as bokeh_session
from bokeh.server.connection import ServerConnection
from bokeh.server.contexts import ApplicationContext
from bokeh.server.protocol_handler import ProtocolHandler
from bokeh.server.session import ServerSession
from bokeh.server.tornado import BokehTornado
from panel.io.server import DocHandler
from panel.models.esm import DataEvent, ESMEvent
from panel.util import edit_readonly
from tornado.websocket import WebSocketHandler
from web_pages import run_apart

from app.components.innards import (
    MADE_ON_A_THREAD,
    THREADS,
    answer_heads,
    ignore_business,
    ignore_the_lost,
    let_come_back,
    open_in_turn,
    stay_on_loop,
)
from app.components.pulse import pulse
from app.views.catalogue import VIEWS
from app.views.drawing.figures import make_figure


def test_sockets_can_be_told_to_send_at_once() -> None:
    assert "_subscribed_connections" in inspect.getsource(ServerSession)
    assert hasattr(WebSocketHandler, "set_nodelay")


def test_a_busy_server_changes_nothing_on_the_page() -> None:
    page = pmui.Page()
    ignore_business(page)
    changes: list[object] = []
    page.param.watch(changes.append, "busy")
    with edit_readonly(pn.state):
        pn.state.busy = True
        pn.state.busy = False
    assert not changes


def test_a_page_may_come_back_for_as_long_as_the_server_says_and_no_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = BokehTornado.session_token_expiration
    monkeypatch.setattr(BokehTornado, "session_token_expiration", told)
    let_come_back(100)
    server = BokehTornado({}, session_token_expiration=1)
    assert server.session_token_expiration == 100
    let_come_back(10)
    assert server.session_token_expiration == 100
    assert BokehTornado({}, session_token_expiration=300).session_token_expiration == 300


def test_pages_are_opened_one_after_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    assert inspect.iscoroutinefunction(inspect.unwrap(DocHandler.get))
    said: list[str] = []

    async def get(name: str) -> None:
        said.append(f"{name} begins")
        await asyncio.sleep(0)
        said.append(f"{name} ends")

    async def both() -> None:
        monkeypatch.setattr(DocHandler, "get", get)
        open_in_turn()
        await asyncio.gather(DocHandler.get("one"), DocHandler.get("two"))

    run_apart(both())
    assert said == ["one begins", "one ends", "two begins", "two ends"]


def test_pages_are_served_on_the_loops_own_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    for place, name in (bokeh_session, THREADS), (ApplicationContext, MADE_ON_A_THREAD):
        if hasattr(place, name):
            monkeypatch.setattr(place, name, getattr(place, name))
    makers = []

    async def serve() -> None:
        stay_on_loop()
        session: Any = ServerSession("page", Document(), asyncio.get_running_loop())
        assert await session.with_document_locked(threading.get_ident) == threading.get_ident()
        page = Application(FunctionHandler(lambda _: makers.append(threading.get_ident())))
        await ApplicationContext(page).create_session_if_needed(ID("page"))
        assert makers == [threading.get_ident()]

    run_apart(serve())


def test_messages_of_a_page_that_was_given_up_are_left(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "self._session = None" in inspect.getsource(ServerConnection.detach_session)

    async def handle(handler: ProtocolHandler, message: str, connection: Any) -> str:
        return message

    monkeypatch.setattr(ProtocolHandler, "handle", handle)
    ignore_the_lost()
    for there, heeded in (object(), "picture"), (None, None):
        work = ProtocolHandler().handle("picture", SimpleNamespace(_session=there))
        assert run_apart(work) == heeded


def test_a_page_is_known_where_it_is_open(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(DocHandler, "head", DocHandler.head)
    answer_heads({"mine"}.__contains__)

    def asked(**given: str) -> int:
        found = [200]
        handler: Any = SimpleNamespace(
            get_argument=given.get, set_status=partial(setitem, found, 0)
        )
        run_apart(DocHandler.head(handler))
        return found[0]

    assert [asked(), asked(page="mine"), asked(page="another's")] == [200, 200, 410]


def test_tags_of_a_pane_are_those_of_its_model() -> None:
    assert pn.pane.HTML("", tags=["status"]).get_root().tags == ["status"]


def test_pictures_are_messages_and_so_is_that_they_are_painted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made, sent, told = pulse(), [], []
    made.on("painted", told.append)
    monkeypatch.setattr(made, "_send_event", lambda kind, data: sent.append((kind, data)))
    made.paint(7, b"1234")
    assert sent == [(ESMEvent, [7, b"1234"])]
    for page in (pulse().page, made.page):
        for kind in ("beat", "painted"):
            made._process_event(DataEvent(made.get_root(), [kind, page, 7]))
    assert told == [7]


def test_what_a_picture_sets_has_its_name_in_the_figure() -> None:
    for view in VIEWS:
        made = make_figure(view)
        names = {model.name for model in made.references() if model.name}
        expected = {"x", "y", "title"} | {marks.kind for marks in view.plot.marks}
        expected |= {"bodies", "box"} if view.plot.equal else {"curves"}
        expected |= {"colors", "color-bar"} if view.plot.scale else set()
        assert {f"{view.slug}.{name}" for name in expected} <= names
