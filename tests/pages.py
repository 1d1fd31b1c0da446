"""Pages as tests open them, and what is found there."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from browser import Chrome, Server
from playwright.sync_api import ConsoleMessage, Error, Locator, Page, expect

ENDLESS = "method=paper&max_iterations=100000&tolerance=1e-30&pace=5"
"""In an address: a run that goes on, no faster than it takes to see that it does."""
POLL_MS = 100.0
IGNORED = ("Failed to load resource", "favicon")
OURS = re.compile(r'File ".*/(app|solver)/')
"""In a traceback; a page that is closed leaves those of the web server."""
REPORTS = {
    "Study": "Every form of LATIN and the incremental solver",
    "Stability": "Stiff and extreme cases of every scene",
    "Proof": "Closed forms, published numbers",
}
"""What stands on the tabs that have a button to start."""
Visit = Callable[..., Page]


@contextmanager
def visits(server: Server, chrome: Chrome) -> Iterator[Visit]:
    """Open pages, and close them; neither they nor the server may complain meanwhile."""
    pages: list[Page] = []
    complaints: list[str] = []
    said_before = len(server.log)

    def hear(message: ConsoleMessage) -> None:
        if message.type == "error" and not message.text.startswith(IGNORED):
            complaints.append(message.text)

    def stumble(error: Error) -> None:
        complaints.append(error.stack or str(error))

    def visit(query: str = "", width: int = 1280, height: int = 720, **device: Any) -> Page:
        page = chrome.new_page(width, height, **device)
        page.on("console", hear)
        page.on("pageerror", stumble)
        pages.append(page)
        page.goto(server.address + query)
        return page

    yield visit
    for page in pages:
        page.remove_listener("console", hear)
        page.remove_listener("pageerror", stumble)
        chrome.leave(page)
    assert not complaints, complaints
    said = server.log[said_before:]
    assert not OURS.search(said), said


def one_page(query: str, said: str, **device: Any) -> Any:
    """Make a fixture: one page for all tests of a file, given once its status says something."""

    @pytest.fixture(scope="module", name="page")
    def opened(chrome: Chrome, server: Server) -> Iterator[Page]:
        with visits(server, chrome) as visit:
            page = visit(query, **device)
            expect(status(page)).to_contain_text(said)
            yield page

    return opened


def status(page: Page) -> Locator:
    return page.locator(".status").first


def iteration(page: Page) -> int:
    words = page.locator(".status div").first.inner_text()
    found = re.search(r"(?:iteration|after) (\d+)", words)
    assert found, words
    return int(found[1])


def slider(page: Page, name: str) -> Locator:
    return page.get_by_role("slider", name=re.compile(rf"^{name}\b"))


def card(page: Page, name: str) -> Locator:
    return page.get_by_role("figure", name=name, exact=True)


def choose(box: Locator, option: str) -> None:
    """Choose in a list of the browser's own, by the beginning of a title, or in one of Material."""
    options = box.locator("option")
    if options.count():
        titles = options.all_text_contents()
        box.select_option(label=next(title for title in titles if title.startswith(option)))
        return
    box.click()
    box.page.get_by_role("menuitem", name=option).click()


def choose_scene(page: Page, title: str) -> None:
    """Choose a scene by the beginning of its title."""
    page.get_by_role("radio", name=re.compile(rf": {re.escape(title)}")).click()


def open_sheets(page: Page) -> None:
    """Open the sheets of the sidebar: what stands in one that is closed is not to be reached."""
    closed = page.locator(".sidebar details:not([open]):visible > summary")
    for sheet in closed.element_handles():
        sheet.click()


def press(page: Page, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).locator("visible=true").click()


def open_report(page: Page, name: str) -> None:
    """Go to a tab, and wait until it alone is there: its buttons are called as those of others."""
    press(page, name)
    for tab, words in REPORTS.items():
        expect(page.get_by_text(words).first).to_be_visible(visible=tab == name)


def at_rest(page: Page, place: str) -> Any:
    """Give what an expression says of a place once that moves no more: the page is laid out."""
    before, now = None, page.evaluate(place)
    while now != before:
        page.wait_for_timeout(300)
        before, now = now, page.evaluate(place)
    return now


def comes_true(page: Page, expression: str, arg: Any = None) -> None:
    """Wait until an expression holds; to ask at every frame takes more than the page itself."""
    page.wait_for_function(expression, arg=arg, polling=POLL_MS)


def bodies_drawn(page: Page, number: str) -> None:
    """Wait until the number of quadrilaterals that the browser draws is as an expression says."""
    comes_true(
        page,
        f"""() => {{
          const documents = window.Bokeh ? Bokeh.documents : []
          const models = documents.flatMap(({{_all_models}}) => [..._all_models.values()])
          for (const {{type, data}} of models) {{
            if (type === "ColumnDataSource" && data.xs && data.value && !data.setting) {{
              return (data.xs.length && data.xs[0].length === 4 ? data.xs.length : 0) {number}
            }}
          }}
          return false
        }}""",
    )
