"""A worker without memory, or stuck, is told, logged and replaced; the settings are kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from functools import partial
from html import unescape
from pathlib import Path

import pytest
import sick_workers
from processes import wait_for
from unpacking import Unpacker

from app.session.page_worker import AGAIN
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.worker import link
from solver.scenes.bar import BarSettings

TOO_LARGE = 20_000


class Page:
    """A page that paints at once.

    Attributes
    ----------
    words
        All that its status line has said.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.words: list[str] = []
        self._unpack = Unpacker()
        session.start()

    def until(self, condition: Callable[[], object]) -> None:
        def is_so() -> object:
            for block in self.session.collect():
                self.words.append(self._unpack(block).get("status", {}).get("text", ""))
                self.session.ask()
            return condition()

        wait_for(is_so)


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return tmp_path / "log"


@pytest.fixture
def page(
    request: pytest.FixtureRequest, log: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Page]:
    monkeypatch.setattr(link, "start", partial(link.start, request.param, str(log)))
    settings = BarSettings.checked({"friction": 0.37})
    with closing(Session(Pages(1), ReportExecutor(), settings)) as session:
        yield Page(session)


@pytest.mark.parametrize("page", [sick_workers.hungry], indirect=True)
def test_a_run_without_memory_is_told_and_the_next_goes_on(page: Page, log: Path) -> None:
    session = page.session
    page.until(lambda: session.is_over)
    session.adopt(session.settings.replace(elements=TOO_LARGE, instants=1201))
    page.until(lambda: session.facts is not None and session.facts.asks)
    session.go()
    page.until(lambda: session.facts is not None and session.facts.is_broken)
    assert "MemoryError" in page.words[-1]
    assert "lower the numbers of elements" in page.words[-1]
    assert session.settings.changed()["friction"] == 0.37
    session.adopt(session.settings.replace(elements=100, instants=101))
    page.until(lambda: session.facts is not None and session.facts.is_over)
    assert "converged" in page.words[-1]
    assert "Traceback" in log.read_text()


@pytest.mark.parametrize("page", [sick_workers.stuck_at_first], indirect=True)
def test_a_process_that_is_stuck_is_replaced(page: Page, log: Path) -> None:
    session = page.session
    page.until(lambda: session.facts is not None and session.facts.is_over)
    assert f"<b>{AGAIN}</b>" in map(unescape, page.words)
    assert "converged" in page.words[-1]
    assert AGAIN in page.words[-1]
    assert session.settings.changed() == {"friction": 0.37}
    assert "_never_end" in log.read_text()
