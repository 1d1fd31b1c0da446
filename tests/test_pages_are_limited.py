"""A server opens no more pages than it can serve, and says so to the others."""

from __future__ import annotations

from typing import Any

import panel as pn
import pytest
from bokeh.document import Document
from lone_link import LoneLink
from panel.io.state import set_curdoc

from app.server import serve
from app.session import pages
from app.session.pages import Pages, most_pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from solver.scenes.bar import BarSettings


def test_a_page_counts_until_it_is_closed() -> None:
    found = Pages(1)
    session = Session(found, ReportExecutor(), BarSettings.checked({}), LoneLink().hire)
    assert found.is_full
    session.close()
    assert not found.is_full
    assert len(found) == 0


def test_the_limit_is_set_or_follows_from_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(pages.VARIABLE, "7")
    assert most_pages() == 7
    monkeypatch.delenv(pages.VARIABLE)
    monkeypatch.setattr(pages, "_memory", lambda: 3e9)
    assert most_pages() == 16
    monkeypatch.setattr(pages, "_memory", lambda: 1e6)
    assert most_pages() == 1


def test_a_page_too_many_is_told_and_tries_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serve, "PAGES", Pages(0))
    with set_curdoc(Document()):
        page: Any = serve.open_page()
        words = page.main[0].object
    assert isinstance(page, pn.viewable.Viewable)
    assert "full" in words
    assert "refresh" in words
