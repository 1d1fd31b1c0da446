"""Measure a server with many pages: `python tests/benchmarks/measure_class.py [PAGES]
[--waves N]`.

Serves the page and opens all pages, thirty without a number, at once: websockets that
say *painted* at once, as browsers of thirty machines do, for which these two cores are
too few. Prints when the first picture of the last page came, how many pictures a second
each got at 20 iterations a second and of searches without an end in 3 s, the memory of
a worker, and what is left once all are closed.

With waves all pages are opened and closed so many times, and the memory of the server
after each is printed. What counts is how much each wave adds from the second on: memory
that was once taken is kept for what comes next.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import re
import sys
import tempfile
import time
from pathlib import Path
from typing import Any
from urllib.parse import quote

from measure_page import ANSWER, ENDLESS
from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import (
    WebSocketClientConnection,
    WebSocketClosedError,
    websocket_connect,
)

# What tests share, too
sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))
from browser import Server, serving

PACES = {"20 a second": ENDLESS, "whole in 3 s": ENDLESS.rpartition("&pace")[0]}
SECONDS = 20.0
PATIENT = {"connect_timeout": 600.0, "request_timeout": 600.0}
LEAVING = 50.0
"""Seconds in which the server ends what belongs to closed pages."""
READY = {
    "kind": "MessageSent",
    "msg_type": "bokeh_event",
    "msg_data": {
        "type": "event",
        "name": "document_ready",
        "values": {"type": "map", "entries": []},
    },
}


class Visitor:
    """A page as a browser has it, but for what is seen of it.

    Attributes
    ----------
    pictures
        When each came.
    """

    def __init__(self) -> None:
        self.pictures: list[float] = []
        self._count = 0

    async def open(self, address: str) -> None:
        """Open a page, and go on saying what is painted."""
        client = AsyncHTTPClient(force_instance=True)
        answer = await client.fetch(address, **PATIENT)
        token = re.search(r'"token":\s*"([^"]+)"', answer.body.decode())
        assert token is not None
        place = address.partition("?")[0].replace("http", "ws") + "/ws"
        headers = {"Sec-WebSocket-Protocol": f"bokeh, {token[1]}"}
        request = HTTPRequest(place, headers=headers, **PATIENT)
        self._socket: WebSocketClientConnection = await websocket_connect(request)
        self._pulse: str | None = None
        # What is to be said to a page that was closed meanwhile is not.
        with contextlib.suppress(WebSocketClosedError):
            while (header := await self._socket.read_message()) is not None:
                await self._take(json.loads(header))

    def close(self) -> None:
        """Close it."""
        self._socket.close()

    async def _take(self, header: dict[str, Any]) -> None:
        """Read a message whose header has come, and answer it."""
        await self._socket.read_message()
        content = str(await self._socket.read_message())
        for _ in range(2 * header.get("num_buffers", 0)):
            await self._socket.read_message()
        if header["msgtype"] == "ACK":
            await self._send("PULL-DOC-REQ", {})
        elif header["msgtype"] == "PULL-DOC-REPLY":
            found = re.search(
                r'"app.browser.Pulse","id":"(\w+)"', content.replace(" ", "")
            )
            assert found is not None
            self._pulse = found[1]
            await self._send("PATCH-DOC", {"events": [READY]})
            await self._paint(content, r'"sent":(\d+)')
        elif self._pulse is not None:
            await self._paint(content, rf'"{self._pulse}"}},"attr":"sent","new":(\d+)')

    async def _paint(self, content: str, pattern: str) -> None:
        if numbers := re.findall(pattern, content.replace(" ", "")):
            self.pictures.append(time.perf_counter())
            change = {
                "kind": "ModelChanged",
                "model": {"id": self._pulse},
                "attr": "painted",
                "new": int(numbers[-1]),
            }
            await self._send("PATCH-DOC", {"events": [change]})

    async def _send(self, kind: str, content: dict[str, Any]) -> None:
        self._count += 1
        header = {"msgid": f"{id(self)}-{self._count}", "msgtype": kind}
        for part in (header, {}, content):
            await self._socket.write_message(json.dumps(part))


async def measure(server: Server, number: int) -> None:
    idle = len(server.processes())
    for pace, query in PACES.items():
        began = time.perf_counter()
        visitors, tasks = await opened(server, number, query)
        last = max(visitor.pictures[0] for visitor in visitors) - began
        print(f"{pace}: the last opens after {last:.1f} s")
        before = [len(visitor.pictures) for visitor in visitors]
        began = time.perf_counter()
        await asyncio.sleep(SECONDS)
        got = [len(v.pictures) - old for v, old in zip(visitors, before, strict=True)]
        rate = sum(got) / number / (time.perf_counter() - began)
        print(
            f"{pace}: {rate:.1f} pictures a second and page; {memory(server):.0f} MB "
            "a worker"
        )
        await close(visitors, tasks)
        print(f"{pace}: {len(server.processes()) - idle} processes left")


async def measure_waves(server: Server, number: int, waves: int) -> None:
    """Print what the server keeps of pages that were opened and closed repeatedly."""
    idle = len(server.processes())
    before = resident(server)
    print(f"at first: {before:.0f} MB")
    for wave in range(1, waves + 1):
        await close(*await opened(server, number, ANSWER))
        kept = resident(server)
        left = len(server.processes()) - idle
        each = (kept - before) / number
        print(
            f"wave {wave}: {kept:.0f} MB, {each:.2f} MB more a page; {left} processes "
            "left"
        )
        before = kept


async def opened(
    server: Server, number: int, query: str
) -> tuple[list[Visitor], list[asyncio.Task[None]]]:
    """Open pages, all at once, until each has a picture."""
    visitors = [Visitor() for _ in range(number)]
    address = f"{server.address}?{quote(query, safe='=&%')}"
    tasks = [asyncio.create_task(visitor.open(address)) for visitor in visitors]
    while not all(visitor.pictures for visitor in visitors):
        await asyncio.sleep(0.1)
        for task in tasks:
            if task.done():
                await task
    return visitors, tasks


async def close(visitors: list[Visitor], tasks: list[asyncio.Task[None]]) -> None:
    """Close pages, and wait until the server has let go of them."""
    for visitor in visitors:
        visitor.close()
    with contextlib.suppress(TimeoutError):
        await asyncio.wait_for(asyncio.gather(*tasks, return_exceptions=True), 5.0)
    await asyncio.sleep(LEAVING)


def resident(server: Server) -> float:
    """Memory that the server's own process holds, MB."""
    lines = Path(f"/proc/{server.pid}/status").read_text().splitlines()
    return (
        int(next(line for line in lines if line.startswith("VmRSS:")).split()[1]) / 1e3
    )


def memory(server: Server) -> float:
    """Share of the memory that a worker has, MB, the median of all."""
    shares = []
    for pid in server.processes()[1:]:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        shares.append(
            int(next(line for line in lines if line.startswith("Pss:")).split()[1])
        )
    return sorted(shares)[len(shares) // 2] / 1e3


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure a server with many pages.")
    parser.add_argument("pages", type=int, nargs="?", default=30)
    parser.add_argument("--waves", type=int, default=0)
    chosen = parser.parse_args()
    quick = ("--unused-session-lifetime", "30000", "--check-unused-sessions", "1000")
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(Path(folder) / "log", 0, *quick) as made,
    ):
        if chosen.waves:
            asyncio.run(measure_waves(made, chosen.pages, chosen.waves))
        else:
            asyncio.run(measure(made, chosen.pages))
