"""A server starts without a complaint, and ends with all the processes that it had."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import time
import urllib.request
from pathlib import Path
from typing import Any

from browser import Server
from processes import wait_for
from web_pages import WebPage, run_apart, until

SHORT = ("--unused-session-lifetime", "3000", "--check-unused-sessions", "200")
"""Options of a server that gives up a page soon after it was closed."""
AT_REST = 0.2
"""Of a processor, far above what a page takes that waits (0.01 to 0.03), and far below one that is
never idle."""


def share(server: Server, seconds: float = 1.0) -> float:
    """Give the share of a processor that a server takes for a while, its workers aside."""

    def taken() -> float:
        fields = Path(f"/proc/{server.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    before, began = taken(), time.monotonic()
    time.sleep(seconds)
    return (taken() - before) / (time.monotonic() - began)


def told(server: Server) -> dict[str, Any]:
    """Give what a server says of itself."""
    with urllib.request.urlopen(server.health) as answer:
        found: dict[str, Any] = json.load(answer)
    return found


def pages(server: Server) -> int:
    return int(told(server)["pages"])


def end_with_pages(server: Server, number: signal.Signals) -> None:
    """Interrupt a server while two pages are open; no process of it stays, and no complaint."""

    async def visit() -> None:
        pages = [WebPage(server.address) for _ in range(2)]
        for page in pages:
            await page.open()
        lives = [asyncio.create_task(page.live()) for page in pages]
        await until(lambda: all(page.times for page in pages))
        os.kill(server.pid, number)
        await asyncio.gather(*lives)
        for page in pages:
            page.close()

    assert len(server.processes()) > 1
    said_before = len(server.log)
    run_apart(visit())
    wait_for(lambda: server.processes() == [])
    for word in ("Error", "WARNING", "Traceback"):
        assert word not in server.log[said_before:], server.log


def test_a_page_at_rest_is_told_of_and_takes_next_to_nothing_and_one_asked_for_or_closed_nothing(
    tmp_path: Path,
) -> None:
    """The first page of a server, without a browser: what is done once only, is done for it."""

    async def visit() -> None:
        page = WebPage(server.address + "?iteration=2")
        await page.open()
        life = asyncio.create_task(page.live())
        await until(lambda: page.times)
        await asyncio.to_thread(until_at_rest, page)
        assert await asyncio.to_thread(share, server) < AT_REST
        facts = await asyncio.to_thread(told, server)
        assert facts["/liveness"] is True
        assert facts["pages"] == facts["workers"] == 1
        assert facts["lateness"]["most"] >= facts["lateness"]["95%"] >= 0.0
        page.close()
        await life

    def until_at_rest(page: WebPage) -> None:
        shown = -1
        while shown != len(page.times):
            shown = len(page.times)
            time.sleep(0.7)

    server = Server(tmp_path / "log", 0, *SHORT)
    try:
        server.wait()
        asked = urllib.request.Request(server.address, method="HEAD")
        with urllib.request.urlopen(asked) as answer:
            assert answer.status == 200
        assert pages(server) == 0
        run_apart(visit())
        wait_for(lambda: pages(server) == 0)
        assert share(server) < AT_REST
        end_with_pages(server, signal.SIGTERM)
    finally:
        server.stop()
