"""Pages without a browser: websockets that speak Bokeh's protocol and acknowledge at once."""

from __future__ import annotations

import asyncio
import json
import re
import time
from contextlib import suppress
from typing import Any

from tornado.httpclient import AsyncHTTPClient
from tornado.websocket import WebSocketClientConnection, WebSocketClosedError, websocket_connect

READY = {"type": "event", "name": "document_ready", "values": {"type": "map"}}


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
    controls
        Of the settings that have come to the page so far: the model that has the value, and what it
        is made of, by the setting's name.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._socket: WebSocketClientConnection | None = None
        self._pulse = self._token = ""
        self._count = 0
        self._writes = asyncio.Lock()
        self._text = 0
        self.began = time.monotonic()
        self.times: list[float] = []
        self.size = 0
        self.controls: dict[str, tuple[str, dict[str, Any]]] = {}

    async def open(self) -> None:
        """Ask for the page, connect, and say that it is built."""
        self.began = time.monotonic()
        client = AsyncHTTPClient()
        answer = await client.fetch(self._address, request_timeout=120)
        found = re.search(r'"token":\s*"([^"]+)"', answer.body.decode())
        assert found, "no page"
        self._token = found[1]
        await self.connect()
        await self._send("PULL-DOC-REQ", {})
        while not self._pulse:
            kind, content = await self._message()
            if kind == "PULL-DOC-REPLY":
                self._pulse = _pulse_of(content)
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
            while (message := await self._message())[0]:
                kind, content = message
                self.controls.update(_controls_of(content))
                for event in content.get("events", ()) if kind == "PATCH-DOC" else ():
                    if event.get("model", {}).get("id") == self._pulse and event["attr"] == "frame":
                        self.times.append(time.monotonic())
                        await self.set("painted", event["new"])

    async def set(self, name: str, value: Any) -> None:
        """Set a parameter of its pulse."""
        await self.change(self._pulse, name, value)

    async def change(self, model_id: str, name: str, value: Any) -> None:
        """Set an attribute of a model."""
        model = {"id": model_id}
        await self._patch({"kind": "ModelChanged", "model": model, "attr": name, "new": value})

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close()

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
        """Give kind and content of the next message; empty at the end."""
        header = await self._part()
        if header is None:
            return "", {}
        parts = json.loads(header)
        await self._part()
        content = await self._part()
        for _ in range(2 * parts.get("num_buffers", 0)):
            await self._part()
        return parts["msgtype"], json.loads(content or "{}")

    async def _part(self) -> str | bytes | None:
        assert self._socket is not None
        part = await self._socket.read_message()
        self.size += len(part or "")
        return part


def _pulse_of(content: Any) -> str:
    """Find the model of the component that acknowledges pictures."""
    if isinstance(content, list):
        return next((found for one in content if (found := _pulse_of(one))), "")
    if not isinstance(content, dict):
        return ""
    if content.get("class_name") == "Pulse":
        return str(content["data"]["id"])
    return next((found for one in content.values() if (found := _pulse_of(one))), "")


def _controls_of(content: Any) -> dict[str, tuple[str, dict[str, Any]]]:
    """Find the widgets of settings."""
    found: dict[str, tuple[str, dict[str, Any]]] = {}
    if isinstance(content, dict):
        for word in content.get("css_classes") or ():
            if word.startswith("setting-"):
                data = content["data"]
                found[word.removeprefix("setting-")] = data["id"], data.get("attributes", {})
        content = list(content.values())
    if isinstance(content, list):
        for one in content:
            found.update(_controls_of(one))
    return found


async def until(condition: Any, patience: float = 120.0) -> None:
    """Wait until something is so."""
    end = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < end
        await asyncio.sleep(0.02)
