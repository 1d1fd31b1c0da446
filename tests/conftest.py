"""What tests of several files hold: a served page and a browser, a pool, worker processes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing

import pytest
from browser import Server, browser
from playwright.sync_api import BrowserContext, Page
from pool_sessions import Session
from worker_line import Line

from app.worker.pool import Pool

IGNORED = ("Failed to load resource", "favicon")
OURS = re.compile(r'File ".*/(app|solver)/')
"""In a traceback; a page that is closed leaves those of the web server."""


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    made = Server(tmp_path_factory.mktemp("server") / "log")
    made.wait()
    yield made
    made.stop()


@pytest.fixture(scope="session")
def chrome() -> Iterator[BrowserContext]:
    """Give one browser, which keeps what every page of the server loads alike."""
    with browser() as opened, closing(opened.new_context()) as context:
        yield context


@pytest.fixture
def open_page(server: Server, chrome: BrowserContext) -> Iterator[Callable[..., Page]]:
    """Open pages; neither they nor the server may complain meanwhile."""
    pages: list[Page] = []
    complaints: list[str] = []
    told_before = len(server.log)

    def visit(query: str = "", width: int = 1280, height: int = 720) -> Page:
        page = chrome.new_page()
        pages.append(page)
        page.set_viewport_size({"width": width, "height": height})
        page.on(
            "console",
            lambda message: (
                complaints.append(message.text)
                if message.type == "error" and not message.text.startswith(IGNORED)
                else None
            ),
        )
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(server.address + query)
        return page

    yield visit
    for page in pages:
        page.close()
    assert complaints == []
    assert not OURS.search(server.log[told_before:])


@pytest.fixture
def pool() -> Iterator[Pool]:
    with closing(Pool(2)) as opened:
        yield opened


@pytest.fixture
def session(pool: Pool) -> Session:
    return Session(pool)


@pytest.fixture
def lines() -> Iterator[list[Line]]:
    """Give two worker processes."""
    with ExitStack() as stack:
        yield [stack.enter_context(closing(Line())) for _ in range(2)]


@pytest.fixture
def line() -> Iterator[Line]:
    with closing(Line()) as opened:
        yield opened
