"""Of pages that were closed the server keeps nothing: no page, no document, no process."""

from __future__ import annotations

import asyncio
import gc
import logging

import pytest
from bokeh.document import Document
from bokeh.server.server import Server
from web_pages import WebPage, give_up_pages, run_apart, serve_pages, until

from app.server import serve
from app.session.session import Session
from app.shell.dashboard import Dashboard

WAVES, PAGES = 2, 2
KEPT_FOR = 30.0
"""Seconds after which what is left of a closed page is kept."""


def alive() -> dict[str, int]:
    """Count what there is of pages after a full collection."""
    gc.collect()
    kinds = (Dashboard, Session, Document)
    found = gc.get_objects()
    return {kind.__name__: sum(isinstance(one, kind) for one in found) for kind in kinds}


async def visit(server: Server, address: str) -> None:
    pages = [WebPage(address) for _ in range(PAGES)]
    lives = []
    for page in pages:
        await page.open()
        lives.append(asyncio.create_task(page.live()))
    await until(lambda: all(len(page.times) > 1 for page in pages))
    for page in pages:
        page.close()
    await asyncio.gather(*lives)
    give_up_pages(server)
    await until(lambda: not server.get_sessions("/app"))
    await until(lambda: len(serve.PAGES) == 0)


# Panel hands its download button both names of one parameter.
@pytest.mark.filterwarnings("ignore")
def test_waves_of_pages_leave_nothing(caplog: pytest.LogCaptureFixture) -> None:
    # What pytest keeps of a log has the messages of pages, and with them their models.
    caplog.set_level(logging.INFO, "panel")

    async def waves() -> list[dict[str, int]]:
        server = serve_pages()
        counts = []
        for _ in range(WAVES):
            await visit(server, f"http://localhost:{server.port}/app")
            # A task of Panel's own, which begins with the first page, has this one in its context.
            await until(lambda: alive()["Dashboard"] <= 1, KEPT_FOR)
            counts.append(alive())
        server.stop()
        return counts

    first, *_, last = run_apart(waves())
    assert last["Session"] <= 1
    assert all(last[kind] <= first[kind] for kind in last)
