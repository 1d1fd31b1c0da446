"""Pages without a browser: websockets that say *painted* at once, and press a button.

A browser takes a core for each page; of these a machine has room for a class.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import re
import threading
import time
from collections.abc import Iterator
from typing import Any

from processes import PATIENCE
from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import (
    WebSocketClientConnection,
    WebSocketClosedError,
    websocket_connect,
)

PATIENT = {"connect_timeout": 600.0, "request_timeout": 600.0}
READY = {
    "kind": "MessageSent",
    "msg_type": "bokeh_event",
    "msg_data": {
        "type": "event",
        "name": "document_ready",
        "values": {"type": "map", "entries": []},
    },
}


async def connected(address: str) -> tuple[str, WebSocketClientConnection]:
    """HTML of a page, and a websocket to its session."""
    client = AsyncHTTPClient(force_instance=True)
    answer = await client.fetch(address, **PATIENT)
    html = answer.body.decode()
    token = re.search(r'"token":\s*"([^"]+)"', html)
    assert token is not None
    place = address.partition("?")[0].replace("http", "ws") + "/ws"
    headers = {"Sec-WebSocket-Protocol": f"bokeh, {token[1]}"}
    request = HTTPRequest(place, headers=headers, **PATIENT)
    return html, await websocket_connect(request)


class Visitor:
    """A page as a browser has it, but for what is seen of it.

    Attributes
    ----------
    pictures
        When each came.
    button
        Id of the newest button with the label; None before there is one.
    """

    def __init__(self, label: str = "") -> None:
        self.pictures: list[float] = []
        self.button: str | None = None
        self._label = f'"label":{json.dumps(label)}'
        self._socket: WebSocketClientConnection
        self._pulse: str | None = None
        self._count = 0
        self._whole = asyncio.Lock()

    async def open(self, address: str) -> None:
        """Open a page, and go on saying what is painted."""
        _, self._socket = await connected(address)
        # What is to be said to a page that was closed meanwhile is not.
        with contextlib.suppress(WebSocketClosedError):
            while True:
                await self._take(json.loads(await self._read()))

    def close(self) -> None:
        """Close it."""
        self._socket.close()

    async def press(self) -> None:
        """Press the button with the label."""
        values = [["model", {"id": self.button}], ["node", "click"], ["data", None]]
        event = {
            "type": "event",
            "name": "dom_event",
            "values": {"type": "map", "entries": values},
        }
        pressed = {"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": event}
        await self._send("PATCH-DOC", {"events": [pressed]})

    async def _take(self, header: dict[str, Any]) -> None:
        """Read a message whose header has come, and answer it."""
        await self._read()
        content = str(await self._read())
        for _ in range(2 * header.get("num_buffers", 0)):
            await self._read()
        self._look_for_button(content)
        if header["msgtype"] == "ACK":
            await self._send("PULL-DOC-REQ", {})
        elif header["msgtype"] == "PULL-DOC-REPLY":
            found = re.search(
                r'"app.display.Pulse","id":"(\w+)"', content.replace(" ", "")
            )
            assert found is not None
            self._pulse = found[1]
            await self._send("PATCH-DOC", {"events": [READY]})
            await self._paint(content, r'"sent":(\d+)')
        elif self._pulse is not None:
            await self._paint(content, rf'"{self._pulse}"}},"attr":"sent","new":(\d+)')

    async def _read(self) -> str | bytes:
        """Read a part of a message.

        A socket says once that it is closed, be it amidst a message, and whoever reads
        on would wait for ever.
        """
        part = await self._socket.read_message()
        if part is None:
            raise WebSocketClosedError
        return part

    def _look_for_button(self, content: str) -> None:
        before, found, _ = content.rpartition(self._label)
        if found:
            self.button = re.findall(r'ReactComponent","id":"(\w+)"', before)[-1]

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
        # What is pressed while a picture is answered would come between its parts
        async with self._whole:
            for part in (header, {}, content):
                await self._socket.write_message(json.dumps(part))


class Crowd:
    """Visitors in a thread of their own, beside a browser that a test waits for."""

    def __init__(self, address: str, number: int, label: str) -> None:
        self.visitors = [Visitor(label) for _ in range(number)]
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever)
        self._thread.start()
        self._pages = [self._begin(visitor.open(address)) for visitor in self.visitors]

    def wait(self) -> None:
        """Wait until all have the button."""
        end = time.monotonic() + PATIENCE
        while not all(visitor.button for visitor in self.visitors):
            assert time.monotonic() < end, "not all visitors have the button"
            time.sleep(0.05)

    def press(self, at: float) -> None:
        """Have all press it at a time of the clock, s since the epoch."""
        for visitor in self.visitors:
            self._begin(_press_at(visitor, at))

    def leave(self) -> None:
        """Close all pages."""
        for visitor in self.visitors:
            self._loop.call_soon_threadsafe(visitor.close)
        for page in self._pages:
            page.result(PATIENCE)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(PATIENCE)
        self._loop.close()

    def _begin(self, task: Any) -> Any:
        return asyncio.run_coroutine_threadsafe(task, self._loop)


async def _press_at(visitor: Visitor, at: float) -> None:
    await asyncio.sleep(at - time.time())
    await visitor.press()


@contextlib.contextmanager
def crowd(address: str, number: int, label: str) -> Iterator[Crowd]:
    """Visitors of an address that may press a button, and leave in any case."""
    made = Crowd(address, number, label)
    try:
        yield made
    finally:
        made.leave()
