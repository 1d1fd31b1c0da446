"""The server of pages: number and address of pages, compression, and log."""

from __future__ import annotations

import asyncio
import logging
import os
import time
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import SplitResult, urlsplit
from weakref import WeakSet

import panel as pn
import param
from bokeh.server.urls import per_app_patterns
from bokeh.settings import settings
from panel.io.server import DocHandler, WSHandler
from panel.viewable import Layoutable
from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPServerRequest
from tornado.routing import Matcher, Rule
from tornado.web import Application, ErrorHandler, GZipContentEncoding
from tornado.websocket import WebSocketClosedError

from solver.refusal import RefusedError

VARIABLE = "SLIPFRONT_PAGES"
"""Variable of the environment with the largest number of open pages."""
OF_A_PAGE = 150_000_000
"""Memory that a page may need, bytes, most of it in its worker and its history."""
SHARE = 0.8
"""Share of the memory of the machine, or of its container, that all pages may take."""
LONGEST = 16_000
"""Largest number of characters of an address; a longer one is refused (414)."""
RECEIVED = 1 << 20
"""Largest size of a request's head, bytes: a longer address than `LONGEST` is read, so
that it is refused with its own status."""
POLICY = "script-src-attr 'none'; object-src 'none'"
"""Policy on contents: handlers in elements do not run, should a text become markup
after all. Scripts in the page stay allowed, as Bokeh has no nonces for its own: with
`script-src 'self'` there would be no page."""
PAUSE = 0.02
"""Time between two pages that are made, in which the server answers others, s."""
OPENING = 20
"""Number of pictures for which a page that opens is left time, before others have their
next one. It takes the server as long as fifty."""
LOOKS = {
    "attached",
    "auto_scroll_limit",
    "button_style",
    "button_type",
    "color",
    "dark_theme",
    "description",
    "description_delay",
    "disable_elevation",
    "disabled",
    "end_icon",
    "href",
    "icon",
    "icon_size",
    "label",
    "orientation",
    "scroll",
    "scroll_button_threshold",
    "size",
    "sx",
    "target",
    "theme_config",
    "use_shadow_dom",
    "value_label",
    "variant",
    "view_latest",
}
"""Names of parameters of components that say how these look, beside sizes and margins,
and that a page has ten copies of or more."""
QUIET = 60.0
"""Least time between two errors of one log that are written, s."""


class Pages:
    """A count of the open pages, and states of pages in the making."""

    def __init__(self) -> None:
        self.count = 0
        self.opening: WeakSet[object] = WeakSet()

    def enter(self) -> bool:
        """Count a page, if another one is allowed; return whether it is."""
        has_room = self.count < most_pages()
        self.count += has_room
        return has_room

    def leave(self) -> None:
        """Remove a page from the count."""
        self.count -= 1

    def pause(self, seconds: float) -> float:
        """Pause of a page for the others after a piece of work, s.

        Each of them may need as long, and more while it is made.
        """
        others = self.count - 1 + OPENING * len(self.opening)
        return max(others, 0) * seconds


PAGES = Pages()


def most_pages() -> int:
    """Largest number of open pages, as set, or as memory allows.

    Raises
    ------
    RefusedError
        If what is set is no such number.
    """
    if text := os.environ.get(VARIABLE):
        if text.strip().isdecimal() and int(text) > 0:
            return int(text)
        remedy = "or leave it out, for as many pages as memory holds"
        raise RefusedError(VARIABLE, text, "whole numbers from 1 on", remedy)
    memory = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    # A container may have less memory than its machine.
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


def port() -> int:
    """Port of the server of this page."""
    return _address().port or 80


def _address() -> SplitResult:
    """Address of this page without its query."""
    return urlsplit(pn.state.location.href.partition("?")[0])


def configure() -> None:
    """Make Tornado, on which Panel serves, use this kind of server."""
    HTTPServer.configure(PageServer)
    ours = {DocHandler: PageHandler, WSHandler: PageSocket}
    per_app_patterns[:0] = [
        (path, ours[handler]) for path, handler in per_app_patterns if handler in ours
    ]
    for name in (
        "bokeh.server.views.ws",
        "bokeh.server.protocol_handler",
        "tornado.application",
    ):
        logging.getLogger(name).addFilter(OneLine())
    logging.getLogger("asyncio").addFilter(is_of_an_open_page)


