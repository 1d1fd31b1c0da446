"""The server that pages come from.

Their number and address, compressed files, and the log.
"""

from __future__ import annotations

import logging
import os
import time
from pathlib import Path
from typing import Any
from urllib.parse import SplitResult, urlsplit

import panel as pn
from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPHeaders, HTTPServerRequest
from tornado.routing import Matcher, Rule
from tornado.web import Application, ErrorHandler, GZipContentEncoding, OutputTransform
from tornado.websocket import WebSocketClosedError

OF_A_PAGE = 150_000_000
"""Bytes that a page may need, most of them in its worker and its history."""
SHARE = 0.8
"""Of the machine's memory, or the container's, that pages may take together."""
FULL = (
    "<h2>Slipfront is full</h2><p>This server has as many pages open as it can serve. "
    "This page tries again by itself.</p><meta http-equiv=refresh content=20>"
)
LONGEST = 16_000
"""Characters of an address; what is longer is refused (414)."""
RECEIVED = 1 << 20
"""Bytes of a request's head that are read at all."""
POLICY = "script-src-attr 'none'; object-src 'none'"
"""No handler that stands in an element runs, should a text become one after all.
Scripts that stand in the page are Bokeh's, which has no nonces for them: with
`script-src 'self'` there is no page."""
QUIET = 60.0
"""Seconds between two lines of the log that say the same kind of thing."""


class Pages:
    """A count of the pages that are open."""

    def __init__(self) -> None:
        self.count = 0

    def enter(self) -> bool:
        """Count a page, if there is room for it."""
        has_room = self.count < most_pages()
        self.count += has_room
        return has_room

    def leave(self) -> None:
        """Count a page no more."""
        self.count -= 1


PAGES = Pages()


def most_pages() -> int:
    """Largest number of open pages, as set, or as memory allows."""
    if text := os.environ.get("SLIPFRONT_PAGES"):
        return max(int(text), 1)
    memory = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    limit = Path("/sys/fs/cgroup/memory.max")
    if limit.exists() and (text := limit.read_text(encoding="ascii").strip()) != "max":
        memory = min(memory, float(text))
    return max(int(SHARE * memory / OF_A_PAGE), 1)


def address_for_others() -> str:
    """Address of this page without its query; "" where that is localhost."""
    here = _address()
    host = here.hostname or "localhost"
    if host in ("localhost", "::1") or host.startswith("127."):
        return ""
    return here.geturl()


def how_to_open() -> str:
    """Advice to a person who serves a page as localhost, for others to reach it (HTML)."""
    name = f"NAME:{_address().port or 80}"
    return (
        "Others cannot open <b>localhost</b>, which is each machine's own name. For a class start "
        f"the server with <code>BOKEH_ALLOW_WS_ORIGIN={name}</code>, and open "
        f"<b>http://{name}/app</b>: NAME is what others call this machine."
    )


def _address() -> SplitResult:
    location = pn.state.location
    return urlsplit(location.href.partition("?")[0] if location is not None else "")


def configure() -> None:
    """Have Tornado, on which Panel serves, use this kind of server."""
    HTTPServer.configure(PageServer)
    for name in (
        "bokeh.server.views.ws",
        "bokeh.server.protocol_handler",
        "tornado.application",
    ):
        logging.getLogger(name).addFilter(OneLine())
    logging.getLogger("asyncio").addFilter(is_of_an_open_page)


class PageServer(HTTPServer):
    """Compresses answers: 1.6 MB for a first visit instead of 4.7."""

    def initialize(self, request_callback: Any, **options: Any) -> None:  # type: ignore[override]
        """Set the application up, as `HTTPServer.initialize` does."""
        if isinstance(request_callback, Application):
            request_callback.add_transform(Compressed)
            request_callback.add_transform(Guarded)
            request_callback.wildcard_router.rules.insert(
                0, Rule(Refused(), ErrorHandler)
            )
        super().initialize(request_callback, **{"max_header_size": RECEIVED, **options})


class Compressed(GZipContentEncoding):
    """Compression that takes little time: all pages wait for it."""

    GZIP_LEVEL = 1


class Guarded(OutputTransform):
    """Sends browsers a policy on contents that no page of this server has."""

    def transform_first_chunk(
        self, status_code: int, headers: HTTPHeaders, chunk: bytes, finishing: bool
    ) -> tuple[int, HTTPHeaders, bytes]:
        """Add the policy to the head of an answer."""
        headers["Content-Security-Policy"] = POLICY
        return status_code, headers, chunk


class Refused(Matcher):
    """Addresses that are too long (414), and paths that no file can have (404)."""

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """Status with which an address is refused; None if it is not."""
        if len(request.uri or "") > LONGEST:
            return {"target_kwargs": {"status_code": 414}}
        if "%00" in request.path:
            return {"target_kwargs": {"status_code": 404}}
        return None


def is_of_an_open_page(record: logging.LogRecord) -> bool:
    """Check whether a record is of anything but a message to a closed page."""
    return not (
        record.exc_info and isinstance(record.exc_info[1], WebSocketClosedError)
    )


class OneLine(logging.Filter):
    """Log messages that are not of Bokeh in one line, and seldom."""

    _last = -QUIET

    def filter(self, record: logging.LogRecord) -> bool:
        """Check whether a record is logged; drop its traceback."""
        if record.exc_info is None or record.levelno < logging.ERROR:
            return True
        record.exc_info = record.exc_text = None
        now = time.monotonic()
        is_due = now - self._last > QUIET
        self._last = max(self._last, now)
        return is_due
