"""A closed page leaves nothing in the server: no state, document or process."""

from __future__ import annotations

import asyncio
import gc
from multiprocessing import active_children
from typing import Any

from bokeh.document import Document
from browser import ROOT
from coroutines import awaited
from measure_class import Visitor
from pages import ANSWER
from panel.io.server import get_server
from processes import PATIENCE

from app.state import PageState

SMALL = f"elements=20&instants=11&{ANSWER}"
QUERIES = SMALL, f"{SMALL}&view=present", "lesson=how-fast-how-big"
LOOKS = 100
"""Looks at what is left, 0.3 s apart: on a busy machine callbacks come late."""
QUICK = {
    "unused_session_lifetime_milliseconds": 1000,
    "check_unused_sessions_milliseconds": 50,
}


def alive() -> list[Any]:
    """States and documents of pages since the last freeze, garbage included."""
    return [each for each in gc.get_objects() if isinstance(each, PageState | Document)]


async def until(condition: Any) -> None:
    """Wait until a condition holds, while the server works."""
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await asyncio.sleep(0.02)


async def open_and_close(address: str) -> None:
    """Open three pages, each until it has a picture, and close them."""
    visitors = []
    tasks = []
    for query in QUERIES:
        visitor = Visitor()
        visitors.append(visitor)
        tasks.append(asyncio.create_task(visitor.open(f"{address}?{query}")))
        await until(lambda: visitor.pictures or tasks[-1].done())  # noqa: B023
    for visitor in visitors:
        visitor.close()
    await asyncio.gather(*tasks)


async def states_left() -> list[Any]:
    """Serve the page, have it visited, and find what is left of the visitors' pages."""
    # What is there before is neither searched nor found again.
    gc.collect()
    gc.freeze()
    server = get_server({"app": str(ROOT / "app" / "main.py")}, **QUICK)
    server.start()
    workers = set(active_children())
    try:
        await open_and_close(f"http://localhost:{server.port}/app")
        await until(lambda: not server.get_sessions("/app"))
        await until(lambda: set(active_children()) <= workers)
        for _ in range(LOOKS):
            gc.collect()
            if not (left := alive()):
                break
            # A callback that was to come each second is forgotten when it comes.
            del left
            await asyncio.sleep(0.3)
        return [type(each).__name__ for each in alive()]
    finally:
        server.stop()


def test_three_pages_that_were_closed_leave_nothing_in_memory() -> None:
    assert awaited(states_left()) == []
