"""A served page and a browser, shared by the tests of a module."""

import pytest
from browser import Server, browser
from playwright.sync_api import Page

IGNORED = ("Failed to load resource", "favicon")


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    made = Server(tmp_path_factory.mktemp("server") / "log")
    made.wait()
    yield made
    made.stop()


@pytest.fixture(scope="module")
def chrome():
    with browser() as opened:
        yield opened


@pytest.fixture
def open_page(server, chrome):
    pages, complaints = [], []

    def visit(query: str = "", width: int = 1280, height: int = 720) -> Page:
        page = chrome.new_page(viewport={"width": width, "height": height})
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
        pages.append(page)
        return page

    yield visit
    for page in pages:
        page.close()
    assert complaints == []
