"""A page that stays open from one journey to the next."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import closing

import pytest
from browser import Chrome, Server
from pages import Desk
from playwright.sync_api import Page

FAILED = pytest.StashKey[bool]()
"""Whether a part of a test has failed."""


@pytest.fixture(scope="session")
def desk(server: Server, chrome: Chrome) -> Iterator[Desk]:
    """Where the page stays."""
    with closing(Desk(server, chrome)) as made:
        yield made


@pytest.fixture
def page(request: pytest.FixtureRequest, desk: Desk) -> Iterator[Page]:
    """The page that stays open."""
    yield desk.page()
    if FAILED in request.node.stash:
        desk.close()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.failed:
        item.stash[FAILED] = True
    return report
