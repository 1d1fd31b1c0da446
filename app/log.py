"""The server's log: a line for what happens, and none for what follows from it."""

from __future__ import annotations

import logging

from tornado.iostream import StreamClosedError
from tornado.websocket import WebSocketClosedError

LOGGERS = ("asyncio", "bokeh.server.views.ws", "panel.io.document", "tornado.application")
NOT_SENT = "Failed sending message as connection was closed"
"""What Bokeh and Panel say of each message on its way to a page that is closed or reloaded."""


def leave_out_the_unsent() -> None:
    """Have nothing said of messages that a closed socket did not take: its closing is a line."""
    for name in LOGGERS:
        logging.getLogger(name).addFilter(_is_news)


def _is_news(record: logging.LogRecord) -> bool:
    error = record.exc_info[1] if record.exc_info else None
    is_of_closed = isinstance(error, WebSocketClosedError | StreamClosedError)
    return not is_of_closed and record.getMessage() != NOT_SENT
