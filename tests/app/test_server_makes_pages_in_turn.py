"""A server that makes many pages at once answers others between them."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from itertools import groupby

import pytest
from bokeh.application import Application
from bokeh.application.handlers import FunctionHandler
from bokeh.document import Document
from bokeh.server.server import Server
from bokeh.server.urls import per_app_patterns
from coroutines import awaited
from tornado.httpclient import AsyncHTTPClient
from tornado.httpserver import HTTPServer

from app.server import configure

PAGES = 5


@pytest.fixture
def configured() -> Iterator[None]:
    """Servers of this process as `panel serve app` has them."""
    patterns = list(per_app_patterns)
    configure()
    yield
    per_app_patterns[:] = patterns
    HTTPServer.configure(None)


async def events_of_opening() -> list[str]:
    """Pages that are made, and rounds of the event loop, in their order."""
    events: list[str] = []

    def make(document: Document) -> None:
        events.append("page")

    server = Server({"/": Application(FunctionHandler(make))}, port=0)
    server.start()
    client = AsyncHTTPClient(force_instance=True)
    address = f"http://localhost:{server.port}/"
    requests = [client.fetch(address) for _ in range(PAGES)]
    opened = asyncio.gather(*requests)
    while not opened.done():
        events.append("round")
        await asyncio.sleep(0)
    server.stop()
    return events


@pytest.mark.usefixtures("configured")
def test_of_pages_that_are_asked_for_together_each_is_made_after_others_had_turns() -> (
    None
):
    groups = groupby(awaited(events_of_opening()))
    rounds = {name: [] for name in ("page", "round")}
    for name, events in groups:
        rounds[name].append(len(list(events)))
    assert rounds["page"] == [1] * PAGES
    # One to accept a connection, one to read it, one to answer.
    assert min(rounds["round"][1:]) >= 3