def lighten() -> None:
    """Switch off Bokeh's checks of the program, which tests without a server have.

    The signatures of a page's thousand callbacks would take a tenth of the time in
    which it is made.
    """
    settings.perform_error_diagnostics = False
    settings.perform_document_validation = False
    # Read once: else the environment is asked for each of a page's models.
    settings.simple_ids = settings.simple_ids()
    settings.serialize_include_defaults = settings.serialize_include_defaults()


def share_looks() -> None:
    """Make components of a kind share the definitions of their looks.

    Param copies a definition for each component that asks for it, as it may be changed
    or referred to there: a page has 2300 copies. Nothing does so with these.
    """
    looks = set(Layoutable.param) - {"name", "visible"} | LOOKS
    for kind in param.descendents(Layoutable):
        for name in looks & set(kind.param):
            kind.param[name].per_instance = False


class PageServer(HTTPServer):
    """HTTP server that compresses answers: a first visit takes 1.6 MB, not 4.7."""

    def initialize(self, request_callback: Any, **options: Any) -> None:  # type: ignore[override]
        """Set the application up, as `HTTPServer.initialize` does."""
        if isinstance(request_callback, Application):
            request_callback.add_transform(Compressed)
            # As the first rule, it comes before all pages.
            request_callback.wildcard_router.rules.insert(
                0, Rule(Refused(), ErrorHandler)
            )
        super().initialize(request_callback, **{"max_header_size": RECEIVED, **options})


class PageHandler(DocHandler):
    """Handler of requests for pages, which are made one by one.

    All of a server has one thread. Of many requests that come together each would make
    its page, and then each its figures, before anything else is answered.
    """

    _turn = asyncio.Lock()

    def set_default_headers(self) -> None:
        """Add the policy on contents to the headers of a page."""
        self.set_header("Content-Security-Policy", POLICY)

    async def prepare(self) -> None:
        """Wait for earlier requests, and until other pages are answered."""
        await super().prepare()
        async with self._turn:
            await asyncio.sleep(PAUSE)


class PageSocket(WSHandler):
    """Socket of a page that sends messages without delay.

    Bokeh writes a message in parts. Each would wait until the browser has acknowledged
    the part before, which browsers put off by some 40 ms.
    """

    def open(self, *args: Any, **kwargs: Any) -> Any:
        """Begin to receive messages."""
        self.set_nodelay(True)
        return super().open(*args, **kwargs)

    def ping(self, data: str | bytes = b"") -> None:
        """Ping the browser, unless the socket is closing.

        `on_close` is about to release it. Bokeh would do so at once, and then once
        more, which is an error.
        """
        with suppress(WebSocketClosedError):
            super().ping(data)


class Compressed(GZipContentEncoding):
    """Compression at a fast level, as all pages wait for it."""

    GZIP_LEVEL = 1


class Refused(Matcher):
    """Rule for addresses that are too long (414), and paths that no file has (404)."""

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """Status of a refused address; None if it is allowed."""
        if len(request.uri or "") > LONGEST:
            return {"target_kwargs": {"status_code": 414}}
        if "%00" in request.path:
            return {"target_kwargs": {"status_code": 404}}
        return None


def is_of_an_open_page(record: logging.LogRecord) -> bool:
    """Check whether a record of the log is not about a message to a closed page."""
    return not (
        record.exc_info and isinstance(record.exc_info[1], WebSocketClosedError)
    )


class OneLine(logging.Filter):
    """Filter of a log: errors in one line without traceback, at a limited rate."""

    _last = -QUIET

    def filter(self, record: logging.LogRecord) -> bool:
        """Check whether a record is logged; drop its traceback."""
        if record.exc_info is None or record.levelno < logging.ERROR:
            return True
        record.exc_info = record.exc_text = None
        # Whoever speaks another language at this port would fill the log.
        now = time.monotonic()
        is_due = now - self._last > QUIET
        self._last = max(self._last, now)
        return is_due
