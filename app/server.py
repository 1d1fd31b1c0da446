"""The server that pages come from: compressed files, refused addresses, a short log."""

from __future__ import annotations

import logging
import time
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPServerRequest
from tornado.routing import Matcher, Rule
from tornado.web import Application, ErrorHandler, GZipContentEncoding
from tornado.websocket import WebSocketClosedError

LONGEST = 16_000
"""Characters of an address; what is longer is refused (414)."""
RECEIVED = 1 << 20
"""Bytes of a request's head that are read at all."""
QUIET = 60.0
"""Seconds between two lines of the log that say the same kind of thing."""


def configure() -> None:
    """Have Tornado, on which Panel serves, make its server of this kind."""
    HTTPServer.configure(PageServer)
    for name in ("bokeh.server.views.ws", "bokeh.server.protocol_handler", "tornado.application"):
        logging.getLogger(name).addFilter(OneLine())
    logging.getLogger("asyncio").addFilter(is_of_an_open_page)


class PageServer(HTTPServer):
    """Compresses what it sends: 1.6 MB for a first visit instead of 4.7."""

    def initialize(self, request_callback: Any, **options: Any) -> None:  # type: ignore[override]
        """Set the application up, as `HTTPServer.initialize` does."""
        if isinstance(request_callback, Application):
            request_callback.add_transform(Compressed)
            refused = [(TooLong(), 414), (NoText(), 404)]
            rules: Any = [Rule(m, ErrorHandler, {"status_code": code}) for m, code in refused]
            request_callback.wildcard_router.rules[:0] = rules
        super().initialize(request_callback, **{"max_header_size": RECEIVED, **options})


class Compressed(GZipContentEncoding):
    """Compression that takes little time: all pages wait for it."""

    GZIP_LEVEL = 1


class TooLong(Matcher):
    """Addresses that are too long."""

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """Whether it is one."""
        return {} if len(request.uri or "") > LONGEST else None


class NoText(Matcher):
    """Paths that no file can have."""

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """Whether it is one."""
        return {} if "%00" in request.path else None


def is_of_an_open_page(record: logging.LogRecord) -> bool:
    """Whether a record is of anything but a message to a page that was closed meanwhile."""
    return not (record.exc_info and isinstance(record.exc_info[1], WebSocketClosedError))


class OneLine(logging.Filter):
    """Log a message that is none of Bokeh's in one line, and seldom."""

    def __init__(self) -> None:
        super().__init__()
        self._last = -QUIET

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether a record is logged; its traceback is not."""
        if record.exc_info is None or record.levelno < logging.ERROR:
            return True
        record.exc_info = record.exc_text = None
        now = time.monotonic()
        is_due, self._last = now - self._last > QUIET, max(self._last, now)
        return is_due
