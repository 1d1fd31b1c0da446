"""Pages without a browser: websockets that speak Bokeh's protocol and acknowledge at once."""

from __future__ import annotations

import asyncio
import json
import re
import time
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any

import panel as pn
from bokeh.server.server import Server
from panel.io.server import get_server
from tornado.httpclient import AsyncHTTPClient
from tornado.websocket import WebSocketClientConnection, WebSocketClosedError, websocket_connect

from app.components.innards import stay_on_loop
from app.server import serve

LONGEST = 270.0
"""Seconds that what runs apart may take, less than a test may."""
READY = {"type": "event", "name": "document_ready", "values": {"type": "map"}}


def serve_pages() -> Server:
    """Serve pages from this process."""
    pn.extension(notifications=True)
    stay_on_loop()
    served: Server = get_server(
        {"/app": lambda: serve.open_page()},
        port=0,
        show=False,
        start=True,
        # Not given up by the clock: a page may be slow to connect.
        unused_session_lifetime_milliseconds=600_000,
        check_unused_sessions_milliseconds=200,
    )
    return served


def give_up_pages(server: Server) -> None:
    """Have a server give up its pages as soon as they are closed."""
    for session in server.get_sessions("/app"):
        session.request_expiration()


class WebPage:
    """A page that paints in no time.

    Attributes
    ----------
    opened
        When its first picture came, or NaN.
    times
        When pictures came.
    size
        Bytes that came with them.
    code
        Of the class that it leads, once it does.
    items, shown
        What the controls of its settings are, and what they show, as `Form` has it.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._socket: WebSocketClientConnection | None = None
        self._pulse = self._pulse_data = self._page = self._token = ""
        self._actions = self._form = self._form_data = ""
        self._count = self._told = 0
        self._writes = asyncio.Lock()
        self._text = 0
        self.began = time.monotonic()
        self.times: list[float] = []
        self.size = 0
        self.code = ""
        self.items: list[dict[str, Any]] = []
        self.shown: dict[str, Any] = {}

    async def open(self) -> None:
        """Ask for the page, connect, and say that it is built."""
        self.began = time.monotonic()
        # One of its own: of a shared one only ten requests are sent at a time.
        client = AsyncHTTPClient(force_instance=True)
        answer = await client.fetch(self._address, connect_timeout=120, request_timeout=120)
        found = re.search(r'"token":\s*"([^"]+)"', answer.body.decode())
        assert found, "no page"
        self._token = found[1]
        await self.connect()
        await self._send("PULL-DOC-REQ", {})
        while not self._pulse:
            kind, content = await self._message()
            if kind == "PULL-DOC-REPLY":
                self._pulse, self._pulse_data, data = _component(content, "Pulse")
                self._page = data["page"]
                self._actions, _, _ = _component(content, "ActionBar")
                self._form, self._form_data, data = _component(content, "Form")
                self._show(data)
        await self._patch({"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": READY})

    async def connect(self) -> None:
        """Connect, for the first time or again."""
        socket = re.sub("^http", "ws", self._address.partition("?")[0]) + "/ws"
        self._socket = await websocket_connect(
            socket, subprotocols=["bokeh", self._token], max_message_size=2**28
        )
        await self._message()

    async def live(self) -> None:
        """Acknowledge pictures until the page is closed."""
        with suppress(WebSocketClosedError):
            while True:
                kind, content = await self._message()
                for event in content.get("events", ()) if kind == "PATCH-DOC" else ():
                    model = event.get("model", {}).get("id")
                    if led := re.search(r"\?class=(\w+)", str(event.get("new", ""))):
                        self.code = led[1]
                    if model == self._form_data:
                        self._show({event["attr"]: event["new"]})
                    if event["kind"] == "MessageSent" and (number := self._number(event)):
                        self.times.append(time.monotonic())
                        await self._tell(self._pulse, ["painted", self._page, number])

    async def set(self, name: str, value: Any) -> None:
        """Set a parameter of its pulse."""
        model = {"id": self._pulse_data}
        await self._patch({"kind": "ModelChanged", "model": model, "attr": name, "new": value})

    async def move(self, name: str, value: Any, *, hand: bool = False) -> None:
        """Have the control of a setting say that it was moved."""
        self._told += 1
        data = {"name": name, "value": value, "hand": hand, "count": self._told}
        await self._tell(self._form, _mapped(data))

    async def lead(self) -> None:
        """Start a class."""
        await self._tell(self._actions, _mapped({"kind": "class", "value": ""}))

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close()

    async def _tell(self, model: str, data: Any) -> None:
        """Send a message of a component."""
        values = _mapped({"model": {"id": model}, "data": data})
        event = {"type": "event", "name": "data_event", "values": values}
        await self._patch({"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": event})

    def _number(self, event: Any) -> int:
        """Give the number of the picture that a message brings, or 0."""
        sent = dict(event["msg_data"]["values"]["entries"])
        return int(sent["data"][0]) if sent["model"]["id"] == self._pulse else 0

    def _show(self, data: dict[str, Any]) -> None:
        if "items" in data:
            self.items = _plain(data["items"])
        if "shown" in data:
            self.shown = _plain(data["shown"])

    async def _patch(self, event: dict[str, Any]) -> None:
        await self._send("PATCH-DOC", {"events": [event]})

    async def _send(self, kind: str, content: dict[str, Any]) -> None:
        self._count += 1
        header = {"msgid": str(self._count), "msgtype": kind}
        assert self._socket is not None
        # One message after the other: each is of three parts.
        async with self._writes:
            for part in (header, {}, content):
                await self._socket.write_message(json.dumps(part))

    async def _message(self) -> tuple[str, dict[str, Any]]:
        """Give kind and content of the next message."""
        parts = json.loads(await self._part())
        await self._part()
        content = await self._part()
        for _ in range(2 * parts.get("num_buffers", 0)):
            await self._part()
        return parts["msgtype"], json.loads(content)

    async def _part(self) -> str | bytes:
        assert self._socket is not None
        part = await self._socket.read_message()
        # Told once only: whoever reads on, in the midst of a message, waits for ever.
        if part is None:
            raise WebSocketClosedError
        self.size += len(part)
        return part


def _component(content: Any, name: str) -> tuple[str, str, dict[str, Any]]:
    """Find a component: its model, the model of its parameters, and these."""
    if isinstance(content, dict):
        made = content.get("attributes")
        if isinstance(made, dict) and made.get("class_name") == name:
            return content["id"], made["data"]["id"], made["data"].get("attributes", {})
        content = list(content.values())
    found = (_component(one, name) for one in content) if isinstance(content, list) else ()
    return next((one for one in found if one[0]), ("", "", {}))


def _mapped(values: dict[str, Any]) -> dict[str, Any]:
    return {"type": "map", "entries": list(values.items())}


def _plain(content: Any) -> Any:
    """Give what Bokeh has written as maps as dictionaries."""
    if isinstance(content, list):
        return [_plain(one) for one in content]
    if isinstance(content, dict) and content.get("type") == "map":
        return {name: _plain(value) for name, value in content.get("entries", ())}
    return content


def run_apart(main: Coroutine[Any, Any, Any]) -> Any:
    """Run in a thread of its own: that of the browser's tests has a loop at work.

    No limit of a test ends a thread, so that it has to be given up here before.
    """
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, asyncio.wait_for(main, LONGEST)).result()


async def until(condition: Any, patience: float = 120.0) -> None:
    """Wait until something is so."""
    end = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < end
        await asyncio.sleep(0.02)
