"""Pages that stay open from one journey to the next: one at a desk, and a phone."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import closing
from urllib.parse import quote

import pytest
from browser import Chrome, Server
from markup import MARKUP
from pages import ANSWER, PHONE, Desk
from playwright.sync_api import Page
from proxy import Proxy

PLACES = (
    "class",
    "scene",
    "lesson",
    "case",
    "tab",
    "question",
    "plots",
    "file",
    "displacement",
    MARKUP,
)
"""Parts of an address that a text may be given for."""
FAILED = pytest.StashKey[bool]()
"""Key of whether a part of a test has failed."""


@pytest.fixture(scope="package")
def desk(server: Server, chrome: Chrome, proxy: Proxy) -> Iterator[Desk]:
    """Desk of the journeys, with its page, which comes over a network.

    Left open beside all other tests, the page would take time from them.
    """
    root = f"http://localhost:{proxy.port}"
    with closing(Desk(server, chrome, root=root)) as made:
        yield made


@pytest.fixture(scope="package")
def stranger(chrome: Chrome, server: Server) -> Iterator[Desk]:
    """A page on a phone in the dark that is opened by a foolish address, once.

    The journey that needs no page any more after it closes it.
    """
    text = quote(MARKUP, safe="")
    said = "&".join(f"{quote(place, safe='')}={text}" for place in PLACES)
    query = f"?friction=-1&moon=3&{ANSWER}&theme=dark&{said}"
    with closing(Desk(server, chrome, query, **PHONE)) as made:
        yield made


@pytest.fixture
def page(request: pytest.FixtureRequest, desk: Desk) -> Iterator[Page]:
    """The page that stays open."""
    yield desk.page()
    _look_back(request, desk)


@pytest.fixture
def new_page(request: pytest.FixtureRequest, desk: Desk) -> Iterator[Page]:
    """A page that has just been opened, and stays open for the journeys after."""
    yield desk.anew()
    if FAILED not in request.node.stash:
        desk.arrive()
    _look_back(request, desk)


def _look_back(request: pytest.FixtureRequest, desk: Desk) -> None:
    """Close a page on which a journey has failed, or which has complained."""
    if FAILED in request.node.stash:
        desk.close()
    else:
        desk.check()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.failed:
        item.stash[FAILED] = True
    return report
